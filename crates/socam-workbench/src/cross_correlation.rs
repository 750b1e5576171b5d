//! Whether the residuals of a fit depend on an input: their cross-correlation with the bounds of chance.

use std::ops::RangeInclusive;

use crate::residual_test::OF_95_PERCENT;

/// Lags, samples: at a positive one the input is earlier than the residual, as a cause is.
pub const LAGS: RangeInclusive<isize> = -20..=60;
/// As [`OF_95_PERCENT`], for the greatest of 81 independent lags (Bonferroni): correlated lags exceed it less often.
const OF_ALL_LAGS: f64 = 3.42;
/// Fewest pairs of which anything is said.
const LEAST: usize = 100;
/// Lags over which correlations of a signal with itself are summed, in roots of the number of samples.
const REACH: f64 = 4.0;

/// Cross-correlation of residuals with an input.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossCorrelation {
    /// Lags, samples.
    pub lags: Vec<isize>,
    /// Correlation coefficients of the residual with the input that many samples before it.
    pub values: Vec<f64>,
    /// Magnitude below which 95 % of the values of residuals without a relation to the input are.
    pub bound: f64,
}

/// A residual and the input at the same samples.
pub type Pair<'a> = [&'a [f64]; 2];

impl CrossCorrelation {
    /// Of residuals and an input in segments; products are not taken across their ends, nor with a missing value. `None` for fewer than
    /// 100 pairs, and where either is constant.
    ///
    /// # Method
    /// The independence test of residuals: Ljung, System Identification, 2nd edition, section 16.6. The variance of a lag is that of
    /// Bartlett for two independent stationary signals, the sum over k of the autocorrelation of the residual times that of the input,
    /// divided by the number of samples: neither needs to be white. The sum is taken under Parzen's lag window over four times the root
    /// of the number of samples. Bounds hold for one lag each. Parameters that were fitted to the same recording take up a part of a
    /// relation, so that the bounds are rather too wide than too narrow.
    #[must_use]
    pub fn new(segments: &[Pair<'_>]) -> Option<Self> {
        let centred = centred(segments)?;
        let count: usize = centred.iter().map(|[residual, _]| residual.len()).sum();
        let power =
            |signal: usize| -> f64 { centred.iter().flat_map(|own| &own[signal]).map(|v| v * v).sum() };
        let scale = (power(0) * power(1)).sqrt();
        let at = |lag: isize| {
            let [late, early] = [lag.max(0) as usize, (-lag).max(0) as usize];
            let pairs = centred
                .iter()
                .flat_map(|[residual, input]| residual.iter().skip(late).zip(input.iter().skip(early)));
            pairs.map(|(residual, input)| residual * input).sum::<f64>() / scale
        };
        let longest = centred.iter().map(|[residual, _]| residual.len()).max().unwrap_or(0);
        let lags: Vec<isize> = LAGS.filter(|lag| lag.unsigned_abs() < longest).collect();
        let values = lags.iter().map(|lag| at(*lag)).collect();
        Some(Self { lags, values, bound: OF_95_PERCENT * (bartlett(&centred) / count as f64).sqrt() })
    }

    /// Number of lags beyond the bounds.
    #[must_use]
    pub fn beyond(&self) -> usize {
        self.values.iter().filter(|value| value.abs() > self.bound).count()
    }

    /// Whether the residual depends on the input: a lag is so far beyond the bounds that chance brings any lag there in 5 % of all cases
    /// at most.
    #[must_use]
    pub fn is_related(&self) -> bool {
        let greatest = self.values.iter().fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
        greatest > OF_ALL_LAGS / OF_95_PERCENT * self.bound
    }

    /// What the values say, in a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let meaning = if self.is_related() {
            "the model lacks something that this input causes"
        } else {
            "nothing that this input causes is seen to be lacking"
        };
        format!(
            "{} of {} lags are beyond the 95 % bounds (by chance: about {:.0}): {meaning}",
            self.beyond(),
            self.values.len(),
            0.05 * self.values.len() as f64
        )
    }
}

/// Residuals and inputs without their means; a pair with a missing value counts as two means. `None` where nothing can be said.
fn centred(segments: &[Pair<'_>]) -> Option<Vec<[Vec<f64>; 2]>> {
    let is_whole = |(a, b): &(&f64, &f64)| a.is_finite() && b.is_finite();
    let whole = || segments.iter().flat_map(|[a, b]| a.iter().zip(*b)).filter(is_whole);
    let count = whole().count();
    if count < LEAST {
        return None;
    }
    let means = [
        whole().map(|(a, _)| a).sum::<f64>() / count as f64,
        whole().map(|(_, b)| b).sum::<f64>() / count as f64,
    ];
    let one = |[residual, input]: &Pair<'_>| {
        let mut own = [Vec::with_capacity(residual.len()), Vec::with_capacity(residual.len())];
        for pair in residual.iter().zip(*input) {
            let is_here = is_whole(&pair);
            own[0].push(if is_here { pair.0 - means[0] } else { 0.0 });
            own[1].push(if is_here { pair.1 - means[1] } else { 0.0 });
        }
        own
    };
    let found: Vec<[Vec<f64>; 2]> = segments.iter().map(one).collect();
    let varies = |signal: usize| {
        let power: f64 = found.iter().flat_map(|own| &own[signal]).map(|v| v * v).sum();
        power / count as f64 > (1e-12 * means[signal]).powi(2)
    };
    (varies(0) && varies(1)).then_some(found)
}

