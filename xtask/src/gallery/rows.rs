//! What the gallery shows.

use super::{Picture, Row};

const fn picture(file: &'static str, caption: &'static str, arguments: &'static str) -> Picture {
    Picture { file, caption, command: "render", arguments }
}

const fn traced(file: &'static str, caption: &'static str, arguments: &'static str) -> Picture {
    Picture { file, caption, command: "truth", arguments }
}

/// All rows, in the order of the page.
pub const ROWS: &[Row] = &[
    Row {
        id: "H1",
        title: "A spot light and its shadow map",
        text: "The scene is drawn from the light; each surface's depth is compared with what the light saw there.",
        pictures: &[
            picture("h1-linear", "`linear`, the default", "--technique linear"),
            picture("h1-unshadowed", "`unshadowed`: the same light", "--technique unshadowed"),
        ],
    },
    Row {
        id: "H2",
        title: "Depth formats",
        text: "Visibility (white lit, black shadow) from a coarse map of 256x256 texels in each depth format. The bias \
               follows the format, so all three agree.",
        pictures: &[
            picture(
                "h2-depth16",
                "16-bit normalised",
                "--view visibility --set map_size=256 --set storage=depth16",
            ),
            picture(
                "h2-depth24",
                "24-bit normalised, or better",
                "--view visibility --set map_size=256 --set storage=depth24",
            ),
            picture(
                "h2-depth32f",
                "32-bit float, reversed",
                "--view visibility --set map_size=256 --set storage=depth32f",
            ),
        ],
    },
    Row {
        id: "H3, H4",
        title: "Bias",
        text: "Planes turned from 0 to 89 degrees away from the light; none shadows another, so every dark spot is an \
               error (acne). Polygon offset by slope follows each plane, so its picture is white all over; a constant \
               does not. A uniform bias in the lookup matrix must be as large as the steepest plane needs, and then \
               light leaks wherever a caster is closer to its receiver than that. Measured against rays by the tests of \
               `umbrage-measure` on `builtin:contact` with a map of 256x256: the least uniform bias without more acne lets \
               light leak into 20 of 173,755 sure pixels and its shadows begin up to 37 mm late; the slope-scaled one \
               leaks into none and none begins late, with half the false shadow.",
        pictures: &[
            picture(
                "h3-none",
                "`bias=none`",
                "builtin:tilt --view visibility --set map_size=512 --set bias=none",
            ),
            picture(
                "h3-constant",
                "`bias=constant`",
                "builtin:tilt --view visibility --set map_size=512 --set bias=constant",
            ),
            picture(
                "h3-slope",
                "`bias=slope`, the default",
                "builtin:tilt --view visibility --set map_size=512 --set bias=slope",
            ),
            picture(
                "h4-matrix",
                "`bias=matrix` of a tenth of the depth range",
                "builtin:tilt --view visibility --set map_size=512 --set bias=matrix --set matrix_bias=0.1",
            ),
            picture(
                "h4-contact-slope",
                "`bias=slope`: shadows begin where things touch",
                "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --set map_size=512",
            ),
            picture(
                "h4-contact-matrix",
                "`bias=matrix` as above: the small ball and the box on top have lost their shadows",
                "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --set map_size=512 \
                 --set bias=matrix --set matrix_bias=0.1",
            ),
        ],
    },
    Row {
        id: "H5",
        title: "Nearest and linear on a very small map",
        text: "A map of 128x128 texels: one comparison makes stairs; four, blended by the hardware, a ramp a texel wide.",
        pictures: &[
            picture("h5-hard", "`hard`: nearest", "--technique hard --set map_size=128"),
            picture("h5-linear", "`linear`: 2x2", "--technique linear --set map_size=128"),
        ],
    },
    Row {
        id: "H6",
        title: "Light that stays in shadow",
        text: "Visibility takes diffuse and specular light away; a chosen share of the diffuse stays, so that shadows \
               do not look flat.",
        pictures: &[
            picture("h6-fill-0", "`--fill 0`", "builtin:contact --fill 0"),
            picture("h6-fill-01", "`--fill 0.1`, the default", "builtin:contact --fill 0.1"),
            picture("h6-fill-03", "`--fill 0.3`", "builtin:contact --fill 0.3"),
        ],
    },
    Row {
        id: "H9",
        title: "Duelling frusta",
        text: "Texels of the light's map in each pixel of the picture: blue where a texel covers many pixels and its edges \
               show, yellow at one, red where many texels go into a pixel. Eye and light face each other along the \
               colonnade. What is near to the eye is far from the light, so the ground at our feet is the bluest and the \
               far end the reddest; in the light's map all that the eye needs finely is a narrow strip, and what the eye \
               does not see at all (grey) is four fifths of the map. `lispsm` widens that strip: a hundredth of the pixels \
               has less than 0.24 texels with `fitted`, less than 0.37 with `lispsm`. It gains less than below, because \
               the warp has first to undo the light's own perspective, which runs the other way. (Everitt, Rege and \
               Cebenoyan 2001.)",
        pictures: &[
            picture(
                "h9-duel-fitted",
                "`fitted`, from the eye",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.2:1.4,fov=52 \
                 --light position=8:5:1.4,target=-7.5:0:1.4,inner=36,outer=40 --set map_size=1024 --view density",
            ),
            picture(
                "h9-duel-fitted-light",
                "`fitted`, in the light's map",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.2:1.4,fov=52 \
                 --light position=8:5:1.4,target=-7.5:0:1.4,inner=36,outer=40 --set map_size=1024 --view density-light",
            ),
            picture(
                "h9-duel-lispsm",
                "`lispsm`, from the eye",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.2:1.4,fov=52 \
                 --light position=8:5:1.4,target=-7.5:0:1.4,inner=36,outer=40 --set map_size=1024 --set projection=lispsm --view density",
            ),
            picture(
                "h9-duel-lispsm-light",
                "`lispsm`, in the light's map",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.2:1.4,fov=52 \
                 --light position=8:5:1.4,target=-7.5:0:1.4,inner=36,outer=40 --set map_size=1024 --set projection=lispsm --view density-light",
            ),
        ],
    },
    Row {
        id: "H9",
        title: "Texels where the eye is",
        text: "The same eye, under a sun from the side. The fitted map spends the same texels on every metre: the eye \
               sees a tenth of it, and on the nearest column a texel is up to ten pixels wide. `lispsm` turns the map \
               towards the eye: the histogram moves up and closes in on one, a hundredth of the pixels has less than 0.11 texels \
               with `fitted` and less than 0.46 with `lispsm`.",
        pictures: &[
            picture(
                "h9-side-fitted",
                "`fitted`, from the eye",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 \
                 --light kind=directional,direction=1:-1.1:-1 --set map_size=1024 --view density",
            ),
            picture(
                "h9-side-fitted-light",
                "`fitted`, in the light's map",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 \
                 --light kind=directional,direction=1:-1.1:-1 --set map_size=1024 --view density-light",
            ),
            picture(
                "h9-side-lispsm",
                "`lispsm`, from the eye",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 \
                 --light kind=directional,direction=1:-1.1:-1 --set map_size=1024 --set projection=lispsm --view density",
            ),
            picture(
                "h9-side-lispsm-light",
                "`lispsm`, in the light's map",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 \
                 --light kind=directional,direction=1:-1.1:-1 --set map_size=1024 --set projection=lispsm --view density-light",
            ),
        ],
    },
    Row {
        id: "H10",
        title: "Nothing behind the light",
        text: "The light hangs before the colonnade and shines up at it. The same division that projects what is before \
               the light mirrors what is behind it: without a test the ground on this side would be lit by a phantom \
               of the cone.",
        pictures: &[picture(
            "h10-behind",
            "the ground on our side of the light is dark",
            "builtin:columns --light position=0:1.5:3.4,target=0:2.4:0,inner=34,outer=40 \
             --camera position=4:3.6:9,target=0:1.5:1.5",
        )],
    },
    Row {
        id: "H13",
        title: "What the light sees, and what becomes of it",
        text: "The same scene and light in every view. In `depth` and `distance` near is black and far is white.",
        pictures: &[
            picture("h13-final", "`--view final`", "--view final"),
            picture("h13-visibility", "`--view visibility`", "--view visibility"),
            picture("h13-light", "`--view light`: from the light's eye", "--view light"),
            picture("h13-depth", "`--view depth`: the map", "--view depth"),
            picture(
                "h13-distance",
                "`--view distance`: how far each surface is from the light",
                "--view distance",
            ),
            picture(
                "h13-projected",
                "`--view projected`: the map projected on the scene",
                "--view projected",
            ),
        ],
    },
    Row {
        id: "F3",
        title: "A slide projector",
        text: "A slide in front of a spot light: [a leaded window](gallery/slide.png), which `cargo xtask gallery` \
               makes. What blocks the light takes the slide away with it.",
        pictures: &[picture(
            "f3-cookie",
            "coloured panes on floor and wall, and the torus' shadow among them",
            "--light position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=30,outer=34,cookie=docs/gallery/slide.png",
        )],
    },
    Row {
        id: "B6",
        title: "The truth, by rays",
        text: "How much of the light each surface sees, traced on the processor: what every technique is measured against. A \
               light that is a point takes one exact ray a pixel; one with a shape takes many, and has umbra and penumbra. \
               What it measures is in the [guide](guide.md).",
        pictures: &[
            traced("b6-point", "V* of the scene's own light, a point", "--view visibility"),
            traced(
                "b6-sphere",
                "V* of a shining ball of 0.4 m radius, 256 rays a pixel",
                "--light radius=0.4,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --samples 256",
            ),
            traced(
                "b6-rectangle",
                "the lit scene under a rectangle of 2 x 0.2 m: soft across its length, sharp along it",
                "--light rect=2:0.2,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --samples 256 --view final",
            ),
            traced(
                "b6-sun",
                "a sun of 4 degrees: sharp where a caster is near, soft where it is far",
                "builtin:columns --light kind=directional,direction=1:-1.1:-1,angle=4 --samples 256 --view final",
            ),
        ],
    },
    Row {
        id: "Scenes",
        title: "Built in",
        text: "No file is needed to try a technique: each built-in scene shows something that goes wrong.",
        pictures: &[
            picture("scene-torus", "`builtin:torus`: curved on curved on flat", "builtin:torus"),
            picture(
                "scene-columns",
                "`builtin:columns`: thick, thin, and long shadows in parallel",
                "builtin:columns",
            ),
            picture("scene-tilt", "`builtin:tilt`: planes turned away from the light", "builtin:tilt"),
            picture("scene-contact", "`builtin:contact`: things that touch", "builtin:contact"),
            picture(
                "scene-knots",
                "`builtin:knots`: half a million triangles",
                "builtin:knots --camera position=2:3:6,fov=40",
            ),
        ],
    },
    Row {
        id: "Files",
        title: "glTF",
        text: "A model from a file, on a ground, under a light that suits it. Flight helmet by Microsoft, converted by \
               Gary Hsu, CC0 1.0.",
        pictures: &[picture(
            "gltf-helmet",
            "straps and goggles shadow the helmet itself",
            "../shared/scenes/flight-helmet/FlightHelmet.gltf --ground",
        )],
    },
];
