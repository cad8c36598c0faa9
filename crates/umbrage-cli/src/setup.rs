//! From options to a scene that is ready to be drawn. What is cheap to refuse is refused first.

use crate::args::SceneArgs;
use crate::cases::{self, Case};
use crate::fault::{Fault, suggest};
use crate::roles;
use crate::specs::{CameraChoice, CameraSpec, Exposure, Pair};
use glam::{UVec2, Vec3};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use umbrage_render::RenderOptions;
use umbrage_render::umbrage::core::technique::Settings;
use umbrage_render::umbrage::core::{Camera, Projection};
use umbrage_scene::{Image, Playing, Pose, Scene, SceneLight};

/// A scene with all that the command line adds to it.
#[derive(Debug)]
pub struct Stage {
    /// Lights and ground are as asked for.
    pub scene: Scene,
    /// Where it is seen from.
    pub camera: Camera,
    /// Pixels.
    pub size: UVec2,
    /// From the command line or the case.
    pub background: Option<Vec3>,
    /// What the case asks for, texels.
    pub map_size: Option<u32>,
    /// The number that each light had before some were left out.
    pub light_numbers: Vec<usize>,
    /// What was added or left out, for the user's eye.
    pub notes: Vec<String>,
    /// Time of reading.
    pub load_ms: f64,
}

/// Loads the scene, its lights and its camera.
///
/// # Errors
/// What cannot be read, or is not in the scene.
pub fn stage(args: &SceneArgs) -> Result<Stage, Fault> {
    let case = args.lights_from.as_ref().map(cases::read).transpose()?;
    let cookies = args
        .light
        .iter()
        .map(|light| light.cookie.as_deref().map(picture).transpose())
        .collect::<Result<Vec<_>, _>>()?;
    let start = Instant::now();
    let (mut scene, playing) = load(args)?;
    let load_ms = start.elapsed().as_secs_f64() * 1e3;

    let bounds = scene.bounds();
    let middle = bounds.center();
    let radius_m = bounds.radius().max(1e-6);
    if !args.light.is_empty() {
        scene.lights.clear();
    }
    for (index, (spec, cookie)) in args.light.iter().zip(cookies).enumerate() {
        let light = spec.resolve(middle, radius_m);
        light.check().map_err(|e| Fault::WrongUse(format!("--light number {}: {e}", index + 1)))?;
        let cookie = cookie.map(|image| {
            scene.images.push(image);
            scene.images.len() - 1
        });
        scene.lights.push(SceneLight { name: format!("--light {index}"), light, cookie });
    }
    let Case { lights, camera, size, background, map_size, mut notes } = match case {
        Some(case) => case,
        None => no_case(&scene),
    };
    if args.lights_from.is_some() {
        scene.lights = lights;
    }
    notes.extend(playing);
    notes.extend(umbrage_scene::add_defaults(&mut scene));
    let from_case = args.lights_from.is_some().then_some(camera);
    if from_case.is_some() {
        // The case has its own camera: a note about one that was added to the scene would mislead.
        notes.retain(|note| !note.starts_with("no camera"));
    }
    let camera = choose_camera(args.camera.as_ref(), &scene, from_case, middle, radius_m)?;
    if args.ground {
        umbrage_scene::add_ground(&mut scene);
    }
    roles::take(&mut scene, args)?;
    let size = args.size.unwrap_or(size);
    let light_numbers = keep_lights(&mut scene, &args.lights)?;
    let background = args.background.or(background);
    Ok(Stage { scene, camera, size, background, map_size, light_numbers, notes, load_ms })
}

/// Loads the scene as the options have it, with a note on what plays.
fn load(args: &SceneArgs) -> Result<(Scene, Option<String>), Fault> {
    let Some(time_s) = args.time else { return Ok((umbrage_scene::load(&args.scene)?, None)) };
    let scene = umbrage_scene::load_at(&args.scene, &Pose { time_s, animation: args.animation.clone() })?;
    let note = scene.playing.as_ref().map(|playing| {
        let Playing { number, name, length_s, time_s } = playing;
        format!("animation {number} `{name}` is shown at {time_s:.3} s of {length_s:.3} s")
    });
    Ok((scene, note))
}

