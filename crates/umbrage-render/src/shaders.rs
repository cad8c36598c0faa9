//! The renderer's shaders: library modules, the chosen filter, and the passes, joined as text.

use crate::layout::{MAX_LIGHTS, SHADER_CONSTANTS};
use umbrage::core::DEPTH;
use umbrage::core::technique::Combination;
use umbrage::core::wgsl::assemble;

const FRAME: &str = include_str!("../wgsl/frame.wgsl");
const SURFACE: &str = include_str!("../wgsl/surface.wgsl");
const SHADE: &str = include_str!("../wgsl/shade.wgsl");
const MESH: &str = include_str!("../wgsl/mesh.wgsl");
const SCREEN: &str = include_str!("../wgsl/screen.wgsl");

/// The WGSL function that the table's filter of that name defines.
fn filter_function(combination: &Combination) -> String {
    format!("umbrage_filter_{}", combination.filter.row().id)
}

/// What a scene's shaders must be able to do. What is not needed is not in their text: software rasterisers, and
/// many GPUs, pay for both sides of a branch.
#[derive(Clone, Debug)]
pub struct ShaderNeeds {
    /// The map, if there is one.
    pub combination: Option<Combination>,
    /// Is V given for each pixel?
    pub given: bool,
    /// Does any surface answer by metallic-roughness?
    pub metallic_roughness: bool,
    /// Does any surface answer by Lambert and Blinn?
    pub blinn: bool,
    /// Has any light a place, or do all of them shine in parallel?
    pub placed: bool,
    /// Has any light a slide?
    pub slide: bool,
    /// The map's view of each light.
    pub views: Vec<Option<usize>>,
}

/// Up to how many lights are written out one by one: an index that is a constant is far cheaper than one that is not.
const WRITTEN_OUT: usize = 4;

/// The function that adds up all lights.
fn lit_by_all(views: &[Option<usize>]) -> String {
    let sum = if views.len() <= WRITTEN_OUT {
        let one = |(light, view): (usize, &Option<usize>)| {
            format!(
                "    sum += lit_by({light}u, lights[{light}], views[{}], s, p_world, v);\n",
                view.unwrap_or(0)
            )
        };
        views.iter().enumerate().map(one).collect()
    } else {
        "    for (var i = 0u; i < frame.light_count; i++) {
        sum += lit_by(i, lights[i], views[max(lights[i].view, 0)], s, p_world, v);
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
fn visible_share(index: u32, light: Light, view: UmbrageView, p_world: vec3f) -> Seen { return 1.0; }
";

/// The share of a light that is seen, where it is given.
const GIVEN: &str = "alias Seen = vec3f;
fn visible_share(index: u32, light: Light, view: UmbrageView, p_world: vec3f) -> Seen {
    return textureLoad(given_v, at_pixel, index, 0).rgb;
}
";

/// What all shaders begin with: the library, the frame, and the technique's visibility.
fn prelude(needs: &ShaderNeeds) -> String {
    let mut modules = needs.combination.as_ref().map(Combination::modules).unwrap_or_default();
    // The debug views locate points whatever the technique is.
    modules.extend(["view", "light", "cookie", "locate"]);
    let library = assemble(&modules).unwrap_or_else(|e| format!("// {e}\n"));
    let visibility = match &needs.combination {
        _ if needs.given => GIVEN.to_owned(),
        // Outside a cone's map lies what the cone does not reach; outside a parallel light's map nothing can block it.
        Some(combination) => format!(
            "alias Seen = f32;
fn visible_share(index: u32, light: Light, view: UmbrageView, p_world: vec3f) -> Seen {{
    let at = umbrage_locate(view, p_world);
    let outside = select(0.0, 1.0, light.kind == DIRECTIONAL);
    let seen = select(outside, {}(maps, map_compare, view, at), at.inside);
    return select(seen, 1.0, light.view < 0);
}}
",
            filter_function(combination)
        ),
        None => ALL_VISIBLE.to_owned(),
    };
    let flags = [
        ("ANY_METALLIC_ROUGHNESS", needs.metallic_roughness),
        ("ANY_BLINN", needs.blinn),
        ("ANY_PLACED", needs.placed),
        ("ANY_SLIDE", needs.slide),
    ];
    let flags: String = flags.iter().map(|(name, on)| format!("const {name} = {on};\n")).collect();
    let shared: String =
        SHADER_CONSTANTS.iter().map(|(name, value)| format!("const {name} = {value}u;\n")).collect();
    let constants = format!(
        "const MAX_LIGHTS = {MAX_LIGHTS}u;\nconst DEPTH_CLEAR = {:?};\n{flags}{shared}",
        DEPTH.clear()
    );
    [&library, &constants, FRAME, SURFACE, &visibility, SHADE, &lit_by_all(&needs.views)].join("\n")
}

/// The shader that draws the scene's meshes.
pub fn mesh(needs: &ShaderNeeds) -> String {
    [&prelude(needs), MESH].join("\n")
}

/// The shader that covers the screen.
pub fn screen(needs: &ShaderNeeds) -> String {
    [&prelude(needs), SCREEN].join("\n")
}

/// Every shader that the renderer can make, with a name: for validation.
#[cfg(test)]
pub fn all() -> Vec<(String, String)> {
    let mut all = Vec::new();
    let mut combinations: Vec<Option<Combination>> = Combination::all().map(Some).collect();
    combinations.push(None);
    for combination in combinations {
        for (metallic_roughness, blinn) in [(true, false), (false, true), (true, true)] {
            for lights in [0, 1, WRITTEN_OUT, WRITTEN_OUT + 1] {
                let views = (0..lights).map(|i| (i % 2 == 0).then_some(i / 2)).collect();
                let (placed, slide) = (lights != 1, lights > 1);
                let given = combination.is_none() && lights == 1;
                let needs =
                    ShaderNeeds { combination, given, metallic_roughness, blinn, placed, slide, views };
                all.push((format!("mesh for {needs:?}"), mesh(&needs)));
                all.push((format!("screen for {needs:?}"), screen(&needs)));
            }
        }
    }
    all
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
