//! The samples of a recording, in memory or in an index file.

use super::groups::Groups;
use super::moments::Moments;
use super::pyramid::{self, BASE, Block, Extremes, MOMENTS_BASE, Pyramid};
use socam_recording::Segment;
use std::ops::Range;
use std::sync::Arc;

/// Storage of the samples.
#[derive(Debug)]
pub(super) enum Store {
    Memory {
        time_s: Vec<f64>,
        columns: Vec<Vec<f32>>,
    },
    File(Groups),
    /// Values beside the samples that have their times.
    Beside {
        times: Arc<Samples>,
        columns: Vec<Vec<f32>>,
    },
}

/// The samples of a recording.
#[derive(Debug)]
pub struct Samples {
    pub(super) rows: usize,
    pub(super) store: Store,
    /// Middle of each channel's range, which is added to the stored values.
    pub(super) middles: Vec<f64>,
    pub(super) pyramids: Vec<Pyramid>,
    pub(super) moments: Vec<Pyramid<Moments>>,
    /// Time of each block's first row, s.
    pub(super) knots: Vec<f64>,
    pub(super) segments: Vec<Segment>,
}

impl Samples {
    /// Samples in memory: `columns` hold a value per time, NaN where it is missing.
    #[must_use]
    pub fn in_memory(time_s: Vec<f64>, columns: &[Vec<f64>], segments: Vec<Segment>) -> Self {
        let middles: Vec<f64> = columns.iter().map(|column| middle(column)).collect();
        let narrow = |(column, middle): (&Vec<f64>, &f64)| {
            column.iter().map(|value| (value - middle) as f32).collect::<Vec<_>>()
        };
        let columns: Vec<Vec<f32>> = columns.iter().zip(&middles).map(narrow).collect();
        let pyramids =
            columns.iter().map(|column| Pyramid::new(column.chunks(BASE).map(pyramid::of).collect()));
        let moments =
            columns.iter().map(|column| Pyramid::new(column.chunks(MOMENTS_BASE).map(Moments::of).collect()));
        let knots = time_s.iter().step_by(BASE).copied().collect();
        Self {
            rows: time_s.len(),
            pyramids: pyramids.collect(),
            moments: moments.collect(),
            knots,
            middles,
            segments,
            store: Store::Memory { time_s, columns },
        }
    }

    /// A channel at the times of other samples, with a value for each of their rows, NaN where it is missing.
    #[must_use]
    pub fn beside(times: &Arc<Self>, values: &[f64]) -> Self {
        let column = [values.to_vec()];
        let alone = Self::in_memory(Vec::new(), &column, times.segments.clone());
        let columns = match alone.store {
            Store::Memory { columns, .. } => columns,
            _ => Vec::new(),
        };
        let store = Store::Beside { times: times.clone(), columns };
        Self { rows: times.rows, knots: times.knots.clone(), store, ..alone }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.pyramids.len()
    }

    /// Uniformly sampled segments, separated by gaps.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Times of the first and the last row, s; `None` without rows.
    #[must_use]
    pub fn span_s(&self) -> Option<[f64; 2]> {
        Some([self.segments.first()?.start_s, self.segments.last()?.end_s])
    }

