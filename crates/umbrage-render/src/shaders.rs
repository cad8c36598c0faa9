//! The renderer's shaders: library modules, the chosen filter, and the passes, joined as text.

use crate::density::EDGE_ON_COS;
use crate::layout::{MAX_LIGHTS, SHADER_CONSTANTS};
use std::sync::Arc;
use umbrage::caster::NO_DEFORM;
use umbrage::core::DEPTH;
use umbrage::core::technique::{Bias, Combination};
use umbrage::core::wgsl::{assemble, assemble_with};
use umbrage::mask::masks_wgsl;

const FRAME: &str = include_str!("../wgsl/frame.wgsl");
const SURFACE: &str = include_str!("../wgsl/surface.wgsl");
const SHADE: &str = include_str!("../wgsl/shade.wgsl");
const MESH: &str = include_str!("../wgsl/mesh.wgsl");
const SCREEN: &str = include_str!("../wgsl/screen.wgsl");
const CHANNELS: &str = include_str!("../wgsl/channels.wgsl");
const DENSITY: &str = include_str!("../wgsl/density.wgsl");

/// What a scene's shaders must be able to do. What is not needed is not in their text: software rasterisers, and
/// many GPUs, pay for both sides of a branch.
#[derive(Clone, Debug)]
pub struct ShaderNeeds {
    /// The map, if there is one.
    pub combination: Option<Combination>,
    /// Is V given for each pixel?
    pub given: bool,
    /// Is a part of V found on the screen before surfaces are lit?
    pub screen: bool,
    /// Does any surface answer by metallic-roughness?
    pub metallic_roughness: bool,
    /// Does any surface answer by Lambert and Blinn?
    pub blinn: bool,
    /// Has any light a place, or do all of them shine in parallel?
    pub placed: bool,
    /// Has any light a slide?
    pub slide: bool,
    /// How many lights there are.
    pub lights: usize,
    /// Are masks looked up while surfaces are lit?
    pub masks: bool,
    /// Does any surface receive no shadow?
    pub exempt: bool,
    /// Is any light a point light?
    pub point: bool,
    /// How many views there may be; see [`MOST_UNIFORM_VIEWS`].
    pub views: usize,
    /// Is any light seen from several places?
    pub places: bool,
    /// Are texels per pixel shown?
    pub density: bool,
    /// Moves vertices: see [`umbrage::caster::NO_DEFORM`].
    pub deform: Option<Arc<str>>,
    /// Weights of the filter `kernel`, in place of its own.
    pub kernel: Option<Arc<str>>,
}

impl ShaderNeeds {
    /// Is V a colour?
    pub fn colors_light(&self) -> bool {
        self.given || self.combination.is_some_and(|c| c.colors_light())
    }
}

/// Up to how many lights are written out one by one: an index that is a constant is far cheaper than one that is not.
const WRITTEN_OUT: usize = 4;

/// The function that adds up all lights.
fn lit_by_all(lights: usize) -> String {
    let sum = if lights <= WRITTEN_OUT {
        let one = |light| format!("    sum += lit_by({light}u, lights[{light}], s, p_world, v);\n");
        (0..lights).map(one).collect()
    } else {
        "    for (var i = 0u; i < frame.light_count; i++) {
        sum += lit_by(i, lights[i], s, p_world, v);
    }
"
        .to_owned()
    };
    format!(
        "fn lit_by_all(s: Surface, p_world: vec3f, v: vec3f) -> vec3f {{
    var sum = vec3f(0.0);
{sum}    return sum;
}}
"
    )
}

/// The share of a light that is seen, without any technique.
const ALL_VISIBLE: &str = "alias Seen = f32;
fn visible_share(index: u32, light: Light, p_world: vec3f, normal: vec3f, towards: vec3f) -> Seen { return 1.0; }
";

/// The share of a light that is seen, where it is given.
const GIVEN: &str = "alias Seen = vec3f;
fn visible_share(index: u32, light: Light, p_world: vec3f, normal: vec3f, towards: vec3f) -> Seen {
    return textureLoad(given_v, at_pixel, index, 0).rgb;
}
";

/// The share of a light that is seen, by what was found on the screen, and by maps for what that leaves out.
fn on_screen(needs: &ShaderNeeds) -> String {
    let others = match &needs.combination {
        Some(combination) => mapped(needs, combination, "mapped_share"),
        None => ALL_VISIBLE.replace("visible_share", "mapped_share"),
    };
    format!(
        "{others}fn visible_share(index: u32, light: Light, p_world: vec3f, normal: vec3f, towards: vec3f) -> Seen {{
    return Seen(textureLoad(given_v, at_pixel, index, 0).r) * mapped_share(index, light, p_world, normal, towards);
}}
"
    )
}

