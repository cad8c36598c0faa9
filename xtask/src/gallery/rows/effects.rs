//! F: effects.

use super::{measure, picture};
use crate::gallery::{Listing, Row};

pub const ROWS: &[Row] = &[
    Row {
        id: "F1",
        title: "Techniques are lists of passes",
        text: "Each technique is a named list of passes, printed by `umbrage passes NAME`; any can be chosen at \
               run time (`--technique`), and each of its choices and parameters set (`--set`). `umbrage \
               techniques` lists them with units, ranges and defaults.",
        listings: &[Listing { arguments: "passes pcf", paragraph: "" }],
        ..Row::BARE
    },
    Row {
        id: "F2",
        title: "The shader side as a library",
        text: "WGSL modules that bind nothing, for any renderer: `umbrage wgsl NAME` prints one with all that it \
               needs.",
        listings: &[Listing { arguments: "wgsl", paragraph: "" }],
        ..Row::BARE
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
        ..Row::BARE
    },
    Row {
        id: "F4",
        title: "Coloured light through glass",
        text: "A map of colours beside that of depths: what is translucent dims and tints the light, at a cost of \
               one more pass; without it, glass blocks all light or none. Glass vase by Eric Chadwick with flowers \
               by Rico Cilliers (CC0 1.0), under a point light: its vase of mixed alpha is glass, while the one by \
               the extension for transmission is drawn opaque; alpha blend mode test by Analytical Graphics, Inc. \
               and Ed Mackey (CC BY 4.0): its second panel fades from clear to opaque, and so does its shadow.",
        pictures: &[
            picture(
                "f4-vase-cut",
                "`linear`: the glass vase casts no shadow",
                "../shared/scenes/glass-vase-flowers/GlassVaseFlowers.glb --ground --light \
                 kind=point,position=-0.5:0.75:0.3 --camera position=0.12:0.55:0.62,target=0.04:0.12:-0.03,fov=24 \
                 --technique linear",
            ),
            picture(
                "f4-vase-colored",
                "`colored`: it dims the light a little",
                "../shared/scenes/glass-vase-flowers/GlassVaseFlowers.glb --ground --light \
                 kind=point,position=-0.5:0.75:0.3 --camera position=0.12:0.55:0.62,target=0.04:0.12:-0.03,fov=24 \
                 --technique colored",
            ),
            picture(
                "f4-panel-cut",
                "`linear`: a shadow from where alpha is a half",
                "../shared/scenes/alpha-blend-mode-test/AlphaBlendModeTest.glb --light \
                 position=-2.4:1.9:6,target=-1.2:1.1:0,outer=30 --camera \
                 position=-1.3:1.5:4.2,target=-1.45:1.1:0,fov=30 --technique linear --view visibility",
            ),
            picture(
                "f4-panel-colored",
                "`colored`: stripes and fading in V",
                "../shared/scenes/alpha-blend-mode-test/AlphaBlendModeTest.glb --light \
                 position=-2.4:1.9:6,target=-1.2:1.1:0,outer=30 --camera \
                 position=-1.3:1.5:4.2,target=-1.45:1.1:0,fov=30 --technique colored --view visibility",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "F5",
        title: "A kernel of your own",
        text: "A float map, and comparisons blended by the weights of a kernel: a bell, or a function of your own \
               in WGSL. `cross.wgsl` has two streaks across each other.",
        pictures: &[
            picture(
                "f5-bell",
                "the bell, `width=17`, 512x512 texels",
                "--technique kernel --set width=17 --set map_size=512 --view visibility",
            ),
            picture(
                "f5-cross",
                "`examples/wgsl/cross.wgsl`, the same",
                "--technique kernel --set width=17 --set map_size=512 --kernel examples/wgsl/cross.wgsl --view \
                 visibility",
            ),
        ],
        measures: &[
            measure("bell", "--techniques kernel --set width=17 --set map_size=512"),
            measure(
                "`cross.wgsl`",
                "--techniques kernel --set width=17 --set map_size=512 --kernel examples/wgsl/cross.wgsl",
            ),
        ],
        ..Row::BARE
    },
];
