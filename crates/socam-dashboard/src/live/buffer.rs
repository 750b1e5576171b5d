//! The last minute of samples.

use socam_recording::Channel;

use super::link::Batch;

/// Length of the buffer, s.
const KEPT_S: f64 = 61.0;

/// Samples of all channels, oldest first.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    channels: Vec<Channel>,
    step_s: f64,
    time_s: Vec<f64>,
    columns: Vec<Vec<f32>>,
    missed: u64,
}

impl Buffer {
    pub(super) fn new(channels: Vec<Channel>, step_s: f64) -> Self {
        Self { columns: vec![Vec::new(); channels.len()], channels, step_s, ..Self::default() }
    }

    /// Whether samples of these channels at this rate can be appended.
    pub(super) fn fits(&self, channels: &[Channel], step_s: f64) -> bool {
        self.channels == channels && self.step_s == step_s
    }

    pub(super) fn channels(&self) -> &[Channel] {
        &self.channels
    }

    pub(super) fn rows(&self) -> usize {
        self.time_s.len()
    }

    pub(super) fn end_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or_default()
    }

    /// Number of samples that did not arrive.
    pub(super) fn missed(&self) -> u64 {
        self.missed
    }

    pub(super) fn take(&mut self, batch: &Batch) {
        let width = self.channels.len();
        if width == 0 || batch.values.len() != width * batch.time_s.len() {
            return;
        }
        for (time, row) in batch.time_s.iter().zip(batch.values.chunks_exact(width)) {
            match self.time_s.last() {
                // The time of a board that was reset begins at 0 again.
                Some(last) if time <= last => {
                    self.time_s.clear();
                    self.columns.iter_mut().for_each(Vec::clear);
                }
                Some(last) if time - last > 1.5 * self.step_s => {
                    self.missed += ((time - last) / self.step_s).round() as u64 - 1;
                }
                _ => {}
            }
            self.time_s.push(*time);
            for (column, value) in self.columns.iter_mut().zip(row) {
                column.push(*value as f32);
            }
        }
        let old = self.time_s.partition_point(|time| *time < self.end_s() - KEPT_S);
        // Removed in large pieces, since the rest is moved.
        if old > self.time_s.len() / 4 {
            self.time_s.drain(..old);
            self.columns.iter_mut().for_each(|column| drop(column.drain(..old)));
        }
    }

    /// The line of a channel: least and greatest values of blocks of samples. Parts end where samples are missing.
    pub(super) fn line(&self, channel: usize, [from, to]: [f64; 2], pixels: usize) -> Vec<Vec<[f64; 2]>> {
        let first = self.time_s.partition_point(|time| *time < from).saturating_sub(1);
        let last = self.time_s.partition_point(|time| *time <= to);
        let block = (last - first).div_ceil(pixels.max(1)).max(1);
        let gap_s = (block as f64 + 0.5) * self.step_s;
        let mut parts = Vec::new();
        let mut part: Vec<[f64; 2]> = Vec::new();
        let column = &self.columns[channel];
        // Blocks begin at multiples of a fixed time, so that the line does not flicker while it moves.
        let offset =
            (self.time_s.get(first).copied().unwrap_or_default() / self.step_s).round() as usize % block;
        let mut start = first;
        while start < last {
            let end = if start == first { start + block - offset } else { start + block }.min(last);
            let mut extremes = [f32::NAN; 2];
            for value in &column[start..end] {
                extremes = [extremes[0].min(*value), extremes[1].max(*value)];
            }
            let time = self.time_s[start];
            let follows = part.last().is_none_or(|[before, _]| time - before <= gap_s);
            if (!follows || extremes[0].is_nan()) && !part.is_empty() {
                parts.push(std::mem::take(&mut part));
            }
            if extremes[0].is_finite() {
                let [low, high] = extremes.map(f64::from);
                // The value nearer to the last point comes first.
                let rises = part.last().is_none_or(|[_, last]| (low - last).abs() <= (high - last).abs());
                let (first, second) = if rises { (low, high) } else { (high, low) };
                part.push([time, first]);
                if first != second {
                    part.push([time, second]);
                }
            }
            start = end;
        }
        if !part.is_empty() {
            parts.push(part);
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::Unit;

    fn batch(ticks: std::ops::Range<usize>) -> Batch {
        let time_s: Vec<f64> = ticks.map(|tick| tick as f64 * 1e-3).collect();
        let values = time_s.iter().flat_map(|time| [*time, f64::NAN]).collect();
        Batch { time_s, values }
    }

    #[test]
    fn what_was_missed_is_counted_and_not_joined_and_old_samples_go() {
        let channels = vec![Channel::new("a", Unit::V), Channel::new("b", Unit::V)];
        let mut buffer = Buffer::new(channels, 1e-3);
        buffer.take(&batch(0..1000));
        buffer.take(&batch(1500..2000));
        assert_eq!(buffer.missed(), 500);
        assert_eq!(buffer.line(0, [0.0, 2.0], 10_000).len(), 2);
        assert_eq!(buffer.line(0, [0.0, 2.0], 50).len(), 2);
        assert!(buffer.line(1, [0.0, 2.0], 1000).is_empty());
        for second in 2..200 {
            buffer.take(&batch(1000 * second..1000 * (second + 1)));
        }
        assert!(buffer.rows() < 90_000 && buffer.rows() >= 61_000, "{}", buffer.rows());
        buffer.take(&batch(0..10));
        assert_eq!(buffer.rows(), 10, "switched on again");
    }
}
