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
    /// Derivative of the innovation's covariance with respect to each log variance, in units of its root.
    spreads: Vec<DMatrix<f64>>,
}

/// Score and Fisher information of the log variances.
#[derive(Debug, Clone)]
pub(crate) struct Score {
    pub(crate) sensitivity: DVector<f64>,
    pub(crate) information: DMatrix<f64>,
}

impl Score {
    pub(crate) fn new(levels: usize) -> Self {
        Self { sensitivity: DVector::zeros(levels), information: DMatrix::zeros(levels, levels) }
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.sensitivity += &other.sensitivity;
        self.information += &other.information;
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
        let filters = FilterBatch::new(&filters.iter().collect::<Vec<_>>());
        Some(Self { filters, inverse_root: root, spreads })
    }

    pub(crate) fn start(&self) -> LevelScore<'_> {
        LevelScore {
            perturbed: self,
            filters: self.filters.initial_state(),
            score: Score::new(self.spreads.len()),
        }
    }
}

/// Score along one segment.
pub(crate) struct LevelScore<'p> {
    perturbed: &'p PerturbedFilters,
    filters: FilterState,
    pub(crate) score: Score,
}

impl LevelScore<'_> {
    /// Adds the residuals of one sample, one per output. Samples with a missing output only update the filters.
    pub(crate) fn take(&mut self, residual: &[f64], present: &[bool]) {
        let PerturbedFilters { filters, inverse_root, spreads } = self.perturbed;
        filters.advance(&mut self.filters, residual, present);
        if present.contains(&false) {
            return;
        }
        let (stride, outputs) = (filters.stride(), residual.len());
        let innovation = |output: usize, lane: usize| self.filters.innovation[output * stride + lane];
        let white = DVector::from_fn(outputs, |o, _| self.filters.white[o * stride]);
        // Derivative of the innovation with respect to each level, in units of the covariance's root.
        let moved = DMatrix::from_fn(outputs, spreads.len(), |o, level| {
            (innovation(o, 2 * level + 1) - innovation(o, 2 * level + 2)) / (2.0 * STEP)
        });
        let moved = inverse_root * moved;
        for (i, spread) in spreads.iter().enumerate() {
            let sensitivity = moved.column(i);
            self.score.sensitivity[i] +=
                0.5 * (white.dot(&(spread * &white)) - spread.trace()) - white.dot(&sensitivity);
            for (j, other) in spreads.iter().enumerate() {
                self.score.information[(i, j)] += 0.5 * spread.dot(other) + sensitivity.dot(&moved.column(j));
            }
        }
    }
}
