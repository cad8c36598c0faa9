//! I: the same on mainstream hardware.

use super::{measure, picture, traced};
use crate::gallery::{Listing, Row};

pub const ROWS: &[Row] = &[
    Row {
        id: "I1",
        title: "Distance in a float colour target",
        text: "For hardware that cannot sample a depth texture: distance from the light in one 32-bit float, \
               compared by the shader.",
        pictures: &[
            picture("i1-r32f", "`storage=r32f`", "--set storage=r32f"),
            picture("i1-channels", "`--view channels`: near is black, far is red", "--set storage=r32f --view \
                     channels"),
        ],
        measures: &[
            measure("`storage=depth32f`", "--techniques linear --set storage=depth32f"),
            measure("`storage=r32f`", "--techniques linear --set storage=r32f"),
        ],
        ..Row::BARE
    },
    Row {
        id: "I2",
        title: "Distance packed into 8-bit channels",
        text: "For hardware without float textures either: distance in one, two or three bytes. The first byte \
               counts 256 steps from near to far, each further one divides a step of the one before into 255 or \
               256 more, so its channel runs through all its values again and again. With `bias=slope`, which does \
               not know that a step of one byte is this coarse (`bias=auto` does), 8 bits show bands of acne; two \
               bytes are enough here.",
        pictures: &[
            picture("i2-channels-1", "`storage=packed1 --view channels`: red", "--set storage=packed1 --view \
                     channels"),
            picture("i2-channels-2", "`storage=packed2 --view channels`: red and green", "--set storage=packed2 \
                     --view channels"),
            picture("i2-channels-3", "`storage=packed3 --view channels`: red, green and blue", "--set \
                     storage=packed3 --view channels"),
            picture("i2-packed1", "`packed1`: bands of 8 bits", "builtin:contact --set bias=slope --set \
                     storage=packed1"),
            picture("i2-packed2", "`packed2`: none", "builtin:contact --set bias=slope --set storage=packed2"),
            picture("i2-packed3", "`packed3`: none", "builtin:contact --set bias=slope --set storage=packed3"),
        ],
        measures: &[
            measure("`packed1`, `slope`", "builtin:contact --techniques linear --set storage=packed1 --set \
                     bias=slope"),
            measure("`packed2`, `slope`", "builtin:contact --techniques linear --set storage=packed2 --set \
                     bias=slope"),
            measure("`packed3`, `slope`", "builtin:contact --techniques linear --set storage=packed3 --set \
                     bias=slope"),
            measure("`packed1`, `auto`", "builtin:contact --techniques linear --set storage=packed1 --set bias=auto"),
            measure("`packed2`, `auto`", "builtin:contact --techniques linear --set storage=packed2 --set bias=auto"),
            measure("`packed3`, `auto`", "builtin:contact --techniques linear --set storage=packed3 --set bias=auto"),
        ],
        ..Row::BARE
    },
    Row {
        id: "I3",
        title: "The format that the adapter has",
        text: "The adapter is asked first; `umbrage doctor` says what was chosen and why:",
        listings: &[
            Listing { arguments: "doctor", paragraph: "Formats of shadow maps" },
        ],
        ..Row::BARE
    },
    Row {
        id: "I4",
        title: "Maps on a thread of their own",
        text: "Maps can be drawn by a thread at its own interval, and no frame waits for them; each set is looked \
               up with the matrices that it was drawn with. Frame rates and ages of the shadows, with and without \
               load on the processor, are in [threaded.md](threaded.md).",
        ..Row::BARE
    },
    Row {
        id: "I6",
        title: "Near and far where the scene is",
        text: "A depth map divides near to far into steps, most of them close to near. Fitted to what is in the \
               light's view, 16 bits are enough; with 2 mm to 1 km the whole scene shares a handful of steps, and \
               whatever bias spans a step loses the shadows.",
        pictures: &[
            picture("i6-fitted", "near and far fitted, the default", "builtin:contact --camera \
                     position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --light \
                     position=-2.2:3.4:2.2,target=0:0.3:0,outer=35 --set storage=depth16 --set bias=slope"),
            picture("i6-wide", "`near=0.002,far=1000`: most shadows are gone", "builtin:contact --camera \
                     position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --light \
                     position=-2.2:3.4:2.2,target=0:0.3:0,outer=35,near=0.002,far=1000 --set storage=depth16 --set \
                     bias=slope"),
        ],
        measures: &[
            measure("fitted", "builtin:contact --light position=-2.2:3.4:2.2,target=0:0.3:0,outer=35 --techniques \
                     linear --set storage=depth16 --set bias=slope"),
            measure("2 mm to 1 km", "builtin:contact --light \
                     position=-2.2:3.4:2.2,target=0:0.3:0,outer=35,near=0.002,far=1000 --techniques linear --set \
                     storage=depth16 --set bias=slope"),
        ],
        ..Row::BARE
    },
    Row {
        id: "I7",
        title: "Smoothing by many samples",
        text: "All comparisons of a box of texels, blended: an edge as wide as the box, the same everywhere. The \
               map has 512x512 texels.",
        pictures: &[
            picture("i7-pcf-3", "`pcf`, `width=3`", "--technique pcf --set width=3 --set map_size=512"),
            picture("i7-pcf-9", "`pcf`, `width=9`", "--technique pcf --set width=9 --set map_size=512"),
            picture("i7-pcf-17", "`pcf`, `width=17`", "--technique pcf --set width=17 --set map_size=512"),
        ],
        measures: &[
            measure("`width=3`", "--techniques pcf --set width=3 --set map_size=512"),
            measure("`width=9`", "--techniques pcf --set width=9 --set map_size=512"),
            measure("`width=17`", "--techniques pcf --set width=17 --set map_size=512"),
        ],
        ..Row::BARE
    },
    Row {
        id: "I8, B4",
        title: "Maps that follow the eye",
        text: "An eye of a standing man along the colonnade, a sun from the side, 512x512 texels. `fitted` spends \
               as many texels on the far end as on the nearest column, and thin shadows break up; `adaptive` keeps \
               only what the eye sees; `perspective` and `lispsm` give more to what is near. All but `fitted` are \
               redrawn when the eye moves. Their texels per pixel are shown at H9. (Stamminger and Drettakis 2002; \
               Wimmer, Scherzer and Purgathofer 2004.)",
        pictures: &[
            picture("i8-fitted", "`fitted`", "builtin:columns --camera \
                     position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light kind=directional,direction=1:-1.1:-1 \
                     --set map_size=512 --set projection=fitted"),
            picture("i8-adaptive", "`adaptive`", "builtin:columns --camera \
                     position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light kind=directional,direction=1:-1.1:-1 \
                     --set map_size=512 --set projection=adaptive"),
            picture("i8-perspective", "`perspective`", "builtin:columns --camera \
                     position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light kind=directional,direction=1:-1.1:-1 \
                     --set map_size=512 --set projection=perspective"),
            picture("i8-lispsm", "`lispsm`", "builtin:columns --camera \
                     position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light kind=directional,direction=1:-1.1:-1 \
                     --set map_size=512 --set projection=lispsm"),
        ],
        measures: &[
            measure("`fitted`", "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light \
                     kind=directional,direction=1:-1.1:-1 --techniques linear --set map_size=512 --set \
                     projection=fitted"),
            measure("`adaptive`", "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light \
                     kind=directional,direction=1:-1.1:-1 --techniques linear --set map_size=512 --set \
                     projection=adaptive"),
            measure("`perspective`", "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 \
                     --light kind=directional,direction=1:-1.1:-1 --techniques linear --set map_size=512 --set \
                     projection=perspective"),
            measure("`lispsm`", "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light \
                     kind=directional,direction=1:-1.1:-1 --techniques linear --set map_size=512 --set \
                     projection=lispsm"),
        ],
        ..Row::BARE
    },
    Row {
        id: "I9, F6",
        title: "Lights with an area",
        text: "Maps from many places of the light, blended. One view is a hard shadow, four are four of them; with \
               more, umbra and penumbra close up to what rays find (next to last picture of each series), and the \
               error falls.",
        pictures: &[
            picture("i9-disc-1", "disc of 0.5 m: 1 view", "--light \
                     disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --technique multi-view \
                     --set views=1"),
            picture("i9-disc-4", "disc of 0.5 m: 4 views", "--light \
                     disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --technique multi-view \
                     --set views=4"),
            picture("i9-disc-16", "disc of 0.5 m: 16 views", "--light \
                     disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --technique multi-view \
                     --set views=16"),
            picture("i9-disc-64", "disc of 0.5 m: 64 views", "--light \
                     disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --technique multi-view \
                     --set views=64"),
            traced("i9-disc-truth", "disc of 0.5 m: the truth, 256 rays a pixel", "--light \
                    disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --samples 256 --view final"),
            picture("i9-disc-v64", "`--view visibility` of 64 views", "--light \
                     disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --technique multi-view \
                     --set views=64 --view visibility"),
            picture("i9-sun-1", "sun of 4 degrees: 1 view", "builtin:columns --light \
                     kind=directional,direction=1:-1.1:-1,angle=4 --technique multi-view --set views=1"),
            picture("i9-sun-4", "sun of 4 degrees: 4 views", "builtin:columns --light \
                     kind=directional,direction=1:-1.1:-1,angle=4 --technique multi-view --set views=4"),
            picture("i9-sun-16", "sun of 4 degrees: 16 views", "builtin:columns --light \
                     kind=directional,direction=1:-1.1:-1,angle=4 --technique multi-view --set views=16"),
            picture("i9-sun-64", "sun of 4 degrees: 64 views", "builtin:columns --light \
                     kind=directional,direction=1:-1.1:-1,angle=4 --technique multi-view --set views=64"),
            traced("i9-sun-truth", "sun of 4 degrees: the truth, 256 rays a pixel", "builtin:columns --light \
                    kind=directional,direction=1:-1.1:-1,angle=4 --samples 256 --view final"),
            picture("i9-sun-v64", "`--view visibility` of 64 views", "builtin:columns --light \
                     kind=directional,direction=1:-1.1:-1,angle=4 --technique multi-view --set views=64 --view \
                     visibility"),
        ],
        measures: &[
            measure("disc, 1 view", "--light disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 \
                     --samples 256 --techniques multi-view --set views=1 --set map_size=1024"),
            measure("disc, 4 views", "--light disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 \
                     --samples 256 --techniques multi-view --set views=4 --set map_size=1024"),
            measure("disc, 16 views", "--light \
                     disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --samples 256 \
                     --techniques multi-view --set views=16 --set map_size=1024"),
            measure("disc, 64 views", "--light \
                     disc=0.5,position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --samples 256 \
                     --techniques multi-view --set views=64 --set map_size=1024"),
            measure("sun, 1 view", "builtin:columns --light kind=directional,direction=1:-1.1:-1,angle=4 --samples \
                     256 --techniques multi-view --set views=1"),
            measure("sun, 4 views", "builtin:columns --light kind=directional,direction=1:-1.1:-1,angle=4 \
                     --samples 256 --techniques multi-view --set views=4"),
            measure("sun, 16 views", "builtin:columns --light kind=directional,direction=1:-1.1:-1,angle=4 \
                     --samples 256 --techniques multi-view --set views=16"),
            measure("sun, 64 views", "builtin:columns --light kind=directional,direction=1:-1.1:-1,angle=4 \
                     --samples 256 --techniques multi-view --set views=64"),
        ],
        ..Row::BARE
    },
    Row {
        id: "I10",
        title: "Ambient, diffuse and highlight as of old",
        text: "All surfaces by the plain sum of the documents: ambient, Lambert and Blinn, each times the \
               material's colour and clamped.",
        pictures: &[
            picture("i10-documents", "`--shading documents`", "--shading documents"),
            picture("i10-material", "`--shading material`, the default", "--shading material"),
        ],
        ..Row::BARE
    },
    Row {
        id: "I11",
        title: "Memory by light, not by scene",
        text: "Every light of the same kind costs the same, whatever the scene: three spot lights take three maps, \
               in a scene of 26,564 triangles and in one of 519,168. Bytes, as the commands print them:",
        pictures: &[
            picture("i11-torus", "three spot lights", "--light \
                     position=-3.4:5.2:4.4,target=0.2:0.9:-0.4,inner=19,outer=34 --light \
                     position=3.4:5.2:4.4,target=0.2:0.9:-0.4,color=1:0.6:0.4,outer=34 --light \
                     position=0:6:3,target=0.2:0.9:-0.4,color=0.5:0.7:1,outer=34 \
                     --json").quoting(&["shadow_memory_per_light_bytes", "shadow_memory_bytes"]),
            picture("i11-knots", "three spot lights in a scene twenty times as large", "builtin:knots --camera \
                     position=2:3:6,fov=40 --light position=-5:8:6 --light position=5:8:6,color=1:0.6:0.4 --light \
                     position=0:9:3,color=0.5:0.7:1 \
                     --json").quoting(&["shadow_memory_per_light_bytes", "shadow_memory_bytes"]),
        ],
        ..Row::BARE
    },
];