/// Keeps the lights that are named, all when none is. Returns the number that each had.
fn keep_lights(scene: &mut Scene, asked: &[String]) -> Result<Vec<usize>, Fault> {
    let names = || scene.lights.iter().map(|placed| placed.name.as_str());
    let mut numbers = Vec::new();
    for name in asked {
        let by_name = names().position(|other| other == name);
        let found = by_name.or_else(|| name.parse().ok().filter(|n| *n < scene.lights.len()));
        let number = found.ok_or_else(|| {
            let near = suggest(name, names().filter(|name| !name.is_empty()));
            let count = scene.lights.len();
            Fault::WrongUse(format!(
                "--lights: there is no light `{name}`{near}; there are {count}, from 0 on"
            ))
        })?;
        if !numbers.contains(&number) {
            numbers.push(number);
        }
    }
    if asked.is_empty() {
        numbers = (0..scene.lights.len()).collect();
    }
    scene.lights = numbers.iter().map(|number| scene.lights[*number].clone()).collect();
    Ok(numbers)
}

/// Without a case: the scene's own lights and camera, and the usual size.
fn no_case(scene: &Scene) -> Case {
    let camera = scene
        .cameras
        .first()
        .map_or_else(|| Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 0.7, 0.1, 100.0), |placed| placed.camera);
    let size = UVec2::new(1280, 720);
    Case { lights: Vec::new(), camera, size, background: None, map_size: None, notes: Vec::new() }
}

fn picture(path: &Path) -> Result<Image, Fault> {
    let refused = |reason: &dyn std::fmt::Display| {
        Fault::Failed(format!("cannot read the cookie {}: {reason}", path.display()))
    };
    if path.is_dir() {
        return Err(refused(&"it is a folder; name a picture in it"));
    }
    let opened = image::ImageReader::open(path).and_then(image::ImageReader::with_guessed_format);
    let decoded = opened
        .map_err(|e| refused(&e))?
        .decode()
        .map_err(|e| refused(&format!("{e}; png, jpg and webp are read")))?;
    let rgba = decoded.into_rgba8();
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Image { name, width: rgba.width(), height: rgba.height(), rgba: rgba.into_raw() })
}

/// `scene` has a camera: defaults were added.
fn choose_camera(
    choice: Option<&CameraChoice>,
    scene: &Scene,
    from_case: Option<Camera>,
    middle: Vec3,
    radius_m: f32,
) -> Result<Camera, Fault> {
    let first = from_case.or(scene.cameras.first().map(|placed| placed.camera));
    let first = first.ok_or_else(|| Fault::Failed("the scene has no camera".into()))?;
    match choice {
        None => Ok(first),
        Some(CameraChoice::OfScene(name)) => camera_of_scene(scene, name),
        Some(CameraChoice::Spec(spec)) => {
            let camera = changed(first, spec, middle, radius_m);
            camera.check().map_err(|e| Fault::WrongUse(format!("--camera: {e}")))?;
            Ok(camera)
        }
    }
}

pub fn camera_of_scene(scene: &Scene, name: &str) -> Result<Camera, Fault> {
    let by_name = scene.cameras.iter().find(|placed| placed.name == name);
    let by_number = || name.parse::<usize>().ok().and_then(|index| scene.cameras.get(index));
    if let Some(found) = by_name.or_else(by_number) {
        return Ok(found.camera);
    }
    let names = || scene.cameras.iter().map(|placed| placed.name.as_str()).filter(|name| !name.is_empty());
    let known: Vec<String> = scene
        .cameras
        .iter()
        .enumerate()
        .take(20)
        .map(|(i, placed)| format!("{i} `{}`", placed.name))
        .collect();
    let near = suggest(name, names());
    Err(Fault::WrongUse(format!(
        "--camera: the scene has no camera `{name}`{near}; it has {}",
        known.join(", ")
    )))
}

