//! F: shadow volumes.

use super::{measure, picture};
use crate::gallery::{Listing, Row};

pub const ROWS: &[Row] = &[
    Row {
        id: "F7",
        title: "Shadow volumes",
        text: "What is dark behind each caster, as polygons that the stencil counts: exact to the pixel, without a map \
               or a bias, under lights of every kind. An eye that is itself in a shadow is what counting before the \
               surface (`depth-pass`) cannot know; `auto` counts such casters behind it. The price is the pixels that \
               volumes cover, which `--view volumes` shows.",
        pictures: &[
            picture("f7-spot", "a spot light", "--technique volume"),
            picture(
                "f7-point",
                "a point light among the columns",
                "builtin:columns --technique volume --light kind=point,position=0:1.6:1.5 --exposure 0.15",
            ),
            picture(
                "f7-sun",
                "a directional light",
                "builtin:columns --technique volume --light kind=directional,direction=1:-1.1:-1",
            ),
            picture(
                "f7-eye-auto",
                "the eye in the shadow of a box, `counting=auto`",
                "builtin:contact --technique volume --light kind=directional,direction=0.2:-0.5:1 --camera \
                 position=-0.35:0.3:0.75,target=0.6:0.25:0.3,fov=60",
            ),
            picture(
                "f7-eye-pass",
                "the same, `counting=depth-pass`: wrong, because counting starts in a shadow",
                "builtin:contact --technique volume --set counting=depth-pass --light \
                 kind=directional,direction=0.2:-0.5:1 --camera \
                 position=-0.35:0.3:0.75,target=0.6:0.25:0.3,fov=60",
            ),
            picture(
                "f7-volumes",
                "`--view volumes`: faces that each pixel pays for",
                "builtin:columns --technique volume --view volumes --json",
            )
            .quoting(&["overdraw.mean", "overdraw.most", "overdraw.deepest_count"]),
        ],
        measures: &[
            measure("torus, `volume`", "--techniques volume"),
            measure("torus, `linear`", "--techniques linear"),
            measure("columns, `volume`", "builtin:columns --techniques volume"),
            measure("columns, `linear`", "builtin:columns --techniques linear"),
            measure("contact, `volume`", "builtin:contact --techniques volume"),
            measure("contact, `linear`", "builtin:contact --techniques linear"),
        ],
        ..Row::BARE
    },
    Row {
        id: "F8",
        title: "Split edges",
        text: "A copy of an OBJ file from which a vertex shader alone pulls volumes: each face has vertices of its own, \
               and ghosts without area join neighbours. Its shadow is that of the file it came from; as each face now \
               has its own normal, its shading is faceted. Spot by Keenan Crane (public domain).",
        pictures: &[
            picture(
                "f8-before",
                "the file, outlines found in compute",
                "../shared/scenes/classic-obj/spot/spot_triangulated.obj --ground --technique volume --exposure 0.5 \
                 --camera position=-2.3:1.9:-2.4,target=-0.2:-0.1:0,fov=36",
            ),
            picture(
                "f8-split",
                "its copy, `silhouette=vertex`",
                "target/gallery/spot-split.obj --ground --technique volume --set silhouette=vertex --exposure 0.5 \
                 --camera position=-2.3:1.9:-2.4,target=-0.2:-0.1:0,fov=36",
            ),
        ],
        listings: &[Listing {
            arguments: "split-edges ../shared/scenes/classic-obj/spot/spot_triangulated.obj -o \
                        target/gallery/spot-split.obj",
            paragraph: "",
        }],
        ..Row::BARE
    },
    Row {
        id: "F9",
        title: "One pass or two",
        text: "Front faces count one way and back faces the other: in one draw, or in the classic two.",
        pictures: &[
            picture(
                "f9-two-sided",
                "`stencil=two-sided`",
                "builtin:contact --technique volume --set stencil=two-sided",
            ),
            picture(
                "f9-two-pass",
                "`stencil=two-pass`",
                "builtin:contact --technique volume --set stencil=two-pass",
            ),
        ],
        listings: &[Listing { arguments: "passes volume --set stencil=two-pass", paragraph: "" }],
        pairs: &[["f9-two-sided", "f9-two-pass"]],
        ..Row::BARE
    },
    Row {
        id: "F10",
        title: "Soft volumes",
        text: "The mask is blurred on the screen, by a width in pixels or in metres, and only across depths that are \
               alike, so that no shadow runs over an edge of what it lies on. In pixels all shadows are as soft, in \
               metres the near ones look softer. No width follows the light: these are not penumbrae.",
        pictures: &[
            picture(
                "f10-hard",
                "`volume`",
                "builtin:columns --technique volume --light kind=directional,direction=1:-0.8:0.35 --camera \
                 position=4.2:1.5:6.4,target=1.4:0.4:1,fov=32",
            ),
            picture(
                "f10-px",
                "`volume-soft`, `soft_px=8`",
                "builtin:columns --technique volume-soft --set soft_px=8 --light \
                 kind=directional,direction=1:-0.8:0.35 --camera position=4.2:1.5:6.4,target=1.4:0.4:1,fov=32",
            ),
            picture(
                "f10-m",
                "`volume-soft`, `soft_m=0.1`",
                "builtin:columns --technique volume-soft --set soft_m=0.1 --light \
                 kind=directional,direction=1:-0.8:0.35 --camera position=4.2:1.5:6.4,target=1.4:0.4:1,fov=32",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "F11",
        title: "What a volume cannot be made of",
        text: "Cut-outs have their outline in a texture, and a function that moves vertices leaves none that is known \
               before: shadows of these casters come from a map, beside the volumes of all others, and a warning says \
               so. Stained glass lamp by Eric Chadwick for Wayfair LLC (CC BY 4.0).",
        pictures: &[
            picture(
                "f11-lamp",
                "grille, glass and beads by a map, the rest by volumes",
                "../shared/scenes/stained-glass-lamp/StainedGlassLamp.gltf --ground --technique volume --camera \
                 position=1.1:0.7:1.1,target=0.2:0.3:0,fov=36 --json",
            )
            .quoting(&["warnings"]),
            picture(
                "f11-sway",
                "`--deform`: all by a map",
                "builtin:columns --technique volume --deform examples/wgsl/sway.wgsl --deform-reach 0.6 --json",
            )
            .quoting(&["warnings"]),
        ],
        ..Row::BARE
    },
];
