use std::vec::Vec;

use proptest::prelude::*;

use super::clock::PeriodClock;
use super::*;

const PERIOD_US: u32 = 1000;

fn profile(shape: Shape) -> Profile {
    Profile {
        command: Command::Voltage,
        shape,
        ramp_us: 0,
        limit_micro: 4_000_000,
        slew_micro_s: u32::MAX,
        duration_us: 20_000_000,
    }
}

fn values(shape: Shape, samples: usize) -> Vec<i32> {
    let mut generator = Generator::new(&profile(shape), PERIOD_US).unwrap();
    (0..samples).map(|_| generator.step().value_micro).collect()
}

const SINE: Shape = Shape::Sine {
    offset_micro: 1_880_000,
    amplitude_micro: 500_000,
    frequency_uhz: 2_000_000,
    periods: Some(10),
};
const STAIRCASE: Shape = Shape::Staircase {
    first_micro: 800_000,
    step_micro: 200_000,
    count: 4,
    dwell_us: 500_000,
    and_back: true,
};
const TRIANGLE: Shape = Shape::Triangle { offset_micro: 0, amplitude_micro: 1_500_000, period_us: 4_000_000 };
const CHIRP: Shape = Shape::Chirp {
    offset_micro: 1_000_000,
    amplitude_micro: 300_000,
    start_uhz: 500_000,
    end_uhz: 150_000_000,
    sweep_us: 10_000_000,
};
const PRBS: Shape =
    Shape::Prbs { offset_micro: 1_000_000, amplitude_micro: 200_000, bit_us: 5000, order: 9, seed: 1 };
const MULTISINE: Shape = Shape::Multisine {
    offset_micro: 1_000_000,
    line_micro: 30_000,
    period_us: 2_000_000,
    lines: Lines::Odd,
    first_line: 1,
    last_line: 300,
    seed: 7,
};

/// The samples are a contract between board and host, and between versions: a change here changes recordings.
#[test]
fn every_shape_keeps_its_samples_bit_for_bit() {
    let hash = |shape| {
        let mut faded = profile(shape);
        faded.ramp_us = 500_000;
        faded.slew_micro_s = 500_000_000;
        let mut generator = Generator::new(&faded, PERIOD_US).unwrap();
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        for _ in 0..21_000 {
            for byte in generator.step().value_micro.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
            }
        }
        std::format!("{hash:016x}")
    };
    let constant = Shape::Constant { level_micro: 1_234_567 };
    let golden = [constant, STAIRCASE, SINE, TRIANGLE, CHIRP, PRBS, MULTISINE].map(hash);
    let pinned = [
        "e0b7bf95fe22b6b6",
        "f330fc37a3ab8669",
        "541fba49e13be164",
        "f29d515445987191",
        "4339ebbab0754e1e",
        "740e2613824d62c7",
        "4403cf8f2ce8d69f",
    ];
    assert_eq!(golden, pinned);
}

#[test]
fn the_thesis_program_is_ten_periods_then_zero() {
    let mut generator = Generator::new(&profile(SINE), PERIOD_US).unwrap();
    let samples: Vec<_> = (0..5001).map(|_| generator.step()).collect();
    for (n, sample) in samples.iter().take(5000).enumerate() {
        let exact = 1.88e6 + 0.5e6 * (core::f64::consts::TAU * 2.0 * n as f64 * 1e-3).sin();
        assert!((f64::from(sample.value_micro) - exact).abs() < 3.5, "sample {n}");
        assert_eq!(usize::from(sample.segment), n / 500);
        assert!(!sample.finished && !sample.limited);
    }
    assert_eq!((samples[5000].value_micro, samples[5000].finished), (0, true));
}

#[test]
fn staircase_climbs_and_descends() {
    let levels: Vec<_> = values(STAIRCASE, 4000).chunks(500).map(|level| (level[0], level[499])).collect();
    let expected = [8, 10, 12, 14, 12, 10, 8, 10].map(|v| (v * 100_000, v * 100_000));
    assert_eq!(levels, expected);
    let single = Shape::Staircase { first_micro: 5, step_micro: 9, count: 1, dwell_us: 1000, and_back: true };
    assert_eq!(values(single, 3), [5, 5, 5]);
}

