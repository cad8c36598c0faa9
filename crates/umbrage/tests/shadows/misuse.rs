//! Wrong use is refused with words that say what to do, and changes nothing.

use crate::common::*;
use glam::{Mat4, Vec3};
use umbrage::core::technique::Settings;
use umbrage::core::{Aabb, Light};
use umbrage::{CasterMesh, Frame, Shadows, ShadowsError, ShadowsOptions};

fn made(gpu: &Gpu) -> Shadows {
    let options = ShadowsOptions::default().map_size(64).expect("a size");
    Shadows::new(&gpu.device, &gpu.queue, options).expect("shadows")
}

fn says<T: std::fmt::Debug>(result: Result<T, ShadowsError>, words: &[&str]) {
    let message = result.expect_err("misuse").to_string();
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
    assert!(!message.contains('\n'), "{message}");
}

#[test]
fn handles_of_what_is_gone_or_elsewhere_are_refused() {
    let Some(gpu) = gpu() else { return };
    let (mut ours, mut theirs) = (made(&gpu), made(&gpu));
    let mesh = add_cube(&gpu, &mut ours);
    let caster = ours.add_caster(mesh, Mat4::IDENTITY).expect("a caster");
    let light = ours.add_light(sun()).expect("a light");
    let receiver = ours.add_receiver(ground()).expect("a receiver");
    says(ours.remove_mesh(mesh), &["1 casters still use", "remove them first"]);
    says(theirs.move_caster(caster, Mat4::IDENTITY), &["caster", "another `Shadows`"]);
    says(theirs.add_caster(mesh, Mat4::IDENTITY), &["mesh", "another `Shadows`"]);
    says(theirs.set_light(light, sun()), &["light", "another `Shadows`"]);
    says(theirs.remove_receiver(receiver), &["receiver", "another `Shadows`"]);
    ours.remove_caster(caster).expect("removed");
    ours.remove_light(light).expect("removed");
    ours.remove_mesh(mesh).expect("removed");
    says(ours.move_caster(caster, Mat4::IDENTITY), &["caster", "was removed", "add the caster anew"]);
    says(ours.remove_caster(caster), &["was removed"]);
    says(ours.light_index(light), &["light", "was removed"]);
    says(ours.set_technique_named(light, "linear"), &["light", "was removed"]);
    says(ours.add_caster(mesh, Mat4::IDENTITY), &["mesh", "was removed"]);
    // Its number goes to the next light, and still the old handle is refused.
    let next = ours.add_light(spot()).expect("a light");
    assert_eq!(ours.light_index(next), Ok(0));
    says(ours.light_index(light), &["was removed"]);
}

#[test]
fn numbers_that_are_none_are_refused() {
    let Some(gpu) = gpu() else { return };
    let mut shadows = made(&gpu);
    let mesh = add_cube(&gpu, &mut shadows);
    let caster = shadows.add_caster(mesh, Mat4::IDENTITY).expect("a caster");
    says(shadows.add_caster(mesh, Mat4::NAN), &["world_from_object", "finite and affine"]);
    says(shadows.move_caster(caster, Mat4::perspective_like()), &["finite and affine"]);
    says(shadows.add_receiver(Aabb::EMPTY), &["receiver's box", "in order"]);
    says(shadows.add_own_caster(Aabb { min: Vec3::NAN, max: Vec3::ONE }), &["caster's box"]);
    says(shadows.add_light(Light { intensity: f32::INFINITY, ..sun() }), &["intensity"]);
    let light = shadows.add_light(sun()).expect("a light");
    says(shadows.set_light(light, Light { direction_world: Vec3::ZERO, ..sun() }), &["direction"]);
    says(shadows.prepare(&Frame::from_matrices(Mat4::NAN, Mat4::IDENTITY, [8, 8])), &["view_from_world"]);
    says(
        shadows.prepare(&Frame::from_matrices(Mat4::IDENTITY, Mat4::IDENTITY, [0, 8])),
        &["size", "1 pixel"],
    );
    let own = shadows.add_own_caster(ground()).expect("an own caster");
    says(shadows.move_caster(own, Mat4::IDENTITY), &["move_own_caster"]);
    // Nothing of it has stuck.
    assert_eq!(shadows.light(light).map(|(light, _)| *light), Ok(sun()));
    shadows.prepare(&frame()).expect("prepared");
}

trait PerspectiveLike {
    fn perspective_like() -> Mat4;
}

impl PerspectiveLike for Mat4 {
    fn perspective_like() -> Mat4 {
        umbrage::core::projection::perspective(1.0, 1.0, 0.1, 10.0, umbrage::core::DEPTH)
    }
}

#[test]
fn recording_comes_after_preparing() {
    let Some(gpu) = gpu() else { return };
    let mut shadows = made(&gpu);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    says(shadows.record(&mut encoder), &["`record`", "before `prepare`", "call `prepare` once a frame"]);
    shadows.prepare(&frame()).expect("prepared");
    shadows.record(&mut encoder).expect("there is nothing to draw, and that is fine");
    let light = shadows.add_light(sun()).expect("a light");
    says(shadows.record(&mut encoder), &["before `prepare`"]);
    shadows.prepare(&frame()).expect("prepared");
    shadows.remove_light(light).expect("removed");
    says(shadows.record(&mut encoder), &["before `prepare`"]);
}

