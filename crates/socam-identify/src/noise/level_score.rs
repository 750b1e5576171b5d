//! Score and Fisher information of the noise levels, from innovations filters at perturbed levels.

use nalgebra::{DMatrix, DVector};
use socam_model::Equations;

use crate::{
    Intersample,
    noise::{
        filter_batch::{FilterBatch, FilterState},
        innovations_filter::{InnovationsFilter, NoiseLevels},
    },
};

/// Step of central differences in the logarithm of a variance.
pub(crate) const STEP: f64 = 0.05;

/// Largest step in the logarithm of a variance.
pub(crate) const LONGEST: f64 = 1.5;

/// The innovations filter at some noise levels, and filters at slightly larger and slightly smaller values of each level.
pub(crate) struct PerturbedFilters {
    /// Filters at the noise levels, then, for each level that is estimated, filters at a larger and at a smaller value.
    filters: FilterBatch,
    inverse_root: DMatrix<f64>,
    /// Logarithm of the determinant of the innovation's covariance.
    log_determinant: f64,
    /// Derivative of the innovation's covariance with respect to each log variance, in units of its root.
    spreads: Vec<DMatrix<f64>>,
}

/// Score and Fisher information of the log variances, and the likelihood at the levels.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    pub(crate) sensitivity: DVector<f64>,
    pub(crate) information: DMatrix<f64>,
    /// Minus twice the log-likelihood, of residuals in the filter's units, without the constant of the normal density.
    pub(crate) deviance: f64,
    /// Squared residuals of each output, in the same units, and the number of samples.
    pub(crate) squares: DVector<f64>,
    pub(crate) samples: f64,
}

impl Score {
    pub(crate) fn new(levels: usize, outputs: usize) -> Self {
        Self {
            sensitivity: DVector::zeros(levels),
            information: DMatrix::zeros(levels, levels),
            deviance: 0.0,
            squares: DVector::zeros(outputs),
            samples: 0.0,
        }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.sensitivity += &other.sensitivity;
        self.information += &other.information;
        self.deviance += other.deviance;
        self.squares += &other.squares;
        self.samples += other.samples;
    }

    /// Removes a level from the step if the likelihood rises with it: for a level at its upper bound.
    pub(crate) fn hold_if_rising(&mut self, level: usize) {
        if self.sensitivity[level] > 0.0 {
            self.sensitivity[level] = 0.0;
            self.information.row_mut(level).fill(0.0);
            self.information.column_mut(level).fill(0.0);
        }
    }

    /// Step of the logarithms of the variances, and the gain of log-likelihood that it predicts.
    pub(crate) fn step(&self) -> (Vec<f64>, f64) {
        let levels = self.sensitivity.len();
        // The identity keeps a level without information unchanged.
        let information = &self.information + DMatrix::identity(levels, levels);
        let step = information.lu().solve(&self.sensitivity).unwrap_or_else(|| DVector::zeros(levels));
        let step = step.map(|s| s.clamp(-LONGEST, LONGEST));
        let gain = self.sensitivity.dot(&step) - 0.5 * step.dot(&(&self.information * &step));
        (step.as_slice().to_vec(), gain)
    }
}

/// A level by its index: outputs first, then inputs. NaN beyond them.
pub(crate) fn of(levels: &NoiseLevels, sought: usize) -> f64 {
    levels.outputs.iter().chain(&levels.inputs).nth(sought).copied().unwrap_or(f64::NAN)
}

/// The levels with one log variance changed; `sought` is the index of the level.
pub(crate) fn scaled(levels: &NoiseLevels, sought: usize, log_change: f64) -> NoiseLevels {
    let mut levels = levels.clone();
    let outputs = levels.outputs.len();
    let std =
        if sought < outputs { &mut levels.outputs[sought] } else { &mut levels.inputs[sought - outputs] };
    *std *= (0.5 * log_change).exp();
    levels
}

