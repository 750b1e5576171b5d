//! Model discrepancy: what residuals hold beyond sensor noise, as one autoregressive process per output.
//!
//! Residuals of a real model are sensor noise plus what the model lacks, and the second part is correlated over time (M. C. Kennedy and
//! A. O'Hagan, J. R. Stat. Soc. B 63, 2001). [`Discrepancy::estimate`] fits an autoregression to residuals that the sensor-noise filter has
//! whitened: coefficients by Yule-Walker and Levinson-Durbin, order by the Bayesian information criterion (G. Schwarz, Ann. Stat. 6, 1978).
//! The prediction-error filter of that process then whitens residuals and sensitivities alike. Where the residuals are
//! white sensor noise the order is 0 and the filter only divides by their standard deviation.
//!
//! # Breaks when
//! The discrepancy is not stationary: one process stands for all recordings of a sample time. Block-robust covariances allow for that.

use faer::{MatMut, reborrow::ReborrowMut};

/// Largest order that is tried.
const MOST_ORDER: usize = 12;
/// White noise, as a share of the residual's power, that a process is taken to have at least. It bounds how much less slow residuals count than fast
/// ones, to 30 dB in power: a short filter would else see differences between neighbouring samples only, and nothing of what is slow.
const LEAST_WHITE: f64 = 1e-3;
/// Samples per coefficient that are needed to estimate one.
const LEAST_SAMPLES: usize = 50;
/// Smallest innovation variance as a share of the residual's: below it rounding decides.
const LEAST_SHARE: f64 = 1e-8;

/// Prediction-error filters of all outputs at one sample time.
#[derive(Debug, Clone)]
pub(crate) struct Discrepancy {
    sample_time_s: f64,
    outputs: Vec<Autoregression>,
}

/// One output's process: the best linear predictor of each order up to its own, for the first samples after a gap have few before them.
#[derive(Debug, Clone)]
struct Autoregression {
    predictors: Vec<OnePredictor>,
}

/// Predicts a sample from so many before it.
#[derive(Debug, Clone)]
struct OnePredictor {
    /// Factor of the sample so many steps back, from one step on.
    coefficients: Vec<f64>,
    /// One over the standard deviation of its error.
    inverse_std: f64,
}

/// Whitened residuals of one segment: its sample time and, per output, its values; zero where one is missing.
pub(crate) type Segment<'a> = (f64, &'a [Vec<f64>]);

impl Discrepancy {
    /// One filter for each of the sample times of some segments.
    pub(crate) fn estimate(segments: &[Segment<'_>]) -> Vec<Self> {
        let mut times: Vec<f64> = segments.iter().map(|(time_s, _)| *time_s).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let each = times.into_iter().map(|sample_time_s| {
            let own: Vec<&[Vec<f64>]> =
                segments.iter().filter(|(time_s, _)| *time_s == sample_time_s).map(|(_, all)| *all).collect();
            let outputs = own.first().map_or(0, |all| all.len());
            let fit =
                |output: usize| Autoregression::fit(&own.iter().map(|all| &*all[output]).collect::<Vec<_>>());
            Self { sample_time_s, outputs: (0..outputs).map(fit).collect() }
        });
        each.collect()
    }

    /// The filter for a sample time.
    pub(crate) fn at(all: &[Self], sample_time_s: f64) -> Option<&Self> {
        all.iter().find(|own| own.sample_time_s == sample_time_s)
    }

    /// At rest before the first sample, for blocks of up to `width` columns.
    pub(crate) fn start(&self, width: usize) -> Filter<'_> {
        let history = self.outputs.iter().map(|own| vec![0.0; own.order() * width]).collect();
        Filter { discrepancy: self, history, run: vec![0; self.outputs.len()], buffer: Vec::new() }
    }
}

impl Autoregression {
    fn order(&self) -> usize {
        self.predictors.len() - 1
    }

    fn fit(segments: &[&[f64]]) -> Self {
        let count: usize = segments.iter().map(|s| s.iter().filter(|value| **value != 0.0).count()).sum();
        let most = MOST_ORDER.min(count / LEAST_SAMPLES);
        let covariance: Vec<f64> = (0..=most)
            .map(|lag| {
                let products = segments
                    .iter()
                    .map(|s| s.iter().zip(s.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>());
                products.sum::<f64>() / count.max(1) as f64
            })
            .collect();
        let mut bounded = covariance.clone();
        bounded[0] *= 1.0 + LEAST_WHITE;
        let all = levinson_durbin(&bounded);
        let n = count.max(2) as f64;
        let criterion =
            |(order, (_, variance)): (usize, &(Vec<f64>, f64))| n * variance.ln() + order as f64 * n.ln();
        let scores: Vec<f64> = all.iter().enumerate().map(criterion).collect();
        let best = (0..scores.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b])).unwrap_or(0);
        let predictors = all.into_iter().take(best + 1).map(|(coefficients, _)| {
            let variance = error_variance(&covariance, &coefficients);
            OnePredictor {
                coefficients,
                inverse_std: if variance > 0.0 { 1.0 / variance.sqrt() } else { 1.0 },
            }
        });
        Self { predictors: predictors.collect() }
    }
}

/// Variance of what a predictor leaves of a series with these autocovariances.
fn error_variance(covariance: &[f64], coefficients: &[f64]) -> f64 {
    let filter: Vec<f64> = std::iter::once(1.0).chain(coefficients.iter().map(|c| -c)).collect();
    let pairs = filter
        .iter()
        .enumerate()
        .flat_map(|(i, a)| filter.iter().enumerate().map(move |(j, b)| (i, j, a * b)));
    pairs.map(|(i, j, product)| product * covariance[i.abs_diff(j)]).sum()
}

