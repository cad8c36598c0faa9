//! Cases for comparing costs: one JSON file that says camera, size and lights, so that every renderer gets the same work.

use crate::fault::{Fault, suggest};
use crate::specs::CaseRef;
use glam::{UVec2, Vec3};
use std::collections::BTreeMap;
use std::f32::consts::PI;
use umbrage_render::umbrage::core::{Camera, Light, LightKind};
use umbrage_scene::SceneLight;

#[derive(serde::Deserialize)]
struct CasesFile {
    image: [u32; 2],
    fovy_deg: f32,
    near: f32,
    far: f32,
    eye: Vec3In,
    target: Vec3In,
    background: Option<Vec3In>,
    cases: BTreeMap<String, CaseIn>,
}

type Vec3In = [f32; 3];

#[derive(serde::Deserialize)]
struct CaseIn {
    #[serde(default)]
    spot: Vec<SpotIn>,
    point: Option<PointIn>,
    dir: Option<Vec3In>,
    distance: Option<f32>,
    cascades: Option<u32>,
    map: Option<u32>,
}

#[derive(serde::Deserialize)]
struct SpotIn {
    pos: Vec3In,
    target: Vec3In,
    outer_deg: f32,
    inner_deg: f32,
    near: Option<f32>,
    far: Option<f32>,
}

#[derive(serde::Deserialize)]
struct PointIn {
    pos: Vec3In,
    near: Option<f32>,
    far: Option<f32>,
}

/// One case, ready to be drawn.
#[derive(Debug)]
pub struct Case {
    /// White lights, pi lux at their target.
    pub lights: Vec<SceneLight>,
    /// Where it is seen from.
    pub camera: Camera,
    /// Pixels.
    pub size: UVec2,
    /// Linear.
    pub background: Option<Vec3>,
    /// Texels.
    pub map_size: Option<u32>,
    /// What the case asks for and does not get.
    pub notes: Vec<String>,
}

/// Reads a case.
///
/// # Errors
/// [`Fault::Failed`] for a file that cannot be read or is not of this format, [`Fault::WrongUse`] for a case that is not in it.
pub fn read(wanted: &CaseRef) -> Result<Case, Fault> {
    let path = wanted.path.display();
    let text = std::fs::read_to_string(&wanted.path)
        .map_err(|e| Fault::Failed(format!("cannot read {path}: {e}; check the path before the last `:`")))?;
    parse(&text, &wanted.case).map_err(|fault| match fault {
        Fault::Failed(reason) => Fault::Failed(format!("{path}: {reason}")),
        Fault::WrongUse(reason) => Fault::WrongUse(format!("{path}: {reason}")),
        other => other,
    })
}

fn parse(text: &str, name: &str) -> Result<Case, Fault> {
    let file: CasesFile =
        serde_json::from_str(text).map_err(|e| Fault::Failed(format!("not a file of cases: {e}")))?;
    let case = file.cases.get(name).ok_or_else(|| {
        let names: Vec<&str> = file.cases.keys().map(String::as_str).collect();
        let near = suggest(name, names.iter().copied());
        Fault::WrongUse(format!("there is no case `{name}`{near}; there are {}", names.join(", ")))
    })?;
    let (eye, target) = (Vec3::from(file.eye), Vec3::from(file.target));
    let camera = Camera::look_at(eye, target, file.fovy_deg.to_radians(), file.near, file.far);
    camera.check().map_err(Fault::Failed)?;
    if file.image.contains(&0) {
        return Err(Fault::Failed("`image` has a side of 0 pixels".into()));
    }
    let lights = lights_of(case, target);
    for placed in &lights {
        placed.light.check().map_err(|e| Fault::Failed(e.to_string()))?;
    }
    let mut notes = Vec::new();
    if let Some(cascades) = case.cascades.filter(|n| *n > 1) {
        notes.push(format!("case {name} asks for {cascades} cascades; a technique with one map draws one"));
    }
    Ok(Case {
        lights,
        camera,
        size: UVec2::from(file.image),
        background: file.background.map(Vec3::from),
        map_size: case.map,
        notes,
    })
}

fn lights_of(case: &CaseIn, target: Vec3) -> Vec<SceneLight> {
    let mut lights = Vec::new();
    let mut add = |light: Light| {
        let name = format!("{} {}", light.kind.id(), lights.len());
        lights.push(SceneLight { name, light, cookie: None });
    };
    for spot in &case.spot {
        let (position, aim) = (Vec3::from(spot.pos), Vec3::from(spot.target));
        let light = Light::spot(position, aim, spot.inner_deg.to_radians(), spot.outer_deg.to_radians());
        let intensity = PI * position.distance_squared(aim);
        add(Light { intensity, near_m: spot.near, far_m: spot.far, ..light });
    }
    if let Some(point) = &case.point {
        let position = Vec3::from(point.pos);
        let intensity = PI * position.distance_squared(target);
        let light = Light {
            kind: LightKind::Point,
            intensity,
            near_m: point.near,
            far_m: point.far,
            ..Light::default()
        };
        add(light.aimed(position, target));
    }
    if let Some(direction) = case.dir {
        let light = Light { kind: LightKind::Directional, intensity: PI, ..Light::default() };
        let back = Vec3::from(direction).normalize_or_zero() * case.distance.unwrap_or(1.0);
        add(light.aimed(target - back, target));
    }
    lights
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r#"{"image":[1280,720],"fovy_deg":60,"near":0.1,"far":100,"eye":[0,7,10],"target":[0,0,0],
        "background":[0.5,0.6,0.7],"cases":{
        "A":{"spot":[{"pos":[4,12,4],"target":[0,0,0],"outer_deg":40,"inner_deg":30,"near":1,"far":30}],"map":2048},
        "C":{"dir":[-0.4,-1,-0.3],"cascades":4,"map":1024,"distance":30},
        "E":{"point":{"pos":[2.5,6,2.5],"near":0.2,"far":30},"map":1024},
        "bad":{"dir":[0,0,0]},"none":{}}}"#;

    #[test]
    fn each_kind_of_light_gives_pi_lux_at_its_target() {
        for (name, kind) in [("A", "spot"), ("C", "directional"), ("E", "point")] {
            let case = parse(FILE, name).expect(name);
            let light = case.lights[0].light;
            assert_eq!(light.kind.id(), kind);
            let lux = light.illuminance_lux(light.position_world.length());
            assert!((lux - PI).abs() < 1e-4, "{name}: {lux}");
            assert_eq!(case.size, UVec2::new(1280, 720));
        }
        assert_eq!(parse(FILE, "C").expect("C").notes.len(), 1);
    }

    #[test]
    fn what_is_wrong_is_said() {
        assert!(matches!(parse(FILE, "a"), Err(Fault::WrongUse(m)) if m.contains("there are A, C, E")));
        assert!(matches!(parse("{}", "A"), Err(Fault::Failed(m)) if m.contains("missing field")));
        assert!(
            matches!(parse(&FILE.replace("1280", "0"), "A"), Err(Fault::Failed(m)) if m.contains("0 pixels"))
        );
    }
}
