//! What a loaded scene is: flat lists that point at each other by index, every index checked.

use glam::{Affine2, Mat4, Vec2, Vec3, Vec4};
use umbrage_core::{Aabb, Camera, Light};

/// A whole scene.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// File stem, or `builtin:NAME`.
    pub name: String,
    /// Triangle meshes in object space, each with one material.
    pub meshes: Vec<Mesh>,
    /// What is drawn where. Many instances may share a mesh.
    pub instances: Vec<Instance>,
    /// Surfaces. Never empty: index 0 is the default material when a file names none.
    pub materials: Vec<Material>,
    /// Decoded pictures, each once whatever the number of its users.
    pub images: Vec<Image>,
    /// Lights in world space.
    pub lights: Vec<SceneLight>,
    /// Cameras in world space.
    pub cameras: Vec<SceneCamera>,
    /// The moment of an animation that all of this is; `None` at rest.
    pub playing: Option<Playing>,
    /// What the file asks for and did not get, one clause each, for the user's eye.
    pub warnings: Vec<String>,
}

/// A moment of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Playing {
    /// Place among the file's animations, from 0.
    pub number: usize,
    /// What the file calls it; may be empty.
    pub name: String,
    /// Time of its last key, seconds, 0 or more.
    pub length_s: f32,
    /// Seconds from its beginning, 0 to `length_s`: the time that was asked for, less whole lengths.
    pub time_s: f32,
}

/// Triangles with one material, in object space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// What the file calls it; may be empty.
    pub name: String,
    /// Metres. All finite.
    pub positions: Vec<Vec3>,
    /// Unit vectors, one for each position.
    pub normals: Vec<Vec3>,
    /// Unit tangent and handedness, one for each position, or empty when no material needs them.
    pub tangents: Vec<Vec4>,
    /// First set of texture coordinates, one for each position, or empty.
    pub uvs: Vec<Vec2>,
    /// Second set of texture coordinates, one for each position, or empty.
    pub uvs1: Vec<Vec2>,
    /// Linear RGBA, 8 bits each, one for each position, or empty.
    pub colors: Vec<[u8; 4]>,
    /// Three for each triangle; each below `positions.len()`. Counter-clockwise seen from the front.
    pub indices: Vec<u32>,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Box around the positions that the indices use.
    pub bounds: Aabb,
}

/// What an object does with light. Default: both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Roles {
    /// It throws shadows on others.
    pub blocker: bool,
    /// Others throw shadows on it.
    pub receiver: bool,
}

impl Default for Roles {
    fn default() -> Self {
        Self { blocker: true, receiver: true }
    }
}

/// A mesh at a place. The default is the first mesh at the origin, of object 0.
#[derive(Clone, Debug, Default)]
pub struct Instance {
    /// What the file calls the node; may be empty.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Finite and affine. A mirrored transform (negative determinant) turns the winding.
    pub world_from_object: Mat4,
    /// What it does with light.
    pub roles: Roles,
    /// Number of the object that it is a part of, from 0 without gaps in a loaded scene. An object is a glTF node with a mesh,
    /// whose primitives share its number; each place of `EXT_mesh_gpu_instancing`; or all faces of one material of an
    /// OBJ file, whose `o` and `g` lines are not kept apart.
    pub object: u32,
}

/// What happens where a surface is not solid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Nothing is there where alpha is below the cutoff.
    Mask {
        /// 0..1, default 0.5.
        cutoff: f32,
    },
    /// Alpha mixes the surface with what is behind it.
    Blend,
}

/// How a surface answers light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// glTF 2.0: metallic-roughness.
    MetallicRoughness {
        /// 0..1.
        metallic: f32,
        /// Perceptual, 0..1.
        roughness: f32,
    },
    /// The documents' (and MTL's): ambient, Lambert, Blinn.
    Blinn {
        /// Share of the ambient light that the surface gives back (MTL `Ka`), linear.
        ambient: Vec3,
        /// Colour of the highlight (MTL `Ks`), linear.
        specular: Vec3,
        /// Exponent of the highlight (MTL `Ns`), 1 or more.
        shininess: f32,
    },
}

/// A surface.
#[derive(Clone, Debug)]
pub struct Material {
    /// What the file calls it; may be empty.
    pub name: String,
    /// Linear RGBA factor (MTL: `Kd` and `d`).
    pub base_color: Vec4,
    /// sRGB colour and alpha that multiply the factor.
    pub base_color_texture: Option<TextureRef>,
    /// How it answers light.
    pub reflectance: Reflectance,
    /// Green: roughness, blue: metallic; multiply the factors.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Tangent-space normals.
    pub normal_texture: Option<TextureRef>,
    /// Scale of the normal map's x and y. Default 1.
    pub normal_scale: f32,
    /// Linear RGB that the surface sends out by itself.
    pub emissive: Vec3,
    /// sRGB, multiplies `emissive`.
    pub emissive_texture: Option<TextureRef>,
    /// Solid, cut out or mixed.
    pub alpha: AlphaMode,
    /// Drawn from behind too, with the normal turned to the viewer.
    pub double_sided: bool,
    /// Shown in its base colour without any light.
    pub unlit: bool,
}

impl Default for Material {
    /// Matte white.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            reflectance: Reflectance::MetallicRoughness { metallic: 0.0, roughness: 1.0 },
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
        }
    }
}

/// A picture on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::images`].
    pub image: usize,
    /// What happens outside 0..1, horizontally and vertically.
    pub wrap: [Wrap; 2],
    /// Blend between texels, or take the nearest.
    pub linear: bool,
    /// 0: [`Mesh::uvs`], 1: [`Mesh::uvs1`].
    pub uv_set: u32,
    /// KHR_texture_transform, identity by default.
    pub uv_from_texcoord: Affine2,
}

/// What a texture shows outside 0..1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Starts again.
    #[default]
    Repeat,
    /// Starts again, every second time mirrored.
    Mirror,
    /// Its edge goes on.
    Clamp,
}

/// A decoded picture: RGBA, 8 bits a channel, rows from the top.
#[derive(Clone, Debug)]
pub struct Image {
    /// File name or what the file calls it; for messages.
    pub name: String,
    /// Pixels across, 1 or more.
    pub width: u32,
    /// Pixels down, 1 or more.
    pub height: u32,
    /// `width * height * 4` bytes.
    pub rgba: Vec<u8>,
}

/// A light and what the file says beside it.
#[derive(Clone, Debug)]
pub struct SceneLight {
    /// What the file calls it; may be empty.
    pub name: String,
    /// In world space.
    pub light: Light,
    /// Slide in front of the light: index into [`Scene::images`].
    pub cookie: Option<usize>,
}

/// A camera and its name.
#[derive(Clone, Debug)]
pub struct SceneCamera {
    /// What the file calls it; may be empty.
    pub name: String,
    /// In world space.
    pub camera: Camera,
}

impl Scene {
    /// Box around everything that is drawn, world space.
    pub fn bounds(&self) -> Aabb {
        self.instances.iter().fold(Aabb::EMPTY, |bounds, instance| {
            bounds.union(&self.meshes[instance.mesh].bounds.transformed(&instance.world_from_object))
        })
    }

    /// The number of objects, which is the number of the next one. At most 2^32 - 1 are counted.
    pub fn objects(&self) -> u32 {
        self.instances.iter().map(|instance| instance.object.saturating_add(1)).max().unwrap_or(0)
    }

    /// Triangles drawn: each mesh counted once for each of its instances.
    pub fn triangles(&self) -> u64 {
        self.instances.iter().map(|i| self.meshes[i.mesh].indices.len() as u64 / 3).sum()
    }
}
