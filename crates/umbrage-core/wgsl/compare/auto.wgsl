// Texels compared so that no lit surface shadows itself and shadows begin where their casters stand, at any scale and without
// a number to set.
//
// A texel blocks the light only where all that the map and the receiver know agrees:
// - what it holds lies above the receiver's plane, at the texel's centre: so a slope does not shadow itself;
// - its own plane, carried on to the receiver's ray, lies above the receiver: so neither does the other side of a crease. The map
//   is drawn with a polygon offset that carries every caster on by UMBRAGE_NEAR of a texel;
// - and it lies above the receiver by more than rounding, and than a bump that no texel resolves.
// A texel farther away than UMBRAGE_NEAR may show the next step of a stair rather than what stands in the receiver's light. How
// far a surface may rise on the way there is bounded by a cone of slope UMBRAGE_CONE: what lies below it is not believed and does
// not count. A texel that lets light pass is not believed either where the receiver's own blocker is as close. So a wide filter
// becomes narrow where caster and receiver touch, as a penumbra does.

// Up to where a texel tells of the receiver's own ray, texels; and the height of a bump that no texel resolves, widths of one.
const UMBRAGE_NEAR = 0.75;
// The steepest rise of a lit surface that is believed in, depth by width.
const UMBRAGE_CONE = 8.0;
// Share of a slope that is lost to rounding of normals and depths.
const UMBRAGE_SLOPE_LOST = 0.01;

// `right` and `down`: from the receiver to each texel's centre, texels.
fn umbrage_compare(view: UmbrageView, at: UmbrageTexel, stored: vec4f, right: vec4f, down: vec4f) -> UmbrageTaps {
    // Heights above the receiver, towards the light, in widths of a texel: of what the map holds, and of the receiver's plane.
    let height = (at.depth - stored) * (UMBRAGE_AWAY / at.unit);
    let slope = at.slope * (-UMBRAGE_AWAY / at.unit);
    let plane = slope.x * right + slope.y * down;
    let lost = at.noise / at.unit;
    let rounding = lost + UMBRAGE_SLOPE_LOST * (abs(slope.x) + abs(slope.y));
    let blocked = height > max(plane + rounding, vec4f(UMBRAGE_NEAR + lost));
    let rise = UMBRAGE_CONE * max(sqrt(right * right + down * down) - UMBRAGE_NEAR, vec4f(0.0));
    let believed = !blocked | (height > UMBRAGE_NEAR + lost + rise);
    return UmbrageTaps(
        select(vec4f(1.0), vec4f(0.0), blocked),
        select(vec4f(0.0), vec4f(1.0), believed),
        height,
    );
}

// Does a wide filter become narrow where blocker and receiver are close?
const UMBRAGE_NARROWS = true;

// Which of the texels count in a wide filter. `blocker` is how high above the receiver its own blocker is, in widths of a texel;
// very high where it has none.
fn umbrage_counts(view: UmbrageView, taps: UmbrageTaps, right: vec4f, down: vec4f, blocker: f32) -> vec4f {
    let rise = mix(taps.height, vec4f(blocker), taps.lit);
    let distance = sqrt(right * right + down * down);
    return select(vec4f(0.0), vec4f(1.0), rise >= UMBRAGE_CONE * distance);
}
