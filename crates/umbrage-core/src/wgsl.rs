//! The WGSL library: modules without bindings, and the text that joins them.
//!
//! A module is a plain WGSL file. Textures, samplers and parameters are arguments, names start with `umbrage_`, and
//! nothing is bound, so any module can be pasted into any renderer together with those it needs.

mod variants;

pub use variants::{Variant, assemble_variants};

/// A WGSL file of the library.
#[derive(Clone, Copy, Debug)]
pub struct Module {
    /// Path below `wgsl/` without its ending.
    pub name: &'static str,
    /// What it offers, in one sentence.
    pub summary: &'static str,
    /// Modules, or [slots](SLOTS), whose text must come before it.
    pub needs: &'static [&'static str],
    /// Its text.
    pub source: &'static str,
}

impl Module {
    /// The slot that it fills: what stands before the slash of its name, where that is a slot.
    pub fn slot(&self) -> Option<&'static str> {
        let (slot, _) = self.name.split_once('/')?;
        SLOTS.iter().find(|(name, _)| *name == slot).map(|(name, _)| *name)
    }
}

/// What can be done in several ways, one of them in each shader: all modules of a slot define the same functions. With each
/// slot, the module that fills it when none is named.
pub const SLOTS: &[(&str, &str)] =
    &[("map", "map/depth"), ("compare", "compare/auto"), ("kernel", "kernel/bell")];

macro_rules! module {
    ($name:literal, $summary:literal, [$($need:literal),*]) => {
        Module {
            name: $name,
            summary: $summary,
            needs: &[$($need),*],
            source: include_str!(concat!("../wgsl/", $name, ".wgsl")),
        }
    };
}

/// The library, each module after those it needs.
pub const MODULES: &[Module] = &[
    module!("view", "what a shader knows of a light's view: lookup matrix, layer, texel size", []),
    module!("light", "distance falloff and cone of KHR_lights_punctual, without shadow", []),
    module!("cookie", "a slide in front of a light", []),
    module!("face", "which of a point light's six tiles looks along a direction", []),
    module!("share", "from the linear share of a distance to stored depth and back", ["view"]),
    module!(
        "locate",
        "from a surface in world space to place, depth and slope in the map; says when outside or behind",
        ["view", "share"]
    ),
    module!("bias/normal", "a receiver moved along its normal before it is looked up", ["view"]),
    module!("map/depth", "four texels of a depth texture", ["view"]),
    module!("map/distance", "four texels of a float texture that holds distance", ["share"]),
    module!("map/packed1", "four texels of distance in 8 bits of one channel", ["share"]),
    module!("map/packed2", "four texels of distance in 16 bits of two channels", ["share"]),
    module!("map/packed3", "four texels of distance in 24 bits of three channels", ["share"]),
    module!("through", "the share of light that a translucent surface lets through", []),
    module!("taps", "what comparing four texels with a receiver gives", []),
    module!("compare/plain", "texels compared with the receiver's own depth", ["locate", "taps"]),
    module!("compare/plane", "texels compared with the receiver's plane at each", ["locate", "taps"]),
    module!("compare/auto", "texels compared so that no lit surface shadows itself", ["locate", "taps"]),
    module!("kernel/box", "a box that slides over the texels without steps", ["view"]),
    module!("kernel/bell", "a quadratic B-spline, near a Gaussian", ["view"]),
    module!("filter/nearest", "one comparison with the texel that holds the receiver", ["map", "compare"]),
    module!("filter/linear", "2x2 comparisons, blended", ["map", "compare"]),
    module!("filter/linear_hardware", "2x2 comparisons with one depth, blended by the hardware", ["locate"]),
    module!(
        "filter/kernel",
        "comparisons with all texels that a kernel reaches, blended",
        ["map", "compare", "kernel"]
    ),
    module!("extrude", "the two ends of a shadow volume, and which triangles face a light", []),
    module!("like_depth", "which neighbouring pixels are on one surface", []),
    module!("mask", "the outline of one blocker, projected on what lies behind it", []),
    module!("density", "texels per pixel: how finely a map samples what a picture shows", []),
    module!("colored", "colours of four texels, and what they make of comparisons", ["view", "taps"]),
    module!("filter/colored_nearest", "`filter/nearest` with coloured light", ["map", "compare", "colored"]),
    module!("filter/colored_linear", "`filter/linear` with coloured light", ["map", "compare", "colored"]),
    module!(
        "filter/colored_kernel",
        "`filter/kernel` with coloured light",
        ["map", "compare", "kernel", "colored"]
    ),
];

/// A name that is no module.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no WGSL module `{asked}`; there are {known}")]
pub struct UnknownModule {
    /// What was asked for.
    pub asked: String,
    /// All names.
    pub known: String,
}

