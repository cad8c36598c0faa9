//! The picture against the golden that somebody looked at, and one without shadows that must not pass for it.

#[path = "../../../crates/umbrage-render/tests/common/compare.rs"]
mod compare;

use compare::{check, check_differs};

/// A picture: RGBA, as high as it is wide.
pub struct Shot {
    /// Pixels.
    pub side: u32,
    /// Rows, top first.
    pub rgba: Vec<u8>,
}

/// The software rasteriser that goldens are made with. `None`, said loudly, where it is missing; a failure where
/// `UMBRAGE_GOLDEN_REQUIRED=1` says that it must not be.
fn gpu() -> Option<own_renderer::Gpu> {
    own_renderer::open(Some("llvmpipe"))
        .inspect_err(|error| {
            let required = std::env::var("UMBRAGE_GOLDEN_REQUIRED").is_ok_and(|v| v == "1");
            assert!(!required, "UMBRAGE_GOLDEN_REQUIRED=1, but: {error}");
            eprintln!("SKIPPED, no golden was compared: {error}");
        })
        .ok()
}

#[test]
fn own_renderer() {
    let Some(gpu) = gpu() else { return };
    let side = 192;
    let shoot = |casters| {
        let rgba = own_renderer::draw(&gpu, side, side, casters).expect("a picture");
        Shot { side, rgba }
    };
    check_differs("own-renderer", &shoot(false), "the scene without casters in the map");
    check("own-renderer", &shoot(true));
}
