//! What the pages of `docs/guide/` show.

use super::FOLDER;

/// One picture and the command that draws it.
pub struct Picture {
    /// Its name, without folder and ending.
    pub file: &'static str,
    /// What to look at.
    pub caption: &'static str,
    /// What stands between `render` and `--size`.
    arguments: &'static str,
}

impl Picture {
    /// From the top of the checkout.
    pub fn path(&self) -> String {
        format!("{FOLDER}/pictures/{}.png", self.file)
    }

    /// As words; no argument of ours holds a space.
    pub fn words(&self) -> Vec<String> {
        let tail = ["--size", "640x360", "--msaa", "4", "-o"].map(str::to_owned);
        let words = self.arguments.split_whitespace().map(str::to_owned);
        std::iter::once("render".to_owned()).chain(words).chain(tail).chain([self.path()]).collect()
    }
}

const fn picture(file: &'static str, caption: &'static str, arguments: &'static str) -> Picture {
    Picture { file, caption, arguments }
}

/// Every picture, in the order of the pages.
pub const PICTURES: &[Picture] = &[
    picture(
        "unshadowed",
        "The same light without a shadow: nothing says what stands on the ground and what floats",
        "builtin:contact --technique unshadowed",
    ),
    picture(
        "hard",
        "`hard`, a map of 2048x2048 texels: every edge is sharp, and in the middle distance no stair is wider than a pixel or two",
        "builtin:columns --technique hard",
    ),
    picture(
        "hard-stairs",
        "`hard`, 256x256 texels: each stair is a texel",
        "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --technique hard --set map_size=256",
    ),
    picture(
        "linear",
        "`linear` as it is set when nothing is said: shadows begin where things touch",
        "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --technique linear",
    ),
    picture(
        "linear-coarse",
        "`linear`, 256x256 texels: ramps instead of stairs, but poles that are thinner than a texel have broken shadows",
        "builtin:columns --technique linear --set map_size=256",
    ),
    picture(
        "pcf",
        "`pcf`, 9 texels wide in a map of 1024x1024: soft away from the casters, narrow where they stand",
        "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --technique pcf --set width=9 \
         --set map_size=1024",
    ),
    picture(
        "pcf-thin",
        "`pcf`, 17 texels wide in a map of 512x512: the poles are thinner than the box, and have next to no shadow",
        "builtin:columns --technique pcf --set width=17 --set map_size=512",
    ),
    picture(
        "kernel",
        "`kernel`, the bell, 9 texels wide in a map of 512x512: no flat middle and no corner in the ramp",
        "builtin:torus --technique kernel --set width=9 --set map_size=512",
    ),
    picture(
        "kernel-own",
        "`examples/wgsl/cross.wgsl`, 9 texels wide in a map of 256x256: streaks along the map's rows and columns",
        "builtin:torus --technique kernel --kernel examples/wgsl/cross.wgsl --set width=9 --set map_size=256",
    ),
    picture(
        "packed",
        "The three channels of the map: red counts 256 steps from near to far, green and blue divide each of them",
        "builtin:contact --technique packed --view channels",
    ),
    picture(
        "packed-bands",
        "V of one channel alone (`storage=packed1`) with a bias that does not know how coarse its steps are (`bias=slope`): \
         bands of acne on every slope",
        "builtin:contact --technique packed --set storage=packed1 --set bias=slope --view visibility",
    ),
    picture(
        "perspective",
        "`perspective`, 512x512 texels for the whole colonnade, seen by somebody who stands in it",
        "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light \
         kind=directional,direction=1:-1.1:-1 --technique perspective --set map_size=512",
    ),
    picture(
        "perspective-gap",
        "V of `perspective`, 512x512 texels: white lines within shadows, where stretched texels let light through at contacts",
        "builtin:contact --technique perspective --set map_size=512 --view visibility",
    ),
    picture(
        "lispsm",
        "`lispsm`, 512x512 texels: the shadow of the nearest pole is whole",
        "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light \
         kind=directional,direction=1:-1.1:-1 --technique lispsm --set map_size=512",
    ),
    picture(
        "lispsm-fitted",
        "`linear` with the same light, eye and number of texels: the near shadows break up",
        "builtin:columns --camera position=-7.5:1.7:1.4,target=5:1.7:1.4,fov=52 --light \
         kind=directional,direction=1:-1.1:-1 --technique linear --set map_size=512",
    ),
    picture(
        "multi-view",
        "`multi-view`, 64 places of a disc of 0.5 m: shadows begin sharp where things touch and soften with the distance",
        "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --technique multi-view --set views=64 --set \
         map_size=1024 --light position=-3:4:2.5,target=0:0.3:0,disc=0.5,inner=30,outer=40",
    ),
    picture(
        "multi-view-few",
        "4 places: four hard shadows, one over the other",
        "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --technique multi-view --set views=4 --set \
         map_size=1024 --light position=-3:4:2.5,target=0:0.3:0,disc=0.5,inner=30,outer=40",
    ),
    picture(
        "colored",
        "`colored`: three panes between poles; shadows of the poles are dark, glass dims and tints",
        "docs/guide/scenes/panes.obj --camera position=2.6:2.3:5.2,target=0:0.6:0.6,fov=42 --light \
         position=-1.5:5:-4,target=0:0.6:0.4,outer=45 --technique colored",
    ),
    picture(
        "colored-cut",
        "`linear` on the same panes: those of alpha 0.6 block all light, that of 0.4 blocks none",
        "docs/guide/scenes/panes.obj --camera position=2.6:2.3:5.2,target=0:0.6:0.6,fov=42 --light \
         position=-1.5:5:-4,target=0:0.6:0.4,outer=45 --technique linear",
    ),
    picture(
        "matrix-bias",
        "`matrix-bias` of 0.005 of the depth range, which is the default: enough for this scene",
        "builtin:torus --technique matrix-bias",
    ),
    picture(
        "matrix-bias-leak",
        "`matrix-bias` of 0.1, as steep receivers need it: the small ball and the box on top have lost their shadows",
        "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --technique matrix-bias --set \
         matrix_bias=0.1 --set map_size=512",
    ),
    picture(
        "midpoint",
        "`midpoint`, 512x512 texels: no bias is set, and no lit surface shadows itself",
        "builtin:torus --technique midpoint --set map_size=512",
    ),
    picture(
        "midpoint-thin",
        "V of `midpoint`, 256x256 texels: thin panels have their backs too close behind them, and speckles",
        "builtin:contact --technique midpoint --set map_size=256 --view visibility",
    ),
    picture(
        "second-depth",
        "`second-depth`, 512x512 texels, on closed solids",
        "builtin:torus --technique second-depth --set map_size=512",
    ),
    picture(
        "second-depth-open",
        "V of `second-depth` on planes without an inside, which nothing shadows: every dark spot is wrong",
        "builtin:tilt --technique second-depth --set map_size=512 --view visibility",
    ),
    picture(
        "volume",
        "`volume`: each pole has its whole shadow, however thin and however far",
        "builtin:columns --technique volume",
    ),
    picture(
        "volume-pays",
        "`--view volumes`: how many faces of volumes each pixel pays for, also where nothing is dark",
        "builtin:columns --technique volume --view volumes",
    ),
    picture(
        "volume-soft",
        "`volume-soft`, 8 pixels wide",
        "builtin:torus --technique volume-soft --set soft_px=8",
    ),
    picture(
        "volume-soft-contact",
        "`volume-soft`, 20 pixels wide: edges are as soft where the small ball touches the ground as far from it",
        "builtin:contact --camera position=1.6:1.5:2.4,target=-0.2:0.25:0,fov=42 --technique volume-soft --set soft_px=20",
    ),
    picture(
        "mask",
        "`mask`: each of 21 blockers fills a mask of 512x512 texels, the thin poles too",
        "builtin:columns --technique mask",
    ),
    picture(
        "mask-self",
        "`mask`: the pedestal's top throws no shadow on the shaft beneath it",
        "builtin:torus --camera position=2.6:1:2.2,target=0.7:0.45:0,fov=36 --technique mask",
    ),
    picture(
        "mask-self-truth",
        "`volume`, which is exact: the shadow that `mask` lacks",
        "builtin:torus --camera position=2.6:1:2.2,target=0.7:0.45:0,fov=36 --technique volume",
    ),
    picture(
        "mask-subtractive",
        "`mask-subtractive`: where shadows of two blockers lie over one another, nothing is darkened twice",
        "builtin:contact --technique mask-subtractive",
    ),
    picture(
        "mask-subtractive-coarse",
        "V of masks of 32x32 texels: ramps as wide as a texel at every edge",
        "builtin:torus --technique mask-subtractive --set mask_size=32 --view visibility",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_picture_has_a_name_of_its_own_can_be_typed_and_needs_no_file_but_ours() {
        let names: HashSet<_> = PICTURES.iter().map(|picture| picture.file).collect();
        assert_eq!(names.len(), PICTURES.len());
        for Picture { file, arguments, .. } in PICTURES {
            assert!(!arguments.contains(['"', '\'']) && !arguments.contains("../"), "{file}");
            let scene = arguments.split_whitespace().next().unwrap_or_default();
            let root = crate::process::root();
            assert!(scene.starts_with("builtin:") || root.join(scene).is_file(), "{file}: {scene}");
        }
    }
}
