//! What long work shows, and how it is stopped.

use crate::fault::Fault;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by Ctrl-C. Work looks at it between steps, so nothing is left half-written.
static STOP: AtomicBool = AtomicBool::new(false);

const STEPS: u64 = 1000;

/// A bar on standard error, on a terminal only.
#[derive(Debug)]
pub struct Progress(ProgressBar);

impl Progress {
    /// Shows the bar, and from now on Ctrl-C stops the work in an orderly way.
    ///
    /// # Errors
    /// When the system lets nobody listen to Ctrl-C.
    pub fn new() -> Result<Self, Fault> {
        ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed))
            .map_err(|e| Fault::Failed(format!("cannot listen to Ctrl-C: {e}")))?;
        let bar =
            if std::io::stderr().is_terminal() { ProgressBar::new(STEPS) } else { ProgressBar::hidden() };
        let style = ProgressStyle::with_template("{msg:<28} {bar:36} {percent:>3} %  {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Ok(Self(bar))
    }

    /// To be called often: shows what is done, says whether to go on.
    pub fn at(&self, label: &str, share: f32) -> ControlFlow<()> {
        if STOP.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        let position = (f64::from(share.clamp(0.0, 1.0)) * STEPS as f64) as u64;
        // From many threads; the bar itself draws a few times a second.
        if position > self.0.position() {
            self.0.set_position(position);
        }
        if self.0.message() != label {
            self.0.set_message(label.to_owned());
        }
        ControlFlow::Continue(())
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