    /// Memory in use, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let raw = match &self.store {
            Store::Memory { time_s, columns } => time_s.len() * (8 + 4 * columns.len()),
            Store::File(_) => 0,
            Store::Beside { columns, .. } => 4 * self.rows * columns.len(),
        };
        let moments: usize = self.moments.iter().map(Pyramid::bytes).sum();
        raw + 8 * self.knots.len() + self.pyramids.iter().map(Pyramid::bytes).sum::<usize>() + moments
    }

    /// Times of rows, s; NaN for rows that cannot be read any more.
    #[must_use]
    pub fn times(&self, rows: Range<usize>) -> Vec<f64> {
        let rows = self.inside(rows);
        match &self.store {
            Store::Memory { time_s, .. } => time_s[rows].to_vec(),
            Store::File(groups) => groups.times(rows),
            Store::Beside { times, .. } => times.times(rows),
        }
    }

    /// Values of some rows of a channel, in its unit; NaN where one is missing or cannot be read any more.
    #[must_use]
    pub fn values(&self, channel: usize, rows: Range<usize>) -> Vec<f64> {
        let middle = self.middles[channel];
        let mut values = Vec::new();
        self.with_stored(channel, rows, |stored| {
            values = stored.iter().map(|value| f64::from(*value) + middle).collect();
        });
        values
    }

    /// Least and greatest value of some rows of a channel; `None` where no value is there.
    #[must_use]
    pub fn extremes(&self, channel: usize, rows: Range<usize>) -> Option<[f64; 2]> {
        let stored = self.stored_extremes(channel, rows);
        let middle = self.middles[channel];
        stored[0].is_finite().then(|| stored.map(|value| f64::from(value) + middle))
    }

    /// Number of missing values of a channel.
    #[must_use]
    pub fn missing(&self, channel: usize) -> u64 {
        self.rows as u64 - self.moments(channel, 0..self.rows).count as u64
    }

    /// The first row at or after a time; the number of rows where there is none.
    #[must_use]
    pub fn row_at(&self, time_s: f64) -> usize {
        let block = self.knots.partition_point(|knot| *knot < time_s).saturating_sub(1);
        let first = block * BASE;
        first + self.times(first..first + BASE).partition_point(|time| *time < time_s)
    }

    /// The value of a channel nearest to a time, and its own time; `None` in a gap, outside, and where it is missing.
    #[must_use]
    pub fn value_at(&self, channel: usize, time_s: f64) -> Option<[f64; 2]> {
        let segment = self.segments.iter().find(|segment| {
            let half_s = 0.5 * segment.sample_time_s;
            (segment.start_s - half_s..=segment.end_s + half_s).contains(&time_s)
        })?;
        let after = self.row_at(time_s);
        let rows = after.saturating_sub(1).max(segment.first_row as usize)
            ..(after + 1).min(segment.end_row() as usize);
        let times = self.times(rows.clone());
        let values = self.values(channel, rows);
        let distance = |time: f64| (time - time_s).abs();
        let nearest = times.iter().zip(values).min_by(|a, b| distance(*a.0).total_cmp(&distance(*b.0)))?;
        nearest.1.is_finite().then_some([*nearest.0, nearest.1])
    }

    fn inside(&self, rows: Range<usize>) -> Range<usize> {
        rows.start.min(self.rows)..rows.end.min(self.rows)
    }

    fn with_stored(&self, channel: usize, rows: Range<usize>, take: impl FnOnce(&[f32])) {
        let rows = self.inside(rows);
        match &self.store {
            Store::Memory { columns, .. } | Store::Beside { columns, .. } => take(&columns[channel][rows]),
            Store::File(groups) => take(&groups.values(channel, rows)),
        }
    }

    fn stored_extremes(&self, channel: usize, rows: Range<usize>) -> Extremes {
        self.joined(channel, rows, (&self.pyramids[channel], BASE), pyramid::of)
    }

    /// Moments of some rows of a channel, in its unit.
    pub(super) fn moments(&self, channel: usize, rows: Range<usize>) -> Moments {
        let stored = self.joined(channel, rows, (&self.moments[channel], MOMENTS_BASE), Moments::of);
        Moments { mean: stored.mean + self.middles[channel], ..stored }
    }

    /// Summary of some rows of a channel: whole blocks of `base` samples are read from the pyramid, the ends from the samples.
    fn joined<B: Block>(
        &self,
        channel: usize,
        rows: Range<usize>,
        (pyramid, base): (&Pyramid<B>, usize),
        of: impl Fn(&[f32]) -> B,
    ) -> B {
        let rows = self.inside(rows);
        let (from, to) = (rows.start.div_ceil(base), rows.end / base);
        let mut result = B::NOTHING;
        if from >= to {
            self.with_stored(channel, rows, |values| result = of(values));
            return result;
        }
        result = pyramid.of_blocks(from, to);
        for edge in [rows.start..from * base, to * base..rows.end] {
            if !edge.is_empty() {
                self.with_stored(channel, edge, |values| result = result.join(of(values)));
            }
        }
        result
    }
}

/// Middle of the range of the finite values.
fn middle(values: &[f64]) -> f64 {
    let range = values.iter().fold([f64::NAN; 2], |[low, high], value| [low.min(*value), high.max(*value)]);
    let middle = 0.5 * (range[0] + range[1]);
    if middle.is_finite() { middle } else { 0.0 }
}
