//! What users write in one word: sizes, places, colours, lights, cameras.

use crate::fault::suggest;
use glam::{UVec2, Vec3};
use std::path::PathBuf;
use umbrage_render::umbrage::core::technique::find;
use umbrage_render::umbrage::core::{Light, LightKind, LightShape};

/// `key=value`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Left of the first `=`.
    pub key: String,
    /// Right of it.
    pub value: String,
}

/// How a camera moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSpec {
    /// Pictures, 2 or more.
    pub frames: u32,
    /// Around the scene's middle, from first to last, degrees.
    pub turn_deg: f32,
    /// From first to last, metres.
    pub move_m: Vec3,
}

/// `FILE:CASE`.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseRef {
    /// Which file.
    pub path: PathBuf,
    /// Which of its cases.
    pub case: String,
}

/// `auto` or a factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// From the lights.
    Auto,
    /// From the user.
    Factor(f32),
}

/// A camera of the scene, or what differs from it.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraChoice {
    /// By its number or name.
    OfScene(String),
    /// By its numbers.
    Spec(CameraSpec),
}

/// What was said of a camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraSpec {
    /// Metres.
    pub position: Option<Vec3>,
    /// Metres.
    pub target: Option<Vec3>,
    /// Not zero.
    pub up: Option<Vec3>,
    /// Full angle from bottom to top.
    pub fov_deg: Option<f32>,
    /// Metres.
    pub near_m: Option<f32>,
    /// Metres.
    pub far_m: Option<f32>,
}

/// Which of the three.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// A cone.
    #[default]
    Spot,
    /// Every direction.
    Point,
    /// Parallel.
    Directional,
}

/// What was said of a light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightSpec {
    /// Which of the three.
    pub kind: Kind,
    /// Metres.
    pub position: Option<Vec3>,
    /// Metres.
    pub target: Option<Vec3>,
    /// Not zero.
    pub direction: Option<Vec3>,
    /// Linear.
    pub color: Option<Vec3>,
    /// Candela or lux, as the kind has it.
    pub intensity: Option<f32>,
    /// From the axis, degrees.
    pub inner_deg: Option<f32>,
    /// From the axis, degrees.
    pub outer_deg: Option<f32>,
    /// Metres.
    pub range_m: Option<f32>,
    /// What shines.
    pub shape: LightShape,
    /// Metres.
    pub near_m: Option<f32>,
    /// Metres.
    pub far_m: Option<f32>,
    /// A picture.
    pub cookie: Option<PathBuf>,
}

const CAMERA_KEYS: [&str; 6] = ["position", "target", "up", "fov", "near", "far"];
const LIGHT_KEYS: [&str; 17] = [
    "kind",
    "position",
    "target",
    "direction",
    "color",
    "candela",
    "lux",
    "inner",
    "outer",
    "range",
    "radius",
    "disc",
    "rect",
    "angle",
    "near",
    "far",
    "cookie",
];
const KINDS: [(&str, Kind); 3] =
    [("spot", Kind::Spot), ("point", Kind::Point), ("directional", Kind::Directional)];

/// `KEY=VALUE`
pub fn pair(text: &str) -> Result<Pair, String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok(Pair { key: key.trim().to_owned(), value: value.trim().to_owned() })
        }
        _ => Err("write key=value, for example map_size=1024".into()),
    }
}

/// A technique with settings of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TechniqueSpec {
    /// Its name, or `all`.
    pub id: String,
    /// What it has of its own.
    pub set: Vec<Pair>,
}

/// `ID[:KEY=VALUE...]`. Whether a technique has such a setting is asked when all choices are known.
pub fn technique(text: &str) -> Result<TechniqueSpec, String> {
    let mut pieces = text.split(':');
    let id = pieces.next().unwrap_or("").trim();
    if id != "all" {
        find(id).map_err(|e| e.to_string())?;
    }
    let set = pieces
        .map(|piece| {
            pair(piece).map_err(|_| {
                format!(
                    "`{}` is not key=value; write for example linear:bias=slope:map_size=512",
                    short(piece)
                )
            })
        })
        .collect::<Result<_, _>>()?;
    Ok(TechniqueSpec { id: id.to_owned(), set })
}

/// `FILE:CASE`
pub fn case_ref(text: &str) -> Result<CaseRef, String> {
    match text.rsplit_once(':') {
        Some((path, case)) if !path.is_empty() && !case.is_empty() => {
            Ok(CaseRef { path: path.into(), case: case.to_owned() })
        }
        _ => Err("write the file and one of its cases, for example cases.json:A".into()),
    }
}

