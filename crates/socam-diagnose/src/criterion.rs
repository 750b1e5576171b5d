//! The one criterion by which models are compared: the predictive log score, by block.
//!
//! Under one noise model (sensor noise and discrepancy) a model's log score is minus half the sum of squares that it leaves on data its
//! parameters were not fitted to. The difference of two models has a standard error from blocks of a second. Recordings are
//! strata, not draws: what they excite differs by design, so that only the scatter within each of them counts
//! (W. G. Cochran, Sampling Techniques, ch. 5). Weights of several models are pseudo-BMA weights with a Bayesian bootstrap over blocks
//! (Y. Yao et al., Bayesian Analysis 13, 2018).

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, Exp1};
use socam_identify::comparison::cross_validation::CrossValidation;

/// Blocks of the evaluation (0.2 s each) that are one block here, at most; and blocks that a recording is to have at least.
const TOGETHER: usize = 5;
const LEAST_BLOCKS: usize = 10;
/// Draws of the bootstrap.
const DRAWS: usize = 500;
/// A law is a simplification: its real counterpart differs from it by about this share of its own contribution to the outputs (tanh against
/// bristle friction: 2 to 8 %; fixed against load-dependent stiffness likewise).
const LAW_DISCREPANCY: f64 = 0.08;
/// The part of that which shows at other places.
const DISCREPANCY_ELSEWHERE: f64 = 0.02;

/// What a law's own discrepancy may make of a difference of log scores, where the law gains so much at its place: a log score goes with the
/// square of what is explained. Smaller differences say nothing for or against the law.
pub(crate) fn by_law(gained: f64) -> f64 {
    LAW_DISCREPANCY.powi(2) * gained.max(0.0)
}

/// The same at other places.
pub(crate) fn by_law_elsewhere(gained: f64) -> f64 {
    DISCREPANCY_ELSEWHERE.powi(2) * gained.max(0.0)
}

/// What a comparison needs to know of a model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scored<'a> {
    pub(crate) validation: &'a CrossValidation,
    /// Log density of its parameters' prior.
    pub(crate) log_prior: f64,
}

/// By how much one model's log score is above another's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Difference {
    pub(crate) log_score: f64,
    pub(crate) std: f64,
}

/// How much better `a` predicts than `b`, priors not counted.
pub(crate) fn difference(a: &CrossValidation, b: &CrossValidation) -> Difference {
    let strata = a.blocks.iter().zip(&b.blocks).map(|(a, b)| {
        let together = together(a);
        let blocks: Vec<f64> = a
            .chunks(together)
            .zip(b.chunks(together))
            .map(|(a, b)| -0.5 * (a.iter().sum::<f64>() - b.iter().sum::<f64>()))
            .collect();
        let n = blocks.len() as f64;
        let mean = blocks.iter().sum::<f64>() / n.max(1.0);
        let squares: f64 = blocks.iter().map(|block| (block - mean).powi(2)).sum();
        if n > 1.0 { n / (n - 1.0) * squares } else { 0.0 }
    });
    Difference { log_score: a.log_score() - b.log_score(), std: strata.sum::<f64>().sqrt() }
}

/// Blocks of a recording that are one: a second, or less where it is short.
fn together(blocks: &[f64]) -> usize {
    (blocks.len() / LEAST_BLOCKS).clamp(1, TOGETHER)
}

/// By how much a difference of log scores is divided to be a log likelihood ratio, where a law gains so much: its own discrepancy counts as one.
pub(crate) fn temper(gained: f64) -> f64 {
    by_law(gained).max(1.0)
}

/// Weights of competing models, in their order; they sum to one. `gain` is what the best of them gains in log score over having none.
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

/// Log score with each block counted so many times, normalised within each recording.
fn reweighted(validation: &CrossValidation, multipliers: &[f64]) -> f64 {
    let mut next = multipliers.iter();
    let each = validation.blocks.iter().map(|blocks| {
        let own: Vec<(f64, f64)> = blocks
            .chunks(together(blocks))
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
        CrossValidation { held_out: blocks.iter().map(|b| b.iter().sum()).collect(), blocks }
    }

    /// One recording that shows an effect and others that do not make no scatter by themselves.
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
