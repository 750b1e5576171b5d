//! The distribution of a statistic on a healthy bench.

/// Standard score of the quantile at which the spread of a statistic is taken: its estimate is below the true one for one bench in ten.
const SPREAD_QUANTILE: f64 = -1.2816;
/// Largest number of blocks over which correlation is summed.
const MOST_LAGS: usize = 8;
/// Parts into which the healthy blocks are divided to see whether their mean drifts.
const PARTS: usize = 6;
/// Largest deviation of one block that counts, in standard deviations. One block alone raises no alarm, however large its deviation.
pub(crate) const CLIP: f64 = 4.0;

/// Mean and spread of a statistic over healthy blocks.
///
/// A mean over m blocks of a healthy bench differs from that of the n baseline blocks with the variance
/// spread^2 (c (1/m + 1/n) + d). c is 1 plus twice the sum of the correlations of successive blocks, and d is the variance of slow
/// drifts, from the means of six parts of the baseline.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Null {
    mean: f64,
    spread: f64,
    correlation: f64,
    drift: f64,
    count: f64,
    /// Factor on the standard deviation of means, so that the baseline itself raises no alarm, 1.
    margin: f64,
}

impl Null {
    /// Estimates the distribution from values of successive healthy blocks; missing values are NaN. `None` if fewer than three are
    /// present or all are equal.
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let present: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let count = present.len() as f64;
        if present.len() < 3 {
            return None;
        }
        let mut sorted = present.clone();
        sorted.sort_by(f64::total_cmp);
        let quantile = |share: f64| sorted[((sorted.len() - 1) as f64 * share).round() as usize];
        // The spread without outliers, by the quartiles of a normal distribution, limits those that count.
        let limit = CLIP * (quantile(0.75) - quantile(0.25)) / 1.349;
        let median = quantile(0.5);
        let limit = if limit > 0.0 { limit } else { f64::INFINITY };
        let clipped: Vec<f64> = present.iter().map(|v| v.clamp(median - limit, median + limit)).collect();
        let mean = clipped.iter().sum::<f64>() / count;
        let variance = clipped.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
        if !(variance.is_normal() && variance > 0.0) {
            return None;
        }
        // Wilson and Hilferty's cube root of the chi-square distribution.
        let ninth = 2.0 / (9.0 * (count - 1.0));
        let lower = (1.0 - ninth + SPREAD_QUANTILE * ninth.sqrt()).max(0.2).powi(3);
        let spread = (variance / lower).sqrt();
        let standard: Vec<f64> = clipped.iter().map(|v| (v - mean) / variance.sqrt()).collect();
        let correlation = correlation(&standard);
        let drift = drift(&standard, correlation);
        Some(Self { mean, spread, correlation, drift, count, margin: 1.0 })
    }

    /// Deviation of a block's value from the mean, in standard deviations, clipped.
    pub(crate) fn deviation(&self, value: f64) -> f64 {
        ((value - self.mean) / self.spread).clamp(-CLIP, CLIP)
    }

    /// Standard deviation of the mean of `blocks` deviations.
    pub(crate) fn std_of_mean(&self, blocks: f64) -> f64 {
        self.margin * (self.correlation * (1.0 / blocks + 1.0 / self.count) + self.drift).sqrt()
    }

    /// Multiplies the standard deviations by `factor`, but never reduces them.
    pub(crate) fn widened(self, factor: f64) -> Self {
        Self { margin: self.margin * factor.max(1.0), ..self }
    }
}

/// 1 plus twice the sum of the autocorrelations, with Bartlett's weights (W. K. Newey and K. D. West, Econometrica 55, 1987); at least 1.
fn correlation(standard: &[f64]) -> f64 {
    let lags = MOST_LAGS.min(standard.len() / 8);
    let at = |lag: usize| {
        let pairs = standard.iter().zip(&standard[lag..]);
        pairs.map(|(a, b)| a * b).sum::<f64>() / standard.len() as f64
    };
    let sum: f64 = (1..=lags).map(|lag| (1.0 - lag as f64 / (lags + 1) as f64) * at(lag)).sum();
    (1.0 + 2.0 * sum).max(1.0)
}

/// Variance of the means of parts beyond that of independent blocks; at least 0.
fn drift(standard: &[f64], correlation: f64) -> f64 {
    let rows = standard.len() / PARTS;
    if rows < 4 {
        return 0.0;
    }
    let means = standard.chunks_exact(rows).map(|part| part.iter().sum::<f64>() / rows as f64);
    let power = means.clone().map(|mean| mean * mean).sum::<f64>() / means.count() as f64;
    (power - correlation / rows as f64).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform numbers of variance 1.
    fn noise(count: usize) -> Vec<f64> {
        let mut state = 7_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * 3.0_f64.sqrt()
        };
        (0..count).map(|_| draw()).collect()
    }

    #[test]
    fn mean_and_spread_are_those_of_the_values() {
        let mut values: Vec<f64> = noise(400).iter().map(|v| 5.0 + 2.0 * v).collect();
        // One outlier and one missing value.
        (values[10], values[20]) = (1e6, f64::NAN);
        let null = Null::of(&values).unwrap();
        assert!((null.mean - 5.0).abs() < 0.3 && (1.9..2.3).contains(&null.spread), "{null:?}");
        assert!((null.std_of_mean(4.0) - 0.5).abs() < 0.1, "{null:?}");
        assert_eq!(null.deviation(1e9), CLIP);
    }

    #[test]
    fn correlated_and_drifting_values_have_wider_means() {
        let white = noise(600);
        let smooth: Vec<f64> = white.windows(4).map(|four| four.iter().sum::<f64>() / 2.0).collect();
        let plain = Null::of(&white).unwrap().std_of_mean(50.0);
        let correlated = Null::of(&smooth).unwrap().std_of_mean(50.0);
        assert!((correlated / plain - 2.0).abs() < 0.5, "{correlated} {plain}");
        let drifting: Vec<f64> = white.iter().enumerate().map(|(k, v)| v + 2e-3 * k as f64).collect();
        assert!(Null::of(&drifting).unwrap().std_of_mean(100.0) > 2.0 * plain);
    }

    #[test]
    fn a_constant_is_no_statistic() {
        assert_eq!(Null::of(&[1.0; 50]), None);
        assert_eq!(Null::of(&[1.0, f64::NAN, 2.0]), None);
    }
}
