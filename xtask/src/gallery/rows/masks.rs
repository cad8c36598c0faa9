//! N: projective masks.

use super::{measure, picture};
use crate::gallery::{Listing, Row};

pub const ROWS: &[Row] = &[
    Row {
        id: "N1",
        title: "Blockers and receivers",
        text: "A mask for each light and blocker, laid over every receiver beyond it. Which object is what can be said in \
               the file or on the command line, for every technique.",
        pictures: &[
            picture("n1-all", "every object is both", "--technique mask"),
            picture("n1-no-blocker", "`--no-blocker torus`", "--technique mask --no-blocker torus"),
            picture("n1-no-receiver", "`--no-receiver floor`", "--technique mask --no-receiver floor"),
        ],
        ..Row::BARE
    },
    Row {
        id: "N2",
        title: "Where a mask looks",
        text: "Along the mean direction to the blocker's vertices, or to the middle of its box. What is adaptive follows the blocker anyway; what reaches as far to both sides (`ratios=symmetric`) loses a few \
               texels by it. In masks of 32x32 both aims are equally near to the truth.",
        pictures: &[
            picture(
                "n2-mean",
                "`aim=mean`",
                "--technique mask --set aim=mean --set ratios=symmetric --set mask_size=32 --view visibility",
            ),
            picture(
                "n2-box",
                "`aim=box`",
                "--technique mask --set aim=box --set ratios=symmetric --set mask_size=32 --view visibility",
            ),
        ],
        measures: &[
            measure("`mean`, `symmetric`", "--techniques mask --set ratios=symmetric --set mask_size=32"),
            measure(
                "`box`, `symmetric`",
                "--techniques mask --set aim=box --set ratios=symmetric --set mask_size=32",
            ),
            measure("`mean`, `adaptive`", "--techniques mask --set mask_size=32"),
            measure("`box`, `adaptive`", "--techniques mask --set aim=box --set mask_size=32"),
        ],
        ..Row::BARE
    },
    Row {
        id: "N3",
        title: "How wide a mask looks",
        text: "Masks of 64x64 texels: as wide as the blocker, along each axis from its first to its last point; as far to \
               both sides; always as wide as the light. The border that stays empty follows from the resolution.",
        pictures: &[
            picture(
                "n3-adaptive",
                "`ratios=adaptive`",
                "--technique mask --set mask_size=64 --view visibility",
            ),
            picture(
                "n3-symmetric",
                "`ratios=symmetric`",
                "--technique mask --set mask_size=64 --set ratios=symmetric --view visibility",
            ),
            picture(
                "n3-fixed",
                "`ratios=fixed`",
                "--technique mask --set mask_size=64 --set ratios=fixed --view visibility",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "N4",
        title: "Three geometries",
        text: "A mask is fitted to the blocker's hull or box, drawn from an outline with fewer triangles that stays within \
               half a texel, and what is seen is the model itself. Triangles of each pass:",
        pictures: &[
            picture(
                "n4-reduced",
                "`fit_to=hull`, `outline=reduced`, the defaults",
                "--technique mask --view visibility --json",
            )
            .quoting(&["passes"]),
            picture(
                "n4-full",
                "`fit_to=box`, `outline=full`",
                "--technique mask --set fit_to=box --set outline=full --view visibility --json",
            )
            .quoting(&["passes"]),
        ],
        pairs: &[["n4-reduced", "n4-full"]],
        ..Row::BARE
    },
    Row {
        id: "N5, N6",
        title: "A flat mask with an empty border",
        text: "One colour, without depth, light or clipping; what lies outside of a mask reads its border, which is empty. \
               Masks of 16x16 texels: coarse, and still no streak runs off their edges.",
        pictures: &[
            picture("n6-linear", "`lookup=linear`", "--technique mask --set mask_size=16 --view visibility"),
            picture(
                "n6-nearest",
                "`lookup=nearest`",
                "--technique mask --set mask_size=16 --set lookup=nearest --view visibility",
            ),
        ],
        listings: &[Listing { arguments: "passes mask", paragraph: "mask (" }],
        ..Row::BARE
    },
    Row {
        id: "N7",
        title: "Receivers in one pass, or darkened one mask at a time",
        text: "All masks are looked up while a receiver is lit; or receivers are drawn once more for each mask, as the \
               hardware of the paper had to.",
        pictures: &[
            picture("n7-single", "`mask`", "builtin:columns --technique mask"),
            picture("n7-subtractive", "`mask-subtractive`", "builtin:columns --technique mask-subtractive"),
        ],
        listings: &[Listing { arguments: "passes mask-subtractive", paragraph: "" }],
        pairs: &[["n7-single", "n7-subtractive"]],
        ..Row::BARE
    },
    Row {
        id: "N8",
        title: "Nothing on faces turned away",
        text: "Seen from behind: the torus' shadow goes through ball and pedestal, and their far sides, which no light \
               reaches, show no outline of it.",
        pictures: &[
            picture(
                "n8-final",
                "the picture",
                "--technique mask --light position=-4.5:4.2:2.2,target=0.6:0.6:0,inner=28,outer=36 --camera \
                 position=4.6:1.9:2.8,target=1.1:0.85:0.4,fov=34",
            ),
            picture(
                "n8-visibility",
                "`--view visibility`",
                "--technique mask --light position=-4.5:4.2:2.2,target=0.6:0.6:0,inner=28,outer=36 --camera \
                 position=4.6:1.9:2.8,target=1.1:0.85:0.4,fov=34 --view visibility",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "N9",
        title: "Nothing behind the light, nothing before the blocker",
        text: "A mask's projection has a mirror image behind the light, and covers what stands before its blocker, too. \
               Neither is darkened: shadows run from the lamp outwards only, and the ball, which stands between light \
               and torus, stays lit.",
        pictures: &[
            picture(
                "n9-behind",
                "a lamp between poles and columns",
                "builtin:columns --technique mask --light kind=point,position=0:1.6:1.5 --exposure 0.15",
            ),
            picture(
                "n9-between",
                "the ball before the torus, seen by the light",
                "--technique mask --light position=5.5:3.2:2.6,target=0.3:1.1:0,outer=30",
            ),
        ],
        ..Row::BARE
    },
    Row {
        id: "N10",
        title: "Two lights",
        text: "Each light has masks of its own, and takes only its own light away.",
        pictures: &[picture(
            "n10-two",
            "where the warm light is blocked the cool one shines on",
            "--technique mask --light kind=point,position=-3.4:4.4:3.4,color=1:0.55:0.25 --light \
             kind=point,position=4.4:3.6:3.4,color=0.25:0.55:1",
        )],
        ..Row::BARE
    },
    Row {
        id: "N11",
        title: "Blockers of one light darken once",
        text: "The shadows of torus, ball and pedestal lie over one another on the floor, and are no darker there: V is 0 \
               once.",
        pictures: &[
            picture(
                "n11-final",
                "`mask-subtractive`",
                "--technique mask-subtractive --light position=-4.5:4.2:2.2,target=0.6:0.6:0,inner=28,outer=36",
            ),
            picture(
                "n11-single",
                "`mask`",
                "--technique mask --light position=-4.5:4.2:2.2,target=0.6:0.6:0,inner=28,outer=36",
            ),
        ],
        pairs: &[["n11-final", "n11-single"]],
        ..Row::BARE
    },
    Row {
        id: "N12",
        title: "Adaptive against fixed",
        text: "Masks of 256x256 texels for 21 blockers, of which the thin poles lose most when each mask is as wide as the \
               light. A blocker has no shadow on itself: leak and gap of the torus' scene are the pedestal's, whose top \
               should darken its foot; the coarse texels of `fixed` have an edge band that reaches there.",
        pictures: &[
            picture(
                "n12-adaptive",
                "`ratios=adaptive`",
                "builtin:columns --technique mask --set mask_size=256 --view visibility",
            ),
            picture(
                "n12-fixed",
                "`ratios=fixed`",
                "builtin:columns --technique mask --set mask_size=256 --set ratios=fixed --view visibility",
            ),
        ],
        measures: &[
            measure("columns, `adaptive`", "builtin:columns --techniques mask --set mask_size=256"),
            measure(
                "columns, `symmetric`",
                "builtin:columns --techniques mask --set mask_size=256 --set ratios=symmetric",
            ),
            measure(
                "columns, `fixed`",
                "builtin:columns --techniques mask --set mask_size=256 --set ratios=fixed",
            ),
            measure("torus, `adaptive`", "--techniques mask --set mask_size=256"),
            measure("torus, `fixed`", "--techniques mask --set mask_size=256 --set ratios=fixed"),
        ],
        ..Row::BARE
    },
];
