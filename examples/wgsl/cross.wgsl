// Two streaks across each other, for `umbrage render --technique kernel --set width=9 --kernel examples/wgsl/cross.wgsl`.
fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f {
    return max(vec4f(1.0) - abs(right), vec4f(0.0)) + max(vec4f(1.0) - abs(down), vec4f(0.0));
}
