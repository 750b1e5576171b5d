//! The criterion by which all models are compared: the difference of predictive log scores, with its standard error.
//!
//! Under one noise model (sensor noise and discrepancy) a model's log score is minus half the sum of squared residuals on data that its
//! parameters were not fitted to. The difference of two models has a standard error from blocks of 1 s. Recordings are strata, not random
//! draws: they excite different motions by design, so only the scatter within each recording counts (W. G. Cochran, Sampling Techniques,
//! ch. 5). Weights of several models are pseudo-BMA weights with a Bayesian bootstrap over blocks (Y. Yao et al., Bayesian Analysis 13,
//! 2018).

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, Exp1};
use socam_identify::comparison::cross_validation::CrossValidation;

/// Largest number of the evaluation's blocks (0.2 s each) in one block of the criterion.
const MOST_MERGED: usize = 5;
/// Least number of blocks that a recording is divided into, if it is long enough.
const LEAST_BLOCKS: usize = 10;
/// Standard errors by which the ratio of two models' sums of squares must differ from one.
const RATIO_ERRORS: f64 = 2.0;
/// Draws of the bootstrap.
const DRAWS: usize = 500;
/// Discrepancy of a law: the real effect differs from its law by about this share of its contribution to the outputs, 1 (2 to 8 % between
/// tanh and bristle friction, and between fixed and load-dependent stiffness).
pub(crate) const LAW_DISCREPANCY: f64 = 0.08;
/// Part of that discrepancy that appears at other places, 1.
const DISCREPANCY_ELSEWHERE: f64 = 0.02;

/// Difference of log scores that the discrepancy of a law can make at its own place, if the law gains `gained` in log score. (A log score
/// is proportional to the square of the explained signal.) Smaller differences are not evidence for or against a law.
pub(crate) fn by_law(gained: f64) -> f64 {
    LAW_DISCREPANCY.powi(2) * gained.max(0.0)
}

/// Difference of log scores that the discrepancy of a law can make at other places.
pub(crate) fn by_law_elsewhere(gained: f64) -> f64 {
    DISCREPANCY_ELSEWHERE.powi(2) * gained.max(0.0)
}

/// A model's cross-validation and prior, for a comparison.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scored<'a> {
    pub(crate) validation: &'a CrossValidation,
    /// Log density of its parameters' prior.
    pub(crate) log_prior: f64,
}

/// Difference of two models' log scores, with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Difference {
    pub(crate) log_score: f64,
    pub(crate) std: f64,
}

/// Log score of `a` minus that of `b`, without priors.
pub(crate) fn difference(a: &CrossValidation, b: &CrossValidation) -> Difference {
    let strata = a.blocks.iter().zip(&b.blocks).map(|(a, b)| {
        let merged_blocks = merged_blocks(a);
        let blocks: Vec<f64> = a
            .chunks(merged_blocks)
            .zip(b.chunks(merged_blocks))
            .map(|(a, b)| -0.5 * (a.iter().sum::<f64>() - b.iter().sum::<f64>()))
            .collect();
        let n = blocks.len() as f64;
        let mean = blocks.iter().sum::<f64>() / n.max(1.0);
        let squares: f64 = blocks.iter().map(|block| (block - mean).powi(2)).sum();
        if n > 1.0 { n / (n - 1.0) * squares } else { 0.0 }
    });
    Difference { log_score: a.log_score() - b.log_score(), std: strata.sum::<f64>().sqrt() }
}

/// Number of the evaluation's blocks in one block of the criterion: 1 s of them, or fewer where a recording is short.
fn merged_blocks(blocks: &[f64]) -> usize {
    (blocks.len() / LEAST_BLOCKS).clamp(1, MOST_MERGED)
}

/// Whether `a` leaves less than `b` in most blocks: the mean logarithm of the ratio of a block's sums of squares exceeds [`RATIO_ERRORS`]
/// standard errors. Each block counts alike, however much of the misfit it holds.
pub(crate) fn leaves_less(a: &CrossValidation, b: &CrossValidation) -> bool {
    let each = a.blocks.iter().zip(&b.blocks).flat_map(|(a, b)| {
        let merged = merged_blocks(a);
        let sums = a.chunks(merged).zip(b.chunks(merged));
        sums.map(|(a, b)| (a.iter().sum::<f64>(), b.iter().sum::<f64>())).collect::<Vec<_>>()
    });
    // Masked samples are exactly zero.
    let ratios: Vec<f64> = each.filter(|(a, b)| *a > 0.0 && *b > 0.0).map(|(a, b)| (b / a).ln()).collect();
    let n = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / n;
    let variance = ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>() / (n - 1.0);
    mean > RATIO_ERRORS * (variance / n).sqrt()
}

/// Divisor of a difference of log scores for a law that gains `gained`: the difference that its discrepancy can make counts as one nat.
pub(crate) fn temper(gained: f64) -> f64 {
    by_law(gained).max(1.0)
}

