//! A place for one value, between the sampling interrupt and the rest of the program.
//!
//! Neither side ever waits or locks: whose turn it is stands in one flag. (Queues of libraries divide by their length at run time,
//! which leaves a panic in the interrupt.)

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

/// The place.
pub(crate) struct Slot<T> {
    is_full: AtomicBool,
    value: UnsafeCell<Option<T>>,
}

// SAFETY: the value is touched by whoever the flag allows: the one `Filler` while it is down, the one `Taker` while it is up.
unsafe impl<T: Send> Sync for Slot<T> {}

impl<T> Slot<T> {
    /// Empty.
    pub(crate) const fn new() -> Self {
        Self { is_full: AtomicBool::new(false), value: UnsafeCell::new(None) }
    }

    /// The two ends. Exclusive access guarantees that there is one of each.
    pub(crate) fn split(&mut self) -> (Filler<'_, T>, Taker<'_, T>) {
        let slot = &*self;
        (Filler { slot }, Taker { slot })
    }
}

/// The end that puts values in.
pub(crate) struct Filler<'s, T> {
    slot: &'s Slot<T>,
}

impl<T> Filler<'_, T> {
    /// Whether there is room.
    pub(crate) fn has_room(&self) -> bool {
        !self.slot.is_full.load(Ordering::Acquire)
    }

    /// Puts a value in; it is dropped where there is no room.
    pub(crate) fn put(&mut self, value: T) {
        if self.has_room() {
            // SAFETY: the flag is down, so only this end, of which there is one, touches the value.
            unsafe { *self.slot.value.get() = Some(value) };
            self.slot.is_full.store(true, Ordering::Release);
        }
    }
}

/// The end that takes values out.
pub(crate) struct Taker<'s, T> {
    slot: &'s Slot<T>,
}

impl<T> Taker<'_, T> {
    /// The value, if there is one.
    pub(crate) fn take(&mut self) -> Option<T> {
        if !self.slot.is_full.load(Ordering::Acquire) {
            return None;
        }
        // SAFETY: the flag is up, so only this end, of which there is one, touches the value.
        let value = unsafe { (*self.slot.value.get()).take() };
        self.slot.is_full.store(false, Ordering::Release);
        value
    }
}
