//! The ring with the processor's atomics.

use std::collections::VecDeque;

use crate::{Flags, MAX_CHANNELS, Ring, Sample};

fn sample(seq: u32) -> Sample<i16> {
    of([i16::MAX, i16::MIN, -257, seq as i16, 5, 0, i16::MAX, -1], seq)
}

fn of<C>(counts: [C; MAX_CHANNELS], seq: u32) -> Sample<C> {
    Sample {
        tick: seq.wrapping_mul(3),
        seq,
        counts,
        output_count: -7,
        setpoint_micro: -1_000_000,
        segment: u16::MAX,
        flags: Flags(0x73),
    }
}

#[test]
fn what_goes_in_comes_out_in_order_and_the_rest_is_counted() {
    let mut ring = Ring::<i16, 4>::new();
    let (mut producer, mut consumer) = ring.split();
    for seq in 0..6 {
        assert_eq!(producer.push(&sample(seq)), seq < 4);
    }
    assert_eq!(producer.dropped(), 2);
    for seq in 0..4 {
        assert_eq!(consumer.pop(), Some(sample(seq)));
    }
    assert_eq!(consumer.pop(), None);
}

#[test]
fn wide_counts_come_out_whole() {
    let mut ring = Ring::<i32, 1>::new();
    let (mut producer, mut consumer) = ring.split();
    let wide = of([i32::MAX, i32::MIN, -65_537, 65_536, 5, i16::MIN.into(), -1, 0x1234_5678], 7);
    assert!(producer.push(&wide));
    assert_eq!(consumer.pop(), Some(wide));
}

#[test]
fn two_threads_lose_and_reorder_nothing_that_was_not_counted() {
    let mut ring = Ring::<i16, 64>::new();
    let (mut producer, mut consumer) = ring.split();
    const TOTAL: u32 = if cfg!(miri) { 300 } else { 200_000 };
    std::thread::scope(|scope| {
        scope.spawn(move || {
            for seq in 0..TOTAL {
                producer.push(&sample(seq));
            }
        });
        let (mut got, mut last) = (0u32, None);
        while last != Some(TOTAL - 1) && got + consumer.dropped() < TOTAL {
            while let Some(s) = consumer.pop() {
                assert_eq!(s, sample(s.seq));
                assert!(last.is_none_or(|l| s.seq > l));
                last = Some(s.seq);
                got += 1;
            }
        }
        while consumer.pop().is_some() {
            got += 1;
        }
        assert_eq!(got + consumer.dropped(), TOTAL);
    });
}

/// One sender and one interrupt in all orders of `STEPS` calls, from positions on both sides of the wrap: the ring is a queue of `N`.
fn behaves_as_a_queue<const N: usize>() {
    // Miri takes a thousand times as long.
    const STEPS: u32 = if cfg!(miri) { 4 } else { 9 };
    for start in (0..3 * N as u32).map(|back| u32::MAX.wrapping_sub(back).wrapping_add(2)) {
        for order in 0..1u32 << STEPS {
            let mut ring = Ring::<i16, N>::starting_at(start);
            let (mut producer, mut consumer) = ring.split();
            let (mut queue, mut lost) = (VecDeque::new(), 0);
            for step in 0..STEPS {
                if order >> step & 1 == 0 {
                    let fits = queue.len() < N;
                    assert_eq!(producer.push(&sample(step)), fits, "{N} from {start}, order {order:b}");
                    if fits { queue.push_back(step) } else { lost += 1 }
                } else {
                    let oldest = queue.pop_front().map(sample);
                    assert_eq!(consumer.peek(), oldest);
                    assert_eq!(consumer.pop(), oldest, "{N} from {start}, order {order:b}");
                }
                assert_eq!((consumer.len(), consumer.dropped()), (queue.len(), lost));
            }
            consumer.clear();
            assert!(consumer.is_empty() && producer.push(&sample(0)));
        }
    }
}

#[test]
fn every_order_of_calls_gives_what_a_queue_gives_also_where_positions_wrap() {
    behaves_as_a_queue::<1>();
    behaves_as_a_queue::<2>();
    behaves_as_a_queue::<4>();
}
