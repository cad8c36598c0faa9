//! What Umbrage makes of the extensions that a file names: refuse what it must have, say what else is left out.

use gltf::json;

/// Extensions that are honoured, or that change nothing that Umbrage shows.
pub(super) const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Data beside the picture: nothing is lost by passing them over.
const WITHOUT_EFFECT: &[&str] =
    &["KHR_xmp", "KHR_xmp_json_ld", "EXT_structural_metadata", "EXT_mesh_features"];

/// What passing over an extension does to the picture.
const MEANINGS: &[(&str, &str)] = &[
    ("KHR_materials_transmission", "see-through surfaces are drawn opaque"),
    ("KHR_materials_diffuse_transmission", "surfaces that let light through are drawn opaque"),
    ("KHR_materials_volume", "glass has no depth"),
    ("KHR_materials_ior", "every surface reflects as if its index of refraction were 1.5"),
    ("KHR_materials_clearcoat", "clear coats are left out"),
    ("KHR_materials_sheen", "the sheen of cloth is left out"),
    ("KHR_materials_specular", "highlights keep their usual strength and colour"),
    ("KHR_materials_anisotropy", "highlights stay round"),
    ("KHR_materials_iridescence", "thin-film colours are left out"),
    ("KHR_materials_dispersion", "glass does not split colours"),
    ("KHR_materials_pbrSpecularGlossiness", "the metallic-roughness values beside it are used"),
    ("KHR_materials_variants", "the default variant is shown"),
    ("KHR_texture_basisu", "its textures are left out unless the file has a PNG or JPEG beside them"),
    ("MSFT_texture_dds", "its textures are left out unless the file has a PNG or JPEG beside them"),
    ("KHR_animation_pointer", "what only it moves is at rest"),
    ("EXT_lights_image_based", "the light of its surroundings is left out"),
    ("MSFT_lod", "the finest level of detail is drawn"),
];

/// Refuses required extensions that are not [`SUPPORTED`] and warns once for each other that has an effect.
pub(super) fn check(root: &json::Root, warnings: &mut Vec<String>) -> Result<(), String> {
    let unknown =
        |name: &&String| !SUPPORTED.contains(&name.as_str()) && !WITHOUT_EFFECT.contains(&name.as_str());
    let mut required: Vec<&str> =
        root.extensions_required.iter().filter(unknown).map(String::as_str).collect();
    required.sort_unstable();
    required.dedup();
    if !required.is_empty() {
        let names = required.join(", ");
        return Err(format!(
            "it requires {names}, which Umbrage does not have; export it without, or convert it with gltf-transform"
        ));
    }
    let mut used: Vec<&str> = root.extensions_used.iter().filter(unknown).map(String::as_str).collect();
    used.sort_unstable();
    used.dedup();
    warnings.extend(used.into_iter().map(meaning));
    Ok(())
}

/// The warning of an extension that is passed over.
pub(super) fn meaning(name: &str) -> String {
    let meaning = MEANINGS.iter().find(|(known, _)| *known == name).map(|(_, meaning)| *meaning);
    format!("{name} is not supported: {}", meaning.unwrap_or("it is passed over"))
}

/// Does the file say that it uses an extension?
pub(super) fn declared(root: &json::Root, name: &str) -> bool {
    root.extensions_used.iter().chain(&root.extensions_required).any(|used| used == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(used: &[&str], required: &[&str]) -> json::Root {
        let own = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
        json::Root { extensions_used: own(used), extensions_required: own(required), ..Default::default() }
    }

    #[test]
    fn required_strangers_are_refused_by_name() {
        let message = check(&root(&[], &["KHR_texture_basisu", "ACME_x"]), &mut vec![]).unwrap_err();
        assert!(message.contains("ACME_x, KHR_texture_basisu"), "{message}");
        assert!(check(&root(&[], SUPPORTED), &mut vec![]).is_ok());
    }

    #[test]
    fn each_optional_stranger_is_one_warning_that_says_what_is_lost() {
        let mut warnings = Vec::new();
        let twice = ["KHR_materials_transmission", "KHR_materials_transmission", "KHR_xmp", "ACME_x"];
        check(&root(&twice, &[]), &mut warnings).unwrap();
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[1].contains("drawn opaque"), "{warnings:?}");
    }
}
