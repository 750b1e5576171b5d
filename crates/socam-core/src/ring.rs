//! A lock-free ring between the sampling interrupt and the sender.
//!
//! It consists of atomic words with loads and stores only: Cortex-M0+ has no compare-and-swap, and this needs no unsafe code. One side
//! writes `head`, the other `tail`; a sample is visible once `head` is released. `tests/ring_under_loom.rs` compiles this file with the
//! atomics of a model checker.

use crate::atomic::{AtomicU32, Ordering};
use crate::{Flags, MAX_CHANNELS, Sample, WIDE_CHANNELS};

/// Tick, sequence number, setpoint, output and segment, flags; the lower halves of all counts, and the upper ones of those that may be wide.
const WORDS: usize = 5 + MAX_CHANNELS / 2 + WIDE_CHANNELS / 2;

type Slot = [AtomicU32; WORDS];

/// Storage for `N` samples; `N` must be a power of two (checked at compile time).
#[derive(Debug)]
pub struct Ring<const N: usize> {
    slots: [Slot; N],
    head: AtomicU32,
    tail: AtomicU32,
    dropped: AtomicU32,
}

impl<const N: usize> Ring<N> {
    const SIZE_IS_POWER_OF_TWO: () = assert!(N.is_power_of_two() && N <= 1 << 16);

    /// An empty ring, usable in a `static`.
    pub const fn new() -> Self {
        Self::starting_at(0)
    }

    /// Creates an empty ring whose next position is `position`. For tests of wrap-around.
    pub(crate) const fn starting_at(position: u32) -> Self {
        let () = Self::SIZE_IS_POWER_OF_TWO;
        Self {
            slots: [const { [const { AtomicU32::new(0) }; WORDS] }; N],
            head: AtomicU32::new(position),
            tail: AtomicU32::new(position),
            dropped: AtomicU32::new(0),
        }
    }

    /// The two ends. Exclusive access guarantees that there is one of each.
    pub fn split(&mut self) -> (Producer<'_, N>, Consumer<'_, N>) {
        let ring = &*self;
        (Producer { ring }, Consumer { ring })
    }

    fn slot(&self, position: u32) -> Option<&Slot> {
        // The mask keeps the index below N.
        self.slots.get(position as usize & N.wrapping_sub(1))
    }
}

impl<const N: usize> Default for Ring<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// The writing end, for the sampling interrupt.
#[derive(Debug)]
pub struct Producer<'r, const N: usize> {
    ring: &'r Ring<N>,
}

impl<const N: usize> Producer<'_, N> {
    /// Appends a sample; a full ring drops it, counts it and returns false.
    pub fn push(&mut self, sample: &Sample) -> bool {
        let head = self.ring.head.load(Ordering::Relaxed);
        let used = head.wrapping_sub(self.ring.tail.load(Ordering::Acquire));
        let slot = self.ring.slot(head).filter(|_| (used as usize) < N);
        let Some(slot) = slot else {
            let dropped = self.ring.dropped.load(Ordering::Relaxed);
            self.ring.dropped.store(dropped.saturating_add(1), Ordering::Relaxed);
            return false;
        };
        for (word, value) in slot.iter().zip(pack(sample)) {
            word.store(value, Ordering::Relaxed);
        }
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
pub struct Consumer<'r, const N: usize> {
    ring: &'r Ring<N>,
}

impl<const N: usize> Consumer<'_, N> {
    /// The oldest sample, removed.
    pub fn pop(&mut self) -> Option<Sample> {
        let sample = self.peek()?;
        let tail = self.ring.tail.load(Ordering::Relaxed);
        self.ring.tail.store(tail.wrapping_add(1), Ordering::Release);
        Some(sample)
    }

    /// The oldest sample, left in place.
    pub fn peek(&self) -> Option<Sample> {
        if self.is_empty() {
            return None;
        }
        let slot = self.ring.slot(self.ring.tail.load(Ordering::Relaxed))?;
        Some(unpack(slot))
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

fn pair(low: i16, high: i16) -> u32 {
    u32::from(low as u16) | (u32::from(high as u16) << 16)
}

fn unpair(word: u32) -> [i16; 2] {
    [word as u16 as i16, (word >> 16) as u16 as i16]
}

/// A count that is sent in 16 bits.
fn narrow(count: i32) -> i16 {
    count.max(i16::MIN.into()).min(i16::MAX.into()) as i16
}

/// A count of which both halves are kept.
fn whole(low: i16, high: i16) -> i32 {
    pair(low, high) as i32
}

fn pack(sample: &Sample) -> [u32; WORDS] {
    let [a, b, c, d, e, f, g, h] = sample.counts;
    [
        sample.tick,
        sample.seq,
        pair(a as i16, b as i16),
        pair(c as i16, d as i16),
        pair(narrow(e), narrow(f)),
        pair(narrow(g), narrow(h)),
        pair((a >> 16) as i16, (b >> 16) as i16),
        pair((c >> 16) as i16, (d >> 16) as i16),
        pair(sample.output_count, sample.segment as i16),
        sample.setpoint_micro as u32,
        u32::from(sample.flags.0),
    ]
}

fn unpack(slot: &Slot) -> Sample {
    let [tick, seq, ab, cd, ef, gh, ab_high, cd_high, output, setpoint, flags] =
        slot.each_ref().map(|word| word.load(Ordering::Relaxed));
    let ([a, b], [c, d], [e, f], [g, h]) = (unpair(ab), unpair(cd), unpair(ef), unpair(gh));
    let ([a_high, b_high], [c_high, d_high]) = (unpair(ab_high), unpair(cd_high));
    let [output_count, segment] = unpair(output);
    Sample {
        tick,
        seq,
        counts: [
            whole(a, a_high),
            whole(b, b_high),
            whole(c, c_high),
            whole(d, d_high),
            e.into(),
            f.into(),
            g.into(),
            h.into(),
        ],
        output_count,
        setpoint_micro: setpoint as i32,
        segment: segment as u16,
        flags: Flags(flags as u8),
    }
}
