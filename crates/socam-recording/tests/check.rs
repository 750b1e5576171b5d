//! Each finding is made by a recording that has the fault, and by none that has not.

use std::f64::consts::TAU;

use socam_recording::check::{
    BothWays, Check, CheckOptions, Finding, FixedRatio, FreeParameters, HeldAt, Resonance, Speed, Verdict,
    check, held,
};
use socam_recording::{Channel, Dataset, Unit};

const RATE_HZ: f64 = 1000.0;

/// Noise with unit spread, the same on every run.
fn noise(index: usize, seed: u64) -> f64 {
    let uniform = |salt: u64| {
        let mut x = (index as u64 * 16 + salt + seed * 1013).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x ^= x >> 29;
        x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x ^= x >> 32;
        (x >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..12).map(uniform).sum::<f64>() - 6.0
}

/// A multisine around a steady speed.
fn multisine(t: f64) -> f64 {
    let line = |k: u32| (TAU * f64::from(k) * 0.7 * t + f64::from(k * k)).sin();
    100.0 + (1..=40).map(line).sum::<f64>()
}

fn checked(input: impl Fn(f64) -> f64, change: impl Fn(&mut [Vec<f64>])) -> Check {
    let time_s: Vec<f64> = (0..20_000).map(|i| i as f64 / RATE_HZ).collect();
    let motor: Vec<f64> = time_s.iter().enumerate().map(|(i, t)| input(*t) + 0.02 * noise(i, 1)).collect();
    let output: Vec<f64> =
        time_s.iter().enumerate().map(|(i, t)| input(*t - 0.01) / 8.0 + 0.005 * noise(i, 2)).collect();
    let mut columns = vec![motor, output];
    change(&mut columns);
    let channels =
        vec![Channel::new("motor_speed", Unit::RadPerS), Channel::new("output_speed", Unit::RadPerS)];
    let data = Dataset::from_columns("run", channels, time_s, columns).unwrap();
    check(&data, &bench()).unwrap()
}

/// A reducer of 8:1 with two resonances.
fn bench() -> CheckOptions {
    let speed = |name: &str| Speed { channel: name.into(), scale: 1.0, offset: 0.0 };
    let resonance = |frequency_hz, name: &str| Resonance { frequency_hz, parameters: vec![name.into()] };
    CheckOptions {
        input: Some("motor_speed".into()),
        channels: vec!["motor_speed".into(), "output_speed".into()],
        ratios: vec![FixedRatio {
            fast: speed("motor_speed"),
            slow: speed("output_speed"),
            ratio: 8.0,
            tolerance: 0.01,
        }],
        resonances: vec![resonance(3.0, "k1"), resonance(20.0, "k2")],
        both_ways: Vec::new(),
        units: Vec::new(),
        free: Some(FreeParameters { parameters: 4, outputs: 1 }),
    }
}

#[test]
fn a_good_recording_is_fit() {
    let check = checked(multisine, |_| {});
    assert_eq!(check.findings, []);
    assert_eq!(check.verdict, Verdict::Fit);
    let motor = &check.channels[0];
    let [from, to] = motor.band_hz.unwrap();
    assert!(from < 1.0 && (27.0..31.0).contains(&to), "{from} to {to}");
    assert!((0.015..0.025).contains(&motor.noise_std.unwrap()));
    assert!(motor.lines.unwrap() >= 20, "{:?}", motor.lines);
    assert_eq!(motor.steps, 0);
}

#[test]
fn a_sine_determines_little_and_a_steady_speed_nothing() {
    let sine = checked(|t| 100.0 + 20.0 * (TAU * 3.0 * t).sin(), |_| {});
    let found = &sine.findings[0];
    assert!(matches!(found, Finding::FewLines { lines: 1, needed: 3, .. }), "{found:?}");
    let unexcited = sine.findings.iter().find_map(|f| match f {
        Finding::ResonancesNotExcited { resonances, .. } => Some((resonances, f)),
        _ => None,
    });
    let (resonances, finding) = unexcited.unwrap();
    assert_eq!(resonances[..], bench().resonances[1..]);
    assert!(finding.sentence().ends_with("the model's resonance at 20.0 Hz, on which k2 depends"));
    assert!(finding.remedy().starts_with("record the `multisine` profile"), "{}", finding.remedy());
    assert!((115..125).contains(&sine.channels[0].turning_points));
    let steady = checked(|_| 100.0, |_| {});
    assert_eq!(steady.verdict, Verdict::Unfit);
    assert!(steady.findings.iter().any(|f| matches!(f, Finding::StandsStill { .. })));
}

#[test]
fn saturation_is_told_from_a_staircase() {
    let clipped = checked(multisine, |columns| {
        columns[1].iter_mut().for_each(|v| *v = v.min(13.0));
    });
    let saturated = clipped.findings.iter().find_map(|f| match f {
        Finding::Saturated { channel, limit, .. } => Some((channel.as_str(), *limit)),
        _ => None,
    });
    assert_eq!(saturated, Some(("output_speed", 13.0)));
    let staircase = |columns: &mut [Vec<f64>]| {
        for (i, value) in columns[0].iter_mut().enumerate() {
            *value = [10.0, 20.0, 35.0, 15.0][i / 1000 % 4];
        }
    };
    let stretch = checked(multisine, |columns| {
        // One cut of a tenth of a noisy recording.
        let rows = columns[1].len();
        columns[1][rows / 2..rows / 2 + rows / 10].fill(14.0);
        columns[1].iter_mut().for_each(|v| *v = v.min(14.0));
    });
    assert!(
        stretch.findings.iter().any(|f| matches!(f, Finding::Saturated { .. })),
        "{:?}",
        stretch.findings
    );
    let stairs = checked(multisine, staircase);
    assert!(!stairs.findings.iter().any(|f| matches!(f, Finding::Saturated { .. })));
    assert_eq!(stairs.channels[0].steps, 19);
}

#[test]
fn hum_is_named_with_its_amplitude() {
    let check = checked(multisine, |columns| {
        for (i, value) in columns[1].iter_mut().enumerate() {
            let t = i as f64 / RATE_HZ;
            *value += 0.05 * (TAU * 50.0 * t).sin() + 0.02 * (TAU * 150.0 * t).sin();
        }
    });
    let [Finding::MainsHum { channel, frequency_hz, amplitude, harmonics, .. }] = &check.findings[..] else {
        panic!("{:?}", check.findings);
    };
    assert_eq!((channel.as_str(), *frequency_hz), ("output_speed", 50.0));
    assert!((amplitude - 0.05).abs() < 0.005, "{amplitude}");
    assert_eq!(harmonics, &[1, 3]);
    assert_eq!(check.verdict, Verdict::Fit);
}

#[test]
fn a_wrong_ratio_is_measured() {
    let check = checked(multisine, |columns| {
        columns[1].iter_mut().for_each(|v| *v *= 0.97);
    });
    let [Finding::RatioBroken { measured, .. }] = check.findings[..] else {
        panic!("{:?}", check.findings);
    };
    assert!((measured - 8.0 / 0.97).abs() < 0.02, "{measured}");
}

#[test]
fn short_empty_and_noisy_channels_are_said() {
    let check = checked(multisine, |columns| {
        for (i, value) in columns[1].iter_mut().enumerate() {
            *value = if i % 100 == 0 { f64::NAN } else { noise(i, 5) };
        }
    });
    let kinds = |f: fn(&Finding) -> bool| check.findings.iter().any(f);
    assert!(kinds(|f| matches!(f, Finding::MissingValues { missing: 200, .. })));
    let channels = vec![Channel::new("u", Unit::V)];
    let few = Dataset::from_columns("run", channels, vec![0.0, 1.0, 5.0], vec![vec![1.0; 3]]);
    let check = socam_recording::check::check(&few.unwrap(), &CheckOptions::default()).unwrap();
    assert_eq!(check.verdict, Verdict::Unfit);
    assert!(check.findings.iter().all(|f| !f.sentence().is_empty() && !f.remedy().is_empty()));
}

#[test]
fn a_ratio_is_only_broken_beyond_its_scatter() {
    // A drive without steady speed: the slow shaft swings on its spring, and averages say little.
    let check =
        checked(|t| 20.0 * (TAU * 3.0 * t).sin(), |columns| columns[1].iter_mut().for_each(|v| *v *= 1.3));
    assert!(!check.findings.iter().any(|f| matches!(f, Finding::RatioBroken { .. })), "{:?}", check.findings);
}

#[test]
fn channels_that_the_model_reads_may_be_missing() {
    let channels = vec![Channel::new("motor_speed", Unit::RadPerS), Channel::new("room", Unit::K)];
    let time_s: Vec<f64> = (0..4000).map(|i| f64::from(i) / RATE_HZ).collect();
    let columns = vec![time_s.iter().map(|t| multisine(*t)).collect(), vec![20.0; 4000]];
    let data = Dataset::from_columns("run", channels, time_s, columns).unwrap();
    let check = check(&data, &bench()).unwrap();
    let missing = &check.findings[0];
    assert_eq!(check.verdict, Verdict::Unfit);
    assert_eq!(
        missing.sentence(),
        "the model reads `output_speed`, which the recording lacks; it has motor_speed_rad_s, room_K"
    );
    // The model has no interest in the room, so its constant temperature is no finding.
    assert_eq!(check.channels.len(), 1);
    assert_eq!(check.findings.len(), 1, "{:?}", check.findings);
}

#[test]
fn friction_and_load_need_motion_both_ways() {
    let found = |position: fn(f64) -> f64| {
        let time_s: Vec<f64> = (0..4000).map(|i| f64::from(i) / RATE_HZ).collect();
        let columns = vec![
            time_s.iter().map(|t| multisine(*t)).collect(),
            time_s.iter().enumerate().map(|(i, t)| position(*t) + 1e-5 * noise(i, 3)).collect(),
        ];
        let channels = vec![Channel::new("force", Unit::N), Channel::new("position", Unit::M)];
        let data = Dataset::from_columns("run", channels, time_s, columns).unwrap();
        let motion =
            BothWays { channel: "position_m".into(), parameters: vec!["dry".into(), "weight".into()] };
        let options = CheckOptions {
            input: Some("force_N".into()),
            both_ways: vec![motion],
            ..CheckOptions::default()
        };
        let check = check(&data, &options).unwrap();
        check.findings.iter().find(|f| matches!(f, Finding::OneWay { .. })).map(Finding::sentence)
    };
    assert_eq!(found(|t| (TAU * t).sin()), None);
    assert_eq!(
        found(|t| 0.1 * t).as_deref(),
        Some("`position` moves one way only, so dry and weight cannot be told apart")
    );
}

/// A channel of this name alone, as the input.
fn alone(name: &str, unit: Unit, values: Vec<f64>) -> (Dataset, Check) {
    let time_s: Vec<f64> = (0..values.len()).map(|i| i as f64 / RATE_HZ).collect();
    let data = Dataset::from_columns("run", vec![Channel::new(name, unit)], time_s, vec![values]).unwrap();
    let options = CheckOptions { input: Some(name.into()), ..CheckOptions::default() };
    let check = check(&data, &options).unwrap();
    (data, check)
}

fn quantised(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// At rest for two seconds, then a speed about which a tachometer of 16 bit swings, cut off at its range.
fn tachometer(least: f64, greatest: f64, rows: usize) -> Vec<f64> {
    let speed = |i: usize| {
        let t = i as f64 / RATE_HZ;
        let rises = (t - 2.0).clamp(0.0, 1.0);
        if i < 2000 {
            0.0
        } else {
            quantised((rises * multisine(t) + 0.02 * noise(i, 3)).clamp(least, greatest), 0.004)
        }
    };
    (0..rows).map(speed).collect()
}

#[test]
fn an_input_that_clips_is_told_with_where_and_how_often() {
    // Standstill before says nothing of the clipping after it.
    let (data, check) = alone("motor_speed", Unit::RadPerS, tachometer(-1e3, 108.0, 20_000));
    let finding = check.findings.iter().find(|f| matches!(f, Finding::Saturated { .. })).unwrap();
    assert!(
        matches!(finding, Finding::Saturated { at: HeldAt::Greatest, limit, .. } if *limit == 108.0),
        "{finding:?}"
    );
    assert!(
        finding.sentence().contains("clipped at its upper end: it sticks at 108 rad/s"),
        "{}",
        finding.sentence()
    );
    let [found] = &held(&data, &[0]).unwrap()[..] else { panic!() };
    let values = tachometer(-1e3, 108.0, 20_000);
    let rows: u64 = found.rows.iter().map(|rows| rows.end - rows.start).sum();
    assert_eq!(rows as usize, values.iter().filter(|value| **value == 108.0).count());
    assert!(found.rows.iter().all(|rows| rows.clone().all(|row| values[row as usize] == 108.0)));
    assert_eq!((found.at, found.value, found.share), (HeldAt::Greatest, 108.0, rows as f64 / 20_000.0));
    let both = alone("motor_speed", Unit::RadPerS, tachometer(92.0, 108.0, 20_000).split_off(3000));
    let ends: Vec<HeldAt> = held(&both.0, &[0]).unwrap().iter().map(|held| held.at).collect();
    assert_eq!(ends, [HeldAt::Least, HeldAt::Greatest]);
    let clean = alone("motor_speed", Unit::RadPerS, tachometer(-1e3, 1e3, 20_000));
    assert_eq!(held(&clean.0, &[0]).unwrap(), []);
}

#[test]
fn a_clipped_amplifier_before_a_noisy_converter_is_seen_to_its_last_bit() {
    let mut values = tachometer(-1e3, 108.0, 20_000);
    for (i, value) in values.iter_mut().enumerate().filter(|(_, value)| **value == 108.0) {
        *value += if noise(i, 9) > 0.5 { -0.004 } else { 0.0 };
    }
    let (data, _) = alone("motor_speed", Unit::RadPerS, values);
    let [found] = &held(&data, &[0]).unwrap()[..] else { panic!("{:?}", held(&data, &[0])) };
    assert_eq!((found.at, found.value), (HeldAt::Greatest, 108.0));
}

#[test]
fn a_sensor_that_is_dead_for_a_while_is_stuck() {
    let mut values = tachometer(-1e3, 1e3, 20_000);
    values[9000..9500].fill(100.0);
    let (data, check) = alone("motor_speed", Unit::RadPerS, values);
    let [found] = &held(&data, &[0]).unwrap()[..] else { panic!("{:?}", held(&data, &[0])) };
    assert_eq!(
        (found.at, found.value, &found.rows[..]),
        (HeldAt::Between, 100.0, std::slice::from_ref(&(9000..9500)))
    );
    assert!(
        check
            .findings
            .iter()
            .any(|f| f.sentence().contains("is stuck: it reads exactly 100 rad/s in 500 rows"))
    );
}

#[test]
fn rests_coarse_encoders_and_turning_points_are_not_clipped() {
    let not_held = |name: &str, unit: Unit, value: &dyn Fn(usize, f64) -> f64| {
        let values = (0..20_000).map(|i| value(i, i as f64 / RATE_HZ)).collect();
        let (data, check) = alone(name, unit, values);
        let found = held(&data, &[0]).unwrap();
        assert!(found.is_empty(), "{name}: {:?}", check.findings);
    };
    // To one end of its travel and back, with rests at both ends, several times.
    let travel = |t: f64| (1.5 * (TAU * 0.2 * t).sin()).clamp(-1.0, 1.0);
    not_held("position", Unit::Rad, &|_, t| quantised(travel(t), TAU / 8192.0));
    not_held("ball_screw", Unit::M, &|i, t| quantised(travel(t) + 1e-4 * noise(i, 1), 3e-4));
    // A spin-up that turns round.
    not_held("position", Unit::Rad, &|_, t| quantised(40.0 * (t - 7.0).powi(2) - 300.0, TAU / 8192.0));
    // Speed from the differences of a coarse encoder.
    let angle = |t: f64| quantised(2.0 * t - 0.4 * (TAU * 0.7 * t).cos(), TAU / 500.0);
    not_held("encoder_speed", Unit::RadPerS, &|_, t| RATE_HZ * (angle(t) - angle(t - 1.0 / RATE_HZ)));
    not_held("filtered_speed", Unit::RadPerS, &|_, t| 50.0 * (angle(t) - angle(t - 0.02)));
    // A smooth wave that is sampled finely, by a converter without noise.
    not_held("torque", Unit::Nm, &|_, t| quantised((TAU * 0.5 * t).sin(), 0.005));
}

#[test]
fn spikes_of_an_input_are_found_and_pulses_are_none() {
    let spiky = checked(multisine, |columns| {
        for row in [2000, 7000, 12_345] {
            columns[0][row] = 160.0;
        }
    });
    let found = spiky
        .findings
        .iter()
        .find(|f| matches!(f, Finding::Spikes { spikes: 3, farthest, .. } if *farthest == 160.0));
    assert!(
        found.unwrap().sentence().starts_with("`motor_speed` has 3 spikes, the farthest at 160"),
        "{found:?}"
    );
    assert_ne!(spiky.verdict, Verdict::Fit);
    // One pulse of a switching signal is as long as one sample, and as large as all others.
    let pulses = alone("command", Unit::V, (0..20_000).map(|i| f64::from(noise(i, 4) > 0.0)).collect()).1;
    assert!(!pulses.findings.iter().any(|f| matches!(f, Finding::Spikes { .. })), "{:?}", pulses.findings);
}

#[test]
fn a_switching_input_is_not_taken_for_noise() {
    let prbs = |clock: usize| move |i: usize| if noise(i / clock, 4) > 0.0 { 2.0 } else { 1.0 };
    for clock in [1, 5, 20] {
        let clean = alone("command", Unit::V, (0..20_000).map(prbs(clock)).collect()).1;
        assert_eq!(clean.verdict, Verdict::Fit, "{clock}: {:?}", clean.findings);
        let measured = |i: usize| prbs(clock)(i) + 0.01 * noise(i, 5);
        let noisy = alone("torque", Unit::Nm, (0..20_000).map(measured).collect()).1;
        if clock > 5 {
            assert!(
                (0.008..0.012).contains(&noisy.channels[0].noise_std.unwrap()),
                "{:?}",
                noisy.channels[0]
            );
        }
    }
    let buried = alone("torque", Unit::Nm, (0..20_000).map(|i| noise(i, 5)).collect()).1;
    assert_eq!(buried.verdict, Verdict::Unfit, "{:?}", buried.findings);
}

#[test]
fn a_channel_in_another_unit_is_said() {
    let (data, _) = alone("drive", Unit::A, (0..4000).map(|i| multisine(i as f64 / RATE_HZ)).collect());
    let options = CheckOptions {
        input: Some("drive".into()),
        units: vec![("drive".into(), "N m".into())],
        ..CheckOptions::default()
    };
    let found = check(&data, &options).unwrap();
    assert_eq!(found.findings[0].sentence(), "`drive` is recorded in A, but the model takes it for N m");
    assert_eq!(found.verdict, Verdict::Unfit);
}

#[test]
fn a_resonance_slower_than_the_recording_is_not_missed() {
    let resonances = vec![Resonance { frequency_hz: 0.01, parameters: vec!["k".into()] }];
    let (data, _) = alone("drive", Unit::Nm, (0..4000).map(|i| multisine(i as f64 / RATE_HZ)).collect());
    let options = CheckOptions { input: Some("drive".into()), resonances, ..CheckOptions::default() };
    let found = check(&data, &options).unwrap();
    assert!(
        !found.findings.iter().any(|f| matches!(f, Finding::ResonancesNotExcited { .. })),
        "{:?}",
        found.findings
    );
}
