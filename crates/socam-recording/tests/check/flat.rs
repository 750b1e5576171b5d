//! Clipped, stuck and spiky channels, and those that only look so.

use std::f64::consts::TAU;

use socam_recording::Unit;
use socam_recording::check::{Finding, HeldAt, Verdict, held};

use crate::bench::{RATE_HZ, alone, checked, multisine, noise};

fn quantised(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// A recording at rest for two seconds, then at a speed about which a tachometer of 16 bit swings, cut off at its range.
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
    // The axis travels from one end to the other and back several times, with rests at both ends.
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
