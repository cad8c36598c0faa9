//! The renderer's shaders: library modules, the chosen filter, and the passes, joined as text.

use crate::layout::MAX_LIGHTS;
use umbrage::core::DEPTH;
use umbrage::core::technique::{Combination, Settings};
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

/// What all shaders begin with: the library, the frame, and the technique's visibility.
fn prelude(combination: Option<&Combination>) -> String {
    let mut modules = combination.map(Combination::modules).unwrap_or_default();
    // The debug views locate points whatever the technique is.
    modules.extend(["view", "light", "cookie", "locate"]);
    let library = assemble(&modules).unwrap_or_else(|e| format!("// {e}\n"));
    let visibility = match combination {
        // Outside a cone's map lies what the cone does not reach; outside a parallel light's map nothing can block it.
        Some(combination) => format!(
            "fn map_visibility(view: UmbrageView, kind: u32, p_world: vec3f) -> f32 {{
    let at = umbrage_locate(view, p_world);
    if !at.inside {{
        return select(0.0, 1.0, kind == DIRECTIONAL);
    }}
    return {}(maps, map_compare, view, at);
}}
",
            filter_function(combination)
        ),
        None => "fn map_visibility(view: UmbrageView, kind: u32, p_world: vec3f) -> f32 { return 1.0; }\n"
            .to_owned(),
    };
    let constants = format!("const MAX_LIGHTS = {MAX_LIGHTS}u;\nconst DEPTH_CLEAR = {:?};\n", DEPTH.clear());
    [&library, &constants, FRAME, SURFACE, &visibility, SHADE].join("\n")
}

/// The shader that draws the scene's meshes.
pub fn mesh(settings: &Settings) -> String {
    [&prelude(settings.combination.as_ref()), MESH].join("\n")
}

/// The shader that covers the screen.
pub fn screen(settings: &Settings) -> String {
    [&prelude(settings.combination.as_ref()), SCREEN].join("\n")
}

/// Every shader that the renderer can make, with a name: for validation.
#[cfg(test)]
pub fn all() -> Vec<(String, String)> {
    let mut all = Vec::new();
    for technique in umbrage::core::technique::TECHNIQUES {
        let settings = Settings::new(technique.id, []).expect("from the table");
        all.push((format!("mesh of {}", technique.id), mesh(&settings)));
        all.push((format!("screen of {}", technique.id), screen(&settings)));
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
