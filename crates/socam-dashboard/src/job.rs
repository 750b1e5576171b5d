//! Work that takes longer than a frame: on a thread of its own, with progress, and a way to cancel it.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};

#[cfg(not(target_arch = "wasm32"))]
use std::time::Instant;

use egui::{ProgressBar, Ui};

/// Error of a cancelled job.
pub const CANCELLED: &str = "cancelled";

#[derive(Debug, Default)]
struct State {
    cancelled: AtomicBool,
    /// Progress in 1/1000; above 1000 it is unknown.
    reached: AtomicU32,
    doing: Mutex<String>,
}

/// The worker's side of a job.
#[derive(Debug, Clone, Default)]
pub struct Handle(Arc<State>);

impl Handle {
    /// Reports progress, 0 to 1.
    ///
    /// # Errors
    /// When the job was cancelled: the worker passes this on and ends.
    pub fn reached(&self, fraction: f32) -> Result<(), String> {
        self.0.reached.store((1000.0 * fraction) as u32, Ordering::Relaxed);
        if self.is_cancelled() { Err(CANCELLED.into()) } else { Ok(()) }
    }

    /// Reports progress, 0 to 1, which never falls.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn at(&self, fraction: f32) {
        self.0.reached.fetch_max((1000.0 * fraction) as u32, Ordering::Relaxed);
    }

    /// Reports the current step.
    pub fn doing(&self, text: String) {
        *self.0.doing.lock().unwrap_or_else(PoisonError::into_inner) = text;
    }

    /// Whether the job was cancelled.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }
}

/// A job that runs.
#[derive(Debug)]
pub struct Job<T> {
    handle: Handle,
    result: Receiver<T>,
    /// A page in a browser has no threads, so that it shows no progress.
    #[cfg(not(target_arch = "wasm32"))]
    since: Instant,
}

impl<T: Send + 'static> Job<T> {
    /// Starts a job; the window is drawn again when it ends. In a browser, which has no threads, it runs at once.
    pub fn start(title: &str, ctx: &egui::Context, work: impl FnOnce(&Handle) -> T + Send + 'static) -> Self {
        let handle = Handle::default();
        handle.doing(title.to_owned());
        let (sender, result) = channel();
        let (theirs, ctx) = (handle.clone(), ctx.clone());
        let run = move || {
            // The receiver is gone if the job was cancelled.
            let _ = sender.send(work(&theirs));
            ctx.request_repaint();
        };
        #[cfg(not(target_arch = "wasm32"))]
        std::thread::spawn(run);
        #[cfg(target_arch = "wasm32")]
        run();
        Self {
            handle,
            result,
            #[cfg(not(target_arch = "wasm32"))]
            since: Instant::now(),
        }
    }

    /// The result, once. `Err` if the worker panicked.
    pub fn poll(&self) -> Option<Result<T, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(Ok(result)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("the work ended without a result; please report this".into()))
            }
        }
    }

    /// Requests the end.
    pub fn cancel(&self) {
        self.handle.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Draws progress and a button to cancel; true when the button was pressed.
    pub fn ui(&self, ui: &mut Ui) -> bool {
        ui.ctx().request_repaint_after_secs(0.1);
        let text = self.handle.0.doing.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let reached = self.handle.0.reached.load(Ordering::Relaxed) as f32 / 1000.0;
        let mut cancelled = false;
        ui.horizontal(|ui| {
            // The button comes first, so that it stays in its place while the text changes.
            cancelled = ui.button("Cancel").clicked();
            ui.spinner();
            if reached > 0.0 {
                ui.add(ProgressBar::new(reached).desired_width(160.0).show_percentage());
            }
            ui.label(&text);
            #[cfg(not(target_arch = "wasm32"))]
            ui.weak(times(self.since.elapsed().as_secs_f64(), f64::from(reached)));
        });
        if cancelled {
            self.cancel();
        }
        cancelled
    }
}

/// A job that may fail, be cancelled and be begun again, with what went wrong the last time.
#[cfg(not(target_arch = "wasm32"))]
#[derive(Debug)]
pub(crate) struct Attempt<T> {
    job: Option<Job<Result<T, String>>>,
    /// Why the last one failed; one sentence.
    pub(crate) problem: Option<String>,
}

#[cfg(not(target_arch = "wasm32"))]
impl<T> Default for Attempt<T> {
    fn default() -> Self {
        Self { job: None, problem: None }
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl<T: Send + 'static> Attempt<T> {
    pub(crate) fn is_running(&self) -> bool {
        self.job.is_some()
    }

    pub(crate) fn start(
        &mut self,
        title: &str,
        ctx: &egui::Context,
        work: impl FnOnce(&Handle) -> Result<T, String> + Send + 'static,
    ) {
        self.problem = None;
        self.job = Some(Job::start(title, ctx, work));
    }

    /// The result, once.
    pub(crate) fn poll(&mut self) -> Option<T> {
        let outcome = self.job.as_ref().and_then(Job::poll)?;
        self.job = None;
        match outcome.and_then(|outcome| outcome) {
            Ok(result) => return Some(result),
            Err(sentence) if sentence == CANCELLED => {}
            Err(sentence) => self.problem = Some(sentence),
        }
        None
    }

    /// Draws the progress of what runs; whether something does.
    pub(crate) fn ui(&mut self, ui: &mut Ui) -> bool {
        let Some(job) = &self.job else { return false };
        if job.ui(ui) {
            self.job = None;
        }
        true
    }
}

/// Time from which on the remaining time is estimated, s, and the least progress for that, 1.
#[cfg(not(target_arch = "wasm32"))]
const KNOWN_AFTER_S: f64 = 2.0;
#[cfg(not(target_arch = "wasm32"))]
const KNOWN_FROM: f64 = 0.02;

/// `12 s, about 40 s left`
#[cfg(not(target_arch = "wasm32"))]
fn times(elapsed_s: f64, reached: f64) -> String {
    let elapsed = duration(elapsed_s);
    if elapsed_s < KNOWN_AFTER_S || !(KNOWN_FROM..1.0).contains(&reached) {
        return elapsed;
    }
    format!("{elapsed}, about {} left", duration(elapsed_s * (1.0 - reached) / reached))
}

/// `45 s`, `3 min 20 s`, `2 h 5 min`
#[cfg(not(target_arch = "wasm32"))]
fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..=119 => format!("{whole} s"),
        120..=7199 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole / 60 % 60),
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.handle.0.cancelled.store(true, Ordering::Relaxed);
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::*;

    #[test]
    fn the_remaining_time_follows_from_the_progress() {
        assert_eq!(times(1.0, 0.5), "1 s");
        assert_eq!(times(30.0, 0.0), "30 s");
        assert_eq!(times(30.0, 0.25), "30 s, about 90 s left");
        assert_eq!(times(600.0, 0.5), "10 min 0 s, about 10 min 0 s left");
    }
}
