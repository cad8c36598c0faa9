//! Lights: added, changed and removed by handle, with any of the options' techniques.

use super::handles::index;
use super::lights::Lit;
use super::{LightHandle, Shadows, ShadowsError, options};
use umbrage_core::Light;
use umbrage_core::technique::Settings;

impl Shadows {
    /// Adds a light with the first of the options' techniques.
    ///
    /// # Errors
    /// [`ShadowsError::Light`], [`ShadowsError::TooMany`].
    pub fn add_light(&mut self, light: Light) -> Result<LightHandle, ShadowsError> {
        let first = self.options.techniques.first().cloned();
        let settings = first.ok_or(ShadowsError::Option {
            option: "techniques",
            value: "empty".into(),
            allowed: "one technique or more".into(),
        })?;
        self.add_light_with(light, &settings)
    }

    /// Adds a light with a technique.
    ///
    /// # Errors
    /// [`ShadowsError::Light`], [`ShadowsError::TooMany`], [`ShadowsError::Undeclared`].
    pub fn add_light_with(
        &mut self,
        light: Light,
        technique: &Settings,
    ) -> Result<LightHandle, ShadowsError> {
        light.check()?;
        if self.lights.len() >= self.options.most_lights as usize {
            return Err(ShadowsError::TooMany {
                what: "lights",
                asked: self.lights.len() + 1,
                most: self.options.most_lights,
                option: "most_lights",
                limit: options::LIMIT,
            });
        }
        let settled = self.declared.settle(technique)?;
        self.lights_changed = true;
        self.is_prepared = false;
        Ok(LightHandle(self.lights.insert(Lit::new(light, settled))))
    }

    /// Moves a light, or changes it otherwise.
    ///
    /// # Errors
    /// [`ShadowsError::Light`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn set_light(&mut self, handle: LightHandle, light: Light) -> Result<(), ShadowsError> {
        light.check()?;
        let lit = self.lights.get_mut(handle.0)?;
        if lit.light != light {
            (lit.light, lit.fit_is_stale) = (light, true);
            self.lights_changed = true;
        }
        Ok(())
    }

    /// Gives a light another technique, or another setting of its own, from the next [`Shadows::prepare`] on. One of the options'
    /// techniques: parameters are free, choices are not. What it
    /// has already costs nothing.
    ///
    /// # Errors
    /// [`ShadowsError::Undeclared`], [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn set_technique(&mut self, handle: LightHandle, technique: &Settings) -> Result<(), ShadowsError> {
        let (settings, lookup) = self.declared.settle(technique)?;
        let lit = self.lights.get_mut(handle.0)?;
        if lit.settings == settings {
            return Ok(());
        }
        lit.give_back(&mut self.pools, &self.declared.lookups);
        *lit = Lit::new(lit.light, (settings, lookup));
        self.lights_changed = true;
        self.is_prepared = false;
        Ok(())
    }

    /// The same by the technique's name, with its defaults: the first of the options' techniques of that name, or of the table.
    ///
    /// # Errors
    /// [`ShadowsError::Setting`] names what there is; otherwise as [`Shadows::set_technique`].
    pub fn set_technique_named(&mut self, handle: LightHandle, name: &str) -> Result<(), ShadowsError> {
        let declared = self.options.techniques.iter().find(|settings| settings.technique.id == name).cloned();
        let settings = declared.map_or_else(|| Settings::new(name, []), Ok)?;
        self.set_technique(handle, &settings)
    }

    /// Removes a light. Its number may be given to another one.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn remove_light(&mut self, handle: LightHandle) -> Result<(), ShadowsError> {
        let mut removed = self.lights.remove(handle.0)?;
        removed.give_back(&mut self.pools, &self.declared.lookups);
        self.lights_changed = true;
        self.is_prepared = false;
        Ok(())
    }

    /// The number of a light in the shader: it stays the same while the light is there.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn light_index(&self, handle: LightHandle) -> Result<u32, ShadowsError> {
        self.lights.get(handle.0)?;
        Ok(index(handle.0.key) as u32)
    }

    /// A light as it was set.
    ///
    /// # Errors
    /// [`ShadowsError::Removed`], [`ShadowsError::OfAnother`].
    pub fn light(&self, handle: LightHandle) -> Result<(&Light, &Settings), ShadowsError> {
        self.lights.get(handle.0).map(|lit| (&lit.light, &lit.settings))
    }
}