/// Predictors of all orders from autocovariances, with the variances of their errors; white noise of unit variance where there are none.
fn levinson_durbin(covariance: &[f64]) -> Vec<(Vec<f64>, f64)> {
    let power = covariance[0];
    if !(power.is_finite() && power > 0.0) {
        return vec![(Vec::new(), 1.0)];
    }
    let mut all: Vec<(Vec<f64>, f64)> = vec![(Vec::new(), power)];
    for order in 1..covariance.len() {
        let (last, variance) = &all[order - 1];
        let known: f64 = last.iter().enumerate().map(|(i, c)| c * covariance[order - 1 - i]).sum();
        let reflection = (covariance[order] - known) / variance;
        let variance = variance * (1.0 - reflection * reflection);
        if variance.is_nan() || variance < LEAST_SHARE * power {
            break;
        }
        let mut next: Vec<f64> = (0..order - 1).map(|i| last[i] - reflection * last[order - 2 - i]).collect();
        next.push(reflection);
        all.push((next, variance));
    }
    all
}

/// The filters along one segment.
pub(crate) struct Filter<'d> {
    discrepancy: &'d Discrepancy,
    /// By output, column by column, the samples before the next block.
    history: Vec<Vec<f64>>,
    /// By output, present samples in a row before the next block.
    run: Vec<usize>,
    buffer: Vec<f64>,
}

impl Filter<'_> {
    /// Filters consecutive samples in place. `block` holds `samples` rows of each output, one output after the other; its first column is
    /// the one numbered `first` of the widest block. `present` is by row of the block; a missing sample stays zero, and the ones
    /// after it are predicted from fewer.
    pub(crate) fn apply(
        &mut self,
        mut block: MatMut<'_, f64>,
        samples: usize,
        present: &[bool],
        first: usize,
    ) {
        for (output, own) in self.discrepancy.outputs.iter().enumerate() {
            let here = &present[output * samples..(output + 1) * samples];
            let order = own.order();
            let orders: Vec<Option<usize>> = here
                .iter()
                .map(|here| {
                    let known = self.run[output];
                    self.run[output] = if *here { known + 1 } else { 0 };
                    here.then_some(known.min(order))
                })
                .collect();
            let mut rows = block.rb_mut().subrows_mut(output * samples, samples);
            for column in 0..rows.ncols() {
                let history = &mut self.history[output][(first + column) * order..][..order];
                self.buffer.clear();
                self.buffer.extend_from_slice(history);
                self.buffer.extend(rows.as_ref().col(column).iter());
                filter_column(own, &orders, &self.buffer, rows.rb_mut().col_mut(column));
                history.copy_from_slice(&self.buffer[samples..]);
            }
        }
    }
}

fn filter_column(
    own: &Autoregression,
    orders: &[Option<usize>],
    buffer: &[f64],
    mut column: faer::ColMut<'_, f64>,
) {
    let order = own.order();
    for (k, chosen) in orders.iter().enumerate() {
        let Some(chosen) = chosen else {
            column[k] = 0.0;
            continue;
        };
        let OnePredictor { coefficients, inverse_std } = &own.predictors[*chosen];
        let before = buffer[order + k - chosen..order + k].iter().rev();
        let predicted: f64 = coefficients.iter().zip(before).map(|(c, value)| c * value).sum();
        column[k] = (buffer[order + k] - predicted) * inverse_std;
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn process(coefficients: [f64; 2], std: f64, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut all = vec![0.0, 0.0];
        for k in 2..8000 {
            let noise: f64 = StandardNormal.sample(&mut random);
            all.push(coefficients[0] * all[k - 1] + coefficients[1] * all[k - 2] + std * noise);
        }
        all
    }

    #[test]
    fn white_noise_has_order_zero_and_its_own_level() {
        let outputs = [process([0.0, 0.0], 3.0, 1)];
        let all = Discrepancy::estimate(&[(1e-3, &outputs)]);
        assert_eq!(all[0].outputs[0].order(), 0);
        assert!((all[0].outputs[0].predictors[0].inverse_std - 1.0 / 3.0).abs() < 0.01);
    }

    /// The filter leaves unit white noise, block boundaries and gaps included.
    #[test]
    fn a_correlated_discrepancy_is_whitened() {
        let outputs = [process([1.6, -0.65], 0.5, 2), process([0.0, 0.0], 2.0, 3)];
        let all = Discrepancy::estimate(&[(1e-3, &outputs)]);
        assert_eq!(all[0].outputs.iter().map(Autoregression::order).collect::<Vec<_>>(), [2, 0]);
        let mut filter = all[0].start(3);
        let mut white: Vec<f64> = Vec::new();
        for start in (0..8000).step_by(100) {
            let mut block = Mat::from_fn(200, 2, |i, _| outputs[i / 100][start + i % 100]);
            let present: Vec<bool> = (0..200).map(|i| i != 50).collect();
            filter.apply(block.as_mut(), 100, &present, 1);
            assert_eq!(block[(50, 0)], 0.0);
            white.extend((0..100).filter(|i| *i != 50).map(|i| block[(i, 1)]));
        }
        let mean_square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        assert!((mean_square(&white) - 1.0).abs() < 0.05, "{}", mean_square(&white));
        let neighbours: f64 =
            white.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / white.len() as f64;
        assert!(neighbours.abs() < 0.05, "{neighbours}");
    }
}
