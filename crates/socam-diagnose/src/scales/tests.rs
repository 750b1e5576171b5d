//! Tests of the limits of readings.

use super::*;

/// Readings of a sine of amplitude 4 with noise by a sensor that saturates at `most`.
fn read(most: f64) -> Traces {
    let truth = |k: usize| 4.0 * (0.01 * k as f64).sin();
    let noise = |k: usize| 0.02 * (78.233 * k as f64).sin();
    Traces {
        recording: 0,
        time_s: (0..5000).map(|k| 1e-3 * k as f64).collect(),
        inputs: Vec::new(),
        measured: vec![(0..5000).map(|k| truth(k).clamp(-most, most) + noise(k)).collect()],
        predicted: vec![(0..5000).map(truth).collect()],
    }
}

#[test]
fn a_limit_is_found_only_where_readings_saturate() {
    let found = limit(&[read(3.0)], 0).unwrap();
    assert!((found - 3.0).abs() < 0.02, "{found}");
    assert_eq!(limit(&[read(10.0)], 0), None);
    assert_eq!(limit(&[], 0), None);
}