impl PerturbedFilters {
    /// `None` where one of the filters does not exist.
    pub(crate) fn new(
        equations: &Equations,
        levels: &NoiseLevels,
        sought: &[usize],
        units: &[f64],
        sample_time_s: f64,
        intersample: &[Intersample],
    ) -> Option<Self> {
        let filter = |levels: &NoiseLevels| {
            InnovationsFilter::new(equations, levels, units, sample_time_s, intersample)
        };
        let centre = filter(levels)?;
        let root = centre.inverse_root();
        let mut filters = vec![centre];
        let mut spreads = Vec::new();
        for level in sought {
            let pair = [filter(&scaled(levels, *level, STEP))?, filter(&scaled(levels, *level, -STEP))?];
            let sensitivity = (&pair[0].covariance - &pair[1].covariance) / (2.0 * STEP);
            spreads.push(&root * sensitivity * root.transpose());
            filters.extend(pair);
        }
        let log_determinant = filters[0].covariance.determinant().ln();
        let filters = FilterBatch::new(&filters.iter().collect::<Vec<_>>());
        Some(Self { filters, inverse_root: root, log_determinant, spreads })
    }

    pub(crate) fn start(&self) -> LevelScore<'_> {
        let (levels, outputs) = (self.spreads.len(), self.inverse_root.nrows());
        LevelScore {
            perturbed: self,
            filters: self.filters.initial_state(),
            moved: vec![0.0; levels * outputs],
            along: vec![0.0; levels],
            across: vec![0.0; levels * levels],
            white: DMatrix::zeros(outputs, outputs),
            squares: DVector::zeros(outputs),
            samples: 0.0,
        }
    }
}

/// Sums along one segment from which the score follows.
pub(crate) struct LevelScore<'p> {
    perturbed: &'p PerturbedFilters,
    filters: FilterState,
    /// Derivatives of the last innovation with respect to each level, in units of the covariance's root, level by level.
    moved: Vec<f64>,
    /// Sums of the products of white innovations and their derivatives, of pairs of derivatives, and of pairs of white innovations.
    along: Vec<f64>,
    across: Vec<f64>,
    white: DMatrix<f64>,
    squares: DVector<f64>,
    samples: f64,
}

impl LevelScore<'_> {
    /// Adds the residuals of one sample, one per output. Samples with a missing output only update the filters.
    pub(crate) fn take(&mut self, residual: &[f64], present: &[bool]) {
        let PerturbedFilters { filters, inverse_root, spreads, .. } = self.perturbed;
        filters.advance(&mut self.filters, residual, present);
        if present.contains(&false) {
            return;
        }
        let (stride, outputs, levels) = (filters.stride(), residual.len(), spreads.len());
        let FilterState { innovation, white, .. } = &self.filters;
        for (level, moved) in self.moved.chunks_exact_mut(outputs).enumerate() {
            let change =
                |o: usize| innovation[o * stride + 2 * level + 1] - innovation[o * stride + 2 * level + 2];
            for (o, moved) in moved.iter_mut().enumerate() {
                *moved = (0..=o).map(|k| inverse_root[(o, k)] * change(k)).sum::<f64>() / (2.0 * STEP);
            }
            let along: f64 = moved.iter().enumerate().map(|(o, moved)| white[o * stride] * moved).sum();
            self.along[level] += along;
        }
        for i in 0..levels {
            for j in 0..levels {
                let each = self.moved[i * outputs..].iter().zip(&self.moved[j * outputs..]).take(outputs);
                self.across[i * levels + j] += each.map(|(a, b)| a * b).sum::<f64>();
            }
        }
        for i in 0..outputs {
            (0..outputs).for_each(|j| self.white[(i, j)] += white[i * stride] * white[j * stride]);
            self.squares[i] += residual[i] * residual[i];
        }
        self.samples += 1.0;
    }

    pub(crate) fn finish(self) -> Score {
        let PerturbedFilters { spreads, log_determinant, .. } = self.perturbed;
        let spread = |i: usize| 0.5 * (spreads[i].dot(&self.white) - self.samples * spreads[i].trace());
        let constant = |i: usize, j: usize| 0.5 * self.samples * spreads[i].dot(&spreads[j]);
        let levels = spreads.len();
        Score {
            sensitivity: DVector::from_fn(levels, |i, _| spread(i) - self.along[i]),
            information: DMatrix::from_fn(levels, levels, |i, j| {
                constant(i, j) + self.across[i * levels + j]
            }),
            deviance: self.white.trace() + self.samples * log_determinant,
            squares: self.squares,
            samples: self.samples,
        }
    }
}