/// The share of a light that is seen, by its masks, and by maps for what has none. Several masks of one light darken once.
fn masked(needs: &ShaderNeeds) -> String {
    let others = match &needs.combination {
        Some(combination) => mapped(needs, combination, "mapped_share"),
        None => ALL_VISIBLE.replace("visible_share", "mapped_share"),
    };
    let masks = masks_wgsl(0, [11, 12, 13]);
    format!(
        "{others}
{masks}
// The object that is shaded.
var<private> at_object: u32;

fn visible_share(index: u32, light: Light, p_world: vec3f, normal: vec3f, towards: vec3f) -> Seen {{
    let covered = umbrage_masks_coverage(light.masks, at_pixel, at_object, p_world, normal, towards);
    return Seen(1.0 - covered) * mapped_share(index, light, p_world, normal, towards);
}}
"
    )
}

/// What shaders do besides where each pixel's object counts: comments stand in their place where none does.
const OBJECTS: [(&str, &str); 8] = [
    ("// OBJECT_ATTRIBUTE", "@location(8) object: u32,"),
    ("// OBJECT_VARYING", "@location(8) @interpolate(flat) object: u32,"),
    ("// OBJECT_OUT", "out.object = i.object;"),
    ("// OBJECT_TARGET", "@location(1) object: u32,"),
    ("// OBJECT_KEPT", "out.object = in.object;"),
    ("// OBJECT_AT", "at_object = in.object;"),
    ("// OBJECT_BINDING", "@group(1) @binding(2) var objects: texture_2d<u32>;"),
    ("// OBJECT_READ", "at_object = textureLoad(objects, at, 0).r;"),
];

fn with_objects(text: &str, needs: &ShaderNeeds) -> String {
    let objects = OBJECTS.iter().filter(|_| needs.masks);
    objects.fold(text.to_owned(), |text, (place, code)| text.replace(place, code))
}

/// The share of a light that is seen, by its maps.
fn mapped(needs: &ShaderNeeds, combination: &Combination, name: &str) -> String {
    let sampler = if combination.compares_in_hardware() { "map_compare" } else { "map_point" };
    let filter = combination.filter_function();
    let moved = if combination.bias == Bias::Normal {
        "umbrage_offset_by_normal(view, p_world, normal, towards)"
    } else {
        "p_world"
    };
    let (seen, maps) = if combination.colors_light() {
        ("vec3f", "maps, translucent_maps, light_colors")
    } else {
        ("f32", "maps")
    };
    // Outside a cone's map lies what the cone does not reach; outside a parallel light's map nothing can block it.
    let seen_in = format!(
        "alias Seen = {seen};
fn seen_in(light: Light, view: UmbrageView, p_world: vec3f, normal: vec3f, towards: vec3f) -> Seen {{
    let at = umbrage_locate(view, {moved}, normal);
    let outside = Seen(select(0.0, 1.0, light.kind == DIRECTIONAL || light.places > 1u));
    let seen = select(outside, {filter}({maps}, {sampler}, view, at), at.inside);
    // Of an area light, a part may be below the surface's horizon though its middle is not.
    return select(seen, Seen(0.0), light.places > 1u && !at.faces);
}}
"
    );
    let face = if needs.point {
        "select(0u, umbrage_face(p_world - views[first].origin), light.kind == POINT)"
    } else {
        "0u"
    };
    let one = format!("seen_in(light, views[first + {face}], p_world, normal, towards)");
    let body = if needs.places {
        format!(
            "    let tiles = select(1u, 6u, light.kind == POINT);
    var sum = Seen(0.0);
    for (var place = 0u; place < light.places; place++) {{
        let first = u32(light.view) + place * tiles;
        sum += {one};
    }}
    let seen = sum / f32(max(light.places, 1u));
"
        )
    } else {
        format!("    let first = u32(max(light.view, 0));\n    let seen = {one};\n")
    };
    format!(
        "{seen_in}fn {name}(index: u32, light: Light, p_world: vec3f, normal: vec3f, towards: vec3f) -> Seen {{
{body}    return select(seen, Seen(1.0), light.view < 0);
}}
"
    )
}

/// Up to how many views stand in a uniform, where every GPU reads them fastest; more stand in a storage buffer.
pub const MOST_UNIFORM_VIEWS: usize = 256;

/// The binding of the views.
fn views(count: usize) -> String {
    if count <= MOST_UNIFORM_VIEWS {
        format!("@group(0) @binding(2) var<uniform> views: array<UmbrageView, {}>;", count.max(1))
    } else {
        "@group(0) @binding(2) var<storage, read> views: array<UmbrageView>;".to_owned()
    }
}

