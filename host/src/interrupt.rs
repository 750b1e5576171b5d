//! Ctrl-C: the first asks for an end, the last that is waited for ends the process at once.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::output;

/// Exit code of whoever did not want to wait: that of a program without a handler, as shells tell it.
const ENDED_AT_ONCE: i32 = 130;

/// The process has one handler.
static LISTENER: OnceLock<Interrupt> = OnceLock::new();

/// Counts how often the operator wanted to stop.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt(Arc<State>);

#[derive(Debug, Default)]
struct State {
    count: AtomicU32,
    /// At this count the process ends; zero is never.
    last: AtomicU32,
    /// A file that would be left behind half-written then.
    unfinished: Mutex<Option<PathBuf>>,
}

impl Interrupt {
    /// Listens to Ctrl-C and to a request to terminate.
    pub(crate) fn listen() -> Self {
        let start = || {
            let interrupt = Self::default();
            let own = interrupt.clone();
            // Without a handler Ctrl-C ends the process at once: the board's watchdog stops the bench then.
            let _ = ctrlc::set_handler(move || own.take());
            interrupt
        };
        LISTENER.get_or_init(start).clone()
    }

    /// How often it was asked for.
    pub(crate) fn count(&self) -> u32 {
        self.0.count.load(Ordering::Relaxed)
    }

    /// From now on the operator's next wish but `patience` ends the process at once.
    pub(crate) fn end_after(&self, patience: u32) {
        self.0.last.store(self.count() + patience + 1, Ordering::Relaxed);
    }

    /// A file to be removed in that case.
    pub(crate) fn unfinished(&self, file: Option<&Path>) {
        *self.0.unfinished.lock().unwrap_or_else(PoisonError::into_inner) = file.map(Into::into);
    }

    fn take(&self) {
        let count = self.0.count.fetch_add(1, Ordering::Relaxed) + 1;
        let last = self.0.last.load(Ordering::Relaxed);
        if last > 0 && count >= last {
            // Held until the end, so that nobody puts another there.
            let unfinished = self.0.unfinished.lock().unwrap_or_else(PoisonError::into_inner);
            unfinished.iter().for_each(|file| drop(std::fs::remove_file(file)));
            output::say("ended at once");
            std::process::exit(ENDED_AT_ONCE);
        }
        if last > 0 {
            output::say("\nending with what there is; Ctrl-C once more ends at once");
        }
    }
}
