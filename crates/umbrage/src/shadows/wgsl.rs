//! The shader's side: one bind group, and the text that reads it.

use super::options::ShadowsOptions;
use super::pool::Pool;
use super::table::Table;
use super::variants::Declared;
use crate::mask::masks_wgsl;
use std::fmt::Write;
use umbrage_core::technique::{Bias, Filter};
use umbrage_core::wgsl::{Variant, assemble_variants};

const SHADOWS: &str = include_str!("../../wgsl/shadows.wgsl");

/// What is bound, in order; the number of each is its place in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bound {
    Lights,
    Views,
    Comparison,
    Point,
    /// Maps of a pool.
    Maps(usize),
    /// Translucent casters of a pool.
    Nearest(usize),
    /// Colours of a pool.
    Colors(usize),
    /// All masks in a list, their texture, what reads it.
    MaskList,
    Masks,
    MaskSampler,
    /// V on the screen.
    Screen,
}

impl Bound {
    /// Does it count to the sampled textures of a stage?
    pub fn is_texture(self) -> bool {
        matches!(self, Self::Maps(_) | Self::Nearest(_) | Self::Colors(_) | Self::Masks | Self::Screen)
    }
}

/// All that a [`Declared`] binds.
pub(super) fn bound(declared: &Declared) -> Vec<Bound> {
    let mut bound = vec![Bound::Lights, Bound::Views, Bound::Comparison, Bound::Point];
    for (index, pool) in declared.pools.iter().enumerate() {
        bound.push(Bound::Maps(index));
        if pool.colored {
            bound.extend([Bound::Nearest(index), Bound::Colors(index)]);
        }
    }
    if declared.masks {
        bound.extend([Bound::MaskList, Bound::Masks, Bound::MaskSampler]);
    }
    bound.extend(declared.screen.then_some(Bound::Screen));
    bound
}

/// Which stages may ask for shadows.
const STAGES: wgpu::ShaderStages = wgpu::ShaderStages::FRAGMENT.union(wgpu::ShaderStages::COMPUTE);

/// The layout of the bind group, whatever lights there are.
pub(super) fn layout(device: &wgpu::Device, declared: &Declared) -> wgpu::BindGroupLayout {
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let texture = |sample_type| wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    };
    let float = wgpu::TextureSampleType::Float { filterable: false };
    let of_map = |pool: usize| {
        if declared.pools[pool].format.storage.is_color() { float } else { wgpu::TextureSampleType::Depth }
    };
    let ty = |bound: &Bound| match *bound {
        Bound::Lights | Bound::Views | Bound::MaskList => uniform,
        Bound::Masks => texture(wgpu::TextureSampleType::Float { filterable: true }),
        Bound::MaskSampler => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        Bound::Comparison => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
        Bound::Point => wgpu::BindingType::Sampler(wgpu::SamplerBindingType::NonFiltering),
        Bound::Maps(pool) | Bound::Nearest(pool) => texture(of_map(pool)),
        Bound::Colors(_) | Bound::Screen => texture(float),
    };
    let entries: Vec<_> = (0u32..)
        .zip(&bound(declared))
        .map(|(binding, bound)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: STAGES,
            ty: ty(bound),
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("umbrage shadows"),
        entries: &entries,
    })
}

/// What a bind group is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Resources<'a> {
    pub table: &'a Table,
    pub pools: &'a [Pool],
    pub comparison: &'a wgpu::Sampler,
    pub point: &'a wgpu::Sampler,
    pub screen: Option<&'a wgpu::TextureView>,
    pub masks: Option<(&'a wgpu::Buffer, &'a wgpu::TextureView, &'a wgpu::Sampler)>,
}

/// The bind group.
pub(super) fn group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    declared: &Declared,
    resources: &Resources<'_>,
) -> wgpu::BindGroup {
    use wgpu::BindingResource::{Sampler, TextureView};
    let resource = |bound: &Bound| {
        let pool = |pool: usize| resources.pools.get(pool);
        Some(match *bound {
            Bound::Lights => resources.table.lights.as_entire_binding(),
            Bound::Views => resources.table.views.as_entire_binding(),
            Bound::Comparison => Sampler(resources.comparison),
            Bound::Point => Sampler(resources.point),
            Bound::Maps(of) => TextureView(pool(of)?.maps().array()),
            Bound::Nearest(of) => TextureView(pool(of)?.translucent()?.nearest().array()),
            Bound::Colors(of) => TextureView(pool(of)?.translucent()?.colors()),
            Bound::MaskList => resources.masks?.0.as_entire_binding(),
            Bound::Masks => TextureView(resources.masks?.1),
            Bound::MaskSampler => Sampler(resources.masks?.2),
            Bound::Screen => TextureView(resources.screen?),
        })
    };
    let entries: Vec<_> = (0u32..)
        .zip(&bound(declared))
        .filter_map(|(binding, bound)| Some(wgpu::BindGroupEntry { binding, resource: resource(bound)? }))
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("umbrage shadows"),
        layout,
        entries: &entries,
    })
}

