//! Whether the samples of a log are in order, in time and in number.

/// Order of consecutive samples: first and last, and whether time decreased or samples were lost between them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SampleOrder {
    first: Option<TimeStamp>,
    last: Option<TimeStamp>,
    /// The first pair of consecutive times that does not increase, s.
    back_s: Option<(f64, f64)>,
    /// Samples lost, by jumps of their sequence numbers.
    pub(crate) lost: u64,
}

/// Time and sequence number of a sample.
#[derive(Debug, Clone, Copy)]
struct TimeStamp {
    time_s: f64,
    sequence: Option<u64>,
}

impl SampleOrder {
    /// Order of a single sample.
    pub(crate) fn of(time_s: f64, sequence: Option<u64>) -> Self {
        let stamp = TimeStamp { time_s, sequence };
        Self { first: Some(stamp), last: Some(stamp), ..Self::default() }
    }

    /// Appends the samples that follow.
    pub(crate) fn append(&mut self, next: &Self) {
        if let (Some(last), Some(first)) = (self.last, next.first) {
            if first.time_s <= last.time_s {
                self.back_s.get_or_insert((last.time_s, first.time_s));
            }
            if let (Some(before), Some(after)) = (last.sequence, first.sequence) {
                let between = after.saturating_sub(before.wrapping_add(1));
                self.lost = self.lost.saturating_add(between);
            }
        }
        self.back_s = self.back_s.or(next.back_s);
        self.lost = self.lost.saturating_add(next.lost);
        self.first = self.first.or(next.first);
        self.last = next.last.or(self.last);
    }

    /// Time of the last sample, s.
    pub(crate) fn last_s(&self) -> Option<f64> {
        self.last.map(|stamp| stamp.time_s)
    }

    /// # Errors
    /// When time does not increase from sample to sample, in words.
    pub(crate) fn check(&self) -> Result<(), String> {
        match self.back_s {
            None => Ok(()),
            Some((last_s, time_s)) => Err(format!(
                "in this chunk time goes from {last_s} s to {time_s} s; it must increase from sample to sample: \
                 the clock was set back while recording, so record again"
            )),
        }
    }
}
