//! Times of a group's samples, by its clock.

use socam_recording::Epoch;
use socam_recording::clocks::median_step_s;

use crate::mapping::Stamps;
use crate::source::Group;

/// Times before this are counted from an arbitrary moment, not since 1970: 1973 in nanoseconds.
const ABSOLUTE_NS: i128 = 100_000_000_000_000_000;
/// Length of a step, in usual steps, above which it is a gap.
const GAP_STEPS: f64 = 5.0;

/// Times of samples, and the rows of the file that they belong to.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Times {
    /// Nanoseconds that are added to all times.
    pub(crate) epoch_ns: i128,
    /// Strictly increasing, s.
    pub(crate) seconds: Vec<f64>,
    /// Row of each time in the group.
    pub(crate) rows: Vec<usize>,
    /// Whether they are times of day, of a day that is not known.
    pub(crate) are_of_day: bool,
    /// Notes on the processing of the times, in a few words each.
    pub(crate) notes: Vec<String>,
}

/// Why there are no times: words for an error.
type Problem = String;

impl Times {
    /// Times at a constant rate.
    pub(crate) fn of_rate(rows: usize, rate_hz: f64) -> Self {
        let seconds = (0..rows).map(|row| row as f64 / rate_hz).collect();
        Self { epoch_ns: 0, seconds, rows: (0..rows).collect(), are_of_day: false, notes: Vec::new() }
    }

    /// Times from a signal of the group whose unit is `unit_s` seconds.
    pub(crate) fn of_signal(
        group: &Group,
        column: usize,
        unit_s: f64,
        stamps: Stamps,
    ) -> Result<Self, Problem> {
        let signal = &group.signals[column];
        let epoch_ns = (i128::from(signal.origin) * (unit_s * 1e9).round() as i128).max(i128::MIN / 4);
        let mut stamped: Vec<(f64, usize)> =
            signal.values.iter().enumerate().map(|(row, value)| (value * unit_s, row)).collect();
        let mut notes = Vec::new();
        let before = stamped.len();
        stamped.retain(|(time, _)| time.is_finite());
        count(&mut notes, before - stamped.len(), "without a time left out");
        if stamped.is_empty() {
            return Err(format!("`{}` holds no time", signal.name));
        }
        if group.is_by_arrival {
            let sorted = stamped.windows(2).filter(|pair| pair[1].0 < pair[0].0).count();
            stamped.sort_by(|a, b| a.0.total_cmp(&b.0));
            count(&mut notes, sorted, "sorted by their times");
            let before = stamped.len();
            stamped.dedup_by(|b, a| a.0 == b.0);
            count(&mut notes, before - stamped.len(), "with the time of another left out");
        }
        let (mut seconds, rows): (Vec<f64>, Vec<usize>) = stamped.into_iter().unzip();
        if stamps == Stamps::Jitter {
            let moved_s = even_out(&mut seconds);
            notes.push(format!("stamps evened out, by {:.3} ms at most", 1e3 * moved_s));
        }
        check(&seconds, &rows, &signal.name)?;
        Ok(Self { epoch_ns, seconds, rows, are_of_day: signal.is_date, notes }.counted_from_start())
    }

    /// Absolute times count from the first one.
    fn counted_from_start(mut self) -> Self {
        let first_ns = (self.seconds[0] * 1e9).round() as i128;
        if self.epoch_ns + first_ns >= ABSOLUTE_NS {
            let first_s = self.seconds[0];
            self.seconds.iter_mut().for_each(|time| *time -= first_s);
            self.epoch_ns += first_ns;
        }
        self
    }

    /// Times in another clock's seconds.
    pub(crate) fn relative_to(&self, epoch_ns: i128, offset_s: f64) -> Vec<f64> {
        let shift_s = (self.epoch_ns - epoch_ns) as f64 / 1e9 + offset_s;
        self.seconds.iter().map(|time| time + shift_s).collect()
    }

    /// What the clock showed at time 0, if it is known.
    pub(crate) fn epoch(&self) -> Option<Epoch> {
        match i64::try_from(self.epoch_ns) {
            Ok(ns) if self.epoch_ns >= ABSOLUTE_NS => Some(Epoch::Date(ns)),
            _ => self.are_of_day.then_some(Epoch::Midnight),
        }
    }
}

fn count(notes: &mut Vec<String>, count: usize, what: &str) {
    match count {
        0 => {}
        1 => notes.push(format!("1 sample {what}")),
        count => notes.push(format!("{count} samples {what}")),
    }
}

