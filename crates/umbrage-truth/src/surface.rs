//! What a surface is where a ray hits it: solid, a hole, or a filter that colours the light.

use glam::{Vec2, Vec3, Vec4};
use umbrage_scene::{AlphaMode, Image, Mesh, Scene, TextureRef, Wrap};

/// The corners' vertices and their weights.
struct Corners {
    vertices: [usize; 3],
    weights: [f32; 3],
}

impl Corners {
    fn new(mesh: &Mesh, triangle: usize, mirrored: bool, u: f64, v: f64) -> Self {
        let [a, b, c] = [0, 1, 2].map(|i| mesh.indices[3 * triangle + i] as usize);
        let (u, v) = (u as f32, v as f32);
        // Mirrored triangles were turned, see `Triangles`.
        let vertices = if mirrored { [a, c, b] } else { [a, b, c] };
        Self { vertices, weights: [1.0 - u - v, u, v] }
    }

    fn mix<T>(&self, of: impl Fn(usize) -> T) -> T
    where
        T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = self.vertices;
        let [x, y, z] = self.weights;
        of(a) * x + of(b) * y + of(c) * z
    }
}

/// Base colour and alpha, linear, of the `triangle`th triangle of an instance's mesh at the weights `u` and `v` of its
/// second and third corner.
fn base_color(scene: &Scene, instance: usize, triangle: usize, u: f64, v: f64) -> Vec4 {
    let placed = &scene.instances[instance];
    let mesh = &scene.meshes[placed.mesh];
    let material = &scene.materials[mesh.material];
    let at = Corners::new(mesh, triangle, placed.world_from_object.determinant() < 0.0, u, v);
    let vertex = if mesh.colors.is_empty() {
        Vec4::ONE
    } else {
        at.mix(|i| Vec4::from(mesh.colors[i].map(f32::from)) / 255.0)
    };
    let texel = material.base_color_texture.map_or(Vec4::ONE, |texture| {
        let set = if texture.uv_set == 1 { &mesh.uvs1 } else { &mesh.uvs };
        let uv = at.mix(|i| set.get(i).copied().unwrap_or_default());
        sample(&scene.images[texture.image], &texture, texture.uv_from_texcoord.transform_point2(uv))
    });
    material.base_color * vertex * texel
}

/// The share of light, for each colour, that goes on behind a hit.
///
/// Holes of a cut-out let all of it through, solid surfaces none. A surface mixed by alpha is a filter: of opacity
/// `a` and colour `c` it lets `(1 - a) * mix(1, c, a)` through, all when clear, none when opaque, tinted in between.
pub fn light_through(scene: &Scene, instance: usize, triangle: usize, u: f64, v: f64) -> Vec3 {
    let mesh = &scene.meshes[scene.instances[instance].mesh];
    match scene.materials[mesh.material].alpha {
        AlphaMode::Opaque => Vec3::ZERO,
        AlphaMode::Mask { cutoff } => {
            let alpha = base_color(scene, instance, triangle, u, v).w;
            Vec3::splat(if alpha < cutoff { 1.0 } else { 0.0 })
        }
        AlphaMode::Blend => {
            let color = base_color(scene, instance, triangle, u, v).clamp(Vec4::ZERO, Vec4::ONE);
            Vec3::ONE.lerp(color.truncate(), color.w) * (1.0 - color.w)
        }
    }
}

/// A texture's colour, linear, at full resolution.
fn sample(image: &Image, texture: &TextureRef, uv: Vec2) -> Vec4 {
    let size = Vec2::new(image.width as f32, image.height as f32);
    let place = uv * size;
    if !place.is_finite() {
        return Vec4::ONE;
    }
    if !texture.linear {
        let cell = place.floor();
        return texel(image, texture, cell.x, cell.y);
    }
    let corner = (place - 0.5).floor();
    let share = place - 0.5 - corner;
    let row =
        |y: f32| texel(image, texture, corner.x, y).lerp(texel(image, texture, corner.x + 1.0, y), share.x);
    row(corner.y).lerp(row(corner.y + 1.0), share.y)
}

fn texel(image: &Image, texture: &TextureRef, x: f32, y: f32) -> Vec4 {
    let x = wrapped(x, image.width, texture.wrap[0]);
    let y = wrapped(y, image.height, texture.wrap[1]);
    let at = 4 * (y * image.width as usize + x);
    let [r, g, b, a] = [0, 1, 2, 3].map(|i| f32::from(image.rgba[at + i]) / 255.0);
    let linear = |x: f32| if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
    Vec4::new(linear(r), linear(g), linear(b), a)
}

/// A whole texel coordinate within 0..size.
fn wrapped(x: f32, size: u32, wrap: Wrap) -> usize {
    let size_f = f64::from(size);
    let x = f64::from(x);
    let inside = match wrap {
        Wrap::Repeat => x.rem_euclid(size_f),
        Wrap::Mirror => {
            let twice = x.rem_euclid(2.0 * size_f);
            if twice < size_f { twice } else { 2.0 * size_f - 1.0 - twice }
        }
        Wrap::Clamp => x,
    };
    inside.clamp(0.0, size_f - 1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_outside_follow_the_wrap() {
        let at = |wrap| [-3.0, -1.0, 0.0, 3.0, 4.0, 5.0].map(|x| wrapped(x, 4, wrap));
        assert_eq!(at(Wrap::Repeat), [1, 3, 0, 3, 0, 1]);
        assert_eq!(at(Wrap::Mirror), [2, 0, 0, 3, 3, 2]);
        assert_eq!(at(Wrap::Clamp), [0, 0, 0, 3, 3, 3]);
    }

    #[test]
    fn colours_are_decoded_and_alpha_is_not() {
        let image =
            Image { name: String::new(), width: 2, height: 1, rgba: vec![255, 0, 0, 255, 0, 188, 0, 0] };
        let texture = TextureRef {
            image: 0,
            wrap: [Wrap::Clamp; 2],
            linear: true,
            uv_set: 0,
            uv_from_texcoord: glam::Affine2::IDENTITY,
        };
        let middle = sample(&image, &texture, Vec2::new(0.5, 0.5));
        assert!((middle - Vec4::new(0.5, 0.5 * 0.5029, 0.0, 0.5)).abs().max_element() < 1e-3, "{middle}");
        let nearest = TextureRef { linear: false, ..texture };
        assert_eq!(sample(&image, &nearest, Vec2::new(0.4, 0.5)), Vec4::new(1.0, 0.0, 0.0, 1.0));
    }
}
