//! The run that is recorded, or the last one that was: its progress and the extremes of its channels.

use std::path::PathBuf;

use crate::buffer::Buffer;

/// Time of samples, s, that may not be in the file of a run that goes on.
const UNWRITTEN_S: f64 = 1.5;
/// Shortest part of a recording that a diagnosis is offered for, s.
const SHORTEST_S: f64 = 1.0;

/// A run and its recording.
#[derive(Debug, Clone, Default)]
pub struct Run {
    /// File of the run.
    pub path: PathBuf,
    /// Planned duration, s.
    pub planned_s: f64,
    /// Time of the first sample since the link was opened, s.
    began_s: Option<f64>,
    /// Time of the last sample that is part of `extremes`, s.
    until_s: f64,
    /// Least and greatest value of each channel; NaN before its first reading.
    extremes: Vec<[f32; 2]>,
    /// The result in words, and whether it succeeded, once the recording is closed.
    pub end: Option<(String, bool)>,
}

impl Run {
    /// A run that has not begun.
    #[must_use]
    pub fn new(path: PathBuf, planned_s: f64) -> Self {
        Self { path, planned_s, ..Self::default() }
    }

    /// The run's first sample is that of this time.
    pub fn begin(&mut self, time_s: f64) {
        self.began_s = Some(time_s);
        self.until_s = time_s;
    }

    /// Whether its recording is still open.
    #[must_use]
    pub fn is_recorded(&self) -> bool {
        self.end.is_none()
    }

    /// Time since its first sample, s; it stands still after the end.
    #[must_use]
    pub fn elapsed_s(&self) -> f64 {
        self.began_s.map_or(0.0, |began_s| self.until_s - began_s)
    }

    /// The part of its file from a time on, s since the link was opened: `RUN@FROM..TO`, as far as it is in the file by now. `None` if that
    /// is shorter than a second.
    #[must_use]
    pub fn since(&self, from_s: f64) -> Option<String> {
        let from_s = (from_s - self.began_s?).max(0.0);
        let to_s = self.elapsed_s() - if self.is_recorded() { UNWRITTEN_S } else { 0.0 };
        (to_s - from_s >= SHORTEST_S).then(|| format!("{}@{from_s:.2}..{to_s:.2}", self.path.display()))
    }

    /// Follows the samples that have arrived, until the run ends.
    pub fn follow(&mut self, buffer: &Buffer) {
        if self.began_s.is_none() || !self.is_recorded() || buffer.end_s() <= self.until_s {
            return;
        }
        let channels = buffer.channels().len();
        self.extremes.resize(channels, [f32::NAN; 2]);
        for (channel, [low, high]) in self.extremes.iter_mut().enumerate() {
            for value in buffer.values(channel, [self.until_s, buffer.end_s()]) {
                (*low, *high) = (low.min(*value), high.max(*value));
            }
        }
        self.until_s = buffer.end_s();
    }

    /// Least and greatest value of a channel since the run began.
    #[must_use]
    pub fn extremes(&self, channel: usize) -> Option<[f32; 2]> {
        self.extremes.get(channel).copied().filter(|extremes| extremes[0].is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queue::Batch;
    use socam_recording::{Channel, Unit};

    #[test]
    fn extremes_and_time_are_those_of_the_run_alone() {
        let mut buffer = Buffer::new(vec![Channel::new("a", Unit::V)]);
        let mut run = Run::new("run-1.mcap".into(), 2.0);
        let batch = |from: u32, value: f64| Batch {
            time_s: (from..from + 500).map(|tick| f64::from(tick) * 1e-3).collect(),
            step_s: 1e-3,
            after_setup: false,
            gaps: None,
            values: vec![value; 500],
        };
        buffer.take(&batch(0, 9.0));
        run.follow(&buffer);
        assert_eq!((run.extremes(0), run.elapsed_s()), (None, 0.0));
        run.begin(0.5);
        buffer.take(&batch(500, -1.0));
        run.follow(&buffer);
        buffer.take(&batch(1000, 3.0));
        run.follow(&buffer);
        assert_eq!(run.extremes(0), Some([-1.0, 3.0]));
        assert!((run.elapsed_s() - 0.999).abs() < 1e-9, "{}", run.elapsed_s());
        assert_eq!(run.since(0.8), None, "what is not in the file yet is not offered");
        run.end = Some((String::new(), true));
        assert_eq!([run.since(0.2), run.since(0.45)].map(Option::unwrap_or_default), ["", ""]);
        buffer.take(&batch(1500, 7.0));
        run.follow(&buffer);
        assert_eq!(run.extremes(0), Some([-1.0, 3.0]));
    }
}
