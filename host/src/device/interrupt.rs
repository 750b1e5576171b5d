//! Ctrl-C: the first stops the bench, the second stops it at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Counts how often the operator wanted to stop.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt(Arc<AtomicU32>);

impl Interrupt {
    /// Listens to Ctrl-C and to a request to terminate.
    pub(crate) fn listen() -> Self {
        let interrupt = Self::default();
        let count = Arc::clone(&interrupt.0);
        // Without a handler Ctrl-C ends the process at once: the board's watchdog stops the bench then.
        let _ = ctrlc::set_handler(move || {
            count.fetch_add(1, Ordering::Relaxed);
        });
        interrupt
    }

    /// How often it was asked for.
    pub(crate) fn count(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}
