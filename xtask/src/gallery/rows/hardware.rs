//! H: hardware shadow maps.

use super::{measure, picture};
use crate::gallery::{Listing, Row};

pub const ROWS: &[Row] = &[
    Row {
        id: "H1",
        title: "A spot light and its shadow map",
        text: "The scene is drawn from the light; each surface's depth is compared with what the light saw there.",
        pictures: &[
            picture("h1-linear", "`linear`, the default", "--technique linear"),
            picture("h1-unshadowed", "`unshadowed`: the same light", "--technique unshadowed"),
        ],
        measures: &[
            measure("`linear`", "--techniques linear"),
            measure("`hard`", "--techniques hard"),
            measure("`unshadowed`", "--techniques unshadowed"),
        ],
        ..Row::BARE
    },
    Row {
        id: "H2",
        title: "Depth formats",
        text: "Visibility (white lit, black shadow) from a coarse map of 256x256 texels in each depth format. The \
               bias \
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
        measures: &[
            measure("`depth16`", "--techniques linear --set map_size=256 --set storage=depth16"),
            measure("`depth24`", "--techniques linear --set map_size=256 --set storage=depth24"),
            measure("`depth32f`", "--techniques linear --set map_size=256 --set storage=depth32f"),
        ],
        ..Row::BARE
    },
    Row {
        id: "H3, H4",
        title: "Bias",
        text: "Planes turned from 0 to 89 degrees away from the light; none shadows another, so every dark spot is \
               an \
               error (acne). Polygon offset by slope follows each plane, so its picture is white all over; a \
               constant \
               does not. A uniform bias in the lookup matrix must be as large as the steepest plane needs, and then \
               light leaks wherever a caster is closer to its receiver than that. Measured against rays by the \
               tests of \
               `umbrage-measure` on `builtin:contact` with a map of 256x256: the least uniform bias without more \
               acne lets \
               light leak into 20 of 173,755 sure pixels and its shadows begin up to 37 mm late; the slope-scaled \
               one \
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
                "`bias=slope`",
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
                "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --set map_size=512 --set \
                 bias=slope",
            ),
            picture(
                "h4-contact-matrix",
                "`bias=matrix` as above: the small ball and the box on top have lost their shadows",
                "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --set map_size=512 \
                 --set bias=matrix --set matrix_bias=0.1",
            ),
        ],
        measures: &[
            measure("planes: `none`", "builtin:tilt --techniques linear --set map_size=512 --set bias=none"),
            measure(
                "planes: `constant`",
                "builtin:tilt --techniques linear --set map_size=512 --set bias=constant",
            ),
            measure(
                "planes: `slope`",
                "builtin:tilt --techniques linear --set map_size=512 --set bias=slope",
            ),
            measure(
                "planes: `matrix`, 0.1",
                "builtin:tilt --techniques linear --set map_size=512 --set bias=matrix --set matrix_bias=0.1",
            ),
            measure(
                "contacts: `slope`",
                "builtin:contact --techniques linear --set map_size=512 --set bias=slope",
            ),
            measure(
                "contacts: `matrix`, 0.1",
                "builtin:contact --techniques linear --set map_size=512 --set bias=matrix --set matrix_bias=0.1",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "H5",
        title: "Nearest and linear on a very small map",
        text: "A map of 128x128 texels: one comparison makes stairs; four, blended by the hardware, a ramp a texel \
               wide.",
        pictures: &[
            picture("h5-hard", "`hard`: nearest", "--technique hard --set map_size=128"),
            picture("h5-linear", "`linear`: 2x2", "--technique linear --set map_size=128"),
        ],
        measures: &[
            measure("`hard`", "--techniques hard --set map_size=128"),
            measure("`linear`", "--techniques linear --set map_size=128"),
        ],
        ..Row::BARE
    },
    Row {
        id: "H6",
        title: "Light that stays in shadow",
        text: "Visibility takes diffuse and specular light away; a chosen share of the diffuse stays, so that \
               shadows \
               do not look flat.",
        pictures: &[
            picture("h6-fill-0", "`--fill 0`", "builtin:contact --fill 0"),
            picture("h6-fill-01", "`--fill 0.1`, the default", "builtin:contact --fill 0.1"),
            picture("h6-fill-03", "`--fill 0.3`", "builtin:contact --fill 0.3"),
        ],
        ..Row::BARE
    },
    Row {
        id: "H7",
        title: "The chain of transforms",
        text: "From a surface to its place in the map, as public maths in `umbrage-core`: from object, eye or \
               world space, in the depth conventions of OpenGL (-1 to 1), Direct3D and WebGPU (0 to 1) and \
               reversed depth, with both origins of a texture. There is nothing to see: equivalent formulations \
               are held to equal results by the tests of `crates/umbrage-core/src/lookup_tests.rs`.",
        ..Row::BARE
    },
    Row {
        id: "H8",
        title: "A light in all directions",
        text: "A lamp within the colonnade. Its map is six square views of 90 degrees (a little wider, so that \
               filters reach across the edges without a seam), each with near and far of its own: right, up and \
               front in the upper row; left, down and back in the lower. Shadows run out from the lamp on all \
               sides, unbroken where one view ends and the next begins.",
        pictures: &[
            picture("h8-point", "the picture", "builtin:columns --light kind=point,position=-1.2:1.4:0.3"),
            picture(
                "h8-tiles",
                "`--view depth`: the six views, each its own tile",
                "builtin:columns --light kind=point,position=-1.2:1.4:0.3 --view depth",
            ),
            picture(
                "h8-visibility",
                "`--view visibility`",
                "builtin:columns --light kind=point,position=-1.2:1.4:0.3 --view visibility",
            ),
            picture(
                "h8-pcf",
                "`--view visibility`, `pcf` of 9 texels in maps of 512x512: softer, and without a seam",
                "builtin:columns --light kind=point,position=-1.2:1.4:0.3 --technique pcf --set width=9 --set \
                 map_size=512 --view visibility",
            ),
        ],
        measures: &[
            measure(
                "`linear`",
                "builtin:columns --light kind=point,position=-1.2:1.4:0.3 --techniques linear",
            ),
            measure(
                "`pcf`, 9 texels, 512x512",
                "builtin:columns --light kind=point,position=-1.2:1.4:0.3 --techniques pcf --set width=9 --set \
                 map_size=512",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "H9",
        title: "Duelling frusta",
        text: "Texels of the light's map in each pixel of the picture: blue where a texel covers many pixels and \
               its edges \
               show, yellow at one, red where many texels go into a pixel. Eye and light face each other along the \
               colonnade. What is near to the eye is far from the light, so the ground at our feet is the bluest \
               and the \
               far end the reddest; in the light's map all that the eye needs finely is a narrow strip, and what \
               the eye \
               does not see at all (grey) is four fifths of the map. `lispsm` widens that strip: a hundredth of \
               the pixels \
               has less than 0.24 texels with `fitted`, less than 0.37 with `lispsm`. It gains less than below, \
               because \
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
                 --light position=8:5:1.4,target=-7.5:0:1.4,inner=36,outer=40 --set map_size=1024 --view \
                 density-light",
            ),
            picture(
                "h9-duel-lispsm",
                "`lispsm`, from the eye",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.2:1.4,fov=52 \
                 --light position=8:5:1.4,target=-7.5:0:1.4,inner=36,outer=40 --set map_size=1024 --set \
                 projection=lispsm --view density",
            ),
            picture(
                "h9-duel-lispsm-light",
                "`lispsm`, in the light's map",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.2:1.4,fov=52 \
                 --light position=8:5:1.4,target=-7.5:0:1.4,inner=36,outer=40 --set map_size=1024 --set \
                 projection=lispsm --view density-light",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "H9",
        title: "Texels where the eye is",
        text: "The same eye, under a sun from the side. The fitted map spends the same texels on every metre: the \
               eye \
               sees a tenth of it, and on the nearest column a texel is up to ten pixels wide. `lispsm` turns the \
               map \
               towards the eye: the histogram moves up and closes in on one, a hundredth of the pixels has less \
               than 0.11 texels \
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
                 --light kind=directional,direction=1:-1.1:-1 --set map_size=1024 --set projection=lispsm --view \
                 density",
            ),
            picture(
                "h9-side-lispsm-light",
                "`lispsm`, in the light's map",
                "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 \
                 --light kind=directional,direction=1:-1.1:-1 --set map_size=1024 --set projection=lispsm --view \
                 density-light",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "H10",
        title: "Nothing behind the light",
        text: "The light hangs before the colonnade and shines up at it. The same division that projects what is \
               before \
               the light mirrors what is behind it: without a test the ground on this side would be lit by a phantom \
               of the cone.",
        pictures: &[picture(
            "h10-behind",
            "the ground on our side of the light is dark",
            "builtin:columns --light position=0:1.5:3.4,target=0:2.4:0,inner=34,outer=40 \
             --camera position=4:3.6:9,target=0:1.5:1.5",
        )],
        ..Row::BARE
    },
    Row {
        id: "H11",
        title: "Midpoint map",
        text: "The map holds the middle between the nearest and the second-nearest surface, found by peeling the \
               nearest layer off. Neither a lit surface nor the one behind it is close to that, so no bias has to \
               be chosen. (Woo 1992.)",
        pictures: &[
            picture("h11-none", "`bias=none`, 256x256 texels", "--set bias=none --set map_size=256"),
            picture("h11-midpoint", "`midpoint`, 256x256 texels", "--technique midpoint --set map_size=256"),
        ],
        measures: &[
            measure("`bias=none`", "--techniques linear --set bias=none --set map_size=256"),
            measure("`bias=slope`", "--techniques linear --set bias=slope --set map_size=256"),
            measure("`midpoint`", "--techniques midpoint --set map_size=256"),
        ],
        ..Row::BARE
    },
    Row {
        id: "H12",
        title: "Second-depth map",
        text: "The map holds back faces only: what the light strikes is far from them if casters are closed \
               solids. Those that are not are drawn whole and named in a warning; the planes of `builtin:tilt` \
               have no inside, and show why. (Wang and Molnar 1994.)",
        pictures: &[
            picture(
                "h12-closed",
                "`second-depth` on closed solids, 256x256 texels",
                "--technique second-depth --set map_size=256",
            ),
            picture(
                "h12-open",
                "`second-depth` on open planes: they shadow themselves",
                "builtin:tilt --technique second-depth --set map_size=256 --json",
            )
            .quoting(&["warnings"]),
        ],
        measures: &[
            measure("closed solids", "--techniques second-depth --set map_size=256"),
            measure("open planes", "builtin:tilt --techniques second-depth --set map_size=256"),
        ],
        ..Row::BARE
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
        ..Row::BARE
    },
    Row {
        id: "H14",
        title: "Casters that move or have holes",
        text: "Shadows follow skins, morph targets and moving nodes at any `--time`, holes that a texture's alpha \
               cuts, and vertices that a WGSL function of your own moves (`--deform`), because maps are drawn by \
               the same code as the picture. Fox by PixelMannen (CC0 1.0), rig and animation by tomkranis and \
               conversion by AsoboStudio and scurest (CC BY 4.0). Mannequiny by GDQuest and contributors (CC BY \
               4.0). Morph stress test by Analytical Graphics, Inc. and Ed Mackey, animated box by Cesium (both CC \
               BY 4.0). Bush by Scopia Visual Interfaces Systems, s.l. and Emmanuel Puybaret / eTeks (CC BY 3.0).",
        pictures: &[
            picture(
                "h14-fox-0",
                "a skin: `Run` at 0 s",
                "../shared/scenes/fox/Fox.glb --ground --animation Run --time 0",
            ),
            picture(
                "h14-fox-035",
                "`Run` at 0.35 s",
                "../shared/scenes/fox/Fox.glb --ground --animation Run --time 0.35",
            ),
            picture(
                "h14-kick",
                "a skin at metre scale: a kick",
                "../shared/scenes/mannequiny/mannequiny.glb --ground --camera \
                 position=1.8:1.7:3.4,target=0.1:0.85:0,fov=38 --light position=-1.2:4:1.6,target=0:0.6:0,outer=40 \
                 --animation fight_kick_root.001 --time 0.5",
            ),
            picture(
                "h14-run",
                "the same in a run",
                "../shared/scenes/mannequiny/mannequiny.glb --ground --camera \
                 position=1.8:1.7:3.4,target=0.1:0.85:0,fov=38 --light position=-1.2:4:1.6,target=0:0.6:0,outer=40 \
                 --animation run_root.001 --time 0.3",
            ),
            picture(
                "h14-morph-0",
                "morph targets, at 0 s",
                "../shared/scenes/morph-stress-test/MorphStressTest.glb --ground --time 0 --light \
                 position=-3:5:-4,target=0:0:0,outer=40",
            ),
            picture(
                "h14-morph-08",
                "at 0.8 s the first stands twice as high, and so does its shadow",
                "../shared/scenes/morph-stress-test/MorphStressTest.glb --ground --time 0.8 --light \
                 position=-3:5:-4,target=0:0:0,outer=40",
            ),
            picture(
                "h14-node",
                "a node on its way into the box, at 1.5 s",
                "../shared/scenes/loader-features/BoxAnimated/BoxAnimated.glb --ground --time 1.5 --light \
                 position=-2.2:9:2.8,target=0:1:0,outer=35",
            ),
            picture(
                "h14-bush",
                "leaves cut out of squares by alpha",
                "../shared/scenes/scopia-trees/bush/bush.obj --ground",
            ),
            picture(
                "h14-sway-0",
                "`sway.wgsl` bends the colonnade, at 0 s",
                "builtin:columns --deform examples/wgsl/sway.wgsl --deform-reach 0.6 --time 0",
            ),
            picture(
                "h14-sway-1",
                "at 1 s: shadows sway with it",
                "builtin:columns --deform examples/wgsl/sway.wgsl --deform-reach 0.6 --time 1",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "H15, I5",
        title: "Maps that nothing moved are kept",
        text: "Three frames with `--reuse`, in which nothing moves: the first draws the map, the others look it up \
               again. A map is drawn again only when its light, its view or a caster in its view moved. The first \
               picture counts with `--reuse`, the second without it.",
        pictures: &[
            picture("h15-reuse", "three frames with `--reuse`", "--frames 3 --reuse --json")
                .quoting(&["maps_drawn", "maps_reused"]),
            picture(
                "h15-redraw",
                "three frames without: the same picture, each map drawn anew",
                "--frames 3 --json",
            )
            .quoting(&["maps_drawn", "maps_reused"]),
        ],
        ..Row::BARE
    },
    Row {
        id: "H16",
        title: "Depth peeling",
        text: "Layer after layer, each nearest behind the one before, to any number: `Peel`, `PeelPipelines` and \
               `record_peel` of the crate `umbrage`. The midpoint map above is made of two layers:",
        listings: &[Listing { arguments: "passes midpoint", paragraph: "" }],
        ..Row::BARE
    },
];
