//! Result of an evaluation on one segment: the triangular factor of its residuals and sensitivities, and sums over its channels.

use faer::{Mat, MatRef};

use crate::{noise::level_score::Score, preprocessing::outlier_detector::OutlierStatistics};

/// Evaluation of one segment.
pub(crate) struct SegmentEvaluation {
    /// Triangular factor over [nuisance | free parameters | residual]; residuals weighted by 1/noise, sensitivities by the scales.
    pub(crate) factor: Mat<f64>,
    /// Row of the factor with the pivot of each nuisance parameter. `None` where the data do not determine it (a start state may be
    /// unobservable, decay within a sample, or equal another one); it then keeps its value.
    pub(crate) pivots: Vec<Option<usize>>,
    /// Per output: sum of squared residuals (SI), their number, and sums over the measured values.
    pub(crate) channels: Vec<ChannelSums>,
    /// Sum of squared weighted residuals.
    pub(crate) weighted_squares: f64,
    /// Number of samples, each counted by the share of its outputs that were measured.
    pub(crate) samples: f64,
    /// Number of samples in which a law was too steep for the shortest step.
    pub(crate) unresolved: u64,
    /// Scores (transposed sensitivities times residuals) over [nuisance | free], summed over consecutive blocks; only if
    /// `Weights::scores`.
    pub(crate) scores: Vec<Vec<f64>>,
    /// Squared whitened residuals, summed over the same blocks.
    pub(crate) block_squares: Vec<f64>,
    /// Whitened residuals by output, zero where one is missing; only if `Weights::innovations`.
    pub(crate) innovations: Vec<Vec<f64>>,
    /// Score of the noise levels; only if `Weights::perturbed_filters`.
    pub(crate) levels: Option<Score>,
    /// Statistics of each output for the outlier search; only if `Weights::detector`.
    pub(crate) detector: Option<Vec<OutlierStatistics>>,
}

impl SegmentEvaluation {
    /// Number of nuisance parameters.
    pub(crate) fn nuisance(&self) -> usize {
        self.pivots.len()
    }

    /// Factor over [free parameters | residual] after elimination of the nuisance parameters (the Schur complement, in square-root form).
    pub(crate) fn schur_complement(&self) -> MatRef<'_, f64> {
        let (rows, columns) = self.factor.shape();
        let shown = self.pivots.iter().flatten().count();
        self.factor.as_ref().submatrix(shown, self.nuisance(), rows - shown, columns - self.nuisance())
    }

    /// Solves for the nuisance parameters that have a pivot, with a right-hand side by row of the factor; the others are zero.
    pub(crate) fn solve_nuisance(&self, right: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut solution = vec![0.0; self.nuisance()];
        for (i, row) in self.pivots.iter().enumerate().rev() {
            if let Some(row) = *row {
                let known: f64 = (i + 1..solution.len()).map(|j| self.factor[(row, j)] * solution[j]).sum();
                solution[i] = (right(row) - known) / self.factor[(row, i)];
            }
        }
        solution
    }

    /// Decrease of the sum of squares by the nuisance parameters' own step that the linearisation predicts.
    pub(crate) fn nuisance_gain(&self) -> f64 {
        let residual = self.factor.col(self.factor.ncols() - 1);
        self.pivots.iter().flatten().map(|row| residual[*row].powi(2)).sum()
    }
}

/// Whether the data determine a nuisance parameter, from the norm of its column after elimination and before: a change of one unit must
/// change the residuals by 0.1 of the noise. A start state that decays within a sample would otherwise be moved without limit.
pub(crate) fn is_determined(remainder: f64, length: f64) -> bool {
    remainder > 0.1 && remainder > 1e-8 * length
}

/// Scores of all segments by block, over the free parameters.
pub(crate) fn blocks(evaluated: &[SegmentEvaluation], free: usize) -> Vec<Vec<f64>> {
    let all = evaluated.iter().flat_map(|result| result.scores.iter());
    all.map(|block| block[block.len() - free..].to_vec()).collect()
}

/// Sums over one output channel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ChannelSums {
    pub(crate) residual_squares: f64,
    pub(crate) count: f64,
    pub(crate) sum: f64,
    pub(crate) squares: f64,
}

impl ChannelSums {
    pub(crate) fn add(&mut self, other: &Self) {
        self.residual_squares += other.residual_squares;
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
    }

    pub(crate) fn rms(&self) -> f64 {
        (self.residual_squares / self.count.max(1.0)).sqrt()
    }

    /// Standard deviation of the measured values.
    pub(crate) fn spread(&self) -> f64 {
        let mean = self.sum / self.count.max(1.0);
        (self.squares / self.count.max(1.0) - mean * mean).max(0.0).sqrt()
    }
}

/// Sum of squared weighted residuals over all segments.
pub(crate) fn squares(results: &[SegmentEvaluation]) -> f64 {
    results.iter().map(|result| result.weighted_squares).sum()
}

/// Sums over each output of all segments.
pub(crate) fn channel_sums(results: &[SegmentEvaluation]) -> Vec<ChannelSums> {
    let mut sums = vec![ChannelSums::default(); results.first().map_or(0, |r| r.channels.len())];
    for result in results {
        sums.iter_mut().zip(&result.channels).for_each(|(sum, channel)| sum.add(channel));
    }
    sums
}
