//! When maps are drawn: before each frame, at an interval of their own, or on a thread of their own.
//!
//! The thread draws into the set of maps that no frame looks up, then hands it over whole: maps, and the matrices that they
//! were drawn with. A frame takes the newest complete set and never waits for one; the thread waits for frames that
//! are still being recorded. Sampling and drawing of one set are kept apart by the order of submissions.
//!
//! Only the CPU's share of the work (fits, culling, recording, whatever the application adds) runs beside the frame. wgpu
//! has one queue: on the GPU, maps and frames follow each other, whichever thread handed them in.

use crate::maps::{MapMaker, MapSet};
use crate::moving::World;
use crate::{RenderError, Renderer};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// When maps are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapSchedule {
    /// Before each frame that would look up others: shadows are never older than the frame.
    #[default]
    EachFrame,
    /// By the frame, but at most once in this time. Between, shadows lag behind what moves.
    Every(Duration),
    /// On a thread of their own, at most once in this time. Shadows lag; memory of the maps doubles.
    Threaded(Duration),
}

/// Whatever a thread did to what the lock holds, each field is whole.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What frame and thread tell each other.
#[derive(Debug)]
struct State {
    /// The newest world.
    world: Arc<World>,
    /// The set that frames look up.
    front: usize,
    /// Which world it shows.
    front_version: u64,
    /// The set that a frame is being recorded with.
    leased: Option<usize>,
    stop: bool,
    /// Why the thread gave up: every frame from then on says so.
    failed: Option<RenderError>,
    /// Maps drawn since a frame last asked.
    drawn: u64,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    told: Condvar,
    sets: [Arc<Mutex<MapSet>>; 2],
    maker: Arc<MapMaker>,
    interval: Duration,
    reuse: bool,
}

/// The thread that draws maps. Ends when dropped.
#[derive(Debug)]
pub(crate) struct MapThread {
    shared: Arc<Shared>,
    handle: Option<JoinHandle<()>>,
}

impl MapThread {
    /// Starts it. Frames look up `sets[front]` until it has drawn the other.
    fn start(
        maker: Arc<MapMaker>,
        sets: [Arc<Mutex<MapSet>>; 2],
        world: Arc<World>,
        interval: Duration,
        reuse: bool,
    ) -> Result<Self, RenderError> {
        let state = State {
            front_version: world.version,
            world,
            front: 0,
            leased: None,
            stop: false,
            failed: None,
            drawn: 0,
        };
        let shared =
            Arc::new(Shared { state: Mutex::new(state), told: Condvar::new(), sets, maker, interval, reuse });
        let its = Arc::clone(&shared);
        let handle = std::thread::Builder::new()
            .name("umbrage maps".into())
            .spawn(move || its.run())
            .map_err(|e| {
                RenderError::Change(format!("no thread can be started for maps: {e}; draw them by the frame"))
            })?;
        Ok(Self { shared, handle: Some(handle) })
    }

    /// Tells it of the world as it is now; gives the set to look up until [`Self::release`], and how many maps were drawn since the last call.
    pub fn exchange(&self, world: &Arc<World>) -> Result<(usize, u64), RenderError> {
        let mut state = locked(&self.shared.state);
        if let Some(error) = &state.failed {
            return Err(error.clone());
        }
        if state.world.version != world.version {
            state.world = Arc::clone(world);
            self.shared.told.notify_all();
        }
        state.leased = Some(state.front);
        Ok((state.front, std::mem::take(&mut state.drawn)))
    }

    /// The frame is submitted: its set may be drawn to again.
    pub fn release(&self) {
        locked(&self.shared.state).leased = None;
        self.shared.told.notify_all();
    }
}

impl Drop for MapThread {
    fn drop(&mut self) {
        locked(&self.shared.state).stop = true;
        self.shared.told.notify_all();
        if let Some(handle) = self.handle.take() {
            // It cannot have panicked in a way that matters here.
            let _ = handle.join();
        }
    }
}

impl Shared {
    fn run(&self) {
        let mut next = Instant::now();
        while let Some((world, back)) = self.work(next) {
            next = Instant::now() + self.interval;
            let made = self.make(&world, back);
            let mut state = locked(&self.state);
            match made {
                Ok(drawn) => {
                    state.front = back;
                    state.front_version = world.version;
                    state.drawn += drawn;
                }
                Err(error) => {
                    state.failed = Some(error);
                    return;
                }
            }
        }
    }

    /// Waits until it is time, something moved, and no frame records with the set to draw. `None`: time to end.
    fn work(&self, next: Instant) -> Option<(Arc<World>, usize)> {
        let mut state = locked(&self.state);
        loop {
            if state.stop {
                return None;
            }
            let back = 1 - state.front;
            let moved = !self.reuse || state.front_version != state.world.version;
            let left = next.saturating_duration_since(Instant::now());
            if moved && left.is_zero() && state.leased != Some(back) {
                return Some((Arc::clone(&state.world), back));
            }
            state = if left.is_zero() {
                self.told.wait(state).unwrap_or_else(PoisonError::into_inner)
            } else {
                self.told.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0
            };
        }
    }

    /// Draws the set that no frame looks up, and waits for the GPU: what is handed over is complete.
    fn make(&self, world: &World, back: usize) -> Result<u64, RenderError> {
        let mut set = locked(&self.sets[back]);
        let (drawn, submitted) = draw_all(&self.maker, &mut set, world, !self.reuse)?;
        self.maker
            .device
            .poll(wgpu::PollType::Wait { submission_index: Some(submitted), timeout: None })
            .map_err(|e| RenderError::Gpu(e.to_string()))?;
        Ok(drawn)
    }
}

/// Brings a set up to date, outside of any frame.
fn draw_all(
    maker: &MapMaker,
    set: &mut MapSet,
    world: &World,
    all: bool,
) -> Result<(u64, wgpu::SubmissionIndex), RenderError> {
    maker.refresh(set, world)?;
    let mut encoder = maker.device.create_command_encoder(&Default::default());
    let stale = set.stale(all);
    for layer in &stale {
        maker.record(&mut encoder, set, *layer, None);
    }
    Ok((stale.len() as u64, maker.queue.submit([encoder.finish()])))
}

impl Renderer<'_> {
    /// Says when maps are drawn from now on. The first maps of a new schedule are complete before this returns.
    ///
    /// # Errors
    /// [`RenderError::Change`] when the system gives no thread; [`RenderError::Shadow`] when a second set of maps has no room.
    pub fn schedule_maps(&mut self, schedule: MapSchedule) -> Result<(), RenderError> {
        self.thread = None;
        self.sets.truncate(1);
        self.groups.truncate(1);
        self.told = None;
        self.drawn_at = None;
        self.schedule = schedule;
        if let MapSchedule::Threaded(interval) = schedule {
            let front = Arc::clone(&self.sets[0]);
            draw_all(&self.maker, &mut locked(&front), &self.world, !self.options.reuse)?;
            let back = Arc::new(Mutex::new(MapSet::new(&self.gpu.device)));
            self.maker.refresh(&mut locked(&back), &self.world)?;
            self.gpu.check()?;
            self.sets.push(Arc::clone(&back));
            self.groups.push(None);
            let world = Arc::clone(&self.world);
            let reuse = self.options.reuse;
            self.thread =
                Some(MapThread::start(Arc::clone(&self.maker), [front, back], world, interval, reuse)?);
        }
        Ok(())
    }
}
