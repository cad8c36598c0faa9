use super::*;
use crate::technique::TECHNIQUES;

#[test]
fn every_technique_ends_in_light_and_maps_come_first() {
    for technique in TECHNIQUES {
        let settings = Settings::new(technique.id, []).expect("from the table");
        let passes = plan(&settings);
        assert_eq!(passes.last().map(|p| p.draws), Some(Draws::Surfaces), "{}", technique.id);
        assert_eq!(passes.len() > 1, technique.method != Method::None, "{}", technique.id);
    }
}

#[test]
fn a_volume_lays_depth_counts_and_lights() {
    let names = |id, pairs: &[(&str, &str)]| -> Vec<&'static str> {
        let settings = Settings::new(id, pairs.iter().copied()).expect("valid");
        plan(&settings).iter().map(|pass| pass.name).collect()
    };
    assert_eq!(names("volume", &[]), ["layZ", "silhouettes", "back+front", "mask", "lighting"]);
    let classic = [("stencil", "two-pass"), ("silhouette", "vertex")];
    assert_eq!(names("volume", &classic), ["layZ", "back", "front", "mask", "lighting"]);
    let soft = ["layZ", "silhouettes", "back+front", "mask", "blur-rows", "blur-columns", "lighting"];
    assert_eq!(names("volume-soft", &[]), soft);
    let text: Vec<_> =
        plan(&Settings::new("volume", classic).expect("valid")).iter().map(Pass::to_string).collect();
    assert!(text[1].contains("stencil 0") && text[1].contains("front faces culled"), "{}", text[1]);
    assert!(text[2].contains("clear   nothing") && text[2].contains("back faces culled"), "{}", text[2]);
}

#[test]
fn coloured_light_takes_two_passes_more_and_says_so() {
    let passes = plan(&Settings::new("colored", []).expect("valid"));
    let draws: Vec<_> = passes.iter().map(|p| p.draws).collect();
    assert_eq!(draws, [Draws::Casters, Draws::Translucent, Draws::Translucent, Draws::Surfaces]);
    // What is tested against the map must be drawn with its offset.
    assert!(passes[..3].iter().all(|p| p.offset == passes[0].offset && p.per_light));
    let text = passes[1].to_string();
    assert!(
        text.contains("rgba8unorm") && text.contains("multiplied") && text.contains("clear   white"),
        "{text}"
    );
    let cut = Settings::new("colored", [("translucent", "cut")]).expect("valid");
    assert_eq!(plan(&cut), plan(&Settings::new("linear", []).expect("valid")));
}

#[test]
fn a_midpoint_map_is_peeled_first_and_a_second_depth_map_culls_fronts() {
    let midpoint = plan(&Settings::new("midpoint", []).expect("valid"));
    let kept: Vec<_> = midpoint.iter().map(|pass| (pass.keeps, pass.cull)).collect();
    let none = Cull::Nothing;
    assert_eq!(kept, [(Keeps::Nearest, none), (Keeps::Midpoint, none), (Keeps::Nearest, Cull::ByMaterial)]);
    let second = plan(&Settings::new("second-depth", []).expect("valid"));
    assert_eq!((second.len(), second[0].cull), (2, Cull::FrontOfClosed));
    for pass in [&midpoint[0], &midpoint[1], &second[0]] {
        assert_eq!(pass.offset, PolygonOffset::default(), "no numbers at all");
    }
}

#[test]
fn only_polygon_offset_biases_offset_polygons() {
    let offset = |bias| plan(&Settings::new("linear", [("bias", bias)]).expect("valid"))[0].offset;
    assert_eq!(offset("none"), PolygonOffset::default());
    assert_eq!(offset("matrix"), PolygonOffset::default());
    assert_eq!(offset("constant"), PolygonOffset { constant: -4, slope: 0.0 });
    assert_eq!(offset("slope"), PolygonOffset { constant: -4, slope: -2.0 });
    assert_eq!(offset("normal"), PolygonOffset { constant: -4, slope: 0.0 });
    let sloped = Settings::new("linear", [("bias", "normal"), ("polygon_slope", "2.5")]).expect("valid");
    assert_eq!(plan(&sloped)[0].offset, PolygonOffset { constant: -4, slope: -2.5 });
}