#[test]
fn triangle_goes_straight_through_zero() {
    let v = values(TRIANGLE, 8000);
    assert_eq!((v[0], v[1000], v[2000], v[3000]), (0, 1_500_000, 0, -1_500_000));
    assert!(v.windows(2).all(|w| (w[1] - w[0]).abs().abs_diff(1500) <= 1));
    assert_eq!(v[..4000], v[4000..]);
}

#[test]
fn chirp_takes_equal_times_for_equal_factors_both_ways() {
    for (start, end) in [(0.5, 150.0), (150.0, 0.5)] {
        let (sweep_s, rate) = (10.0, f64::ln(end / start) / 10.0);
        let shape = Shape::Chirp {
            offset_micro: 0,
            amplitude_micro: 1_000_000,
            start_uhz: (start * 1e6) as u32,
            end_uhz: (end * 1e6) as u32,
            sweep_us: (sweep_s * 1e6) as u32,
        };
        // The frequency is held over each sample, so the phase is the sum of a geometric series.
        let growth = (rate * 1e-3).exp();
        let v = values(shape, 10_000);
        for n in (0..10_000).step_by(97) {
            let turns = start * 1e-3 * (growth.powi(n) - 1.0) / (growth - 1.0);
            let exact = (core::f64::consts::TAU * turns).sin();
            assert!(
                (f64::from(v[n as usize]) * 1e-6 - exact).abs() < 1e-5,
                "{start} to {end} Hz, sample {n}"
            );
        }
    }
}

#[test]
fn every_prbs_order_has_maximum_length() {
    for order in 3..=16u8 {
        let mut prbs = prbs::Prbs::new(0, 1, PERIOD_US, order, 1, PERIOD_US).unwrap();
        let length = (1u32 << order) - 1;
        let segments: Vec<_> = (0..=length).map(|_| prbs.step().segment).collect();
        assert_eq!(segments.iter().position(|&s| s == 1), Some(length as usize), "order {order}");
        let mut prbs = prbs::Prbs::new(0, 1, PERIOD_US, order, 0, PERIOD_US).unwrap();
        let sum: i32 = (0..length).map(|_| prbs.step().value_micro).sum();
        assert_eq!(sum, 1, "order {order} is not balanced");
    }
}

#[test]
fn multisine_has_its_lines_and_nothing_else() {
    let v = values(MULTISINE, 4000);
    assert_eq!(v[..2000], v[2000..], "not periodic");
    let line = |k: usize| {
        let (mut re, mut im) = (0.0, 0.0);
        for (n, &value) in v[..2000].iter().enumerate() {
            let angle = core::f64::consts::TAU * ((k * n) % 2000) as f64 / 2000.0;
            re += f64::from(value) * angle.cos();
            im += f64::from(value) * angle.sin();
        }
        re.hypot(im) / 1000.0
    };
    for k in 1..320 {
        let expected = if k % 2 == 1 && k < 300 { 30_000.0 } else { 0.0 };
        assert!((line(k) - expected).abs() < 3.0, "line {k} is {}", line(k));
    }
    let peak = Generator::peak_micro(&MULTISINE, PERIOD_US).unwrap();
    assert_eq!(i64::from(v.iter().map(|x| x.abs()).max().unwrap()), peak);
}

#[test]
fn a_period_that_does_not_divide_the_turn_is_still_exact() {
    for period in [2u32, 3, 7, 1000, 1999, 4_000_037] {
        let mut clock = PeriodClock::new(period);
        for n in 0..u64::from(period.min(5000)) {
            assert_eq!(u64::from(clock.step()), (n << 32) / u64::from(period));
        }
    }
    let mut clock = PeriodClock::new(1999);
    let turns: Vec<_> = (0..3 * 1999).map(|_| clock.step()).collect();
    assert_eq!(turns[..1999], turns[1999..2 * 1999]);
    assert_eq!(clock.periods, 3);
}

