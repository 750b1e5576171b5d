//! The transform from a recording's column to a channel: its values, their time derivative, their integral, or a wave of an angle.
//!
//! A bench with encoders records angles. The prescribed speed of its motor, or a torque that repeats with each turn of a shaft, is computed
//! from them here, so that no recording has to be rewritten.

mod uneven;

/// Number of samples on either side that a rate uses.
const REACH: usize = 8;

/// The transform of a column's values (`take` in a model file).
///
/// ```
/// use socam_model::ChannelTransform;
///
/// assert_eq!(ChannelTransform::Rate.reach(), 8);
/// assert_eq!(ChannelTransform::Rate.noise().len(), 17);
/// assert_eq!(ChannelTransform::Value.noise(), [1.0]);
/// // White noise of 1e-4 rad at 1 kHz becomes noise of about 0.13 rad/s.
/// let std_rad_s = 1e-4 * ChannelTransform::Rate.amplification(1e-3);
/// assert!((std_rad_s - 0.13).abs() < 0.02, "{std_rad_s}");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ChannelTransform {
    /// The values themselves.
    #[default]
    #[serde(skip)]
    Value,
    /// Their time derivative per second, by central differences of order 16 over eight samples on either side. The amplitude error of a
    /// sinusoid is 0.14 % at a quarter of the sampling rate and 5e-7 at a seventh. Near the ends of a segment the order is lower; the first
    /// and last values are derivatives of a parabola through three samples.
    Rate,
    /// cos(order * value): a wave of `order` cycles per turn of an angle in rad.
    Cos(f64),
    /// sin(order * value), see [`Self::Cos`].
    Sin(f64),
    /// Time since the start of the recording, s; the values are not used.
    #[serde(skip)]
    Elapsed,
    /// Their integral over time since the start of the recording, to order 4.
    #[serde(skip)]
    Integral,
}

impl ChannelTransform {
    /// Number of samples on either side of a sample on which its transformed value depends.
    #[must_use]
    pub const fn reach(self) -> usize {
        match self {
            Self::Rate => REACH,
            Self::Integral => 2,
            Self::Value | Self::Cos(_) | Self::Sin(_) | Self::Elapsed => 0,
        }
    }

    /// The weights, earliest first and with squares that sum to 1, by which white noise of the column enters a transformed sample: `[1]`, or
    /// for [`Self::Rate`] the 17 difference weights, which colour the noise (its spectrum rises with frequency).
    #[must_use]
    pub fn noise(self) -> Vec<f64> {
        if self != Self::Rate {
            return vec![1.0];
        }
        let (after, size) = (weights(REACH), self.amplification(1.0));
        let before = after.iter().rev().map(|weight| -weight);
        before.chain([0.0]).chain(after.iter().copied()).map(|weight| weight / size).collect()
    }

    /// Standard deviation of a transformed sample divided by that of white noise in the column: 1, or for [`Self::Rate`] a factor in 1/s.
    #[must_use]
    pub fn amplification(self, sample_time_s: f64) -> f64 {
        if self != Self::Rate {
            return 1.0;
        }
        weights(REACH).iter().map(|weight| 2.0 * weight * weight).sum::<f64>().sqrt() / sample_time_s
    }

    pub(crate) fn apply(self, column: &[f64], sample_time_s: f64, start: TransformStart) -> Vec<f64> {
        match self {
            Self::Value => column.to_vec(),
            Self::Rate => rate(column).into_iter().map(|step| step / sample_time_s).collect(),
            Self::Cos(order) => column.iter().map(|value| (order * value).cos()).collect(),
            Self::Sin(order) => column.iter().map(|value| (order * value).sin()).collect(),
            Self::Elapsed => (0..column.len()).map(|k| start.time_s + k as f64 * sample_time_s).collect(),
            Self::Integral => integral(column, sample_time_s, start.integral),
        }
    }

    /// [`Self::apply`] for samples at these times, s.
    pub(crate) fn apply_at(self, column: &[f64], time_s: &[f64], start: TransformStart) -> Vec<f64> {
        match self {
            Self::Rate => uneven::rate(column, time_s),
            Self::Integral => uneven::integral(column, time_s, start.integral),
            Self::Elapsed => time_s.to_vec(),
            Self::Value | Self::Cos(_) | Self::Sin(_) => self.apply(column, 1.0, start),
        }
    }
}