fn changed(first: Camera, spec: &CameraSpec, middle: Vec3, radius_m: f32) -> Camera {
    let position = spec.position.unwrap_or(first.position_world);
    let target = match (spec.target, spec.position) {
        (Some(target), _) => target,
        (None, Some(_)) => middle,
        (None, None) => position + first.direction_world * position.length().max(1.0),
    };
    let projection = spec
        .fov_deg
        .map_or(first.projection, |degrees| Projection::Perspective { fov_y_rad: degrees.to_radians() });
    // A camera that was moved away must not lose the scene behind its far plane.
    let reach_m = position.distance(middle) + 2.0 * radius_m;
    let far_m =
        spec.far_m.unwrap_or(if spec.position.is_some() { first.far_m.max(reach_m) } else { first.far_m });
    let near_m = spec.near_m.unwrap_or(first.near_m.min(0.5 * far_m));
    let aimed = Camera::look_at(position, target, 1.0, near_m, far_m);
    let turned = spec.target.is_some() || spec.position.is_some();
    let direction_world = if turned && position == target {
        Vec3::ZERO
    } else if turned {
        aimed.direction_world
    } else {
        first.direction_world
    };
    let up_world = spec.up.unwrap_or(if turned { aimed.up_world } else { first.up_world });
    Camera { direction_world, up_world, projection, ..aimed }
}

/// The technique with what was set, and the case's map size unless that was set too.
///
/// # Errors
/// [`Fault::WrongUse`] names what is unknown or out of range.
pub fn settings(id: &str, set: &[Pair], map_size: Option<u32>) -> Result<Settings, Fault> {
    let pairs = || set.iter().map(|pair| (pair.key.as_str(), pair.value.as_str()));
    let settings = Settings::new(id, pairs())?;
    let size = map_size.map(|size| size.to_string());
    match size {
        Some(size)
            if settings.value("map_size").is_some() && set.iter().all(|pair| pair.key != "map_size") =>
        {
            Ok(Settings::new(id, pairs().chain([("map_size", size.as_str())]))?)
        }
        _ => Ok(settings),
    }
}

/// Everything about the picture that the shared options say.
///
/// # Errors
/// A file of the user's own WGSL that cannot be read.
pub fn options(args: &SceneArgs, stage: &Stage, settings: Settings) -> Result<RenderOptions, Fault> {
    let plain = RenderOptions::new(settings);
    Ok(RenderOptions {
        size: stage.size,
        samples: args.msaa,
        all_blinn: args.shading == "documents",
        ambient: args.ambient,
        fill: args.fill,
        exposure: match args.exposure {
            Exposure::Auto => None,
            Exposure::Factor(factor) => Some(factor),
        },
        background: stage.background.unwrap_or(plain.background),
        all_casters: args.all_casters,
        deform: args.deform.as_deref().map(own_wgsl).transpose()?,
        deform_reach_m: args.deform_reach,
        time_s: args.time.unwrap_or(0.0),
        kernel: args.kernel.as_deref().map(own_wgsl).transpose()?,
        ..plain
    })
}

/// The text of a file of the user's own WGSL.
fn own_wgsl(path: &Path) -> Result<Arc<str>, Fault> {
    let text = std::fs::read_to_string(path).map_err(|e| {
        Fault::Failed(format!("cannot read {}: {e}; name a text file with a WGSL function", path.display()))
    })?;
    Ok(Arc::from(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(text: &str) -> CameraSpec {
        match crate::specs::camera(text) {
            Ok(CameraChoice::Spec(spec)) => spec,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_a_camera_does_not_say_comes_from_the_scene() {
        let first = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 1.0, 0.1, 20.0);
        let with = |text| changed(first, &spec(text), Vec3::ZERO, 1.0);
        let wide = with("fov=90");
        assert_eq!(
            (wide.position_world, wide.direction_world),
            (first.position_world, first.direction_world)
        );
        assert_eq!(wide.projection, Projection::Perspective { fov_y_rad: 90f32.to_radians() });
        let moved = with("position=100:0:0");
        assert!((moved.direction_world - Vec3::NEG_X).length() < 1e-6 && moved.far_m >= 101.0);
        let turned = with("target=5:0:5,up=0:0:1");
        assert!((turned.direction_world - Vec3::X).length() < 1e-6 && turned.up_world == Vec3::Z);
        assert!(with("position=0:0:0").check().is_err());
        assert_eq!(with("far=9").far_m, 9.0);
    }

    #[test]
    fn a_map_size_of_a_case_gives_way() {
        let pair = |key: &str, value: &str| [Pair { key: key.into(), value: value.into() }];
        let size = |id, set: &[Pair]| settings(id, set, Some(512)).expect("valid").map_size_texel();
        assert_eq!(size("linear", &[]), 512);
        assert_eq!(size("linear", &pair("map_size", "64")), 64);
        assert_eq!(size("unshadowed", &[]), 0);
    }
}
