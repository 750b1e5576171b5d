//! Folds predictions and sensitivities of one segment, block by block, into its triangular factor.

use std::sync::Arc;

use faer::{Mat, MatRef, reborrow::ReborrowMut};

use crate::{
    evaluation::{
        segment::{ChannelSums, SegmentEvaluation, is_determined},
        weights::Weights,
    },
    matrix::dot,
    noise::{
        discrepancy::Discrepancy,
        level_score,
        prewhitening::{self, Prewhitening},
    },
    optimiser::qr::{self, QrAccumulator},
    preprocessing::outlier_detector::OutlierDetector,
    problem::Problem,
    progress::ProgressMonitor,
};

/// Length of the blocks of scores, s: longer than the correlation time of residuals after the filters of a noise model.
const COMPARED_BLOCK_S: f64 = 0.2;

/// Length of the blocks of scores without a noise model, s.
const BLOCK_S: f64 = 0.5;

/// Folds predictions and sensitivities of one segment into triangular factors.
pub(crate) struct ResidualAccumulator<'w> {
    nuisance: usize,
    globals: usize,
    with_nuisance: QrAccumulator,
    without_nuisance: QrAccumulator,
    channels: Vec<ChannelSums>,
    weighted_squares: f64,
    samples: f64,
    pub(crate) unresolved: u64,
    prewhitening: Option<prewhitening::PrewhiteningState<'w>>,
    discrepancy: Option<&'w Discrepancy>,
    level_score: Option<level_score::LevelScore<'w>>,
    detector: Option<OutlierDetector<'w>>,
    scores: Option<Scores>,
    innovations: Option<Vec<Vec<f64>>>,
    present: Vec<bool>,
    /// Nuisance parameters that keep their values.
    pub(crate) still: Vec<usize>,
    /// Sum of squares above which the evaluation is given up.
    pub(crate) most: f64,
    /// The monitor whose end of the search gives the evaluation up; `None` where the evaluation is needed.
    pub(crate) tentative: Option<ProgressMonitor>,
}

impl<'w> ResidualAccumulator<'w> {
    pub(crate) fn new(
        problem: &Problem<'_>,
        sample_time_s: f64,
        weights: &'w Weights,
        prewhitening: Option<&'w Prewhitening>,
        nuisance: usize,
    ) -> Self {
        let globals = problem.free.len();
        let outputs = problem.outputs();
        let perturbed = weights.perturbed_filters.iter().find(|(time_s, _)| *time_s == sample_time_s);
        let block_s = if weights.discrepancy.is_empty() { BLOCK_S } else { COMPARED_BLOCK_S };
        Self {
            nuisance,
            globals,
            with_nuisance: QrAccumulator::new(nuisance + globals + 1),
            without_nuisance: QrAccumulator::new(globals + 1),
            channels: vec![ChannelSums::default(); outputs],
            weighted_squares: 0.0,
            samples: 0.0,
            unresolved: 0,
            prewhitening: prewhitening.map(|prewhitening| prewhitening.start(nuisance, globals)),
            discrepancy: Discrepancy::at(&weights.discrepancy, sample_time_s),
            level_score: perturbed.map(|(_, perturbed)| perturbed.start()),
            detector: weights
                .detector
                .as_ref()
                .map(|sizes| OutlierDetector::new(prewhitening.map(|c| &c.filter), Arc::clone(sizes))),
            scores: weights.scores.then(|| Scores {
                block_rows: (block_s / sample_time_s).ceil().max(1.0) as usize,
                row: 0,
                sums: Vec::new(),
                squares: Vec::new(),
                width: nuisance + globals,
            }),
            innovations: weights.innovations.then(|| vec![Vec::new(); outputs]),
            present: Vec::new(),
            still: Vec::new(),
            most: f64::INFINITY,
            tentative: None,
        }
    }

    /// Largest number of samples in one call of [`ResidualAccumulator::fold`].
    pub(crate) fn capacity(&self) -> usize {
        (QrAccumulator::capacity() / self.channels.len()).max(1)
    }