/// Weights of competing models, in their order; they sum to one. `gain` is the gain of the best of them in log score over the model without
/// any.
pub(crate) fn weights(models: &[Scored<'_>], gain: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let temper = temper(gain);
    let count: usize = models.first().map_or(0, |model| model.validation.blocks.iter().map(Vec::len).sum());
    let fixed: Vec<f64> = models
        .iter()
        .map(|model| {
            let fitted: f64 = model.validation.blocks.iter().flatten().sum();
            (model.validation.log_score() + 0.5 * fitted) / temper + model.log_prior
        })
        .collect();
    let mut sums = vec![0.0; models.len()];
    for _ in 0..DRAWS {
        let multipliers: Vec<f64> = (0..count).map(|_| Exp1.sample(&mut random)).collect();
        let scores: Vec<f64> = models
            .iter()
            .zip(&fixed)
            .map(|(model, fixed)| reweighted(model.validation, &multipliers) / temper + fixed)
            .collect();
        let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = scores.iter().map(|score| (score - most).exp()).sum();
        sums.iter_mut().zip(&scores).for_each(|(sum, score)| *sum += (score - most).exp() / total);
    }
    sums.into_iter().map(|sum| sum / DRAWS as f64).collect()
}

/// Log score with the blocks weighted by `multipliers`, normalised within each recording.
fn reweighted(validation: &CrossValidation, multipliers: &[f64]) -> f64 {
    let mut next = multipliers.iter();
    let each = validation.blocks.iter().map(|blocks| {
        let own: Vec<(f64, f64)> = blocks
            .chunks(merged_blocks(blocks))
            .zip(&mut next)
            .map(|(block, m)| (block.iter().sum(), *m))
            .collect();
        let total: f64 = own.iter().map(|(_, m)| m).sum();
        let weighted: f64 = own.iter().map(|(squares, m)| squares * m).sum();
        -0.5 * weighted * own.len() as f64 / total.max(f64::MIN_POSITIVE)
    });
    each.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(levels: &[f64]) -> CrossValidation {
        let blocks: Vec<Vec<f64>> = levels
            .iter()
            .map(|level| (0..50).map(|k| level + f64::from(k % 7) + 0.1 * f64::from(k % 3)).collect())
            .collect();
        CrossValidation {
            held_out: blocks.iter().map(|b| b.iter().sum()).collect(),
            blocks,
            nearest: Vec::new(),
        }
    }

    /// Blocks count alike, although the last ones hold nearly all of an error that grows.
    #[test]
    fn what_leaves_less_in_most_blocks_is_told_from_chance() {
        let growing = |share: f64| {
            let blocks: Vec<f64> = (0..50).map(|k| share * 1.5_f64.powi(k)).collect();
            CrossValidation { held_out: vec![blocks.iter().sum()], blocks: vec![blocks], nearest: Vec::new() }
        };
        let (after, before) = (growing(0.3), growing(1.0));
        assert!(leaves_less(&after, &before) && !leaves_less(&before, &after));
        let mut shuffled = after.clone();
        shuffled.blocks[0].iter_mut().step_by(2).for_each(|block| *block *= 9.0);
        assert!(!leaves_less(&shuffled, &before));
    }

    /// An effect that acts in one recording only makes no scatter within the recordings.
    #[test]
    fn recordings_are_strata() {
        let (with, without) = (model(&[200.0, 200.0, 200.0]), model(&[200.0, 200.0, 230.0]));
        let difference = difference(&with, &without);
        assert!((difference.log_score - 750.0).abs() < 1e-9, "{difference:?}");
        assert!(difference.std < 1e-6, "{difference:?}");
    }

    #[test]
    fn scatter_between_blocks_makes_a_difference_uncertain() {
        let mut noisy = model(&[200.0]);
        noisy.blocks[0].iter_mut().enumerate().for_each(|(k, b)| *b += if k < 25 { 40.0 } else { -40.0 });
        let difference = difference(&noisy, &model(&[200.0]));
        assert!(difference.log_score.abs() < 1e-9 && difference.std > 300.0, "{difference:?}");
    }

    #[test]
    fn equal_models_share_their_weight_and_a_prior_decides() {
        let one = model(&[200.0, 210.0]);
        let scored = |log_prior| Scored { validation: &one, log_prior };
        let equal = weights(&[scored(0.0), scored(0.0)], 10.0, 1);
        assert!((equal[0] - 0.5).abs() < 1e-9);
        let strange = weights(&[scored(0.0), scored(-7.0)], 10.0, 1);
        assert!(strange[0] > 0.99);
        // Where the law gains much, seven units of the score are within its own discrepancy.
        let better = model(&[193.0, 203.0]);
        let both = [Scored { validation: &better, log_prior: 0.0 }, scored(0.0)];
        assert!(weights(&both, 10.0, 1)[1] < 1e-3 && weights(&both, 1e6, 1)[1] > 0.4);
    }
}
