//! The window that holds what the eye sees and no more: half angles, or extents, of its own for each axis, off centre.

use super::FitOptions;
use super::seen::Seen;
use super::window::Window;
use glam::DVec3;

/// `None` only where numbers run out.
pub(super) fn window(seen: &Seen, options: &FitOptions) -> Option<Window> {
    Window::best(seen, DVec3::Z, options)
}
