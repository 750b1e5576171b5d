//! Result of an evaluation on one segment: the triangular factor of its residuals and sensitivities, and sums over its channels.

use faer::{Mat, MatRef};

use crate::{noise::levels::Score, preprocessing::outliers::OutlierStatistics};

/// What a pass says of one segment.
pub(crate) struct SegmentEvaluation {
    /// Factor over [local | free parameters | residual], residuals weighted by 1/noise, sensitivities by the scales.
    pub(crate) factor: Mat<f64>,
    /// Row of the factor that holds each local unknown's pivot; `None` where the data do not show it at all: a start term
    /// may be unobservable, decay within a sample, or repeat another. Such a one stays where it is.
    pub(crate) pivots: Vec<Option<usize>>,
    /// Per output: sum of squared residuals (SI), their number, and sums over the measured values.
    pub(crate) channels: Vec<ChannelSums>,
    /// Sum of squared residuals as they were weighted.
    pub(crate) weighted_squares: f64,
    /// Samples, each counted by the share of its outputs that were measured.
    pub(crate) samples: f64,
    /// Of these, samples in which a law was too steep for the shortest step.
    pub(crate) unresolved: u64,
    /// Transposed sensitivities times residuals, summed over consecutive blocks of [`BLOCK_S`] or [`COMPARED_BLOCK_S`]; over
    /// [local | free]. Only when asked for.
    pub(crate) scores: Vec<Vec<f64>>,
    /// Squared whitened residuals, summed over the same blocks.
    pub(crate) block_squares: Vec<f64>,
    /// Whitened residuals by output, nothing where one is missing. Only when asked for.
    pub(crate) innovations: Vec<Vec<f64>>,
    /// What the residuals say of the noise levels; only when asked for.
    pub(crate) levels: Option<Score>,
    /// What was seen of each output while looking for outliers; only when asked for.
    pub(crate) detector: Option<Vec<OutlierStatistics>>,
}

impl SegmentEvaluation {
    pub(crate) fn nuisance(&self) -> usize {
        self.pivots.len()
    }

    /// What the segment says of [free parameters | residual] once its local unknowns have followed.
    pub(crate) fn schur_complement(&self) -> MatRef<'_, f64> {
        let (rows, columns) = self.factor.shape();
        let shown = self.pivots.iter().flatten().count();
        self.factor.as_ref().submatrix(shown, self.nuisance(), rows - shown, columns - self.nuisance())
    }

    /// Solves for the local unknowns that the data show, `right` being by row of the factor; the others stay zero.
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
}

/// Whether a local unknown's remainder, of a column of this length, shows: moving it by a whole unit must change the residuals by a
/// tenth of the noise. What dies within a sample would else be moved anywhere, and a force law would see it there.
pub(crate) fn shows(remainder: f64, length: f64) -> bool {
    remainder > 0.1 && remainder > 1e-8 * length
}

/// Sums of sensitivities times residuals over blocks of that length, by free parameter.
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
