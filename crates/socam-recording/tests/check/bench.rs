//! A recording of a reducer with two speeds, and the requirements of a model on it.

use std::f64::consts::TAU;

use socam_recording::check::{Check, CheckOptions, FixedRatio, FreeParameters, Resonance, Speed, check};
use socam_recording::{Channel, Dataset, Unit};

pub(crate) const RATE_HZ: f64 = 1000.0;

/// Noise with unit spread, the same on every run.
pub(crate) fn noise(index: usize, seed: u64) -> f64 {
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
pub(crate) fn multisine(t: f64) -> f64 {
    let line = |k: u32| (TAU * f64::from(k) * 0.7 * t + f64::from(k * k)).sin();
    100.0 + (1..=40).map(line).sum::<f64>()
}

pub(crate) fn checked(input: impl Fn(f64) -> f64, change: impl Fn(&mut [Vec<f64>])) -> Check {
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
pub(crate) fn bench() -> CheckOptions {
    let speed = |name: &str| Speed { channel: name.into(), scale: 1.0, offset: 0.0 };
    let resonance = |frequency_hz, name: &str| Resonance { frequency_hz, parameters: vec![name.into()] };
    CheckOptions {
        input: Some("motor_speed".into()),
        channels: vec!["motor_speed".into(), "output_speed".into()],
        shafts: Vec::new(),
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

/// A channel of this name alone, as the input.
pub(crate) fn alone(name: &str, unit: Unit, values: Vec<f64>) -> (Dataset, Check) {
    let time_s: Vec<f64> = (0..values.len()).map(|i| i as f64 / RATE_HZ).collect();
    let data = Dataset::from_columns("run", vec![Channel::new(name, unit)], time_s, vec![values]).unwrap();
    let options = CheckOptions { input: Some(name.into()), ..CheckOptions::default() };
    let check = check(&data, &options).unwrap();
    (data, check)
}
