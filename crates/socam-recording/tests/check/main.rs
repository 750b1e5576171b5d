//! Each finding is made by a recording that has the fault, and by none that has not.

mod bench;
mod flat;

use std::f64::consts::TAU;

use bench::{RATE_HZ, alone, bench, checked, multisine, noise};
use socam_recording::check::{BothWays, CheckOptions, Finding, Resonance, Verdict, check};
use socam_recording::{Channel, Dataset, Unit};

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