/// The declarations of all that is bound.
fn bindings(group: u32, declared: &Declared, options: &ShadowsOptions) -> String {
    let mut text = String::new();
    let map = |pool: usize| {
        if declared.pools[pool].format.storage.is_color() {
            "texture_2d_array<f32>"
        } else {
            "texture_depth_2d_array"
        }
    };
    for (binding, bound) in bound(declared).iter().enumerate() {
        let (lights, views) = (options.most_lights, options.most_views);
        let declaration = match *bound {
            Bound::Lights => format!("var<uniform> umbrage_lights: array<UmbrageLight, {lights}>"),
            Bound::Views => format!("var<uniform> umbrage_views: array<UmbrageView, {views}>"),
            Bound::Comparison => "var umbrage_comparison: sampler_comparison".to_owned(),
            Bound::Point => "var umbrage_point: sampler".to_owned(),
            Bound::Maps(pool) => format!("var umbrage_maps_{pool}: {}", map(pool)),
            Bound::Nearest(pool) => format!("var umbrage_nearest_{pool}: {}", map(pool)),
            Bound::Colors(pool) => format!("var umbrage_colors_{pool}: texture_2d_array<f32>"),
            Bound::MaskList => {
                let at = binding as u32;
                text.push_str(&masks_wgsl(group, [at, at + 1, at + 2]));
                continue;
            }
            Bound::Masks | Bound::MaskSampler => continue,
            Bound::Screen => "var umbrage_screen: texture_2d_array<f32>".to_owned(),
        };
        let _ = writeln!(text, "@group({group}) @binding({binding}) {declaration};");
    }
    text
}

/// The functions of one lookup.
fn lookup(number: usize, declared: &Declared, variant: &Variant<'_>) -> String {
    let lookup = &declared.lookups[number];
    let (combination, pool) = (lookup.combination, lookup.pool);
    let filter = variant.name(combination.filter_module(), &combination.filter_function());
    let sampler = if combination.compares_in_hardware() { "umbrage_comparison" } else { "umbrage_point" };
    let (seen, maps) = if combination.colors_light() {
        ("vec3f", format!("umbrage_maps_{pool}, umbrage_nearest_{pool}, umbrage_colors_{pool}"))
    } else {
        ("f32", format!("umbrage_maps_{pool}"))
    };
    let moved = if combination.bias == Bias::Normal {
        "umbrage_offset_by_normal(view, p_world, normal, towards)"
    } else {
        "p_world"
    };
    format!(
        "
fn umbrage_seen_{number}(light: UmbrageLight, view: UmbrageView, p_world: vec3f, normal: vec3f, towards: vec3f) -> {seen} {{
    let at = umbrage_locate(view, {moved}, normal);
    // Outside a cone's map lies what the cone does not reach; outside a parallel light's map nothing can block it.
    let outside = {seen}(select(0.0, 1.0, light.lit_outside != 0u));
    let seen = select(outside, {filter}({maps}, {sampler}, view, at), at.inside);
    // Of an area light, a part may be below the surface's horizon though its middle is not.
    return select(seen, {seen}(0.0), light.places > 1u && !at.faces);
}}

fn umbrage_mapped_{number}(light: UmbrageLight, p_world: vec3f, normal: vec3f, towards: vec3f) -> {seen} {{
    var sum = {seen}(0.0);
    for (var place = 0u; place < light.places; place++) {{
        let first = light.first_view + place * light.tiles;
        let face = select(0u, umbrage_face(p_world - umbrage_views[first].origin), light.tiles > 1u);
        sum += umbrage_seen_{number}(light, umbrage_views[first + face], p_world, normal, towards);
    }}
    return sum / f32(max(light.places, 1u));
}}
"
    )
}

