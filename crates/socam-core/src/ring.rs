//! A lock-free ring between the sampling interrupt and the sender.
//!
//! It consists of atomic words with loads and stores only: Cortex-M0+ has no compare-and-swap, and this needs no unsafe code. One side
//! writes `head`, the other `tail`; a sample is visible once `head` is released. `tests/ring_under_loom.rs` compiles this file with the
//! atomics of a model checker.

use core::fmt;

use crate::atomic::{AtomicU32, Ordering};
use crate::{Flags, MAX_CHANNELS, Sample};

/// Tick, sequence number, setpoint, output and segment, flags.
const COMMON: usize = 5;

/// Storage for `N` samples; `N` must be a power of two (checked at compile time).
#[derive(Debug)]
pub struct Ring<C: Stored, const N: usize> {
    slots: [C::Slot; N],
    head: AtomicU32,
    tail: AtomicU32,
    dropped: AtomicU32,
}

impl<C: Stored, const N: usize> Ring<C, N> {
    const SIZE_IS_POWER_OF_TWO: () = assert!(N.is_power_of_two() && N <= 1 << 16);

    /// An empty ring, usable in a `static`.
    pub const fn new() -> Self {
        Self::starting_at(0)
    }

    /// Creates an empty ring whose next position is `position`. For tests of wrap-around.
    pub(crate) const fn starting_at(position: u32) -> Self {
        let () = Self::SIZE_IS_POWER_OF_TWO;
        Self {
            slots: [const { C::EMPTY }; N],
            head: AtomicU32::new(position),
            tail: AtomicU32::new(position),
            dropped: AtomicU32::new(0),
        }
    }

    /// The two ends. Exclusive access guarantees that there is one of each.
    pub fn split(&mut self) -> (Producer<'_, C, N>, Consumer<'_, C, N>) {
        let ring = &*self;
        (Producer { ring }, Consumer { ring })
    }

    fn slot(&self, position: u32) -> Option<&C::Slot> {
        // The mask keeps the index below N.
        self.slots.get(position as usize & N.wrapping_sub(1))
    }
}

impl<C: Stored, const N: usize> Default for Ring<C, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The writing end, for the sampling interrupt.
#[derive(Debug)]
pub struct Producer<'r, C: Stored, const N: usize> {
    ring: &'r Ring<C, N>,
}

impl<C: Stored, const N: usize> Producer<'_, C, N> {
    /// Appends a sample; a full ring drops it, counts it and returns false.
    pub fn push(&mut self, sample: &Sample<C>) -> bool {
        let head = self.ring.head.load(Ordering::Relaxed);
        let used = head.wrapping_sub(self.ring.tail.load(Ordering::Acquire));
        let slot = self.ring.slot(head).filter(|_| (used as usize) < N);
        let Some(slot) = slot else {
            let dropped = self.ring.dropped.load(Ordering::Relaxed);
            self.ring.dropped.store(dropped.saturating_add(1), Ordering::Relaxed);
            return false;
        };
        C::store(sample, slot);
        self.ring.head.store(head.wrapping_add(1), Ordering::Release);
        true
    }

    /// Number of samples lost to a full ring since power-on.
    pub fn dropped(&self) -> u32 {
        self.ring.dropped.load(Ordering::Relaxed)
    }
}

/// The reading end, for the sender.
#[derive(Debug)]
pub struct Consumer<'r, C: Stored, const N: usize> {
    ring: &'r Ring<C, N>,
}

impl<C: Stored, const N: usize> Consumer<'_, C, N> {
    /// The oldest sample, removed.
    pub fn pop(&mut self) -> Option<Sample<C>> {
        let sample = self.peek()?;
        let tail = self.ring.tail.load(Ordering::Relaxed);
        self.ring.tail.store(tail.wrapping_add(1), Ordering::Release);
        Some(sample)
    }

    /// The oldest sample, left in place.
    pub fn peek(&self) -> Option<Sample<C>> {
        if self.is_empty() {
            return None;
        }
        let slot = self.ring.slot(self.ring.tail.load(Ordering::Relaxed))?;
        Some(C::load(slot))
    }

    /// Number of waiting samples.
    pub fn len(&self) -> usize {
        let head = self.ring.head.load(Ordering::Acquire);
        head.wrapping_sub(self.ring.tail.load(Ordering::Relaxed)) as usize
    }

    /// Whether no sample waits.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Drops all waiting samples.
    pub fn clear(&mut self) {
        let head = self.ring.head.load(Ordering::Acquire);
        self.ring.tail.store(head, Ordering::Release);
    }

    /// Number of samples lost to a full ring since power-on.
    pub fn dropped(&self) -> u32 {
        self.ring.dropped.load(Ordering::Relaxed)
    }
}

