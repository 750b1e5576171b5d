//! Statistics of the innovations along a segment, from which outliers are found.

use std::{ops::Range, sync::Arc};

use crate::noise::innovations_filter::{FilterColumn, InnovationsFilter};

/// Least magnitude of an outlier, in standard deviations of the bulk.
pub(super) const THRESHOLD: f64 = 6.0;

/// Most consecutive samples of an outlier.
const LONGEST: u64 = 3;

/// Largest magnitude of the innovations just before and after an outlier, as a share of the outlier's.
pub(super) const ALONE: f64 = 0.5;

/// Octaves below and above one of the histogram of magnitudes. Each octave has 2^[`BIN_BITS`] bins: the bin of a number follows from its
/// exponent and the first binary digits of its mantissa.
const OCTAVES: i32 = 24;

/// See [`OCTAVES`].
const BIN_BITS: u32 = 4;

/// Detector of outliers along one segment.
pub(crate) struct OutlierDetector<'w> {
    filter: Option<(&'w InnovationsFilter, FilterColumn)>,
    /// Standard deviation of the bulk of each output, in units of its noise.
    sizes: Arc<Vec<f64>>,
    row: u64,
    innovation: Vec<f64>,
    statistics: Vec<OutlierStatistics>,
}

/// Statistics of one output along one segment.
#[derive(Clone)]
pub(crate) struct OutlierStatistics {
    pub(super) histogram: Vec<u64>,
    /// Number of magnitudes above [`THRESHOLD`].
    pub(super) large: u64,
    /// Isolated clusters of these: rows of the segment, and the largest residual in units of noise.
    pub(super) alone: Vec<(Range<u64>, f64)>,
    cluster: Option<Cluster>,
    previous: f64,
}

/// Consecutive samples above [`THRESHOLD`].
#[derive(Clone)]
struct Cluster {
    rows: Range<u64>,
    largest: f64,
    before: f64,
}

impl<'w> OutlierDetector<'w> {
    pub(crate) fn new(filter: Option<&'w InnovationsFilter>, sizes: Arc<Vec<f64>>) -> Self {
        let bins = (2 * OCTAVES as usize) << BIN_BITS;
        let track = OutlierStatistics {
            histogram: vec![0; bins],
            large: 0,
            alone: Vec::new(),
            cluster: None,
            previous: 0.0,
        };
        let statistics = vec![track; sizes.len()];
        let filter = filter.map(|filter| (filter, filter.initial_state()));
        Self { filter, sizes, row: 0, innovation: Vec::new(), statistics }
    }

    /// Adds the residuals of one sample, in units of noise. A large innovation is not fed to the filter.
    pub(crate) fn take(&mut self, residual: &[f64], present: &[bool]) {
        self.innovation.clear();
        self.innovation.extend_from_slice(residual);
        if let Some((filter, state)) = &self.filter {
            filter.subtract_prediction(state, &mut self.innovation, present);
        }
        for (o, track) in self.statistics.iter_mut().enumerate() {
            let unit = self.filter.as_ref().map_or(1.0, |(filter, _)| filter.covariance[(o, o)].sqrt());
            let value = if present[o] { self.innovation[o].abs() / (unit * self.sizes[o]) } else { 0.0 };
            if present[o] {
                track.count(value);
            }
            if track.stands_out(value, self.row, residual[o]) {
                self.innovation[o] = 0.0;
            }
        }
        if let Some((filter, state)) = &mut self.filter {
            filter.update(state, &self.innovation);
        }
        self.row += 1;
    }

    pub(crate) fn finish(mut self) -> Vec<OutlierStatistics> {
        self.statistics.iter_mut().for_each(|track| track.close(0.0));
        self.statistics
    }
}

/// A positive number's exponent and first binary digits as one integer, which is monotonic in the number.
fn bin_bits(value: f64) -> u64 {
    value.to_bits() >> (f64::MANTISSA_DIGITS - 1 - BIN_BITS)
}

/// Least number in a bin of the histogram.
pub(super) fn bin_start(bin: usize) -> f64 {
    f64::from_bits((bin as u64 + bin_bits(2f64.powi(-OCTAVES))) << (f64::MANTISSA_DIGITS - 1 - BIN_BITS))
}

impl OutlierStatistics {
    fn count(&mut self, value: f64) {
        let bin = bin_bits(value).saturating_sub(bin_bits(2f64.powi(-OCTAVES)));
        let last = self.histogram.len() - 1;
        self.histogram[(bin as usize).min(last)] += 1;
    }

    /// Upper edge of the highest bin that is not empty; infinity for the last bin.
    pub(super) fn largest(&self) -> f64 {
        self.histogram.iter().rposition(|count| *count > 0).map_or(0.0, |bin| {
            if bin + 1 < self.histogram.len() { bin_start(bin + 1) } else { f64::INFINITY }
        })
    }

    fn stands_out(&mut self, value: f64, row: u64, residual: f64) -> bool {
        let large = value > THRESHOLD;
        if large {
            self.large += 1;
            let before = self.previous;
            let cluster = self.cluster.get_or_insert(Cluster { rows: row..row, largest: 0.0, before });
            cluster.rows.end = row + 1;
            if residual.abs() > cluster.largest.abs() {
                cluster.largest = residual;
            }
            self.previous = value.max(self.previous);
        } else {
            self.close(value);
            self.previous = value;
        }
        large
    }

    /// Ends the present cluster; `after` is the next magnitude. During a cluster, `previous` is its largest magnitude.
    fn close(&mut self, after: f64) {
        let Some(cluster) = self.cluster.take() else { return };
        let alone = cluster.before.max(after) <= ALONE * self.previous;
        if alone && cluster.rows.end - cluster.rows.start <= LONGEST {
            self.alone.push((cluster.rows, cluster.largest));
        }
    }
}
