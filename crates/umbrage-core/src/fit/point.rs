//! The six views of a point light, one along each axis of the world. Each is wider than its 90 degrees by the border, so that a
//! filter finds on a face's own tile what lies just past the face.

use super::{Fallback, FitError, FitOptions, ShadowView, spot};
use crate::bounds::Aabb;
use crate::light::{Light, up_for};
use crate::technique::Projection;
use glam::{Mat3, Vec3};

/// Which way each tile looks, in the order of the tiles.
const AXES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

fn looking_along(axis: Vec3) -> Mat3 {
    let right = up_for(axis).cross(-axis);
    Mat3::from_cols(right, (-axis).cross(right), -axis)
}

pub(super) fn tiles(
    light: &Light,
    bounds_world: &[Aabb],
    options: &FitOptions,
) -> Result<Vec<ShadowView>, FitError> {
    let tile = |axis: &Vec3| spot::pyramid(light, looking_along(*axis), 1.0, bounds_world, options);
    let fitted: Vec<Result<ShadowView, FitError>> = AXES.iter().map(tile).collect();
    let Some(any) = fitted.iter().flatten().next().copied() else { return Err(FitError::NothingInReach) };
    // A tile in whose way nothing lies is empty, but it has its place; any planes will do.
    let filled = |(axis, tile): (&Vec3, Result<ShadowView, FitError>)| match tile {
        Err(FitError::NothingInReach) => Ok(ShadowView {
            light_from_world: (glam::Mat4::from_translation(light.position_world)
                * glam::Mat4::from_mat3(looking_along(*axis)))
            .inverse(),
            ..any
        }),
        other => other,
    };
    let fallback = (options.projection != Projection::Fitted).then_some(Fallback::Tiles);
    let tiles = AXES.iter().zip(fitted).map(filled);
    tiles.map(|tile| tile.map(|view| ShadowView { fallback, ..view })).collect()
}

#[cfg(test)]
mod tests {
    use super::super::fit_all;
    use super::*;
    use crate::light::LightKind;
    use crate::lookup::locate;

    #[test]
    fn each_direction_is_in_its_tile_and_the_border_holds_what_lies_past_it() {
        let light =
            Light { kind: LightKind::Point, position_world: Vec3::new(1.0, 2.0, 3.0), ..Light::default() };
        let room = [Aabb { min: Vec3::splat(-10.0), max: Vec3::splat(10.0) }];
        let options = FitOptions { size_texel: 64, border_texel: 4.0, ..FitOptions::default() };
        let views = fit_all(&light, &room, &options).expect("a room around it");
        assert_eq!(views.len(), 6);
        for (axis, view) in AXES.iter().zip(&views) {
            let (a, b) = axis.any_orthonormal_pair();
            // The border's texels are a little wider on the face than at its middle; 3.9 of 4 are always inside.
            let past = 1.0 + 2.0 * 3.9 / (64.0 - 8.0);
            for (x, y) in [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (past, 0.3), (-0.2, past), (-past, -past)] {
                let at =
                    locate(&view.texture_from_world(), light.position_world + 5.0 * (*axis + a * x + b * y));
                assert!(at.inside && at.depth > 0.0 && at.depth < 1.0, "{axis} {x} {y} {at:?}");
            }
            assert!(!locate(&view.texture_from_world(), light.position_world - *axis).inside);
        }
    }

    #[test]
    fn a_light_beside_everything_has_tiles_all_the_same() {
        let light = Light { kind: LightKind::Point, ..Light::default() };
        let options = FitOptions { size_texel: 64, ..FitOptions::default() };
        let aside = [Aabb { min: Vec3::new(5.0, -1.0, -1.0), max: Vec3::new(7.0, 1.0, 1.0) }];
        let views = fit_all(&light, &aside, &options).expect("a box to the right");
        assert!(views.iter().all(|v| v.clip_from_world().is_finite()));
        assert!(locate(&views[1].texture_from_world(), Vec3::NEG_X * 3.0).inside);
        assert_eq!(fit_all(&light, &[], &options), Err(FitError::NothingInReach));
    }
}
