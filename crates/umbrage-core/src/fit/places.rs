//! All views that a technique asks for: of a light, or of several places on an area light.

use super::{Eye, FitError, FitOptions, ShadowView, fit_all};
use crate::area::places;
use crate::bounds::Aabb;
use crate::light::Light;
use crate::technique::{Settings, Storage};

/// The views of one light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacedViews {
    /// Each with the light at its place. As many for every place.
    pub views: Vec<(Light, ShadowView)>,
    /// From how many places there are views; 0 where nothing lies in the light's reach.
    pub places: u32,
    /// Why places got none, but for places that reach nothing: there nothing is missing.
    pub failures: Vec<FitError>,
}

/// Fits all views of a light that `settings` ask for around boxes in world space; none for techniques without maps. `storage` is
/// what the maps got: never `auto`.
///
/// Cost on the CPU: proportional to the number of boxes and of views.
///
/// # Errors
/// [`FitError::Light`] when the light itself cannot be used.
pub fn fit_places(
    light: &Light,
    settings: &Settings,
    storage: Storage,
    bounds_world: &[Aabb],
    eye: Option<Eye>,
) -> Result<PlacedViews, FitError> {
    light.check()?;
    let mut made = PlacedViews::default();
    let Some(combination) = settings.combination() else { return Ok(made) };
    let options = FitOptions {
        size_texel: settings.map_size_texel(),
        least_near: storage.least_near(),
        projection: combination.projection,
        eye,
        border_texel: settings.reach_texel() + 1.0,
    };
    for place in places_on(light, settings.places(), bounds_world, &options) {
        match fit_all(&place, bounds_world, &options) {
            Ok(views) => {
                made.views.extend(views.into_iter().map(|view| (place, view)));
                made.places += 1;
            }
            Err(FitError::NothingInReach) => {}
            Err(error) => made.failures.push(error),
        }
    }
    Ok(made)
}

/// The places of a light that it is seen from: itself, or many on an area light.
fn places_on(light: &Light, count: u32, bounds_world: &[Aabb], options: &FitOptions) -> Vec<Light> {
    // Only the cones of many places have to know how near to the light there is anything: from its middle.
    let nearest_m = if count > 1 {
        let middle = fit_all(light, bounds_world, options).ok();
        middle.iter().flatten().map(|view| view.near_m).fold(f32::INFINITY, f32::min)
    } else {
        f32::INFINITY
    };
    places(light, count, nearest_m)
}
