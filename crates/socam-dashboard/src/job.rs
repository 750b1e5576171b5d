//! Work that takes longer than a frame: on a thread of its own, with progress, and a way to cancel it.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};

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
        Self { handle, result }
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
        });
        if cancelled {
            self.cancel();
        }
        cancelled
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.handle.0.cancelled.store(true, Ordering::Relaxed);
    }
}