#[test]
fn refusals_name_the_parameter() {
    let refusal = |change: fn(&mut Profile)| {
        let mut p = profile(TRIANGLE);
        change(&mut p);
        std::string::ToString::to_string(&Generator::new(&p, PERIOD_US).unwrap_err())
    };
    assert_eq!(refusal(|p| p.limit_micro = 0), "limit must be greater than 0");
    assert_eq!(refusal(|p| p.slew_micro_s = 0), "slew must be greater than 0");
    assert_eq!(refusal(|p| p.duration_us = 999), "duration must be greater than 0");
    assert!(refusal(|p| p.limit_micro = 1_499_999).contains("reaches 1500000"));
    assert!(refusal(|p| p.slew_micro_s = 999).contains("less than one millionth per sample"));
    let period =
        refusal(|p| p.shape = Shape::Triangle { offset_micro: 0, amplitude_micro: 1, period_us: 4500 });
    assert_eq!(period, "period is 4500 us; it must be a whole number of samples of 1000 us, at least 4");
    let nyquist = refusal(|p| {
        p.shape =
            Shape::Sine { offset_micro: 0, amplitude_micro: 1, frequency_uhz: 500_000_000, periods: None }
    });
    assert!(nyquist.starts_with("a frequency of 500000000 uHz"));
}

fn any_shape() -> impl Strategy<Value = Shape> {
    let (offset, amplitude) = (-2_000_000..2_000_000i32, 0..2_000_000i32);
    (0..7, offset, amplitude, 1..400u32, any::<u32>(), any::<bool>()).prop_map(
        |(kind, offset_micro, amplitude_micro, n, seed, flag)| match kind {
            0 => Shape::Constant { level_micro: offset_micro },
            1 => Shape::Staircase {
                first_micro: offset_micro,
                step_micro: amplitude_micro / 8,
                count: 1 + (n % 8) as u16,
                dwell_us: n * PERIOD_US,
                and_back: flag,
            },
            2 => Shape::Sine {
                offset_micro,
                amplitude_micro,
                frequency_uhz: n * 1_000_000,
                periods: flag.then_some(n as u16),
            },
            3 => Shape::Triangle { offset_micro, amplitude_micro, period_us: (n + 3) * PERIOD_US },
            4 => Shape::Chirp {
                offset_micro,
                amplitude_micro,
                start_uhz: n * 1_000_000,
                end_uhz: 1 + seed % 400_000_000,
                sweep_us: (1000 + n) * PERIOD_US,
            },
            5 => Shape::Prbs {
                offset_micro,
                amplitude_micro,
                bit_us: n * PERIOD_US,
                order: 3 + (seed % 14) as u8,
                seed: seed as u16,
            },
            _ => Shape::Multisine {
                offset_micro,
                line_micro: amplitude_micro,
                period_us: 2 * (n + 100) * PERIOD_US,
                lines: if flag { Lines::Odd } else { Lines::Full },
                first_line: 1,
                last_line: (1 + seed % 90) as u16,
                seed,
            },
        },
    )
}

proptest! {
    /// Whatever the shape: it starts next to 0, keeps amplitude and slew, is left in finite time, and ends at 0.
    #[test]
    fn limits_hold_from_zero_to_zero(
        shape in any_shape(),
        ramp_ms in 0..300u32,
        slew in 100_000..2_000_000_000u32,
        duration_ms in 1..1500u64,
        stop_at in 0..2000usize,
    ) {
        let profile = Profile {
            command: Command::Voltage,
            shape,
            ramp_us: ramp_ms * 1000,
            limit_micro: 4_000_000,
            slew_micro_s: slew,
            duration_us: duration_ms * 1000,
        };
        let mut generator = Generator::new(&profile, PERIOD_US).unwrap();
        let per_sample = (u64::from(slew) / 1000) as u32;
        let longest = duration_ms + u64::from(ramp_ms) + 4_000_000 / u64::from(per_sample) + 3;
        let (mut last, mut finished) = (0i32, false);
        for n in 0..=longest as usize {
            if n == stop_at {
                generator.stop();
            }
            let sample = generator.step();
            prop_assert!(sample.value_micro.abs() <= 4_000_000);
            prop_assert!(sample.value_micro.abs_diff(last) <= per_sample);
            prop_assert!(!sample.finished || sample.value_micro == 0);
            last = sample.value_micro;
            finished = sample.finished;
            if finished {
                break;
            }
        }
        prop_assert!(finished, "still at {last} after {longest} samples");
    }
}