/// The text of the named modules and all that they need, each once, in an order that compiles. A slot that is needed is
/// filled by the module of it that is named, or by its default.
///
/// # Errors
/// [`UnknownModule`] lists the names that exist.
pub fn assemble(names: &[&str]) -> Result<String, UnknownModule> {
    assemble_with(names, &[])
}

/// The same, with slots filled by text of one's own: pairs of a slot and the text that defines its functions.
///
/// # Errors
/// [`UnknownModule`] lists the names that exist.
pub fn assemble_with(names: &[&str], own: &[(&str, &str)]) -> Result<String, UnknownModule> {
    let chosen = MODULES.iter().zip(wanted(names)?).filter(|(_, wanted)| *wanted);
    Ok(chosen.map(|(module, _)| text(module, own)).collect::<Vec<_>>().join("\n"))
}

/// Which modules are named or needed, in the library's order.
fn wanted(names: &[&str]) -> Result<Vec<bool>, UnknownModule> {
    let mut wanted = vec![false; MODULES.len()];
    let mut open: Vec<&str> = names.to_vec();
    let filler = |name: &str| {
        let (_, default) = SLOTS.iter().find(|(slot, _)| *slot == name)?;
        let named =
            names.iter().find(|named| named.strip_prefix(name).is_some_and(|rest| rest.starts_with('/')));
        Some(named.copied().unwrap_or(default))
    };
    while let Some(name) = open.pop() {
        let name = filler(name).unwrap_or(name);
        let index = MODULES.iter().position(|m| m.name == name).ok_or_else(|| UnknownModule {
            asked: name.to_owned(),
            known: MODULES.iter().map(|m| m.name).collect::<Vec<_>>().join(", "),
        })?;
        if !std::mem::replace(&mut wanted[index], true) {
            open.extend(MODULES[index].needs);
        }
    }
    Ok(wanted)
}

/// A module's text, or that of one's own for its slot.
fn text<'a>(module: &'a Module, own: &[(&str, &'a str)]) -> &'a str {
    own.iter().find(|(slot, _)| module.slot() == Some(slot)).map_or(module.source, |(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn validate(name: &str, text: &str) -> naga::Module {
        let module = naga::front::wgsl::parse_str(text)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(text)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(text)));
        module
    }

    #[test]
    fn every_module_validates_alone_with_what_it_needs_and_binds_nothing() {
        assert!(!MODULES.is_empty());
        for module in MODULES {
            let text = assemble(&[module.name]).expect(module.name);
            assert!(text.contains(module.source));
            let parsed = validate(module.name, &text);
            assert_eq!(parsed.global_variables.len(), 0, "{} binds something", module.name);
            assert_eq!(parsed.entry_points.len(), 0, "{} has an entry point", module.name);
        }
    }

    #[test]
    fn every_name_that_a_module_defines_starts_with_umbrage() {
        for module in MODULES {
            let parsed = validate(module.name, &assemble(&[module.name]).expect(module.name));
            for (_, function) in parsed.functions.iter() {
                let name = function.name.as_deref().unwrap_or_default();
                assert!(name.starts_with("umbrage_"), "{}: fn {name}", module.name);
            }
            for (_, ty) in parsed.types.iter() {
                if let (Some(name), naga::TypeInner::Struct { .. }) = (&ty.name, &ty.inner) {
                    assert!(name.starts_with("Umbrage"), "{}: struct {name}", module.name);
                }
            }
        }
    }

    #[test]
    fn every_file_of_the_folder_is_a_module_and_a_broken_one_is_seen() {
        fn files(folder: &std::path::Path, found: &mut Vec<String>, root: &std::path::Path) {
            for entry in std::fs::read_dir(folder).expect("wgsl folder").flatten() {
                let path = entry.path();
                if path.is_dir() {
                    files(&path, found, root);
                } else {
                    let name = path.strip_prefix(root).expect("below root").with_extension("");
                    found.push(name.to_string_lossy().replace('\\', "/"));
                }
            }
        }
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("wgsl");
        let mut found = Vec::new();
        files(&root, &mut found, &root);
        found.sort();
        let mut named: Vec<_> = MODULES.iter().map(|m| m.name.to_owned()).collect();
        named.sort();
        assert_eq!(found, named);
        assert!(naga::front::wgsl::parse_str("fn umbrage_broken() -> f32 { return 1; ").is_err());
    }

    #[test]
    fn needs_come_first_and_once() {
        let text = assemble(&["filter/linear", "filter/nearest"]).expect("known");
        assert_eq!(text.matches("struct UmbrageView").count(), 1);
        assert!(text.find("struct UmbrageView") < text.find("fn umbrage_locate"));
        assert!(assemble(&["filter/liner"]).expect_err("unknown").to_string().contains("filter/linear"));
    }

    #[test]
    fn every_choice_names_modules_that_exist() {
        for combination in crate::technique::Combination::all() {
            assemble(&combination.modules()).expect("modules of a choice");
        }
    }
}