/// Variance of a correlation coefficient of two independent signals, times their number of samples.
fn bartlett(segments: &[[Vec<f64>; 2]]) -> f64 {
    let count: usize = segments.iter().map(|[residual, _]| residual.len()).sum();
    let reach = (REACH * (count as f64).sqrt()).ceil() as usize;
    let of = |signal: usize| {
        let mut sums = vec![0.0; reach + 1];
        for own in segments {
            let all = socam_spectrum::autocorrelation(&own[signal]);
            sums.iter_mut().zip(all).for_each(|(sum, value)| *sum += value);
        }
        let whole = sums[0].max(f64::MIN_POSITIVE);
        sums.iter_mut().for_each(|sum| *sum /= whole);
        sums
    };
    let [residual, input] = [of(0), of(1)];
    let later = residual.iter().zip(&input).enumerate().skip(1);
    let sum: f64 = later.map(|(lag, (a, b))| parzen(lag as f64 / reach as f64) * a * b).sum();
    // Parzen's window keeps the sum above zero, but for rounding.
    (1.0 + 2.0 * sum).max(1e-6)
}

/// Parzen's lag window at a share of its reach.
fn parzen(share: f64) -> f64 {
    if share <= 0.5 {
        1.0 - 6.0 * share.powi(2) * (1.0 - share)
    } else {
        2.0 * (1.0 - share).max(0.0).powi(3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        }

        /// A first-order filter with this pole over white noise.
        fn coloured(&mut self, pole: f64, count: usize) -> Vec<f64> {
            let mut last = 0.0;
            (0..count)
                .map(|_| {
                    last = pole * last + self.next();
                    last
                })
                .collect()
        }
    }

    /// Independent signals, white and coloured, are beyond the bounds in 5 % of the lags, and called related in 5 % of the cases at most.
    /// Bounds that took coloured signals for white ones would be passed by half of them.
    #[test]
    fn chance_is_beyond_the_bounds_as_often_as_they_say() {
        let mut noise = Noise(11);
        for poles in [[0.0, 0.0], [0.0, 0.95], [0.9, 0.95]] {
            let (mut beyond, mut all, mut related, mut white) = (0, 0, 0, 0);
            for _ in 0..150 {
                let [residual, input] = poles.map(|pole| noise.coloured(pole, 4000));
                let found = CrossCorrelation::new(&[
                    [&residual[..1500], &input[..1500]],
                    [&residual[1500..], &input[1500..]],
                ])
                .unwrap();
                beyond += found.beyond();
                all += found.values.len();
                related += usize::from(found.is_related());
                let bound = OF_95_PERCENT / 4000_f64.sqrt();
                white += found.values.iter().filter(|value| value.abs() > bound).count();
            }
            let share = |count: usize| count as f64 / all as f64;
            assert!((0.03..0.075).contains(&share(beyond)), "{poles:?}: {}", share(beyond));
            assert!(related <= 12, "{poles:?}: {related} of 150");
            if poles == [0.9, 0.95] {
                assert!(share(white) > 0.3, "{}", share(white));
            }
        }
    }

    /// A residual that keeps 3 samples later a tenth of a coloured input is found, at the lags after those 3 samples.
    #[test]
    fn what_the_model_lacks_is_seen() {
        let mut noise = Noise(5);
        let input = noise.coloured(0.8, 20_000);
        let rest = noise.coloured(0.5, 20_000);
        let residual: Vec<f64> =
            (0..20_000).map(|k| rest[k] + if k < 3 { 0.0 } else { 0.1 * input[k - 3] }).collect();
        let found = CrossCorrelation::new(&[[&residual, &input]]).unwrap();
        let greatest =
            (0..found.lags.len()).max_by(|a, b| found.values[*a].total_cmp(&found.values[*b])).unwrap();
        assert_eq!(found.lags[greatest], 3);
        assert!(found.is_related() && found.sentence().ends_with("lacks something that this input causes"));
        let unrelated = CrossCorrelation::new(&[[&rest, &input]]).unwrap();
        assert!(!unrelated.is_related(), "{unrelated:?}");
    }

    /// A sine that is left out of a model driven by that sine is found, although the correlations of neither end.
    #[test]
    fn a_periodic_misfit_is_seen() {
        let mut noise = Noise(9);
        let sine: Vec<f64> = (0..8000).map(|k| (0.02 * f64::from(k)).sin()).collect();
        let residual: Vec<f64> = sine.iter().map(|value| value + noise.next()).collect();
        assert!(CrossCorrelation::new(&[[&residual, &sine]]).unwrap().is_related());
    }

    #[test]
    fn missing_values_and_short_recordings() {
        let mut noise = Noise(3);
        let [mut residual, input] = [0.0, 0.0].map(|pole| noise.coloured(pole, 1000));
        residual[500] = f64::NAN;
        let found = CrossCorrelation::new(&[[&residual, &input]]).unwrap();
        assert!(found.values.iter().all(|value| value.is_finite()) && !found.is_related());
        assert!(CrossCorrelation::new(&[[&residual[..50], &input[..50]]]).is_none());
        assert!(CrossCorrelation::new(&[[&residual, &[2.0; 1000]]]).is_none(), "a constant input");
    }
}