/// `WxH`
pub fn size(text: &str) -> Result<UVec2, String> {
    let side = |text: &str| text.trim().parse::<u32>().ok().filter(|side| *side > 0);
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some(UVec2::new(side(width)?, side(height)?)))
        .ok_or_else(|| "write width x height in pixels, each 1 or more, for example 1280x720".into())
}

/// A time, which may be negative.
pub fn seconds(text: &str) -> Result<f32, String> {
    number(text).map_err(|_| "it must be a number of seconds, for example 0.5".into())
}

/// Metres, 0 or more.
pub fn length(text: &str) -> Result<f32, String> {
    number(text).ok().filter(|x| *x >= 0.0).ok_or_else(|| "it must be a number of metres, 0 or more".into())
}

/// A time of milliseconds that a frame may wait, so not for ever.
pub fn milliseconds(text: &str) -> Result<f32, String> {
    number(text)
        .ok()
        .filter(|x| (0.0..=1000.0).contains(x))
        .ok_or_else(|| "it must be a number of milliseconds from 0 to 1000".into())
}

/// How long a row of a measurement takes.
pub fn row_seconds(text: &str) -> Result<f32, String> {
    number(text)
        .ok()
        .filter(|x| (0.05..=600.0).contains(x))
        .ok_or_else(|| "it must be a number of seconds from 0.05 to 600".into())
}

/// A number from 0 to 1.
pub fn share(text: &str) -> Result<f32, String> {
    number(text)
        .ok()
        .filter(|x| (0.0..=1.0).contains(x))
        .ok_or_else(|| "it must be a number from 0 to 1".into())
}

/// `auto` or a factor above 0.
pub fn exposure(text: &str) -> Result<Exposure, String> {
    if text == "auto" {
        return Ok(Exposure::Auto);
    }
    let factor = number(text).ok().filter(|x| *x > 0.0);
    factor.map(Exposure::Factor).ok_or_else(|| "it must be `auto` or a factor above 0".into())
}

/// `#rrggbb` in sRGB or `r:g:b` in linear light.
pub fn color(text: &str) -> Result<Vec3, String> {
    let bad = || "write a colour as r:g:b (linear, 0 or more) or #rrggbb (sRGB)".to_owned();
    if let Some(hex) = text.strip_prefix('#') {
        let is_hex = hex.len() == 6 && hex.bytes().all(|b| b.is_ascii_hexdigit());
        let digits = u32::from_str_radix(hex, 16).ok().filter(|_| is_hex).ok_or_else(bad)?;
        return Ok(Vec3::from(
            [16, 8, 0].map(|shift| linear_from_srgb(((digits >> shift) & 255) as f32 / 255.0)),
        ));
    }
    vector(text).ok().filter(|c| c.min_element() >= 0.0).ok_or_else(bad)
}

fn linear_from_srgb(x: f32) -> f32 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

fn number(text: &str) -> Result<f32, String> {
    let bad = || format!("`{}` is not a finite number", short(text));
    text.trim().parse::<f32>().ok().filter(|x| x.is_finite()).ok_or_else(bad)
}

fn vector(text: &str) -> Result<Vec3, String> {
    let bad = || format!("`{}` is not three finite numbers, x:y:z", short(text));
    let parts: Vec<f32> = text.split(':').map(number).collect::<Result<_, _>>().map_err(|_| bad())?;
    let [x, y, z] = parts[..] else { return Err(bad()) };
    Ok(Vec3::new(x, y, z))
}

fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

fn above_zero(text: &str) -> Result<f32, String> {
    number(text).ok().filter(|x| *x > 0.0).ok_or_else(|| format!("`{}` is not a number above 0", short(text)))
}

fn zero_or_more(text: &str) -> Result<f32, String> {
    number(text)
        .ok()
        .filter(|x| *x >= 0.0)
        .ok_or_else(|| format!("`{}` is not a number of 0 or more", short(text)))
}

fn axis(text: &str) -> Result<Vec3, String> {
    let axis = vector(text)?;
    axis.try_normalize().ok_or_else(|| "it is 0:0:0, which points nowhere".into())
}