/// State of [`ChannelTransform::Elapsed`] and [`ChannelTransform::Integral`] at the first of some samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TransformStart {
    /// Time of the first sample since the start of the recording, s.
    pub time_s: f64,
    /// Integral from the start of the recording to the first sample, in the column's unit times s.
    pub integral: f64,
}

/// Integral at each value, `start` at the first.
fn integral(values: &[f64], sample_time_s: f64, start: f64) -> Vec<f64> {
    let step = |k: usize| match (k.checked_sub(2).and_then(|before| values.get(before)), values.get(k + 1)) {
        (Some(before), Some(after)) => (13.0 * (values[k - 1] + values[k]) - before - after) / 24.0,
        _ => 0.5 * (values[k - 1] + values[k]),
    };
    let sums = (0..values.len()).scan(start, |sum, k| {
        *sum += if k == 0 { 0.0 } else { sample_time_s * step(k) };
        Some(*sum)
    });
    sums.collect()
}

/// Derivative per sample.
fn rate(values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let weights: Vec<Vec<f64>> = (0..=REACH).map(weights).collect();
    let at = |row: usize| match (row.min(last - row).min(REACH), values) {
        (0, [_]) => 0.0,
        (0, [from, to]) => to - from,
        (0, [a, b, c, ..]) if row == 0 => 0.5 * (4.0 * b - 3.0 * a - c),
        (0, [.., c, b, a]) => -0.5 * (4.0 * b - 3.0 * a - c),
        (reach, _) => {
            let pairs = weights[reach].iter().zip(1..);
            pairs.map(|(weight, k)| weight * (values[row + k] - values[row - k])).sum()
        }
    };
    (0..values.len()).map(at).collect()
}

/// Weights of the differences between the k-th neighbours, k from 1: the derivative of the polynomial through `reach` samples on either
/// side.
fn weights(reach: usize) -> Vec<f64> {
    let m = reach as f64;
    let next =
        |(k, weight): &(f64, f64)| Some((k + 1.0, -weight * k * (m - k) / ((k + 1.0) * (m + k + 1.0))));
    std::iter::successors(Some((1.0, m / (m + 1.0))), next).take(reach).map(|(_, weight)| weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_that_of_the_tone_below_a_quarter_of_the_sampling_rate() {
        for (turns, tolerance) in [(0.05, 1e-12), (1.0 / 7.0, 6e-7), (0.25, 1.5e-3)] {
            let x = std::f64::consts::TAU * turns;
            let tone: Vec<f64> = (0..400).map(|k| (x * f64::from(k) + 0.3).sin()).collect();
            let found = ChannelTransform::Rate.apply(&tone, 0.01, TransformStart::default());
            for (k, value) in found.iter().enumerate().take(392).skip(8) {
                let expected = 100.0 * x * (x * k as f64 + 0.3).cos();
                assert!((value - expected).abs() < 100.0 * x * tolerance, "{turns} {k}: {value}, {expected}");
            }
        }
    }

    #[test]
    fn noise_weights_are_the_response_to_an_impulse() {
        let mut impulse = [0.0; 65];
        impulse[32] = 1.0;
        for take in [ChannelTransform::Value, ChannelTransform::Rate] {
            let mut found = take.apply(&impulse, 0.01, TransformStart::default());
            // The response to an impulse is the weights in reverse order.
            found.reverse();
            let reach = take.reach();
            let expected = take.noise();
            assert_eq!(expected.len(), 2 * reach + 1);
            for (found, expected) in found[32 - reach..].iter().zip(&expected) {
                assert!((found - expected * take.amplification(0.01)).abs() < 1e-12);
            }
            assert!((expected.iter().map(|w| w * w).sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_rate_follows_parabolas_up_to_the_ends() {
        let line = |k: f64| 1e4 + 3.0 * k + 0.25 * k * k;
        for rows in 3..40 {
            let values: Vec<f64> = (0..rows).map(|k| line(f64::from(k))).collect();
            for (k, derivative) in rate(&values).into_iter().enumerate() {
                assert!((derivative - (3.0 + 0.5 * k as f64)).abs() < 1e-9, "{rows} {k}: {derivative}");
            }
        }
        assert_eq!((rate(&[]), rate(&[2.0]), rate(&[2.0, 5.0])), (vec![], vec![0.0], vec![3.0, 3.0]));
    }
}
