//! What an animated scene is asked for.

use crate::{Scene, SceneError};

/// A moment of an animation of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Seconds from the animation's beginning, finite. From 0 to the animation's length (the time of its last key, itself
    /// within) it is taken as it stands; outside of that the animation starts again, as viewers loop it, so that -0.1 is
    /// 0.1 s before the end. Before a channel's first key and after its last, that key holds.
    pub time_s: f32,
    /// Its name in the file, or its number counted from 0; a name goes before a number. Default: the first.
    pub animation: Option<String>,
}

impl Pose {
    /// Is the time one?
    pub(crate) fn check(&self, spec: &str) -> Result<(), SceneError> {
        if self.time_s.is_finite() {
            return Ok(());
        }
        let what = format!("the time {} s is not finite; give seconds", self.time_s);
        Err(SceneError::Pose { path: spec.into(), what })
    }

    /// Nothing plays: worth a warning, and an error where something was to play by name.
    pub(crate) fn without_animations(&self, spec: &str, scene: &mut Scene) -> Result<(), SceneError> {
        let Some(name) = &self.animation else {
            scene.warnings.push("there is no animation in it: its nodes are the same at all times".into());
            return Ok(());
        };
        let name: String = name.chars().take(60).map(|c| if c.is_control() { ' ' } else { c }).collect();
        let what = format!("there is no animation \"{name}\", nor any other; leave its name out");
        Err(SceneError::Pose { path: spec.into(), what })
    }
}
