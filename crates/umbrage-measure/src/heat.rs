//! Pictures of V, and of how far it is from the truth.

use glam::{UVec2, Vec3};

/// V as a picture: grey, or in the colours of the light that arrives.
pub fn picture_of_v(v: &[Vec3]) -> Vec<u8> {
    let level = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    v.iter().flat_map(|v| [level(v.x), level(v.y), level(v.z), 255]).collect()
}

/// Colours of V - V*, with the values that they stand for; between them colours blend. Orange and blue differ for every
/// kind of colour blindness. `report/page.css` draws its legend from the same stops; a test compares the two.
pub const STOPS: [(f32, [u8; 3]); 4] = [
    (-1.0, [0xb3, 0x58, 0x06]),
    (-0.25, [0xf1, 0xa3, 0x40]),
    (0.25, [0x7f, 0xb8, 0xe6]),
    (1.0, [0x08, 0x51, 0x9c]),
];

/// Differences below this show nothing: a step of an 8-bit picture.
const LEAST: f32 = 1.0 / 255.0;

/// The colour of a difference, and how much of it covers the picture beneath, 0..1.
fn color(difference: f32) -> (Vec3, f32) {
    let d = difference.clamp(-1.0, 1.0);
    let rgb = |i: usize| Vec3::from(STOPS[i].1.map(f32::from));
    let (pale, full) = if d < 0.0 { (1, 0) } else { (2, 3) };
    let share = (d.abs() - 0.25) / 0.75;
    let covers = (d.abs() / 0.25).sqrt().min(1.0);
    (rgb(pale).lerp(rgb(full), share.clamp(0.0, 1.0)), if d.abs() < LEAST { 0.0 } else { covers })
}

/// The signed heat map: where V is below the truth orange, where above blue, over the darkened grey scene. What is not
/// judged is darker, and hatched where the two saw different surfaces.
pub fn heat(
    size: UVec2,
    scene_rgba: &[u8],
    truth: &[Vec3],
    v: &[Vec3],
    receivers: &[bool],
    excluded: &[bool],
) -> Vec<u8> {
    let mean = |v: Vec3| (v.x + v.y + v.z) / 3.0;
    let pixel = |i: usize| {
        let [r, g, b] = [0, 1, 2].map(|c| f32::from(scene_rgba[4 * i + c]));
        let grey = 0.22 * r + 0.71 * g + 0.07 * b;
        let beneath = Vec3::splat(if receivers[i] { 18.0 + 0.3 * grey } else { 12.0 + 0.16 * grey });
        let (x, y) = (i as u32 % size.x, i as u32 / size.x);
        let painted = if excluded[i] {
            if (x + y) % 4 < 2 { Vec3::splat(96.0) } else { beneath }
        } else if receivers[i] {
            let (color, covers) = color(mean(v[i] - truth[i]));
            beneath.lerp(color, covers)
        } else {
            beneath
        };
        let [r, g, b] = painted.to_array().map(|x| x.round() as u8);
        [r, g, b, 255]
    };
    (0..truth.len()).flat_map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_dark_is_orange_and_too_bright_is_blue() {
        let truth = [Vec3::ONE, Vec3::ZERO, Vec3::ONE, Vec3::ONE, Vec3::ONE];
        let v = [Vec3::ZERO, Vec3::ONE, Vec3::ONE, Vec3::ZERO, Vec3::ZERO];
        let receivers = [true, true, true, false, false];
        let excluded = [false, false, false, false, true];
        let found = heat(UVec2::new(5, 1), &[100; 20], &truth, &v, &receivers, &excluded);
        let pixel = |i: usize| &found[4 * i..4 * i + 3];
        assert_eq!((pixel(0), pixel(1)), (&STOPS[0].1[..], &STOPS[3].1[..]));
        assert_eq!((pixel(2), pixel(3)), (&[48, 48, 48][..], &[28, 28, 28][..]));
        assert_eq!(pixel(4), &[96, 96, 96][..]);
    }

    #[test]
    fn the_page_s_legend_has_the_same_stops() {
        let css = include_str!("../report/page.css");
        for (value, [r, g, b]) in STOPS {
            let hex = format!("#{r:02x}{g:02x}{b:02x}");
            assert!(css.contains(&hex), "{hex} of {value} is not in page.css");
        }
    }

    #[test]
    fn v_is_drawn_in_its_colours() {
        assert_eq!(picture_of_v(&[Vec3::new(1.0, 0.5, -1.0)]), [255, 128, 0, 255]);
    }
}
