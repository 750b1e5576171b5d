use std::f64::consts::TAU;

use socam_recording::{Channel, Dataset, Unit};

use super::*;

fn samples(time_s: Vec<f64>, columns: &[Vec<f64>]) -> Samples {
    let channels = (0..columns.len()).map(|n| Channel::new(format!("c{n}"), Unit::V)).collect();
    let data = Dataset::from_columns("r", channels, time_s.clone(), columns.to_vec()).unwrap();
    Samples::in_memory(time_s, columns, data.segments().to_vec())
}

fn derived(samples: &Samples, operation: Operation, value: f64) -> Vec<f64> {
    let derivation = Derivation { operation, value: Some(value), ..Derivation::default() };
    let second = operation.second().map(|_| (samples, samples.channels() - 1));
    let sources: Vec<_> = std::iter::once((samples, 0)).chain(second).collect();
    values(&derivation, &[], &sources, &Handle::default()).unwrap()
}

fn wave(hz: f64, rows: usize) -> Samples {
    let time_s: Vec<f64> = (0..rows).map(|row| row as f64 * 1e-3).collect();
    let values = time_s.iter().map(|time| 2.0 * (TAU * hz * time).sin()).collect();
    samples(time_s, &[values])
}

/// Largest difference from a function of time, without the ends.
fn worst(values: &[f64], margin: usize, truth: impl Fn(f64) -> f64) -> f64 {
    let inner = margin..values.len() - margin;
    inner.map(|row| (values[row] - truth(row as f64 * 1e-3)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_sine_has_a_cosine_as_derivative_and_its_integral_is_the_sine_again() {
    let sine = wave(2.0, 4000);
    let slope = derived(&sine, Operation::Derivative, 0.0);
    let greatest = 2.0 * TAU * 2.0;
    assert!(worst(&slope, 1, |t| greatest * (TAU * 2.0 * t).cos()) < 1e-4 * greatest);
    let integral = derived(&sine, Operation::Integral, 0.0);
    let truth = |t: f64| 2.0 / (TAU * 2.0) * (1.0 - (TAU * 2.0 * t).cos());
    assert!(worst(&integral, 0, truth) < 1e-5, "{}", worst(&integral, 0, truth));
}

#[test]
fn an_integral_begins_anew_after_a_gap_and_after_a_missing_value() {
    let time_s = vec![0.0, 1.0, 2.0, 10.0, 11.0, 12.0, 13.0];
    let samples = samples(time_s, &[vec![4.0, 4.0, 4.0, 6.0, 6.0, f64::NAN, 6.0]]);
    let integral = derived(&samples, Operation::Integral, 0.0);
    assert_eq!(integral[..5], [0.0, 4.0, 8.0, 0.0, 6.0]);
    assert!(integral[5].is_nan() && integral[6] == 0.0);
    // No slope across the gap either.
    assert_eq!(derived(&samples, Operation::Derivative, 0.0)[..5], [0.0; 5]);
}

#[test]
fn filters_have_no_delay_and_halve_the_power_at_their_corner() {
    let size = |hz: f64, operation: Operation| {
        let values = derived(&wave(hz, 8000), operation, 10.0);
        // The part in phase with the input; a delay would move some of it out of phase.
        let part = |shape: fn(f64) -> f64| {
            let sum = (2000..6000).map(|row| values[row] * shape(TAU * hz * row as f64 * 1e-3)).sum::<f64>();
            sum / 4000.0
        };
        (part(f64::sin), part(f64::cos))
    };
    let (in_phase, delayed) = size(10.0, Operation::LowPass);
    assert!((in_phase - 0.5_f64.sqrt()).abs() < 1e-3 && delayed.abs() < 1e-6, "{in_phase} {delayed}");
    assert!((size(0.5, Operation::LowPass).0 - 1.0).abs() < 1e-3);
    assert!(size(100.0, Operation::LowPass).0.abs() < 1e-3);
    assert!((size(100.0, Operation::HighPass).0 - 1.0).abs() < 1e-3);
    let (kept, delayed) = size(10.0, Operation::HighPass);
    assert!((kept - (1.0 - 0.5_f64.sqrt())).abs() < 1e-3 && delayed.abs() < 1e-6);
}

#[test]
fn a_moving_mean_of_a_ramp_is_the_ramp_and_of_a_period_nothing() {
    let time_s: Vec<f64> = (0..1000).map(|row| f64::from(row) * 1e-3).collect();
    let ramp: Vec<f64> = time_s.iter().map(|time| 1e6 + 3.0 * time).collect();
    let mean = derived(&samples(time_s, &[ramp]), Operation::MovingMean, 0.1);
    assert!(worst(&mean, 60, |t| 1e6 + 3.0 * t) < 1e-6);
    // 0.1 s hold 101 samples, both ends included: one sample more than two periods.
    let mean = derived(&wave(20.0, 1000), Operation::MovingMean, 0.1);
    assert!(worst(&mean, 60, |_| 0.0) < 2.0 / 101.0 + 1e-6);
}

#[test]
fn two_channels_are_combined_sample_by_sample() {
    let time_s = vec![0.0, 1.0, 2.0, 3.0];
    let samples = samples(time_s, &[vec![6.0, 8.0, f64::NAN, 1.0], vec![2.0, 4.0, 1.0, 0.0]]);
    assert_eq!(derived(&samples, Operation::Difference, 0.0)[..2], [4.0, 4.0]);
    assert_eq!(derived(&samples, Operation::Product, 0.0)[..2], [12.0, 32.0]);
    let ratio = derived(&samples, Operation::Ratio, 0.0);
    assert_eq!(ratio[..2], [3.0, 2.0]);
    assert!(ratio[2].is_nan() && ratio[3].is_nan(), "{ratio:?}");
}

#[test]
fn what_cannot_be_computed_says_why() {
    let of = |operation, value| {
        let derivation = Derivation { operation, value: Some(value), ..Derivation::default() };
        let wave = wave(1.0, 100);
        values(&derivation, &[], &[(&wave, 0)], &Handle::default())
    };
    assert!(of(Operation::LowPass, 600.0).unwrap_err().contains("below half of 1000"));
    assert!(of(Operation::HighPass, 0.0).is_err() && of(Operation::MovingMean, 0.0).is_err());
    let twist = Derivation { operation: Operation::Difference, ..Derivation::default() };
    let of = |unit: &str| Signal { name: "c".into(), unit: unit.into() };
    assert!(twist.unit(&[of("rad"), of("V")]).unwrap_err().contains("same unit"));
    assert_eq!(twist.unit(&[of("rad"), of("rad")]).as_deref(), Ok("rad"));
}

#[test]
fn a_formula_is_computed_where_all_its_channels_have_values() {
    let time_s = vec![0.0, 1.0, 2.0, 3.0];
    let samples = samples(time_s, &[vec![6.0, 8.0, f64::NAN, 1.0], vec![2.0, 4.0, 1.0, 0.0]]);
    let signals = ["a", "b"].map(|name| Signal { name: name.into(), unit: "V".into() });
    let of = |text: &str| {
        let formula = Some(text.into());
        let derivation = Derivation { operation: Operation::Formula, formula, ..Derivation::default() };
        let sources = derivation.sources(&signals).unwrap();
        let place = |signal: &Signal| signals.iter().position(|own| own == signal).unwrap();
        let from: Vec<_> = sources.iter().map(|signal| (&samples, place(signal))).collect();
        values(&derivation, &sources, &from, &Handle::default()).unwrap()
    };
    let power = of("2*a^2/b");
    assert_eq!(power[..2], [36.0, 32.0]);
    assert!(power[2].is_nan() && power[3].is_nan(), "{power:?}");
    let least = of("min(b, a) - 1*a");
    assert!(least[..2] == [-4.0, -4.0] && least[2].is_nan() && least[3] == -1.0, "{least:?}");
}
