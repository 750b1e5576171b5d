//! The last minute of samples.

use std::ops::Range;

use socam_recording::Channel;

use crate::queue::{Batch, Gap};

/// Length of the buffer, s.
const KEPT_S: f64 = 61.0;

/// A gap in the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Time of the last sample before it and of the first one after it, s.
    pub span: [f64; 2],
    /// Number of samples that did not arrive; 0 where the board was being set up, and where that is not known.
    pub missed: u64,
}

/// Samples of all channels, oldest first.
#[derive(Debug, Clone, Default)]
pub struct Buffer {
    channels: Vec<Channel>,
    time_s: Vec<f64>,
    columns: Vec<Vec<f32>>,
    /// The latest sampling period, s.
    step_s: f64,
    holes: Vec<Hole>,
    missed: u64,
    losses: u64,
}

impl Buffer {
    /// A buffer without samples.
    #[must_use]
    pub fn new(channels: Vec<Channel>) -> Self {
        Self { columns: vec![Vec::new(); channels.len()], channels, ..Self::default() }
    }

    /// Channels of the buffer.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Number of samples of each channel.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }

    /// Time of the oldest sample, s.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.time_s.first().copied().unwrap_or_default()
    }

    /// Time of the latest sample, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or_default()
    }

    /// Gaps in the samples, oldest first.
    #[must_use]
    pub fn holes(&self) -> &[Hole] {
        &self.holes
    }

    /// Number of samples that did not arrive since the link was opened, and of the gaps that they left.
    #[must_use]
    pub fn missed(&self) -> [u64; 2] {
        [self.missed, self.losses]
    }

    /// Samples of a channel within a time, both ends included.
    #[must_use]
    pub fn values(&self, channel: usize, [from, to]: [f64; 2]) -> &[f32] {
        let first = self.time_s.partition_point(|time| *time < from);
        let last = self.time_s.partition_point(|time| *time <= to);
        self.columns.get(channel).map_or(&[], |column| &column[first..last.max(first)])
    }

    /// The latest value of a channel; NaN where there is no reading.
    #[must_use]
    pub fn latest(&self, channel: usize) -> f32 {
        self.columns.get(channel).and_then(|column| column.last()).copied().unwrap_or(f32::NAN)
    }

    /// Appends samples, and drops those that are too old.
    pub fn take(&mut self, batch: &Batch) {
        let width = self.channels.len();
        if width == 0 || batch.values.len() != width * batch.time_s.len() {
            return;
        }
        let step_s = self.step_s.max(batch.step_s);
        self.step_s = batch.step_s;
        let Some(first) = batch.time_s.first() else { return };
        // The time of a board that was reset begins at 0 again.
        if *first <= self.end_s() && !self.time_s.is_empty() {
            *self = Self { step_s: batch.step_s, ..Self::new(std::mem::take(&mut self.channels)) };
        }
        match &batch.gaps {
            None => self.take_times(batch, step_s),
            Some(gaps) => self.take_counted(&batch.time_s, gaps),
        }
        for row in batch.values.chunks_exact(width) {
            for (column, value) in self.columns.iter_mut().zip(row) {
                column.push(*value as f32);
            }
        }
        self.forget_old();
    }

    /// Appends times; a step of more than one and a half periods is a gap. `step_s`: the period before the first one.
    fn take_times(&mut self, batch: &Batch, mut step_s: f64) {
        for (row, time) in batch.time_s.iter().enumerate() {
            if let Some(last) = self.time_s.last()
                && time - last > 1.5 * step_s
            {
                let steps = ((time - last) / self.step_s).round() as u64;
                let is_setup = batch.after_setup && row == 0;
                self.mark([*last, *time], if is_setup { 0 } else { steps.saturating_sub(1) });
            }
            step_s = batch.step_s;
            self.time_s.push(*time);
        }
    }

    /// Appends times of a source that counts its rows itself.
    fn take_counted(&mut self, time_s: &[f64], gaps: &[Gap]) {
        let mut gaps = gaps.iter().peekable();
        for (row, time) in time_s.iter().enumerate() {
            if let Some(gap) = gaps.next_if(|gap| gap.row == row)
                && let Some(last) = self.time_s.last()
            {
                self.mark([*last, *time], gap.missed);
            }
            self.time_s.push(*time);
        }
    }

    fn mark(&mut self, span: [f64; 2], missed: u64) {
        self.missed += missed;
        self.losses += u64::from(missed > 0);
        self.holes.push(Hole { span, missed });
    }

    fn forget_old(&mut self) {
        let from_s = self.end_s() - KEPT_S;
        let old = self.time_s.partition_point(|time| *time < from_s);
        // Removed in large pieces, since the rest is moved.
        if old > self.time_s.len() / 4 {
            self.time_s.drain(..old);
            self.columns.iter_mut().for_each(|column| drop(column.drain(..old)));
            self.holes.retain(|hole| hole.span[1] > from_s);
        }
    }

    /// The samples of each pixel of a picture. No pixel's samples lie on both sides of a gap, so there may be more blocks than pixels.
    #[must_use]
    pub fn blocks(&self, [from, to]: [f64; 2], pixels: usize) -> Vec<Block> {
        let first = self.time_s.partition_point(|time| *time < from).saturating_sub(1);
        let last = self.time_s.partition_point(|time| *time <= to);
        // Pixels are counted from time 0, so that the line does not flicker while it moves.
        let pixel_s = (to - from) / pixels.max(1) as f64;
        let after_hole = |hole: &Hole| self.time_s.partition_point(|time| *time < hole.span[1]);
        let mut splits = self.holes.iter().map(after_hole).filter(|row| *row > first).peekable();
        let mut blocks = Vec::with_capacity(2 * pixels);
        let mut start = first;
        let mut joins = false;
        while start < last {
            let edge_s = ((self.time_s[start] / pixel_s).floor() + 1.0) * pixel_s;
            let mut end = start + 1 + self.time_s[start + 1..last].partition_point(|time| *time < edge_s);
            let split = splits.peek().copied().filter(|split| *split <= end);
            if let Some(split) = split {
                end = split;
                splits.next();
            }
            blocks.push(Block { rows: start..end, joins });
            joins = split.is_none();
            start = end;
        }
        blocks
    }

    /// The line of a channel: least and greatest values of blocks of samples. Parts end where samples are missing.
    #[must_use]
    pub fn line(&self, channel: usize, blocks: &[Block]) -> Vec<Vec<[f64; 2]>> {
        let mut parts = Vec::new();
        let mut part: Vec<[f64; 2]> = Vec::new();
        let column = &self.columns[channel];
        for block in blocks {
            let mut extremes = [f32::NAN; 2];
            for value in &column[block.rows.clone()] {
                extremes = [extremes[0].min(*value), extremes[1].max(*value)];
            }
            if (!block.joins || extremes[0].is_nan()) && !part.is_empty() {
                parts.push(std::mem::take(&mut part));
            }
            if extremes[0].is_finite() {
                let time = self.time_s[block.rows.start];
                let [low, high] = extremes.map(f64::from);
                // The value nearer to the last point comes first.
                let rises = part.last().is_none_or(|[_, last]| (low - last).abs() <= (high - last).abs());
                let (first, second) = if rises { (low, high) } else { (high, low) };
                part.push([time, first]);
                if first != second {
                    part.push([time, second]);
                }
            }
        }
        if !part.is_empty() {
            parts.push(part);
        }
        parts
    }
}

