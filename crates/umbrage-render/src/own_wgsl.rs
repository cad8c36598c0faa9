//! WGSL functions of the user's own: checked before they are joined with ours, so that a mistake is told in their terms.

use crate::RenderError;
use umbrage::core::wgsl::assemble;

/// Checks a `fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f`.
///
/// # Errors
/// [`RenderError::Wgsl`] with the line and the reason.
pub fn check_deform(text: &str) -> Result<(), RenderError> {
    let call = "fn check(p: vec3f, t: f32) -> vec3f { return umbrage_deform(p, p, t); }";
    check(
        "deform",
        "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f",
        "",
        text,
        call,
    )
}

/// Checks a `fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f`.
///
/// # Errors
/// [`RenderError::Wgsl`] with the line and the reason.
pub fn check_kernel(text: &str) -> Result<(), RenderError> {
    let view = assemble(&["view"]).unwrap_or_default();
    let call = "fn check(view: UmbrageView, x: vec4f) -> vec4f { return umbrage_kernel(view, x, x); }";
    check(
        "kernel",
        "fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f",
        &view,
        text,
        call,
    )
}

fn check(
    what: &'static str,
    wanted: &'static str,
    before: &str,
    text: &str,
    call: &str,
) -> Result<(), RenderError> {
    let refused = |reason: String| RenderError::Wgsl { what, wanted, reason };
    let whole = format!("{before}\n{text}\n{call}\n");
    // Where the user's own text begins and ends.
    let first = before.matches('\n').count() as u32 + 2;
    let past = first + text.lines().count() as u32;
    let at = |location: Option<naga::SourceLocation>| match location.map(|place| place.line_number) {
        Some(line) if line >= past => "where it is called: ".to_owned(),
        Some(line) if line >= first => format!("line {}: ", line + 1 - first),
        _ => String::new(),
    };
    let module = naga::front::wgsl::parse_str(&whole)
        .map_err(|e| refused(format!("{}{}", at(e.location(&whole)), e.message())))?;
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&module)
        .map_err(|e| refused(format!("{}{}", at(e.location(&whole)), e.into_inner())))?;
    if module.global_variables.is_empty() && module.entry_points.is_empty() {
        return Ok(());
    }
    Err(refused("it binds something or has an entry point; a plain function is needed".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_works_passes_and_what_does_not_is_told_with_its_line() {
        let good = "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {\n    return p_world;\n}";
        assert_eq!(check_deform(good), Ok(()));
        assert_eq!(
            check_kernel(
                "fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f { return right + down; }"
            ),
            Ok(())
        );
        for (text, words) in [
            ("", "umbrage_deform"),
            ("fn umbrage_deform(p: vec3f) -> vec3f { return p; }", "where it is called"),
            (
                "fn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f {\n    return p_wrld;\n}",
                "line 2",
            ),
            ("not a shader", "line 1"),
            (
                "@group(0) @binding(0) var<uniform> x: f32;\nfn umbrage_deform(p_world: vec3f, p_object: vec3f, time_s: f32) -> vec3f { return p_world * x; }",
                "binds",
            ),
        ] {
            let message = check_deform(text).expect_err(words).to_string();
            assert!(message.contains(words) && !message.contains('\n'), "{message}");
        }
    }
}