    /// Folds a block: `fill(output, target)` writes the weighted sensitivities and, in the last column, the weighted prediction of all
    /// `rows` samples of one output. `measured` holds NaN where nothing was measured. Without `alive`, nuisance columns are zero and left
    /// out. Returns whether the evaluation continues.
    pub(crate) fn fold(
        &mut self,
        rows: usize,
        alive: bool,
        noise_std: &[f64],
        measured: &[&[f64]],
        mut fill: impl FnMut(usize, faer::MatMut<'_, f64>),
    ) -> bool {
        let outputs = self.channels.len();
        let (triangle, columns) = if alive {
            (&mut self.with_nuisance, self.nuisance + self.globals + 1)
        } else {
            (&mut self.without_nuisance, self.globals + 1)
        };
        let mut target = triangle.rows_mut(rows * outputs);
        let mut finite = true;
        self.present.clear();
        for (output, sums) in self.channels.iter_mut().enumerate() {
            let mut block = target.rb_mut().subrows_mut(output * rows, rows);
            fill(output, block.rb_mut());
            let std = noise_std[output];
            for (k, value) in measured[output].iter().enumerate() {
                self.present.push(!value.is_nan());
                if value.is_nan() {
                    block.rb_mut().row_mut(k).fill(0.0);
                    continue;
                }
                let residual = block[(k, columns - 1)] - value / std;
                block[(k, columns - 1)] = residual;
                sums.residual_squares += (residual * std).powi(2);
                sums.count += 1.0;
                sums.sum += value;
                sums.squares += value * value;
            }
            finite &= sums.residual_squares.is_finite();
        }
        let residuals = target.as_ref().col(columns - 1);
        if let Some(level_score) = &mut self.level_score {
            follow(residuals, rows, &self.present, |residual, present| level_score.take(residual, present));
        }
        if let Some(detector) = &mut self.detector {
            follow(residuals, rows, &self.present, |residual, present| detector.take(residual, present));
        }
        let skipped = if alive { 0 } else { self.nuisance };
        if let Some(prewhitening) = &mut self.prewhitening {
            prewhitening.apply(target.rb_mut(), rows, &self.present);
        }
        if let Some(discrepancy) = self.discrepancy {
            discrepancy.apply(target.rb_mut(), rows);
        }
        self.weighted_squares += target.as_ref().col(columns - 1).squared_norm_l2();
        self.samples += self.present.iter().filter(|present| **present).count() as f64 / outputs as f64;
        for (output, all) in self.innovations.iter_mut().flatten().enumerate() {
            all.extend(target.as_ref().col(columns - 1).subrows(output * rows, rows).iter());
        }
        if let Some(scores) = &mut self.scores {
            scores.take(target.as_ref(), rows, &self.present, skipped);
        }
        finite && self.weighted_squares <= self.most && !self.is_given_up()
    }

    /// Whether the search was ended and the evaluation is of no use then.
    pub(crate) fn is_given_up(&self) -> bool {
        self.tentative.as_ref().is_some_and(ProgressMonitor::stops)
    }

    /// `None` where sensitivities overflowed.
    pub(crate) fn finish(self) -> Option<SegmentEvaluation> {
        let columns = self.nuisance + self.globals + 1;
        let late = self.without_nuisance.finish();
        let shifted = Mat::from_fn(late.nrows(), columns, |i, j| {
            if j < self.nuisance { 0.0 } else { late[(i, j - self.nuisance)] }
        });
        let early = self.with_nuisance.finish();
        let mut factor = qr::join([early.as_ref(), shifted.as_ref()].into_iter(), columns);
        let moves = |column: usize| !self.still.contains(&column);
        let pivots = qr::eliminate(&mut factor, self.nuisance, |column, remainder, length| {
            moves(column) && is_determined(remainder, length)
        });
        let (scores, block_squares) =
            self.scores.map(|scores| (scores.sums, scores.squares)).unwrap_or_default();
        let finite = factor.col_iter().all(|column| column.iter().all(|value| value.is_finite()));
        let finite = finite && self.weighted_squares.is_finite();
        finite.then_some(SegmentEvaluation {
            factor,
            pivots,
            channels: self.channels,
            weighted_squares: self.weighted_squares,
            samples: self.samples,
            unresolved: self.unresolved,
            scores,
            block_squares,
            innovations: self.innovations.unwrap_or_default(),
            levels: self.level_score.map(level_score::LevelScore::finish),
            detector: self.detector.map(OutlierDetector::finish),
        })
    }
}

/// Calls `take` with the residuals of each sample of a block, by output.
fn follow(
    residuals: faer::ColRef<'_, f64>,
    samples: usize,
    present: &[bool],
    mut take: impl FnMut(&[f64], &[bool]),
) {
    let outputs = present.len() / samples.max(1);
    let (mut residual, mut here) = (vec![0.0; outputs], vec![false; outputs]);
    for k in 0..samples {
        for o in 0..outputs {
            (residual[o], here[o]) = (residuals[o * samples + k], present[o * samples + k]);
        }
        take(&residual, &here);
    }
}

/// Scores summed by block.
struct Scores {
    block_rows: usize,
    row: usize,
    sums: Vec<Vec<f64>>,
    squares: Vec<f64>,
    width: usize,
}

impl Scores {
    fn take(&mut self, rows: MatRef<'_, f64>, samples: usize, present: &[bool], skipped: usize) {
        let last = rows.ncols() - 1;
        let outputs = present.len() / samples.max(1);
        let mut from = 0;
        while from < samples {
            let block = (self.row + from) / self.block_rows;
            let to = samples.min((block + 1) * self.block_rows - self.row);
            if block >= self.sums.len() {
                self.sums.push(vec![0.0; self.width]);
                self.squares.push(0.0);
            }
            for output in 0..outputs {
                let own = rows.subrows(output * samples + from, to - from);
                let residual = own.col(last);
                self.squares[block] += residual.squared_norm_l2();
                let sums = self.sums[block][skipped..].iter_mut();
                sums.zip(own.col_iter())
                    .for_each(|(sum, sensitivities)| *sum += dot(sensitivities, residual));
            }
            from = to;
        }
        self.row += samples;
    }
}
