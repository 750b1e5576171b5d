//! Signals and residuals of the made-up diagnosis.

use std::f64::consts::TAU;

use socam_findings::{
    document::{Overlay, RecordingUse},
    evidence::*,
};

use super::sample::CHANNELS;

/// Numbers that look like noise, the same on every machine.
struct Noise(u64);

impl Noise {
    /// Between -1 and 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// About normal with this standard deviation.
    fn normal(&mut self, std: f64) -> f64 {
        std * (self.next() + self.next() + self.next())
    }
}

/// A second of torque_out on a held-out recording, with a gap.
pub(super) fn overlay() -> Overlay {
    let (mut noise, std) = (Noise(9), 0.02);
    let time_s: Vec<f64> = (0..500).map(|n| 4.0 + 2e-3 * f64::from(n)).collect();
    let present = |(index, value): (usize, f64)| (!(200..220).contains(&index)).then_some(value);
    let shown =
        |values: Vec<f64>| -> Vec<Option<f64>> { values.into_iter().enumerate().map(present).collect() };
    let truth: Vec<f64> = time_s.iter().map(|t| 0.4 * (9.0 * t).sin() + 0.1 * (31.0 * t).cos()).collect();
    let missing: Vec<f64> = time_s.iter().map(|t| 0.12 * (9.0 * t).cos().signum()).collect();
    let after: Vec<f64> = truth.iter().map(|_| noise.normal(std)).collect();
    let sum = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
    Overlay {
        channel: "torque_out".into(),
        unit: "N m".into(),
        recording: "triangle-2.mcap".into(),
        held_out: true,
        measured: shown(sum(&truth, &after)),
        before: shown(truth.iter().zip(&missing).map(|(truth, missing)| truth - missing).collect()),
        after: shown(truth.clone()),
        residual_before: shown(sum(&missing, &after)),
        residual_after: shown(after),
        time_s,
    }
}

/// Residuals of so many samples per recording.
pub(super) fn evidence(recordings: &[RecordingUse], samples: usize) -> Evidence {
    let mut noise = Noise(1);
    let traces = recordings.iter().enumerate().map(|(index, recording)| RecordingTraces {
        name: recording.name.clone(),
        held_out: recording.held_out,
        channels: CHANNELS.iter().map(|channel| trace(&mut noise, *channel, index, samples)).collect(),
    });
    Evidence {
        recordings: traces.collect(),
        channels: CHANNELS.iter().map(|channel| shapes(&mut noise, *channel)).collect(),
    }
}

fn trace(noise: &mut Noise, (channel, _, std): (&str, &str, f64), recording: usize, samples: usize) -> Trace {
    let period = 2.0 + 0.3 * recording as f64;
    let time_s: Vec<f64> = (0..samples).map(|n| 10.0 * n as f64 / samples as f64).collect();
    let mut after: Vec<f64> = time_s.iter().map(|_| noise.normal(std)).collect();
    let missing = |t: f64| 3.0 * std * (TAU * t / period).sin().signum() + 1.5 * std * (TAU * 7.0 * t).sin();
    let mut before: Vec<f64> = time_s.iter().zip(&after).map(|(t, noise)| missing(*t) + noise).collect();
    // A gap, and a spike of one sample.
    for values in [&mut before, &mut after] {
        values[samples / 3..(samples / 3).max(samples * 35 / 100)].fill(f64::NAN);
        if let Some(value) = values.get_mut(samples * 3 / 4) {
            *value = 14.0 * std;
        }
    }
    Trace { channel: channel.into(), time_s, before, after }
}

fn shapes(noise: &mut Noise, (name, unit, std): (&str, &str, f64)) -> ChannelEvidence {
    let mut binned = |low: f64, high: f64, shape: fn(f64) -> f64| {
        let x: Vec<f64> = (0..24).map(|n| low + (high - low) * (f64::from(n) + 0.5) / 24.0).collect();
        let before: Vec<f64> = x.iter().map(|x| 3.0 * std * shape(*x) + noise.normal(0.08 * std)).collect();
        let after: Vec<f64> = x.iter().map(|_| noise.normal(0.08 * std)).collect();
        Some(Binned { before_std: vec![0.1 * std; 24], after_std: vec![0.08 * std; 24], x, before, after })
    };
    let over_speed = binned(-90.0, 90.0, |x| (x / 4.0).tanh());
    let over_angle = binned(0.0, TAU, |x| 0.3 * (x + 0.4).sin());
    let over_torque = binned(-0.4, 0.4, |x| 1.6 * x);
    let frequency_hz: Vec<f64> = (0..2500).map(|n| 0.2 * f64::from(n)).collect();
    let floor = |f: f64| std / 500_f64.sqrt() * (1.0 + 2.0 / (1.0 + (f / 20.0).powi(2))).sqrt();
    let peak = |f: f64| 40.0 * std / (1.0 + (f / 0.6).powi(2)) + std / (1.0 + (f - 7.0).powi(2) * 8.0);
    let mut ragged = |value: f64| value * (1.0 + 0.25 * noise.next());
    let spectrum = Spectrum {
        before: frequency_hz.iter().map(|f| ragged(floor(*f).hypot(peak(*f)))).collect(),
        after: frequency_hz.iter().map(|f| ragged(floor(*f))).collect(),
        noise: frequency_hz.iter().map(|f| floor(*f)).collect(),
        frequency_hz,
    };
    ChannelEvidence {
        name: name.into(),
        unit: unit.into(),
        noise_std: std,
        over_speed,
        over_angle,
        over_torque,
        spectrum: Some(spectrum),
    }
}
