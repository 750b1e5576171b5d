//! How many devices are attended to, so that the program does not end before they are left in order.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// The devices that are attended to, each by a thread.
#[derive(Clone, Default)]
pub(super) struct Attended(Arc<AtomicUsize>);

/// A device that is attended to, until this is dropped.
pub(super) struct Attending(Arc<AtomicUsize>);

impl Attended {
    /// Begins to attend to a device.
    pub(super) fn begin(&self) -> Attending {
        self.0.fetch_add(1, Ordering::SeqCst);
        Attending(self.0.clone())
    }

    /// Waits until none is attended to any more: what moves is stopped, and its file is closed. Returns whether that is so.
    pub(super) fn wait(&self, patience: Duration) -> bool {
        let begin = Instant::now();
        while self.0.load(Ordering::SeqCst) > 0 && begin.elapsed() < patience {
            std::thread::sleep(Duration::from_millis(5));
        }
        self.0.load(Ordering::SeqCst) == 0
    }
}

impl Drop for Attending {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}
