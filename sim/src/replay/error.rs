//! Simulated outputs compared with measured ones.

use socam_model::Channel;

/// The error of a simulated channel against the measured one. SI.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputError {
    /// The model's channel.
    pub channel: String,
    /// SI unit of the channel.
    pub unit: &'static str,
    /// Samples compared.
    pub samples: usize,
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub max: f64,
    /// 100 |error| / |measured|, both as norms over all samples.
    pub relative_percent: f64,
}

pub(super) fn compare(channel: &Channel, predicted: &[f64], measured: &[f64]) -> OutputError {
    let pairs = || predicted.iter().zip(measured).filter(|(_, measured)| !measured.is_nan());
    let samples = pairs().count();
    let square = pairs().map(|(p, m)| (p - m) * (p - m)).sum::<f64>();
    let norm = pairs().map(|(_, m)| m * m).sum::<f64>();
    OutputError {
        channel: channel.name.clone(),
        unit: channel.unit,
        samples,
        rms: (square / samples.max(1) as f64).sqrt(),
        max: pairs().map(|(p, m)| (p - m).abs()).fold(0.0, f64::max),
        relative_percent: if norm > 0.0 { 100.0 * (square / norm).sqrt() } else { 0.0 },
    }
}
