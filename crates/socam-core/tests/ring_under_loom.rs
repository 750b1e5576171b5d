//! The ring's source with the atomics of loom, which runs two threads in every order that matters and lets each load return every
//! value stored before that the memory orderings allow. A processor shows few of these, and x86 shows hardly any.
//!
//! It catches a relaxed `head` on either side. It does not delay loads past a later store, which is what a relaxed `tail` would allow.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use loom::thread;
use socam_core::{Flags, MAX_CHANNELS, Sample};

mod atomic {
    use std::sync::OnceLock;

    use loom::sync::atomic;
    pub(crate) use loom::sync::atomic::Ordering;

    /// Loom's word cannot be made in a constant; it is made at the first access.
    ///
    /// Loom 0.7 remembers one access of each word. Where a thread loads a word that it stores next, it forgets the other thread's load
    /// and explores hardly any order (tokio-rs/loom issues 166 and 392). So each access is preceded by a relaxed store to a second
    /// word that nobody loads: it synchronises nothing, and two stores are never independent.
    #[derive(Debug)]
    #[expect(unreachable_pub, reason = "a public trait of the ring names it")]
    pub struct AtomicU32 {
        first: u32,
        words: OnceLock<[atomic::AtomicU32; 2]>,
    }

    impl AtomicU32 {
        pub(crate) const fn new(first: u32) -> Self {
            Self { first, words: OnceLock::new() }
        }

        fn word(&self) -> &atomic::AtomicU32 {
            let [word, access] = self.words.get_or_init(|| [self.first, 0].map(atomic::AtomicU32::new));
            access.store(0, Ordering::Relaxed);
            word
        }

        pub(crate) fn load(&self, ordering: Ordering) -> u32 {
            self.word().load(ordering)
        }

        pub(crate) fn store(&self, value: u32, ordering: Ordering) {
            self.word().store(value, ordering);
        }
    }
}

#[path = "../src/ring.rs"]
#[allow(unreachable_pub, dead_code, reason = "it is a library's file")]
mod ring;

use ring::{Consumer, Producer, Ring};

fn sample(seq: u32) -> Sample<i16> {
    let count = seq as i16 + 1;
    Sample {
        tick: seq + 100,
        seq,
        counts: [count; MAX_CHANNELS],
        output_count: count,
        setpoint_micro: -i32::from(count),
        segment: count as u16,
        flags: Flags(count as u8),
    }
}

/// Number of the sample that was in each slot before.
const STALE: u32 = 50;

/// Samples that a sender took, and whether it has cleared the ring meanwhile.
type Taken = (Vec<Sample<i16>>, bool);

/// Runs the interrupt, which pushes `PUSHES` samples, against `sender`, with at most `preemptions` changes of thread that nothing
/// forces, and checks that each sample arrives once, whole and in order, or is counted.
fn explore<const N: usize, const PUSHES: u32>(
    start: u32,
    preemptions: usize,
    sender: fn(&mut Consumer<'static, i16, N>) -> Taken,
) {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(preemptions);
    let runs = Arc::new(AtomicU32::new(0));
    let counted = runs.clone();
    model.check(move || {
        counted.fetch_add(1, Relaxed);
        // Threads of loom have no scope.
        let ring: &'static mut Ring<i16, N> = Box::leak(Box::new(Ring::starting_at(start)));
        let (mut producer, mut consumer): (Producer<'_, i16, N>, Consumer<'_, i16, N>) = ring.split();
        // Before there are two threads, every word is created and holds a value from an earlier sample.
        while producer.push(&sample(STALE)) {}
        while consumer.pop().is_some() {}
        let interrupt = thread::spawn(move || (0..PUSHES).filter(|seq| producer.push(&sample(*seq))).count());
        let (mut got, has_cleared) = sender(&mut consumer);
        let pushed = interrupt.join().unwrap();
        got.extend(std::iter::from_fn(|| consumer.pop()));
        assert!(got.iter().all(|s| *s == sample(s.seq) && s.seq != STALE), "a sample is torn: {got:?}");
        assert!(got.is_sorted_by(|a, b| a.seq < b.seq), "samples are out of order");
        assert_eq!(pushed as u32 + consumer.dropped(), PUSHES + 1, "a lost sample is not counted");
        assert!(
            got.len() == pushed || has_cleared && got.len() < pushed,
            "{} of {pushed} arrived",
            got.len()
        );
    });
    assert!(runs.load(Relaxed) > 1000, "hardly any order was explored");
}

#[test]
fn a_sender_takes_whole_samples_in_order_whatever_the_interrupt_does() {
    explore::<1, 3>(u32::MAX, 4, |consumer| ((0..2).filter_map(|_| consumer.pop()).collect(), false));
    explore::<2, 4>(u32::MAX - 2, 3, |consumer| ((0..3).filter_map(|_| consumer.pop()).collect(), false));
}

#[test]
fn a_sender_that_clears_the_ring_takes_whole_samples_in_order() {
    explore::<2, 3>(u32::MAX, 3, |consumer| {
        let first = consumer.pop();
        consumer.clear();
        (first.into_iter().chain(consumer.pop()).collect(), true)
    });
}
