//! The WGSL library: modules without bindings, and the text that joins them.
//!
//! A module is a plain WGSL file. Textures, samplers and parameters are arguments, names start with `umbrage_`, and
//! nothing is bound, so any module can be pasted into any renderer together with those it needs.

/// A WGSL file of the library.
#[derive(Clone, Copy, Debug)]
pub struct Module {
    /// Path below `wgsl/` without its ending.
    pub name: &'static str,
    /// What it offers, in one sentence.
    pub summary: &'static str,
    /// Modules whose text must come before it.
    pub needs: &'static [&'static str],
    /// Its text.
    pub source: &'static str,
}

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
    module!(
        "locate",
        "from world space to a place and depth in the map; says when outside or behind",
        ["view"]
    ),
    module!("density", "texels per pixel: how finely a map samples what a picture shows", []),
    module!("filter/nearest", "one comparison with the texel that holds the receiver", ["locate"]),
    module!("filter/linear", "2x2 comparisons blended by the hardware", ["locate"]),
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

/// The text of the named modules and all that they need, each once, in an order that compiles.
///
/// # Errors
/// [`UnknownModule`] lists the names that exist.
pub fn assemble(names: &[&str]) -> Result<String, UnknownModule> {
    let mut wanted = vec![false; MODULES.len()];
    let mut open: Vec<&str> = names.to_vec();
    while let Some(name) = open.pop() {
        let index = MODULES.iter().position(|m| m.name == name).ok_or_else(|| UnknownModule {
            asked: name.to_owned(),
            known: MODULES.iter().map(|m| m.name).collect::<Vec<_>>().join(", "),
        })?;
        if !std::mem::replace(&mut wanted[index], true) {
            open.extend(MODULES[index].needs);
        }
    }
    let chosen = MODULES.iter().zip(wanted).filter(|(_, wanted)| *wanted).map(|(module, _)| module.source);
    Ok(chosen.collect::<Vec<_>>().join("\n"))
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
