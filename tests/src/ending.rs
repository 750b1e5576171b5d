//! The end of threads that stand for a device.

use std::sync::atomic::{AtomicBool, Ordering};

/// Tells the threads of a test to end when the test ends, also where it fails.
pub struct Ending<'o>(pub &'o AtomicBool);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