fn check(seconds: &[f64], rows: &[usize], name: &str) -> Result<(), Problem> {
    let Some(at) = seconds.windows(2).position(|pair| pair[1] <= pair[0]) else { return Ok(()) };
    let (before, after) = (seconds[at], seconds[at + 1]);
    let row = rows[at + 1] + 1;
    Err(if before == after {
        format!(
            "the time `{name}` stands still at {after} s in row {row}; say stamps = \"jitter\" at its clock where stamps are coarser than \
             the sampling, or delete the row"
        )
    } else {
        format!(
            "the time `{name}` goes back from {before} s to {after} s in row {row}; split the file there, or delete what comes before"
        )
    })
}

/// Puts the times of each stretch without a gap on a line, by least squares. Returns the largest change, s.
fn even_out(seconds: &mut [f64]) -> f64 {
    let span = seconds.last().unwrap_or(&0.0) - seconds.first().unwrap_or(&0.0);
    // Coarse stamps repeat: the mean step is meaningful where the median is zero.
    let step = median_step_s(seconds).unwrap_or(0.0).max(span / seconds.len() as f64);
    let mut moved: f64 = 0.0;
    let mut start = 0;
    for end in 1..=seconds.len() {
        if end < seconds.len() && seconds[end] - seconds[end - 1] <= GAP_STEPS * step {
            continue;
        }
        let stretch = &mut seconds[start..end];
        let (middle, mean) =
            ((stretch.len() - 1) as f64 / 2.0, stretch.iter().sum::<f64>() / stretch.len() as f64);
        let offsets = || (0..end - start).map(|row| row as f64 - middle);
        let squares: f64 = offsets().map(|offset| offset * offset).sum();
        let slope = if squares > 0.0 {
            offsets().zip(stretch.iter()).map(|(offset, time)| offset * (time - mean)).sum::<f64>() / squares
        } else {
            0.0
        };
        for (row, time) in stretch.iter_mut().enumerate() {
            let even = mean + slope * (row as f64 - middle);
            moved = moved.max((even - *time).abs());
            *time = even;
        }
        start = end;
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Signal;

    fn group(times: Signal, is_by_arrival: bool) -> Group {
        Group { signals: vec![times], is_by_arrival, ..Group::default() }
    }

    #[test]
    fn nanoseconds_since_1970_keep_their_steps() {
        let first = 1_700_000_000_123_456_789_i64;
        let stamps = [0, 1_000_003, 2_000_001].map(|step| Some(first + step));
        let signal = Signal::of_integers("t", None, stamps.into_iter());
        let times = Times::of_signal(&group(signal, false), 0, 1e-9, Stamps::Exact).unwrap();
        assert_eq!(times.epoch(), Some(Epoch::Date(first)));
        assert!(
            times.seconds.iter().zip([0.0, 1.000_003e-3, 2.000_001e-3]).all(|(a, b)| (a - b).abs() < 1e-15)
        );
    }

    #[test]
    fn a_time_that_stands_still_or_runs_back_is_refused_with_its_row() {
        let problem = |values: Vec<f64>| {
            let group = group(Signal::new("t", None, values), false);
            Times::of_signal(&group, 0, 1.0, Stamps::Exact).unwrap_err()
        };
        assert!(problem(vec![0.0, 1.0, 1.0]).starts_with("the time `t` stands still at 1 s in row 3;"));
        assert!(
            problem(vec![0.0, 1.0, f64::NAN, 0.5])
                .starts_with("the time `t` goes back from 1 s to 0.5 s in row 4;")
        );
        assert_eq!(problem(vec![f64::NAN]), "`t` holds no time");
    }

    #[test]
    fn messages_are_sorted_and_coarse_stamps_evened_out() {
        let arrived = group(Signal::new("t", None, vec![0.0, 2.0, 1.0, 1.0]), true);
        let times = Times::of_signal(&arrived, 0, 1.0, Stamps::Exact).unwrap();
        assert_eq!((times.seconds, times.rows), (vec![0.0, 1.0, 2.0], vec![0, 2, 1]));
        // 1 kHz, written with two decimals, and a gap of a second.
        let coarse = (0..400)
            .map(|k| (f64::from(k) * 0.1 + if k < 200 { 0.0 } else { 100.0 }).floor() / 100.0)
            .collect();
        let times =
            Times::of_signal(&group(Signal::new("t", None, coarse), false), 0, 1.0, Stamps::Jitter).unwrap();
        let steps: Vec<f64> = times.seconds.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let worst = steps
            .iter()
            .enumerate()
            .filter(|(k, _)| *k != 199)
            .map(|(_, step)| (step - 0.001).abs())
            .fold(0.0, f64::max);
        assert!(worst < 4e-6, "{worst}");
        assert!((steps[199] - 1.001).abs() < 0.01);
    }
}