/// No light, no caster, a light that reaches nothing: all is lit, and nothing is wrong.
#[test]
fn nothing_is_no_misuse() {
    let Some(gpu) = gpu() else { return };
    let mut shadows = made(&gpu);
    let probe = Probe::new(&gpu, &shadows);
    let points = points(8);
    let all_lit = |seen: Vec<glam::Vec4>| seen.iter().all(|v| v.w == 1.0);
    assert!(all_lit(probe.shoot(&gpu, &mut shadows, 0, &points)));
    assert!(all_lit(probe.shoot(&gpu, &mut shadows, 4_000, &points)), "a number that no light has");
    shadows.add_light(sun()).expect("a light");
    assert!(all_lit(probe.shoot(&gpu, &mut shadows, 0, &points)));
}

#[test]
fn options_that_cannot_be_are_refused() {
    let Some(gpu) = gpu() else { return };
    let make = |options: ShadowsOptions| Shadows::new(&gpu.device, &gpu.queue, options);
    let default = ShadowsOptions::default;
    says(make(default().at_most(0, 8)), &["most_lights", "1 to 256"]);
    says(make(default().at_most(8, 300)), &["most_views", "1 to 256"]);
    says(ShadowsOptions::with(["liner"]), &["did you mean `linear`"]);
    says(ShadowsOptions::with([]).and_then(&make), &["techniques", "`linear`"]);
    says(default().map_size(0), &["map_size"]);
    let most = gpu.device.limits().max_texture_dimension_2d;
    says(default().map_size(2 * most).and_then(&make), &["16384x16384", "8192"]);
    says(
        make(default().depth_stencil(wgpu::TextureFormat::Depth32Float)),
        &["depth_stencil", "Depth24PlusStencil8"],
    );
    let fine = wgpu::TextureFormat::Depth32FloatStencil8;
    says(make(default().depth_stencil(fine)), &["Depth32FloatStencil8", "DEPTH32FLOAT_STENCIL8"]);
    says(make(default().kernel("fn mine() {}")), &["umbrage_kernel"]);
    let unknown =
        "fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f {\n return rihgt; }";
    says(make(default().kernel(unknown)), &["rihgt", "2:"]);
    let mut many = default();
    for size in 1..20 {
        let size = (64 * size).to_string();
        many = many.technique(Settings::new("hard", [("map_size", size.as_str())]).expect("settings"));
    }
    says(make(many), &["max_sampled_textures_per_shader_stage = 16", "fewer techniques"]);

    let mut few = make(default().map_size(64).expect("a size").at_most(2, 6)).expect("shadows");
    let mesh = add_cube(&gpu, &mut few);
    few.add_caster(mesh, Mat4::IDENTITY).expect("a caster");
    let lamp = few.add_light(lamp()).expect("a light");
    few.add_light(sun()).expect("a light");
    says(few.add_light(sun()), &["3 lights are more than 2", "most_lights"]);
    says(few.prepare(&frame()), &["7 views are more than 6", "most_views"]);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    says(few.record(&mut encoder), &["before `prepare`"]);
    few.remove_light(lamp).expect("removed");
    few.prepare(&frame()).expect("there is room again");
    says(
        few.add_light_with(sun(), &Settings::new("pcf", []).expect("settings")),
        &["`pcf`", "ShadowsOptions::technique"],
    );
    let big = Settings::new("linear", [("map_size", "1024")]).expect("settings");
    says(few.add_light_with(sun(), &big), &["map_size=1024", "map_size=64"]);
}

#[test]
fn buffers_that_cannot_be_read_so_are_refused() {
    let Some([gpu, other]) = gpus() else { return };
    let mut shadows = made(&gpu);
    let cube = CubeBuffers::new(&gpu);
    let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let index = wgpu::IndexFormat::Uint32;
    let positions = CasterMesh::new(&cube.positions, 0..8, bounds);
    says(
        shadows.add_mesh(&CasterMesh::new(&cube.positions, 0..9, bounds)),
        &["positions", "96 bytes", "108"],
    );
    says(
        shadows.add_mesh(&CasterMesh::new(&cube.indices, 0..3, bounds)),
        &["VERTEX", "add that to its usage"],
    );
    says(shadows.add_mesh(&positions.clone().indexed(&cube.positions, index, 0..3)), &["indices", "INDEX"]);
    says(shadows.add_mesh(&positions.clone().indexed(&cube.indices, index, 0..37)), &["144 bytes", "148"]);
    says(shadows.add_mesh(&positions.clone().interleaved(2, 12)), &["multiples of 4"]);
    says(shadows.add_mesh(&positions.clone().interleaved(0, 8)), &["stride"]);
    says(shadows.add_mesh(&positions.clone().format(wgpu::VertexFormat::Sint8x4)), &["Float32x3"]);
    says(shadows.add_mesh(&CubeBuffers::new(&other).mesh()), &["another device", "one device"]);
    let foreign_indices = CubeBuffers::new(&other).indices;
    says(
        shadows.add_mesh(&positions.clone().indexed(&foreign_indices, index, 0..36)),
        &["indices", "another device"],
    );
    shadows.add_mesh(&positions).expect("and this one is fine");
}
