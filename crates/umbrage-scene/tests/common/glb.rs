//! A small writer of GLB files, so that a fresh clone can test the loader without any file.

use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use umbrage_scene::{Pose, Scene, SceneError};

pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A document in the making: JSON that a test may change as it likes, and the binary chunk.
pub struct Glb {
    pub json: Value,
    pub bin: Vec<u8>,
}

pub fn f32s(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

pub fn u16s(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Corners of a unit square in z = 0, counter-clockwise.
pub const SQUARE: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

impl Glb {
    /// One node with one mesh, whose primitives are still to come.
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "N", "mesh": 0}],
            "meshes": [{"name": "M", "primitives": []}],
            "accessors": [], "bufferViews": [], "buffers": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// A square of two triangles with indices of bytes.
    pub fn square() -> Self {
        let mut glb = Self::new();
        let positions = glb.accessor(&f32s(&SQUARE), F32, "VEC3", 4, false);
        let indices = glb.accessor(&[0, 1, 2, 0, 2, 3], U8, "SCALAR", 6, false);
        glb.primitive(json!({"attributes": {"POSITION": positions}, "indices": indices}));
        glb
    }

    pub fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self
            .json
            .as_object_mut()
            .unwrap()
            .entry(list)
            .or_insert_with(|| json!([]))
            .as_array_mut()
            .unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    pub fn accessor(
        &mut self,
        bytes: &[u8],
        component: u32,
        kind: &str,
        count: usize,
        normalized: bool,
    ) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count, "normalized": normalized}),
        )
    }

    pub fn primitive(&mut self, primitive: Value) {
        self.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    }

    /// The file's bytes.
    pub fn bytes(&self) -> Vec<u8> {
        let mut document = self.json.clone();
        if document["buffers"].as_array().is_some_and(Vec::is_empty) && !self.bin.is_empty() {
            document["buffers"] = json!([{"byteLength": self.bin.len()}]);
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((12 + 8 + text.len() as u32 + 8 + bin.len() as u32).to_le_bytes());
        file.extend((text.len() as u32).to_le_bytes());
        file.extend(b"JSON");
        file.extend(text);
        file.extend((bin.len() as u32).to_le_bytes());
        file.extend(b"BIN\0");
        file.extend(bin);
        file
    }

    pub fn load(&self) -> Result<Scene, SceneError> {
        load(&self.bytes(), "glb")
    }

    /// At a time of the first animation.
    pub fn load_at(&self, time_s: f32) -> Result<Scene, SceneError> {
        load_at(&self.bytes(), "glb", &Pose { time_s, animation: None })
    }

    /// An animation of one channel, its keys at `times`; its values are an accessor.
    pub fn animate(&mut self, node: usize, path: &str, how: &str, times: &[f32], values: usize) -> usize {
        let input = self.accessor(&f32s(times), F32, "SCALAR", times.len(), false);
        self.push(
            "animations",
            json!({"channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
                   "samplers": [{"input": input, "output": values, "interpolation": how}]}),
        )
    }
}

/// A path that no other test uses.
pub fn temporary(ending: &str) -> PathBuf {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    std::env::temp_dir().join(format!("umbrage-scene-{}-{number}.{ending}", std::process::id()))
}

/// Loads bytes by way of a file.
pub fn load(bytes: &[u8], ending: &str) -> Result<Scene, SceneError> {
    by_file(bytes, ending, umbrage_scene::load)
}

/// Loads bytes by way of a file, in a pose.
pub fn load_at(bytes: &[u8], ending: &str, pose: &Pose) -> Result<Scene, SceneError> {
    by_file(bytes, ending, |path| umbrage_scene::load_at(path, pose))
}

fn by_file(
    bytes: &[u8],
    ending: &str,
    load: impl Fn(&str) -> Result<Scene, SceneError>,
) -> Result<Scene, SceneError> {
    let path = temporary(ending);
    std::fs::write(&path, bytes).unwrap();
    let outcome = load(&path.to_string_lossy());
    std::fs::remove_file(&path).unwrap();
    outcome
}

/// A number generator of the tests' own (xorshift), so that a seed gives the same damage everywhere.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }
}
