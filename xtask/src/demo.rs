//! `cargo xtask demo`: from a fresh checkout to a picture.

use crate::process::{self, Done};
use crate::setup;

/// `cargo xtask demo`
pub fn run(_: &[String]) -> Done {
    setup::before_build(setup::Need::Draw)?;
    process::build_umbrage("debug")?;
    setup::after_build()?;
    let folder = process::root().join("target").join("demo");
    process::make_folder(&folder)?;
    let (picture, without) = (folder.join("umbrage.png"), folder.join("unshadowed.png"));
    for (technique, file) in [("linear", &picture), ("unshadowed", &without)] {
        let mut render =
            process::umbrage("debug", ["render", "--technique", technique, "--size", "1280x720"]);
        process::run(render.arg("--quiet").arg("-o").arg(file))?;
    }
    let umbrage = process::programs("debug").join("umbrage");
    let shown = umbrage.strip_prefix(process::root()).unwrap_or(&umbrage).display();
    println!(
        "
The built-in scene is drawn: a torus that floats before a floor and a wall, under one spot light.
  {}    with a shadow map of 2048x2048, 2x2 comparisons
  {}    the same light without shadow

Try next:
  {shown} render builtin:columns -o columns.png
  {shown} render YOUR-MODEL.glb --ground -o model.png
  {shown} render --technique hard --set map_size=128 -o stairs.png
  {shown} techniques
  cargo xtask test",
        picture.display(),
        without.display()
    );
    Ok(())
}
