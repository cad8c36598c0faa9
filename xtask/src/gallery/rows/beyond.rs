//! B: beyond the documents; scenes and files.

use super::{measure, picture, traced};
use crate::gallery::Row;

pub const ROWS: &[Row] = &[
    Row {
        id: "B5",
        title: "Bias that nobody has to set",
        text: "All ways of bias on a small map of 256x256 texels, where each texel is large and errors with it. \
               `auto`, the default, has no number to set; four of the smallest steps (`constant`) are nothing in a \
               map of 32-bit floats. More scenes, and what engines set, in [bias.md](bias.md).",
        pictures: &[
            picture("b5-contact-none", "`bias=none`", "builtin:contact --set map_size=256 --set bias=none"),
            picture(
                "b5-contact-constant",
                "`bias=constant`",
                "builtin:contact --set map_size=256 --set bias=constant",
            ),
            picture(
                "b5-contact-slope",
                "`bias=slope`",
                "builtin:contact --set map_size=256 --set bias=slope",
            ),
            picture(
                "b5-contact-normal",
                "`bias=normal`",
                "builtin:contact --set map_size=256 --set bias=normal",
            ),
            picture(
                "b5-contact-receiver-plane",
                "`bias=receiver-plane`",
                "builtin:contact --set map_size=256 --set bias=receiver-plane",
            ),
            picture("b5-contact-auto", "`bias=auto`", "builtin:contact --set map_size=256 --set bias=auto"),
            picture("b5-torus-none", "`bias=none`", "builtin:torus --set map_size=256 --set bias=none"),
            picture(
                "b5-torus-constant",
                "`bias=constant`",
                "builtin:torus --set map_size=256 --set bias=constant",
            ),
            picture("b5-torus-slope", "`bias=slope`", "builtin:torus --set map_size=256 --set bias=slope"),
            picture("b5-torus-normal", "`bias=normal`", "builtin:torus --set map_size=256 --set bias=normal"),
            picture(
                "b5-torus-receiver-plane",
                "`bias=receiver-plane`",
                "builtin:torus --set map_size=256 --set bias=receiver-plane",
            ),
            picture("b5-torus-auto", "`bias=auto`", "builtin:torus --set map_size=256 --set bias=auto"),
        ],
        measures: &[
            measure(
                "contact, `none`",
                "builtin:contact --techniques linear --set map_size=256 --set bias=none",
            ),
            measure(
                "contact, `constant`",
                "builtin:contact --techniques linear --set map_size=256 --set bias=constant",
            ),
            measure(
                "contact, `slope`",
                "builtin:contact --techniques linear --set map_size=256 --set bias=slope",
            ),
            measure(
                "contact, `normal`",
                "builtin:contact --techniques linear --set map_size=256 --set bias=normal",
            ),
            measure(
                "contact, `receiver-plane`",
                "builtin:contact --techniques linear --set map_size=256 --set bias=receiver-plane",
            ),
            measure(
                "contact, `auto`",
                "builtin:contact --techniques linear --set map_size=256 --set bias=auto",
            ),
            measure("torus, `none`", "builtin:torus --techniques linear --set map_size=256 --set bias=none"),
            measure(
                "torus, `constant`",
                "builtin:torus --techniques linear --set map_size=256 --set bias=constant",
            ),
            measure(
                "torus, `slope`",
                "builtin:torus --techniques linear --set map_size=256 --set bias=slope",
            ),
            measure(
                "torus, `normal`",
                "builtin:torus --techniques linear --set map_size=256 --set bias=normal",
            ),
            measure(
                "torus, `receiver-plane`",
                "builtin:torus --techniques linear --set map_size=256 --set bias=receiver-plane",
            ),
            measure("torus, `auto`", "builtin:torus --techniques linear --set map_size=256 --set bias=auto"),
        ],
        ..Row::BARE
    },
    Row {
        id: "B6",
        title: "The truth, by rays",
        text: "How much of the light each surface sees, traced on the processor: what every technique is measured \
               against. A \
               light that is a point takes one exact ray a pixel; one with a shape takes many, and has umbra and \
               penumbra. \
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
                "--light rect=2:0.2,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --samples 256 \
                 --view final",
            ),
            traced(
                "b6-sun",
                "a sun of 4 degrees: sharp where a caster is near, soft where it is far",
                "builtin:columns --light kind=directional,direction=1:-1.1:-1,angle=4 --samples 256 --view final",
            ),
        ],
        ..Row::BARE
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
        ..Row::BARE
    },
    Row {
        id: "Files",
        title: "glTF",
        text: "A model from a file, on a ground, under a light that suits it. Flight helmet by Microsoft, \
               converted by \
               Gary Hsu, CC0 1.0.",
        pictures: &[picture(
            "gltf-helmet",
            "straps and goggles shadow the helmet itself",
            "../shared/scenes/flight-helmet/FlightHelmet.gltf --ground",
        )],
        ..Row::BARE
    },
];
