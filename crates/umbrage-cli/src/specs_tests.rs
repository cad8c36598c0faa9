//! Every way to write a word wrong has an answer.

use super::*;

fn close(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from(b)).length() < 1e-4
}

#[test]
fn sizes_numbers_and_colours() {
    assert_eq!(size("64x36"), Ok(UVec2::new(64, 36)));
    assert_eq!(size("100000X2"), Ok(UVec2::new(100_000, 2)));
    for bad in ["", "x", "0x0", "64", "64x", "-1x3", "1.5x2", "64x36x2", "99999999999x1", "axb"] {
        assert!(size(bad).is_err(), "{bad}");
    }
    for bad in ["-0.1", "1.1", "NaN", "inf", "", "half"] {
        assert!(share(bad).is_err(), "{bad}");
    }
    assert_eq!((seconds("0.5"), seconds("-2")), (Ok(0.5), Ok(-2.0)));
    for bad in ["", "NaN", "inf", "1e39", "1s", "now"] {
        assert!(seconds(bad).is_err(), "{bad}");
    }
    assert_eq!(exposure("auto"), Ok(Exposure::Auto));
    assert_eq!(exposure("2.5"), Ok(Exposure::Factor(2.5)));
    for bad in ["0", "-1", "automatic", "inf", "NaN"] {
        assert!(exposure(bad).is_err(), "{bad}");
    }
    assert!(close(color("#ff0080").expect("hex"), [1.0, 0.0, 0.215_86]));
    assert!(close(color("2:0.5:0").expect("linear"), [2.0, 0.5, 0.0]));
    for bad in ["#ff00", "#gg0000", "1:2", "-1:0:0", "red", "#+12345", "#ééé"] {
        assert!(color(bad).is_err(), "{bad}");
    }
}

#[test]
fn pairs_and_cases() {
    assert_eq!(pair("a=b=c"), Ok(Pair { key: "a".into(), value: "b=c".into() }));
    assert!(pair("map_size").is_err() && pair("=3").is_err());
    assert_eq!(case_ref("C:/x/cases.json:A").map(|c| c.case), Ok("A".into()));
    assert!(case_ref("cases.json").is_err() && case_ref(":A").is_err() && case_ref("cases.json:").is_err());
}

#[test]
fn cameras() {
    assert_eq!(camera("1"), Ok(CameraChoice::OfScene("1".into())));
    let Ok(CameraChoice::Spec(spec)) = camera("position=1:-2:3e1,fov=50") else { panic!() };
    assert_eq!(
        (spec.position, spec.fov_deg, spec.near_m),
        (Some(Vec3::new(1.0, -2.0, 30.0)), Some(50.0), None)
    );
    for (bad, word) in [
        ("", "name a camera"),
        ("position=1:2", "position"),
        ("position=1/2/3", "x:y:z"),
        ("position=1:2:NaN", "finite"),
        ("postion=1:2:3", "did you mean `position`?"),
        ("fov=0", "above 0"),
        ("fov=179", "below 179"),
        ("near=-1", "above 0"),
        ("near=2,far=1", "below far"),
        ("up=0:0:0", "nowhere"),
        ("fov=30,fov=40", "twice"),
        ("position=1:2:3,target=1:2:3", "same place"),
        ("fov=30,", "not key=value"),
    ] {
        let message = camera(bad).expect_err(bad);
        assert!(message.contains(word), "{bad}: {message}");
    }
}

#[test]
fn a_light_in_full() {
    let spec = light(
        "kind=spot,position=0:4:0,target=0:0:0,color=#ffffff,candela=50,inner=10,outer=20,range=9,radius=0.1,near=1,far=8,cookie=a,b.png",
    )
    .expect("valid");
    assert_eq!(spec.cookie, Some(PathBuf::from("a,b.png")));
    let light = spec.resolve(Vec3::ONE, 2.0);
    assert!(close(light.direction_world, [0.0, -1.0, 0.0]) && close(light.position_world, [0.0, 4.0, 0.0]));
    assert_eq!((light.intensity, light.range_m), (50.0, Some(9.0)));
    assert_eq!(light.shape, LightShape::Sphere { radius_m: 0.1 });
    assert_eq!((light.near_m, light.far_m), (Some(1.0), Some(8.0)));
    let LightKind::Spot { inner_rad, outer_rad } = light.kind else { panic!() };
    assert!((inner_rad.to_degrees() - 10.0).abs() < 1e-4 && (outer_rad.to_degrees() - 20.0).abs() < 1e-4);
}

#[test]
fn what_is_not_said_suits_the_scene() {
    let (center, radius) = (Vec3::new(5.0, 1.0, -2.0), 3.0);
    for text in
        ["kind=spot", "kind=point", "kind=directional", "position=9:9:9", "direction=0:-1:0", "outer=20"]
    {
        let light = light(text).expect(text).resolve(center, radius);
        light.check().expect(text);
        let aimed = (center - light.position_world).normalize();
        assert!(light.kind == LightKind::Point || (light.direction_world - aimed).length() < 1e-4, "{text}");
        let lux = light.illuminance_lux(light.position_world.distance(center));
        assert!((lux / std::f32::consts::PI - 1.0).abs() < 1e-3, "{text}: {lux}");
    }
}

#[test]
fn bad_lights() {
    for (bad, word) in [
        ("", "not key=value"),
        ("spot", "not key=value"),
        ("kind=spott", "did you mean `spot`?"),
        ("knid=spot", "did you mean `kind`?"),
        ("position=1:2", "x:y:z"),
        ("position=a:b:c", "x:y:z"),
        ("direction=0:0:0", "nowhere"),
        ("target=0:0:0,direction=0:1:0", "keep one"),
        ("position=1:1:1,target=1:1:1", "same place"),
        ("color=blue", "#rrggbb"),
        ("candela=-1", "0 or more"),
        ("candela=inf", "0 or more"),
        ("lux=3", "candela="),
        ("kind=directional,candela=3", "lux="),
        ("kind=directional,range=3", "range"),
        ("kind=point,outer=30", "kind=spot"),
        ("kind=point,cookie=a.png", "only a spot light"),
        ("outer=90", "below 90 degrees"),
        ("outer=20,inner=30", "outer angle"),
        ("near=2,far=1", "below far"),
        ("range=0", "above 0"),
        ("radius=-1", "0 or more"),
        ("disc=0", "above 0"),
        ("rect=2", "width:height"),
        ("rect=2:0", "width:height"),
        ("radius=1,rect=1:1", "one shape"),
        ("angle=0.5", "only a directional light"),
        ("kind=directional,angle=180", "below 180"),
        ("kind=directional,radius=1", "angle instead"),
        ("cookie=", "name a picture"),
        ("outer=20,outer=30", "twice"),
    ] {
        let message = light(bad).expect_err(bad);
        assert!(message.contains(word), "{bad}: {message}");
        assert!(!message.contains('\n'), "{bad}");
    }
}
