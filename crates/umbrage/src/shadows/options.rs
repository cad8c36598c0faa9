//! What has to be known before shaders and pipelines can be made.

use super::ShadowsError;
use umbrage_core::technique::{DEFAULT, Settings};

/// What a [`Shadows`](super::Shadows) is made for. `default()` has one technique, the default one, which has nothing to set.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShadowsOptions {
    /// The techniques that lights may have; new lights get the first. The shader holds the lookup of each, and each size of maps has
    /// a texture of its own: name no more than you use. Parameters may differ light by light, choices may not.
    pub techniques: Vec<Settings>,
    /// WGSL in place of the weights of the filter `kernel`:
    /// `fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f`, see `wgsl/kernel/bell.wgsl`.
    pub kernel: Option<String>,
    /// Lights at most at one time: 1 to 256, default 64. Costs 48 bytes each.
    pub most_lights: u32,
    /// Views at most, over all lights: a spot or a sun has one, a point light six, an area light so many for each of its places.
    /// 1 to 256, default 256. Costs 400 bytes each; maps are made only for views that there are.
    pub most_views: u32,
    /// Format of the depth that `record_screen` counts over. Default: the best with a stencil that the device has, see
    /// [`crate::volume::choose_count_format`].
    pub depth_stencil: Option<wgpu::TextureFormat>,
    /// A caster that did not move for so many frames counts as still again; default 64. Still casters are drawn once and copied
    /// while others move over them.
    pub still_frames: u32,
}

/// The most lights and views that fit into uniform buffers of every device.
pub(super) const LIMIT: u32 = 256;

impl ShadowsOptions {
    /// For the techniques of these names, with all their defaults.
    ///
    /// # Errors
    /// [`ShadowsError::Setting`] names what there is.
    pub fn with<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self, ShadowsError> {
        let techniques = names.into_iter().map(|name| Settings::new(name, [])).collect::<Result<_, _>>()?;
        Ok(Self { techniques, ..Self::bare() })
    }

    fn bare() -> Self {
        Self {
            techniques: Vec::new(),
            kernel: None,
            most_lights: 64,
            most_views: LIMIT,
            depth_stencil: None,
            still_frames: 64,
        }
    }

    /// And for one more technique, with its choices and its size of maps.
    #[must_use]
    pub fn technique(mut self, settings: Settings) -> Self {
        self.techniques.push(settings);
        self
    }

    /// Maps of `size_texel` by `size_texel` for all techniques named so far that have maps; 1 to 16384, default 2048.
    ///
    /// # Errors
    /// [`ShadowsError::Setting`] when it is out of range.
    pub fn map_size(mut self, size_texel: u32) -> Result<Self, ShadowsError> {
        for settings in &mut self.techniques {
            if settings.value("map_size").is_some() {
                *settings = settings.clone().with_value("map_size", size_texel as f32)?;
            }
        }
        Ok(self)
    }

    /// With a kernel of the user's own.
    #[must_use]
    pub fn kernel(mut self, wgsl: impl Into<String>) -> Self {
        self.kernel = Some(wgsl.into());
        self
    }

    /// With room for so many lights and views.
    #[must_use]
    pub fn at_most(mut self, lights: u32, views: u32) -> Self {
        (self.most_lights, self.most_views) = (lights, views);
        self
    }

    /// For depth of this format.
    #[must_use]
    pub fn depth_stencil(mut self, format: wgpu::TextureFormat) -> Self {
        self.depth_stencil = Some(format);
        self
    }

    pub(super) fn check(&self, device: &wgpu::Device) -> Result<(), ShadowsError> {
        let refuse =
            |option, value: String, allowed: String| Err(ShadowsError::Option { option, value, allowed });
        if self.techniques.is_empty() {
            return refuse(
                "techniques",
                "empty".into(),
                format!("one technique or more, such as `{DEFAULT}`"),
            );
        }
        for (option, value) in [("most_lights", self.most_lights), ("most_views", self.most_views)] {
            if value == 0 || value > LIMIT {
                return refuse(option, value.to_string(), format!("1 to {LIMIT}"));
            }
        }
        if let Some(format) = self.depth_stencil.filter(|format| !format.has_stencil_aspect()) {
            let formats = crate::volume::COUNT_FORMATS.map(|format| format!("{format:?}")).join(" or ");
            return refuse("depth_stencil", format!("{format:?}"), formats);
        }
        let lacks = |format: &wgpu::TextureFormat| !device.features().contains(format.required_features());
        if let Some(format) = self.depth_stencil.filter(lacks) {
            let allowed =
                format!("a format that the device has; {format:?} needs {:?}", format.required_features());
            return refuse("depth_stencil", format!("{format:?}"), allowed);
        }
        Ok(())
    }
}

impl Default for ShadowsOptions {
    /// The default technique alone.
    fn default() -> Self {
        Self { techniques: Settings::new(DEFAULT, []).into_iter().collect(), ..Self::bare() }
    }
}