/// Samples that share a pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    rows: Range<usize>,
    /// Whether no gap lies between it and the one before.
    joins: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::Unit;

    fn batch(ticks: std::ops::Range<usize>) -> Batch {
        let time_s: Vec<f64> = ticks.map(|tick| tick as f64 * 1e-3).collect();
        let values = time_s.iter().flat_map(|time| [*time, f64::NAN]).collect();
        Batch { time_s, values, step_s: 1e-3, after_setup: false, gaps: None }
    }

    fn buffer() -> Buffer {
        Buffer::new(vec![Channel::new("a", Unit::V), Channel::new("b", Unit::V)])
    }

    fn parts(buffer: &Buffer, channel: usize, pixels: usize) -> Vec<Vec<[f64; 2]>> {
        buffer.line(channel, &buffer.blocks([0.0, 2.0], pixels))
    }

    #[test]
    fn what_was_missed_is_counted_and_not_joined_and_old_samples_go() {
        let mut buffer = buffer();
        buffer.take(&batch(0..1000));
        buffer.take(&batch(1500..2000));
        assert_eq!(buffer.missed(), [500, 1]);
        assert_eq!(buffer.holes(), [Hole { span: [0.999, 1.5], missed: 500 }]);
        for pixels in [10_000, 50, 3, 1] {
            assert_eq!(parts(&buffer, 0, pixels).len(), 2, "{pixels}");
        }
        assert!(parts(&buffer, 1, 1000).is_empty());
        for second in 2..200 {
            buffer.take(&batch(1000 * second..1000 * (second + 1)));
        }
        assert!(buffer.rows() < 90_000 && buffer.rows() >= 61_000, "{}", buffer.rows());
        assert!(buffer.holes().is_empty() && buffer.missed() == [500, 1]);
        buffer.take(&batch(0..10));
        assert_eq!(buffer.rows(), 10, "switched on again");
    }

    #[test]
    fn another_rate_goes_on_and_a_setup_is_no_loss() {
        let mut buffer = buffer();
        buffer.take(&batch(0..1000));
        let time_s: Vec<f64> = (0..1000).map(|tick| 1.2 + f64::from(tick) * 1e-4).collect();
        let values = vec![2.0; 2000];
        buffer.take(&Batch {
            time_s: time_s.clone(),
            values: values.clone(),
            step_s: 1e-4,
            after_setup: true,
            gaps: None,
        });
        assert_eq!((buffer.rows(), buffer.missed()), (2000, [0, 0]));
        assert_eq!(buffer.holes(), [Hole { span: [0.999, 1.2], missed: 0 }]);
        let time_s = time_s.iter().map(|time| time + 0.101).collect();
        buffer.take(&Batch { time_s, values, step_s: 1e-4, after_setup: false, gaps: None });
        assert_eq!(buffer.missed(), [10, 1]);
        assert_eq!(parts(&buffer, 0, 4000).len(), 3);
    }
}
