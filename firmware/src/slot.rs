//! A slot for one value, between the sampling interrupt and the rest of the program.
//!
//! Neither side waits or locks: one flag says which side may access the value. (Queues of libraries divide by their length at run
//! time, which would leave a panic in the interrupt.)

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

/// The slot.
pub(crate) struct Slot<T> {
    is_full: AtomicBool,
    value: UnsafeCell<Option<T>>,
}

// SAFETY: only the side that the flag allows accesses the value: the one `Filler` while it is down, the one `Taker` while it is up.
unsafe impl<T: Send> Sync for Slot<T> {}

impl<T> Slot<T> {
    /// An empty slot.
    pub(crate) const fn new() -> Self {
        Self { is_full: AtomicBool::new(false), value: UnsafeCell::new(None) }
    }

    /// The two ends. Exclusive access guarantees that there is one of each.
    pub(crate) fn split(&mut self) -> (Filler<'_, T>, Taker<'_, T>) {
        let slot = &*self;
        (Filler { slot }, Taker { slot })
    }
}

/// The writing end.
pub(crate) struct Filler<'s, T> {
    slot: &'s Slot<T>,
}

impl<T> Filler<'_, T> {
    /// Whether there is room.
    pub(crate) fn has_room(&self) -> bool {
        !self.slot.is_full.load(Ordering::Acquire)
    }

    /// Writes a value; it is dropped when the slot is full.
    pub(crate) fn put(&mut self, value: T) {
        if self.has_room() {
            // SAFETY: the flag is down, so only this end, of which there is one, accesses the value.
            unsafe { *self.slot.value.get() = Some(value) };
            self.slot.is_full.store(true, Ordering::Release);
        }
    }
}

/// The reading end.
pub(crate) struct Taker<'s, T> {
    slot: &'s Slot<T>,
}

impl<T> Taker<'_, T> {
    /// The value, if there is one.
    pub(crate) fn take(&mut self) -> Option<T> {
        if !self.slot.is_full.load(Ordering::Acquire) {
            return None;
        }
        // SAFETY: the flag is up, so only this end, of which there is one, accesses the value.
        let value = unsafe { (*self.slot.value.get()).take() };
        self.slot.is_full.store(false, Ordering::Release);
        value
    }
}

// The one `unsafe` that another thread of control depends on. The file is a program of its own for Miri: see `docs/reliability.md`.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_pass_once_and_in_order_between_two_threads() {
        let mut slot = Slot::new();
        let (mut filler, mut taker) = slot.split();
        const LAST: u32 = 100;
        std::thread::scope(|scope| {
            scope.spawn(move || {
                for number in 0..=LAST {
                    while !filler.has_room() {
                        std::hint::spin_loop();
                    }
                    filler.put(Box::new(number));
                }
            });
            let mut next = 0;
            while next <= LAST {
                let Some(number) = taker.take() else { continue };
                assert_eq!(*number, next);
                next += 1;
            }
        });
    }
}