/// All of the text, for a bind group of this number.
pub(super) fn text(group: u32, declared: &Declared, options: &ShadowsOptions) -> String {
    let modules: Vec<Vec<&str>> = declared.lookups.iter().map(|l| l.combination.modules()).collect();
    let suffixes: Vec<String> = (0..modules.len()).map(|number| format!("_{number}")).collect();
    let own = options.kernel.as_deref().map(|kernel| [("kernel", kernel)]);
    let variants: Vec<Variant<'_>> = declared
        .lookups
        .iter()
        .zip(modules.iter().zip(&suffixes))
        .map(|(lookup, (modules, suffix))| {
            let own = own.as_ref().filter(|_| lookup.combination.filter == Filter::Kernel);
            Variant { modules, suffix, own: own.map_or(&[], |own| own) }
        })
        .collect();
    let mut shared = vec!["view", "locate", "face"];
    shared.extend(declared.masks.then_some("mask"));
    let library = assemble_variants(&shared, &variants).unwrap_or_else(|e| format!("// {e}\n"));
    let lookups: String =
        variants.iter().enumerate().map(|(number, variant)| lookup(number, declared, variant)).collect();
    let colored = declared.lookups.iter().any(|lookup| lookup.combination.colors_light());
    let seen = if colored { "vec3f" } else { "f32" };
    let mut cases = String::new();
    for number in 0..variants.len() {
        let case = number + 1;
        let _ = writeln!(
            cases,
            "        case {case}u: {{ return {seen}(umbrage_mapped_{number}(light, p_world, normal, towards)); }}"
        );
    }
    let on_screen = if declared.screen {
        "    if light.screen != 0u {
        seen *= textureLoad(umbrage_screen, vec2i(pixel), light.screen - 1u, 0).r;
    }
"
    } else {
        ""
    };
    let by_masks = if declared.masks {
        "    if light.masks != 0u {
        seen *= 1.0 - umbrage_masks_coverage(light.masks, vec2u(pixel), caster, p_world, normal, towards);
    }
"
    } else {
        ""
    };
    let (mean, rgb) = if colored { ("dot(seen, vec3f(1.0 / 3.0))", "seen") } else { ("seen", "vec3f(seen)") };
    let bindings = bindings(group, declared, options);
    let most = options.most_lights;
    format!(
        "{library}
{SHADOWS}
{bindings}{lookups}
fn umbrage_mapped(light: UmbrageLight, p_world: vec3f, normal: vec3f, towards: vec3f) -> {seen} {{
    switch light.lookup {{
{cases}        default: {{ return {seen}(1.0); }}
    }}
}}

fn umbrage_seen(number: u32, p_world: vec3f, normal: vec3f, pixel: vec2f, caster: u32) -> {seen} {{
    if number >= {most}u {{
        return {seen}(1.0);
    }}
    let light = umbrage_lights[number];
    let towards = umbrage_towards(light, p_world);
    var seen = umbrage_mapped(light, p_world, normal, towards);
{by_masks}{on_screen}    return seen;
}}

// How much of light number `light` (`Shadows::light_index`) is seen from a surface: 1 lit, 0 in shadow. `p_world` is the surface's
// place, `normal` its own, not interpolated (of any length), both in world space; `pixel` is `@builtin(position).xy`. Cone, falloff and the
// angle of the light are the caller's.
fn umbrage_visibility(light: u32, p_world: vec3f, normal: vec3f, pixel: vec2f) -> f32 {{
    let seen = umbrage_seen(light, p_world, normal, pixel, UMBRAGE_NOBODY);
    return {mean};
}}

// The same on caster number `caster` (`Shadows::caster_index`): masks then leave out its own, which knows not what of itself lies
// behind it. Other techniques need no telling.
fn umbrage_visibility_on(light: u32, p_world: vec3f, normal: vec3f, pixel: vec2f, caster: u32) -> f32 {{
    let seen = umbrage_seen(light, p_world, normal, pixel, caster);
    return {mean};
}}

// The same in colours, for techniques that let translucent casters colour the light.
fn umbrage_visibility_rgb(light: u32, p_world: vec3f, normal: vec3f, pixel: vec2f) -> vec3f {{
    let seen = umbrage_seen(light, p_world, normal, pixel, UMBRAGE_NOBODY);
    return {rgb};
}}
"
    )
}
