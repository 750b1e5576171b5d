use std::f64::consts::TAU;

use nalgebra::Complex;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, Normal};

use super::*;

const STEP_S: f64 = 1e-3;

/// A resonance at 30 Hz as a recursion, whose response over frequency is known exactly.
const NUMERATOR: [f64; 3] = [0.004, 0.008, 0.004];
const DENOMINATOR: [f64; 3] = [1.0, -1.93, 0.962];

fn exact(frequency_hz: f64) -> Complex<f64> {
    let z = Complex::from_polar(1.0, -TAU * frequency_hz * STEP_S);
    let at = |c: [f64; 3]| z * z * c[2] + z * c[1] + c[0];
    at(NUMERATOR) / at(DENOMINATOR)
}

fn filtered(input: &[f64]) -> Vec<f64> {
    let mut output = vec![0.0; input.len()];
    for t in 0..input.len() {
        let past = |values: &[f64], k: usize| if t >= k { values[t - k] } else { 0.0 };
        output[t] = (0..3).map(|k| NUMERATOR[k] * past(input, k)).sum::<f64>()
            - (1..3).map(|k| DENOMINATOR[k] * past(&output, k)).sum::<f64>();
    }
    output
}

fn multisine(periods: usize, stride: usize) -> Vec<f64> {
    let period = 1000;
    let one = |t: usize| {
        (1..120)
            .step_by(stride)
            .map(|k| (TAU * (k * t) as f64 / f64::from(period) + (k * k) as f64).sin())
            .sum()
    };
    (0..periods * period as usize).map(one).collect()
}

fn noisy(values: &[f64], std: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    let normal = Normal::new(0.0, std).unwrap();
    values.iter().map(|value| value + normal.sample(random)).collect()
}

const OPTIONS: Options = Options { band_hz: [1.0, 100.0], period_s: None };

/// Share of lines whose magnitude and phase lie in their intervals, per cent, and the root mean square of errors in units of their
/// standard deviation.
fn coverage(estimates: &[Response]) -> (f64, f64) {
    let lines: Vec<&Line> = estimates.iter().flat_map(|response| &response.lines).collect();
    let share = |holds: &dyn Fn(&Line) -> bool| {
        100.0 * lines.iter().filter(|line| holds(line)).count() as f64 / lines.len() as f64
    };
    let magnitude = share(&|line| {
        let [low, high] = line.magnitude_ci95();
        (low..=high).contains(&exact(line.frequency_hz).norm())
    });
    let phase = share(&|line| {
        let error = (line.response / exact(line.frequency_hz)).arg().to_degrees();
        error.abs() <= line.phase_half_width_deg()
    });
    (magnitude, phase)
}

#[test]
fn bands_of_a_multisine_hold_the_truth_as_often_as_they_say() {
    let input = multisine(6, 2);
    let output = filtered(&input);
    let estimates: Vec<Response> = (0..30)
        .map(|seed| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            // The input's sensor is noisy, too.
            let (u, y) = (noisy(&input, 1.0, &mut random), noisy(&output, 0.5, &mut random));
            let signals = Signals { input: &u, output: &y, reference: Some(&input), sample_time_s: STEP_S };
            estimate(&[signals], &OPTIONS).unwrap()
        })
        .collect();
    assert_eq!(estimates[0].method, Method::Periodic { period_s: 1.0, periods: 5 });
    let (magnitude, phase) = coverage(&estimates);
    assert!((93.0..=97.0).contains(&magnitude) && (93.0..=97.0).contains(&phase), "{magnitude} {phase}");
    // Nothing is distorted, and nothing said to be.
    let parities = estimates.iter().filter_map(|e| e.distortion.as_ref()?.even);
    assert_eq!(parities.filter(|parity| parity.significant).count(), 0);
}

#[test]
fn bands_of_a_random_signal_hold_the_truth_whatever_leaks() {
    let estimates: Vec<Response> = (0..12)
        .map(|seed| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let drive = noisy(&vec![0.0; 30_000], 1.0, &mut random);
            let output = filtered(&drive);
            let (u, y) = (noisy(&drive, 0.3, &mut random), noisy(&output, 0.1, &mut random));
            // Starts anywhere and ends anywhere: a transient of each stretch.
            let cut = |values: &'_ [f64], rows: Range<usize>| values[rows].to_vec();
            let parts = [100..17_003, 17_500..29_999]
                .map(|rows: Range<usize>| (cut(&u, rows.clone()), cut(&y, rows.clone()), cut(&drive, rows)));
            let signals = parts.each_ref().map(|(u, y, r)| Signals {
                input: u,
                output: y,
                reference: Some(r),
                sample_time_s: STEP_S,
            });
            estimate(&signals, &OPTIONS).unwrap()
        })
        .collect();
    assert_eq!(estimates[0].method, Method::Local);
    let (magnitude, phase) = coverage(&estimates);
    assert!((93.0..=97.0).contains(&magnitude) && (93.0..=97.0).contains(&phase), "{magnitude} {phase}");
}

#[test]
fn odd_and_even_distortion_are_told_apart_and_from_noise() {
    let input = multisine(5, 4);
    let distorted = |law: &dyn Fn(f64) -> f64| {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let output: Vec<f64> = noisy(&filtered(&input), 0.01, &mut random).into_iter().map(law).collect();
        let signals = Signals { input: &input, output: &output, reference: None, sample_time_s: STEP_S };
        let distortion = estimate(&[signals], &OPTIONS).unwrap().distortion.unwrap();
        let seen = |parity: Option<Parity>| parity.unwrap().significant;
        (seen(distortion.even), seen(distortion.odd))
    };
    assert_eq!(distorted(&|y| y), (false, false));
    assert_eq!(distorted(&|y| y + 0.003 * y * y), (true, false));
    assert_eq!(distorted(&|y| y + 0.0003 * y * y * y), (false, true));
}

#[test]
fn a_signal_without_lines_in_the_band_is_refused() {
    let flat = vec![1.0; 2000];
    let signals = Signals { input: &flat, output: &flat, reference: None, sample_time_s: STEP_S };
    assert!(matches!(estimate(&[signals], &OPTIONS), Err(FrequencyError::NotExcited { .. })));
    let short = Signals { input: &flat[..20], output: &flat[..20], ..signals };
    assert!(matches!(estimate(&[short], &OPTIONS), Err(FrequencyError::TooShort { .. })));
}
