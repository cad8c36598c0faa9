//! Lights: what each is, its technique, and its views.

use super::handles::Store;
use super::meshes::Mesh;
use super::pool::Pool;
use super::views::View;
use crate::volume::VolumeSettings;
use umbrage_core::fit::{Eye, Fallback, PlacedViews, fit_places};
use umbrage_core::technique::mask::Receivers;
use umbrage_core::technique::{Family, Method, Projection, Settings};
use umbrage_core::{Aabb, Light, LightError, LightKind};

/// A light.
#[derive(Debug)]
pub(super) struct Lit {
    pub light: Light,
    pub settings: Settings,
    /// What its maps are drawn with: its own technique, or what takes over for casters that this cannot draw.
    pub map_settings: Option<Settings>,
    /// Which lookup its maps have.
    pub lookup: Option<usize>,
    /// Which passes draw its maps.
    pub casting: Option<usize>,
    pub views: Vec<View>,
    /// From how many places it has views.
    pub places: u32,
    /// Why its maps are laid more plainly than was asked for.
    pub fallback: Option<Fallback>,
    /// Why there is no map.
    pub failure: Option<umbrage_core::fit::FitError>,
    /// Has it to be fitted?
    pub fit_is_stale: bool,
    /// Might a fit be tighter?
    pub is_loose: bool,
    /// First of its views in the table.
    pub first_view: u32,
    /// How its volumes are drawn, if it has some.
    pub volume: Option<VolumeSettings>,
    /// Its layer of V on the screen.
    pub screen: Option<u32>,
    /// Its number among lights with masks, and its masks as the shader counts them.
    pub mask_number: usize,
    pub masks: u32,
    /// Are its masks taken away from V on the screen?
    pub is_subtractive: bool,
    /// Are there more blockers than it may have masks?
    pub is_crowded: bool,
    /// Casters that its family cannot draw under this light, by number.
    pub left_to_maps: Vec<usize>,
    /// Are there casters that maps draw for it?
    pub has_map_casters: bool,
}

fn is_subtractive(settings: &Settings) -> bool {
    matches!(settings.method, Method::Mask(mask) if mask.receivers == Receivers::Subtractive)
}

/// Can a family draw a caster itself? Others are drawn into maps for it.
pub(super) fn draws(family: Family, mesh: Option<&Mesh>) -> bool {
    match family {
        Family::None | Family::Map => true,
        Family::Volume => mesh.is_some_and(Mesh::makes_volumes),
        Family::Mask => mesh.is_some(),
    }
}

impl Lit {
    pub fn new(light: Light, (settings, lookup): (Settings, Option<usize>)) -> Self {
        let map_settings = match settings.method.family() {
            Family::Map => Some(settings.clone()),
            _ => settings.fallback(),
        };
        Self {
            light,
            map_settings,
            lookup,
            casting: None,
            views: Vec::new(),
            places: 0,
            fallback: None,
            failure: None,
            fit_is_stale: true,
            is_loose: false,
            first_view: 0,
            volume: VolumeSettings::of(&settings),
            screen: None,
            mask_number: 0,
            masks: 0,
            is_subtractive: is_subtractive(&settings),
            is_crowded: false,
            left_to_maps: Vec::new(),
            has_map_casters: true,
            settings,
        }
    }

    /// Is its V found on the screen?
    pub fn is_on_screen(&self) -> bool {
        self.volume.is_some() || self.is_subtractive
    }

    /// Has it masks?
    pub fn is_masked(&self) -> bool {
        self.family() == Family::Mask
    }

    /// Do its maps follow the eye?
    pub fn follows_eye(&self) -> bool {
        let combination = self.map_settings.as_ref().and_then(Settings::combination);
        combination.is_some_and(|c| c.projection != Projection::Fitted) && self.light.kind != LightKind::Point
    }

    /// What draws the casters that it can.
    pub fn family(&self) -> Family {
        self.settings.method.family()
    }

    /// Do its views have room for a box?
    pub fn has_room_for(&self, bounds_world: &Aabb) -> bool {
        // Without views, nothing was in reach; something may be now.
        !self.has_map_casters
            || !self.views.is_empty() && self.views.iter().all(|view| view.has_room_for(bounds_world))
    }

    /// Fits its views around boxes, those of what has maps; layers come from its pool and go back there. True when the number of
    /// views changed.
    pub fn fit(
        &mut self,
        device: &wgpu::Device,
        pool: &mut Pool,
        boxes_world: &[Aabb],
        eye: Eye,
    ) -> Result<bool, LightError> {
        (self.fit_is_stale, self.is_loose) = (false, false);
        let Some(settings) = self.map_settings.as_ref().filter(|_| self.has_map_casters) else {
            let before = self.views.len();
            self.views.drain(..).for_each(|view| pool.give_back(view.layer));
            return Ok(before > 0);
        };
        let storage = pool.kind.format.storage;
        let placed = match fit_places(&self.light, settings, storage, boxes_world, Some(eye)) {
            Ok(placed) => placed,
            Err(umbrage_core::fit::FitError::Light(error)) => return Err(error),
            Err(error) => PlacedViews { failures: vec![error], ..PlacedViews::default() },
        };
        self.places = placed.places;
        self.failure = placed.failures.first().cloned();
        self.fallback = placed.views.first().and_then(|(_, view)| view.fallback);
        let count = placed.views.len();
        let before = self.views.len();
        for view in self.views.drain(count.min(before)..) {
            pool.give_back(view.layer);
        }
        let mut fitted = placed.views.into_iter();
        self.views.iter_mut().zip(fitted.by_ref()).for_each(|(view, fitted)| view.aim(fitted));
        self.views.extend(fitted.map(|fitted| View::new(device, fitted, pool.take())));
        Ok(count != before)
    }

    /// Gives all layers back.
    pub fn give_back(&mut self, pools: &mut [Pool], lookups: &[super::variants::Lookup]) {
        let pool = self.lookup.and_then(|lookup| lookups.get(lookup)).map(|lookup| lookup.pool);
        let views = self.views.drain(..);
        if let Some(pool) = pool.and_then(|pool| pools.get_mut(pool)) {
            views.for_each(|view| pool.give_back(view.layer));
        }
    }
}

/// Views of all lights.
pub(super) fn count_views(lights: &Store<Lit>) -> usize {
    lights.iter().map(|(_, lit)| lit.views.len()).sum()
}