/// What all shaders begin with: the library, the frame, and the technique's visibility.
fn prelude(needs: &ShaderNeeds) -> String {
    let mut modules = needs.combination.as_ref().map(Combination::modules).unwrap_or_default();
    // The debug views locate points and read maps whatever the technique is.
    modules.extend(["view", "light", "cookie", "locate", "face", "map"]);
    if needs.masks {
        modules.push("mask");
    }
    if needs.density {
        modules.push("density");
    }
    let own_kernel = needs.kernel.as_deref().filter(|_| modules.contains(&"filter/kernel"));
    let library = match own_kernel {
        Some(kernel) => assemble_with(&modules, &[("kernel", kernel)]),
        None => assemble(&modules),
    };
    let library = library.unwrap_or_else(|e| format!("// {e}\n"));
    let visibility = match &needs.combination {
        _ if needs.given => GIVEN.to_owned(),
        _ if needs.screen => on_screen(needs),
        _ if needs.masks => masked(needs),
        Some(combination) => mapped(needs, combination, "visible_share"),
        None => ALL_VISIBLE.to_owned(),
    };
    let flags = [
        ("ANY_METALLIC_ROUGHNESS", needs.metallic_roughness),
        ("ANY_BLINN", needs.blinn),
        ("ANY_PLACED", needs.placed),
        ("ANY_SLIDE", needs.slide),
        ("ANY_EXEMPT", needs.exempt),
    ];
    let flags: String = flags.iter().map(|(name, on)| format!("const {name} = {on};\n")).collect();
    let shared: String =
        SHADER_CONSTANTS.iter().map(|(name, value)| format!("const {name} = {value}u;\n")).collect();
    let constants = format!(
        "const MAX_LIGHTS = {MAX_LIGHTS}u;\nconst DEPTH_CLEAR = {:?};\n{flags}{shared}",
        DEPTH.clear()
    );
    let frame = FRAME.replace("// VIEWS_HERE", &views(needs.views));
    [&library, &constants, &frame, SURFACE, &visibility, SHADE, &lit_by_all(needs.lights)].join("\n")
}

/// The shader that draws the scene's meshes.
pub fn mesh(needs: &ShaderNeeds) -> String {
    let mesh = with_objects(MESH, needs);
    [&prelude(needs), needs.deform.as_deref().unwrap_or(NO_DEFORM), &mesh].join("\n")
}

/// The shader that covers the screen.
pub fn screen(needs: &ShaderNeeds) -> String {
    let is_color = needs.combination.is_some_and(|c| c.storage.is_color());
    let density = if needs.density {
        format!("const EDGE_ON_COS = {EDGE_ON_COS:?};\n{DENSITY}")
    } else {
        String::new()
    };
    let screen = with_objects(SCREEN, needs);
    [prelude(needs).as_str(), &screen, if is_color { CHANNELS } else { "" }, &density].join("\n")
}

/// Every shader that the renderer can make, with a name: for validation. Combinations and kinds of scenes do not touch each other,
/// so each combination is joined with one kind, and each kind with the default; texts that are the same come once.
#[cfg(test)]
pub fn all() -> std::collections::BTreeMap<String, String> {
    let needs = |combination, lights: usize, metallic_roughness, blinn| ShaderNeeds {
        combination,
        given: combination.is_none() && lights == 1,
        screen: lights > WRITTEN_OUT,
        masks: lights == WRITTEN_OUT,
        exempt: lights > 1,
        metallic_roughness,
        blinn,
        placed: lights != 1,
        slide: lights > 1,
        lights,
        point: lights > 1,
        views: if lights > WRITTEN_OUT { MOST_UNIFORM_VIEWS + 1 } else { lights },
        places: lights > WRITTEN_OUT,
        density: combination.is_some() && lights > 0,
        deform: None,
        kernel: None,
    };
    let mut wanted: Vec<ShaderNeeds> =
        Combination::all().map(|combination| needs(Some(combination), 2, true, false)).collect();
    let default = umbrage::core::technique::find(umbrage::core::technique::DEFAULT).expect("the default");
    for combination in [None, default.method.combination()] {
        for (metallic_roughness, blinn) in [(true, false), (false, true), (true, true)] {
            for lights in [0, 1, WRITTEN_OUT, WRITTEN_OUT + 1] {
                wanted.push(needs(combination, lights, metallic_roughness, blinn));
            }
        }
    }
    let both = |needs: &ShaderNeeds| {
        [(mesh(needs), format!("mesh for {needs:?}")), (screen(needs), format!("screen for {needs:?}"))]
    };
    let texts: std::collections::HashMap<String, String> = wanted.iter().flat_map(both).collect();
    texts.into_iter().map(|(text, name)| (name, text)).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_shader_validates_without_optional_capabilities() {
        let all = super::all();
        assert!(all.len() >= 2);
        for (name, text) in all {
            let module = naga::front::wgsl::parse_str(&text)
                .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&text)));
            naga::valid::Validator::new(
                naga::valid::ValidationFlags::all(),
                naga::valid::Capabilities::empty(),
            )
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&text)));
        }
    }
}