/// Splits `key=value,key=value`; a piece without `=` belongs to the path before it, which may hold commas.
fn pairs<'a>(text: &'a str, known: &[&str]) -> Result<Vec<(&'a str, String)>, String> {
    let mut pairs: Vec<(&str, String)> = Vec::new();
    for piece in text.split(',') {
        match (piece.split_once('='), pairs.last_mut()) {
            (None, Some(("cookie", path))) => {
                path.push(',');
                path.push_str(piece);
            }
            (None, _) => return Err(format!("`{}` is not key=value", short(piece))),
            (Some((key, value)), _) => {
                let key = key.trim();
                if !known.contains(&key) {
                    let near = suggest(key, known.iter().copied());
                    return Err(format!(
                        "there is no key `{}`{near}; the keys are {}",
                        short(key),
                        known.join(", ")
                    ));
                }
                if pairs.iter().any(|(other, _)| *other == key) {
                    return Err(format!("`{key}` is set twice; keep one of them"));
                }
                pairs.push((key, value.to_owned()));
            }
        }
    }
    Ok(pairs)
}

/// `--camera`
pub fn camera(text: &str) -> Result<CameraChoice, String> {
    if text.trim().is_empty() {
        return Err("name a camera of the scene, or write key=value,...".into());
    }
    if !text.contains('=') {
        return Ok(CameraChoice::OfScene(text.to_owned()));
    }
    let mut spec = CameraSpec::default();
    for (key, value) in pairs(text, &CAMERA_KEYS)? {
        let set = match key {
            "position" => vector(&value).map(|v| spec.position = Some(v)),
            "target" => vector(&value).map(|v| spec.target = Some(v)),
            "up" => axis(&value).map(|v| spec.up = Some(v)),
            "fov" => above_zero(&value).map(|v| spec.fov_deg = Some(v)),
            "near" => above_zero(&value).map(|v| spec.near_m = Some(v)),
            _ => above_zero(&value).map(|v| spec.far_m = Some(v)),
        };
        set.map_err(|e| format!("{key}: {e}"))?;
    }
    if spec.fov_deg.is_some_and(|fov| fov >= 179.0) {
        return Err("fov: it must be below 179 degrees".into());
    }
    if spec.position.is_some() && spec.position == spec.target {
        return Err("position and target are the same place".into());
    }
    if let (Some(near), Some(far)) = (spec.near_m, spec.far_m)
        && near >= far
    {
        return Err("near must be below far".into());
    }
    Ok(CameraChoice::Spec(spec))
}

/// `--path`
pub fn path(text: &str) -> Result<PathSpec, String> {
    let mut spec = PathSpec { frames: 8, turn_deg: 0.0, move_m: Vec3::ZERO };
    for (key, value) in pairs(text, &["frames", "turn", "move"])? {
        let set = match key {
            "frames" => {
                let frames = value.trim().parse().ok().filter(|frames| (2..=1000).contains(frames));
                frames.map(|frames| spec.frames = frames).ok_or_else(|| "it must be 2 to 1000".to_owned())
            }
            "turn" => number(&value).map(|v| spec.turn_deg = v),
            _ => vector(&value).map(|v| spec.move_m = v),
        };
        set.map_err(|e| format!("{key}: {e}"))?;
    }
    if spec.turn_deg == 0.0 && spec.move_m == Vec3::ZERO {
        return Err("the camera does not move; say turn=DEG or move=x:y:z".into());
    }
    Ok(spec)
}

/// `--light`
pub fn light(text: &str) -> Result<LightSpec, String> {
    let mut spec = LightSpec::default();
    let (mut candela, mut lux) = (None, None);
    for (key, value) in pairs(text, &LIGHT_KEYS)? {
        let set = match key {
            "kind" => kind(&value).map(|k| spec.kind = k),
            "position" => vector(&value).map(|v| spec.position = Some(v)),
            "target" => vector(&value).map(|v| spec.target = Some(v)),
            "direction" => axis(&value).map(|v| spec.direction = Some(v)),
            "color" => color(&value).map(|v| spec.color = Some(v)),
            "candela" => zero_or_more(&value).map(|v| candela = Some(v)),
            "lux" => zero_or_more(&value).map(|v| lux = Some(v)),
            "inner" => zero_or_more(&value).map(|v| spec.inner_deg = Some(v)),
            "outer" => above_zero(&value).map(|v| spec.outer_deg = Some(v)),
            "range" => above_zero(&value).map(|v| spec.range_m = Some(v)),
            "radius" | "disc" | "rect" | "angle" => shape(key, &value).and_then(|shape| {
                // A radius of 0 is a point.
                let is_second = spec.shape != LightShape::Point && shape != LightShape::Point;
                spec.shape = shape;
                if is_second {
                    Err("a light has one shape; keep one of radius, disc, rect, angle".into())
                } else {
                    Ok(())
                }
            }),
            "near" => above_zero(&value).map(|v| spec.near_m = Some(v)),
            "far" => above_zero(&value).map(|v| spec.far_m = Some(v)),
            _ if value.is_empty() => Err("name a picture".into()),
            _ => {
                spec.cookie = Some(PathBuf::from(value));
                Ok(())
            }
        };
        set.map_err(|e| format!("{key}: {e}"))?;
    }
    spec.intensity = match (spec.kind, candela, lux) {
        (Kind::Directional, Some(_), _) => return Err("candela: a directional light has lux=".into()),
        (Kind::Spot | Kind::Point, _, Some(_)) => {
            return Err("lux: spot and point lights have candela=".into());
        }
        (_, candela, lux) => candela.or(lux),
    };
    spec.check()?;
    Ok(spec)
}

