//! Command lines to be typed again: what was typed, and what draws one picture of it.

use umbrage_render::umbrage::core::{Camera, Projection};

/// Options of `umbrage compare` that `umbrage render` does not know, or that each row has its own of: long name, short
/// name, and whether a value follows.
const NOT_OF_RENDER: [(&str, &str, bool); 11] = [
    ("--techniques", "-t", true),
    ("--set", "-s", true),
    ("--output", "-o", true),
    ("--samples", "", true),
    ("--seed", "", true),
    ("--lights", "", true),
    ("--cameras", "", true),
    ("--path", "", true),
    ("--frames", "", true),
    ("--json", "", false),
    ("--quiet", "-q", false),
];

/// What this process was called with, as one line for a shell.
pub fn whole() -> String {
    let words: Vec<String> = std::iter::once("umbrage".to_owned()).chain(own_words()).collect();
    typed(&words)
}

fn own_words() -> Vec<String> {
    std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect()
}

/// What this process was told of scene, lights and picture.
pub fn scene_words() -> Vec<String> {
    kept(&own_words())
}

fn kept(words: &[String]) -> Vec<String> {
    let mut kept = Vec::new();
    let mut words = words.iter().skip(1); // The command's name.
    while let Some(word) = words.next() {
        let name = word.split_once('=').map_or(word.as_str(), |(name, _)| name);
        let is_short = |short: &str| !short.is_empty() && word.starts_with(short) && !word.starts_with("--");
        match NOT_OF_RENDER.iter().find(|(long, short, _)| *long == name || is_short(short)) {
            None => kept.push(word.clone()),
            // `-o FILE`, `--output FILE`; the value is part of the word in `-oFILE` and `--output=FILE`.
            Some((long, short, true)) if word == long || word == short => {
                words.next();
            }
            Some(_) => {}
        }
    }
    kept
}

/// Words as one line for a shell.
pub fn typed(words: &[String]) -> String {
    let quoted = |word: &String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,+@%".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word.clone()
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    words.iter().map(quoted).collect::<Vec<_>>().join(" ")
}

/// A camera as `--camera` takes it.
pub fn camera_spec(camera: &Camera) -> String {
    let place = |p: glam::Vec3| format!("{}:{}:{}", p.x, p.y, p.z);
    let target = camera.position_world + camera.direction_world;
    let mut spec = format!(
        "position={},target={},up={},near={},far={}",
        place(camera.position_world),
        place(target),
        place(camera.up_world),
        camera.near_m,
        camera.far_m
    );
    if let Projection::Perspective { fov_y_rad } = camera.projection {
        spec += &format!(",fov={}", fov_y_rad.to_degrees());
    }
    spec
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split(' ').map(str::to_owned).collect()
    }

    #[test]
    fn only_what_render_knows_is_kept() {
        let typed = "compare a.glb --ground -t hard,linear --set map_size=64 -sbias=none --size 8x8 -o out \
                     --path=frames=2,turn=1 --samples 4 --json --light radius=1";
        assert_eq!(kept(&words(typed)), words("a.glb --ground --size 8x8 --light radius=1"));
        let typed = "compare a.glb -t hard --time -0.5 --animation Run --techniques=hard";
        assert_eq!(kept(&words(typed)), words("a.glb --time -0.5 --animation Run"));
    }

    #[test]
    fn what_a_shell_would_change_is_quoted() {
        let line = typed(&["umbrage".into(), "my model.glb".into(), "it's".into(), "#fff".into()]);
        assert_eq!(line, r"umbrage 'my model.glb' 'it'\''s' '#fff'");
    }

    #[test]
    fn a_camera_can_be_typed_again() {
        let camera = Camera::look_at(glam::Vec3::new(1.0, 2.0, 3.5), glam::Vec3::ZERO, 0.9, 0.25, 40.0);
        let spec = match crate::specs::camera(&camera_spec(&camera)) {
            Ok(crate::specs::CameraChoice::Spec(spec)) => spec,
            other => panic!("{other:?}"),
        };
        assert_eq!(
            (spec.position, spec.near_m, spec.far_m),
            (Some(camera.position_world), Some(0.25), Some(40.0))
        );
        assert!((spec.fov_deg.expect("a field of view") - 0.9f32.to_degrees()).abs() < 1e-4);
    }
}
