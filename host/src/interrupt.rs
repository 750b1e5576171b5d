//! Ctrl-C ends the process at once, unless a command responds to it: a search ends with its best result, a bench is stopped.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::output;

/// Exit code after an interrupt that ended the process or its search: that of a program without a handler, as shells report it.
pub(crate) const INTERRUPTED: u8 = 130;

/// The process has one handler.
static LISTENER: OnceLock<Interrupt> = OnceLock::new();

/// Counts how often the operator wanted to stop.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt(Arc<State>);

#[derive(Debug, Default)]
struct State {
    count: AtomicU32,
    /// Count of interrupts at which the process ends; at zero it never ends.
    last: AtomicU32,
    /// Whether the command itself prints a message at the earlier interrupts.
    is_answered: AtomicBool,
    /// A file that would otherwise be left half-written when the process ends at once.
    unfinished: Mutex<Option<PathBuf>>,
}

impl Interrupt {
    /// Listens to Ctrl-C and to a request to terminate. The first one ends the process at once, unless the command handles it.
    pub(crate) fn listen() -> Self {
        let start = || {
            let interrupt = Self::default();
            interrupt.end_after(0);
            let own = interrupt.clone();
            // Without a handler Ctrl-C ends the process at once: the board's watchdog stops the bench then.
            let _ = ctrlc::set_handler(move || own.take());
            interrupt
        };
        LISTENER.get_or_init(start).clone()
    }

    /// Number of interrupts so far.
    pub(crate) fn count(&self) -> u32 {
        self.0.count.load(Ordering::Relaxed)
    }

    /// From now on the process ends at once at the interrupt after the next `patience` ones. This handler tells the operator so.
    pub(crate) fn end_after(&self, patience: u32) {
        self.0.is_answered.store(false, Ordering::Relaxed);
        self.set_last(patience + 1);
    }

    /// From now on the command itself responds to the next `times` interrupts; the one after these ends the process at once.
    pub(crate) fn answer(&self, times: u32) {
        self.0.is_answered.store(true, Ordering::Relaxed);
        self.set_last(times + 1);
    }

    fn set_last(&self, more: u32) {
        self.0.last.store(self.count() + more, Ordering::Relaxed);
    }

    /// Sets the file to remove if the process ends at once.
    pub(crate) fn unfinished(&self, file: Option<&Path>) {
        *self.0.unfinished.lock().unwrap_or_else(PoisonError::into_inner) = file.map(Into::into);
    }

    /// Ends the process, and removes its unfinished file.
    fn end(&self, why: &str) -> ! {
        // The lock is held until the process ends, so that no other file is stored there.
        let unfinished = self.0.unfinished.lock().unwrap_or_else(PoisonError::into_inner);
        unfinished.iter().for_each(|file| drop(std::fs::remove_file(file)));
        output::say(why);
        std::process::exit(INTERRUPTED.into());
    }

    fn take(&self) {
        let count = self.0.count.fetch_add(1, Ordering::Relaxed) + 1;
        let last = self.0.last.load(Ordering::Relaxed);
        if last > 0 && count >= last {
            self.end("ended at once");
        }
        if last > 0 && !self.0.is_answered.load(Ordering::Relaxed) {
            output::say("\nending with what there is; Ctrl-C once more ends at once");
        }
    }
}
