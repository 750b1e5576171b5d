use super::*;

fn row(device_s: Option<f64>, number: Option<u64>, arrival_s: f64) -> Row {
    Row {
        device_s,
        number,
        arrival_ns: (arrival_s * 1e9).round() as i64,
        spread_ns: 2_000_000,
        values: Vec::new(),
    }
}

fn at(placed: Placed) -> (f64, u64, bool) {
    match placed {
        Placed::At { time_ns, sequence, jumped } => (time_ns as f64 * 1e-9, sequence, jumped),
        other => panic!("{other:?}"),
    }
}

/// Places rows of 100 Hz, the host's clock running `drift` slower and each row delayed by up to 8 ms.
fn run(timeline: &mut Timeline, rows: std::ops::Range<u64>, drift: f64) {
    for k in rows {
        let t = 0.01 * k as f64;
        let delay = 0.001 * ((k * 7) % 9) as f64;
        let _ = timeline.place(&row(Some(100.0 + t), None, 5.0 + t / (1.0 + drift) + delay));
    }
}

#[test]
fn a_devices_clock_is_kept_and_compared_with_the_hosts() {
    let mut timeline = Timeline::new(Numbering::Clock, None);
    run(&mut timeline, 0..3000, 50e-6);
    let (time_s, sequence, jumped) = at(timeline.place(&row(Some(130.02), None, 35.03)));
    assert!((time_s - 30.02).abs() < 1e-9 && sequence == 3002 && !jumped, "{time_s} {sequence}");
    let map = timeline.clock_map().unwrap();
    assert!((map.drift - 50e-6).abs() < 5e-6, "{map:?}");
    assert!(map.uncertainty_s < 1e-4 && (map.latest_s - 0.008).abs() < 1e-3, "{map:?}");
    assert!(timeline.counted_by().contains("0.010000 s"), "{}", timeline.counted_by());
    assert_eq!(timeline.counts(), Counts::default());
}

#[test]
fn numbers_count_what_is_lost_and_begin_anew() {
    let mut timeline = Timeline::new(Numbering::Numbered(256), None);
    let mut place = |number: u64, s: f64| timeline.place(&row(None, Some(number), s));
    assert_eq!(at(place(250, 1.0)).1, 0);
    assert_eq!(at(place(253, 1.1)).1, 3);
    assert_eq!(at(place(2, 1.2)).1, 8);
    assert_eq!(place(2, 1.3), Placed::Repeated);
    assert!((at(place(3, 1.3)).0 - 0.3).abs() < 1e-9);
}

#[test]
fn late_repeated_and_restarted_rows_are_told_apart() {
    let mut timeline = Timeline::new(Numbering::Clock, None);
    run(&mut timeline, 0..100, 0.0);
    assert_eq!(timeline.place(&row(Some(100.99), None, 6.0)), Placed::Repeated);
    assert_eq!(timeline.place(&row(Some(100.95), None, 6.0)), Placed::Late);
    // The clock begins anew, and goes on by the host's time.
    let (time_s, sequence, jumped) = at(timeline.place(&row(Some(0.0), None, 8.0)));
    assert!(jumped && (time_s - 2.99).abs() < 0.02 && (298..=300).contains(&sequence), "{time_s} {sequence}");
    // It jumps an hour ahead.
    let (time_s, _, jumped) = at(timeline.place(&row(Some(3600.0), None, 8.01)));
    assert!(jumped && (time_s - 3.0).abs() < 0.02, "{time_s}");
    let (next_s, ..) = at(timeline.place(&row(Some(3600.01), None, 8.02)));
    assert!((next_s - time_s - 0.01).abs() < 1e-6);
    assert_eq!(timeline.counts(), Counts { repeated: 1, late: 1, jumps: 2, damaged: 0 });
}

#[test]
fn a_clock_that_stands_still_is_one_jump_and_the_hosts_goes_on() {
    let mut timeline = Timeline::new(Numbering::Numbered(0), None);
    let mut place = |k: u64, stood: bool| {
        let t = 0.01 * k as f64;
        at(timeline.place(&row(Some(if stood { 1.0 } else { t }), Some(k), 5.0 + t)))
    };
    (0..100).for_each(|k| assert!(!place(k, false).2));
    let stopped: Vec<_> = (100..300).map(|k| place(k, true)).collect();
    assert_eq!(stopped.iter().filter(|placed| placed.2).count(), 1);
    // From when it is noticed on, rows are as far apart as they arrive.
    assert!((stopped[199].0 - stopped[99].0 - 1.0).abs() < 1e-6, "{stopped:?}");
    assert!(place(300, false).2 && !place(301, false).2);
    assert_eq!(timeline.counts().jumps, 2);
}

#[test]
fn a_clock_that_wraps_goes_on() {
    let wrap_s = 4_294.967_296;
    let mut timeline = Timeline::new(Numbering::Clock, Some(wrap_s));
    for k in 0..100 {
        let device_s = (wrap_s - 0.5 + 0.01 * f64::from(k)) % wrap_s;
        let (time_s, sequence, _) = at(timeline.place(&row(Some(device_s), None, 0.01 * f64::from(k))));
        assert!((time_s - 0.01 * f64::from(k)).abs() < 1e-6 && sequence == u64::try_from(k).unwrap());
    }
    assert_eq!(timeline.counts().jumps, 0);
}

#[test]
fn without_clock_and_number_damaged_rows_count() {
    let mut timeline = Timeline::new(Numbering::Arrival, None);
    assert_eq!(at(timeline.place(&row(None, None, 1.0))), (0.0, 0, false));
    timeline.damaged();
    // Two rows of one read.
    let (first, second) =
        (at(timeline.place(&row(None, None, 1.5))), at(timeline.place(&row(None, None, 1.5))));
    assert_eq!((first.1, second.1), (2, 3));
    assert!(second.0 > first.0);
    assert_eq!((timeline.counts().damaged, timeline.arrival_spread_s()), (1, 0.002));
}

/// A clock coarser than its jitter: two rows in one tick and none in the next is not a loss, a row that is missing is one.
#[test]
fn rows_that_share_a_tick_are_not_followed_by_a_loss() {
    let mut timeline = Timeline::new(Numbering::Clock, None);
    run(&mut timeline, 0..100, 0.0);
    let mut place = |s: f64| at(timeline.place(&row(Some(100.0 + s), None, 5.0 + s))).1;
    assert_eq!([place(1.0), place(1.000_001), place(1.02)], [100, 101, 102]);
    assert_eq!([place(1.03), place(1.05)], [103, 105]);
}