/// A count as samples in a ring hold it.
pub trait Stored: Copy {
    /// The words of a sample.
    type Slot: fmt::Debug;
    /// A slot that no sample was written to.
    const EMPTY: Self::Slot;

    /// Writes a sample to a slot.
    fn store(sample: &Sample<Self>, slot: &Self::Slot);

    /// Reads the sample of a slot.
    fn load(slot: &Self::Slot) -> Sample<Self>;
}

impl Stored for i16 {
    type Slot = [AtomicU32; COMMON + MAX_CHANNELS / 2];
    #[expect(clippy::declare_interior_mutable_const, reason = "each use is a slot of its own")]
    const EMPTY: Self::Slot = [const { AtomicU32::new(0) }; COMMON + MAX_CHANNELS / 2];

    fn store(sample: &Sample<Self>, slot: &Self::Slot) {
        let [a, b, c, d, e, f, g, h] = sample.counts;
        let [tick, seq, output, setpoint, flags] = pack(sample);
        put(slot, [tick, seq, pair(a, b), pair(c, d), pair(e, f), pair(g, h), output, setpoint, flags]);
    }

    fn load(slot: &Self::Slot) -> Sample<Self> {
        let [tick, seq, ab, cd, ef, gh, output, setpoint, flags] = get(slot);
        let ([a, b], [c, d], [e, f], [g, h]) = (unpair(ab), unpair(cd), unpair(ef), unpair(gh));
        unpack([tick, seq, output, setpoint, flags], [a, b, c, d, e, f, g, h])
    }
}

impl Stored for i32 {
    type Slot = [AtomicU32; COMMON + MAX_CHANNELS];
    #[expect(clippy::declare_interior_mutable_const, reason = "each use is a slot of its own")]
    const EMPTY: Self::Slot = [const { AtomicU32::new(0) }; COMMON + MAX_CHANNELS];

    fn store(sample: &Sample<Self>, slot: &Self::Slot) {
        let [a, b, c, d, e, f, g, h] = sample.counts.map(|count| count as u32);
        let [tick, seq, output, setpoint, flags] = pack(sample);
        put(slot, [tick, seq, a, b, c, d, e, f, g, h, output, setpoint, flags]);
    }

    fn load(slot: &Self::Slot) -> Sample<Self> {
        let [tick, seq, counts @ .., output, setpoint, flags] = get(slot);
        unpack([tick, seq, output, setpoint, flags], counts.map(|count| count as i32))
    }
}

fn put<const W: usize>(slot: &[AtomicU32; W], words: [u32; W]) {
    for (word, value) in slot.iter().zip(words) {
        word.store(value, Ordering::Relaxed);
    }
}

fn get<const W: usize>(slot: &[AtomicU32; W]) -> [u32; W] {
    slot.each_ref().map(|word| word.load(Ordering::Relaxed))
}

fn pair(low: i16, high: i16) -> u32 {
    u32::from(low as u16) | (u32::from(high as u16) << 16)
}

fn unpair(word: u32) -> [i16; 2] {
    [word as u16 as i16, (word >> 16) as u16 as i16]
}

/// All of a sample but its counts.
fn pack<C>(sample: &Sample<C>) -> [u32; COMMON] {
    [
        sample.tick,
        sample.seq,
        pair(sample.output_count, sample.segment as i16),
        sample.setpoint_micro as u32,
        u32::from(sample.flags.0),
    ]
}

fn unpack<C>([tick, seq, output, setpoint, flags]: [u32; COMMON], counts: [C; MAX_CHANNELS]) -> Sample<C> {
    let [output_count, segment] = unpair(output);
    Sample {
        tick,
        seq,
        counts,
        output_count,
        setpoint_micro: setpoint as i32,
        segment: segment as u16,
        flags: Flags(flags as u8),
    }
}