/// What shines, by the key that says so.
fn shape(key: &str, text: &str) -> Result<LightShape, String> {
    match key {
        "radius" => zero_or_more(text).map(|radius_m| match radius_m {
            0.0 => LightShape::Point,
            _ => LightShape::Sphere { radius_m },
        }),
        "disc" => above_zero(text).map(|radius_m| LightShape::Disc { radius_m }),
        "angle" => above_zero(text).map(|degrees| LightShape::Sun { angle_rad: degrees.to_radians() }),
        _ => {
            let bad = || format!("`{}` is not width:height in metres", short(text));
            let (width, height) = text.split_once(':').ok_or_else(bad)?;
            let side = |text| above_zero(text).map_err(|_| bad());
            Ok(LightShape::Rectangle { width_m: side(width)?, height_m: side(height)? })
        }
    }
}

fn kind(text: &str) -> Result<Kind, String> {
    let found = KINDS.iter().find(|(name, _)| *name == text).map(|(_, kind)| *kind);
    found.ok_or_else(|| {
        let names = KINDS.map(|(name, _)| name);
        format!("`{}` is none of {}{}", short(text), names.join(", "), suggest(text, names))
    })
}

impl LightSpec {
    fn check(&self) -> Result<(), String> {
        if self.target.is_some() && self.direction.is_some() {
            return Err("target and direction say the same thing; keep one of them".into());
        }
        if self.position.is_some() && self.position == self.target {
            return Err("position and target are the same place".into());
        }
        if self.kind != Kind::Spot {
            if self.cookie.is_some() {
                return Err("cookie: only a spot light has a slide; set kind=spot".into());
            }
            if self.inner_deg.is_some() || self.outer_deg.is_some() {
                return Err("inner and outer are the cone of a spot light; set kind=spot".into());
            }
        }
        if self.kind == Kind::Directional && self.range_m.is_some() {
            return Err("range: a directional light has none".into());
        }
        // Angles and planes: the same check that the renderer makes, before anything is loaded.
        self.resolve(Vec3::ZERO, 1.0).check().map_err(|e| e.to_string())
    }

    /// The light in a scene around `center` with this radius. What was not said suits the scene.
    pub fn resolve(&self, center: Vec3, radius_m: f32) -> Light {
        let target = self.target.unwrap_or(center);
        // The default light's place: the eye's upper left, four radii away.
        let away = self.direction.map_or(Vec3::new(-0.75, 1.25, 0.85).normalize(), |d| -d);
        let position = self.position.unwrap_or(target + away * 4.0 * radius_m);
        let outer_deg = self.outer_deg.unwrap_or(45.0);
        let inner_deg = self.inner_deg.unwrap_or(0.8 * outer_deg);
        let kind = match self.kind {
            Kind::Spot => {
                LightKind::Spot { inner_rad: inner_deg.to_radians(), outer_rad: outer_deg.to_radians() }
            }
            Kind::Point => LightKind::Point,
            Kind::Directional => LightKind::Directional,
        };
        let aim = self.direction.map_or(target, |d| position + d * radius_m.max(position.length() * 1e-3));
        let pi_lux = std::f32::consts::PI;
        let intensity = self.intensity.unwrap_or(match self.kind {
            Kind::Directional => pi_lux,
            _ => pi_lux * position.distance_squared(target).max(0.0625 * radius_m * radius_m),
        });
        let light = Light {
            kind,
            color: self.color.unwrap_or(Vec3::ONE),
            intensity,
            range_m: self.range_m,
            shape: self.shape,
            near_m: self.near_m,
            far_m: self.far_m,
            ..Light::default()
        };
        light.aimed(position, aim)
    }
}

#[cfg(test)]
#[path = "specs_tests.rs"]
mod tests;
