//! Tests of ranges that hold most of a gain.

use super::*;

#[test]
fn the_narrowest_bins_hold_four_fifths() {
    let bins = [(1.0, 50.0), (8.0, 2.0), (30.0, 1.0), (10.0, 1.0), (1.0, 46.0)];
    assert_eq!(narrowest(&bins), Some((2, 4, 0.02)));
    assert_eq!(narrowest(&[(0.0, 3.0), (-1.0, 2.0)]), None);
}

#[test]
fn a_range_is_where_the_gain_is() {
    let sample = |k: i32| Sample {
        speed: f64::from(k - 100) / 10.0,
        torque: f64::NAN,
        angle: 0.0,
        time_s: f64::from(k),
        gain: if (95..105).contains(&k) { 4.0 } else { 0.0 },
    };
    let samples: Vec<Sample> = (0..=200).map(sample).collect();
    let ([low, high], share) = range(&samples, |sample| sample.speed).unwrap();
    assert!(
        (-1.1..=-0.4).contains(&low) && (0.3..=1.1).contains(&high) && share < 0.1,
        "{low} {high} {share}"
    );
    assert!(range(&samples, |sample| sample.torque).is_none());
    assert!(range(&samples, |sample| sample.angle).is_none());
}
