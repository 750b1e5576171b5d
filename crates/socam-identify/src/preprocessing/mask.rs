//! Samples of a recording that are not used as measured: output samples that are left out, input samples that are imputed.

use std::ops::Range;

use serde::Serialize;
use socam_recording::Dataset;

/// Why samples are not used as measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// An output is at the limit of its range: left out.
    Saturated,
    /// Single output values that neither the model nor the neighbouring values explain: left out.
    Outliers,
    /// A speed that was computed from an angle, which is an output too: left out.
    Computed,
    /// Single input values that differ from their neighbours: replaced by interpolated values.
    #[serde(rename = "bridged")]
    Imputed,
}

/// A report of samples that are not used as measured.
///
/// ```
/// use socam_identify::{LeftOut, Reason};
///
/// let report = LeftOut {
///     recording: "run.csv".into(),
///     channel: "torque".into(),
///     reason: Reason::Outliers,
///     samples: 1,
///     share_percent: 0.1,
///     places: 1,
///     time_s: [2.0, 2.0],
///     rows: vec![2000..2001],
/// };
/// assert!(report.sentence().starts_with("run.csv: torque has outliers in 1 place"));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LeftOut {
    /// Recording.
    pub recording: String,
    /// Channel.
    pub channel: String,
    /// Why.
    pub reason: Reason,
    /// Number of samples.
    pub samples: u64,
    /// Share of the recording's samples, %.
    pub share_percent: f64,
    /// Number of separate ranges of rows.
    pub places: usize,
    /// Times of the first and the last sample, s.
    pub time_s: [f64; 2],
    /// Their rows in the recording: ascending ranges that do not touch.
    #[serde(skip)]
    pub rows: Vec<Range<u64>>,
}

impl LeftOut {
    /// The report of `rows`, ascending ranges that do not touch; `None` if there are none.
    pub(crate) fn new(dataset: &Dataset, channel: &str, reason: Reason, rows: &[Range<u64>]) -> Option<Self> {
        let (first, last) = (rows.first()?, rows.last()?);
        let samples = rows.iter().map(|rows| rows.end - rows.start).sum();
        Some(Self {
            recording: dataset.name().into(),
            channel: channel.into(),
            reason,
            samples,
            share_percent: 100.0 * samples as f64 / dataset.rows() as f64,
            places: rows.len(),
            time_s: [first.start, last.end - 1].map(|row| time_of(dataset, row)),
            rows: rows.to_vec(),
        })
    }

    /// Adds the report to `all`: to the one of the same recording, channel and reason, if there is one.
    pub(crate) fn join(self, all: &mut Vec<Self>) {
        let alike = |other: &&mut Self| {
            (&other.recording, &other.channel, other.reason) == (&self.recording, &self.channel, self.reason)
        };
        match all.iter_mut().find(alike) {
            Some(other) => {
                other.samples += self.samples;
                other.share_percent += self.share_percent;
                other.places += self.places;
                let [from, to] = self.time_s;
                other.time_s = [other.time_s[0].min(from), other.time_s[1].max(to)];
                other.rows = joined([std::mem::take(&mut other.rows), self.rows].concat());
            }
            None => all.push(self),
        }
    }

    /// The report as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let Self { recording, channel, samples, share_percent, places, time_s: [from, to], .. } = self;
        let plural = |count: u64, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
        let (samples, places) = (plural(*samples, "sample"), plural(*places as u64, "place"));
        let share = format!("({share_percent:.2} %)");
        let place = format!("in {places} from {from:.3} s to {to:.3} s");
        match self.reason {
            Reason::Saturated => {
                format!("{recording}: {channel} is saturated {place}: {samples} {share} left out")
            }
            Reason::Outliers => {
                format!("{recording}: {channel} has outliers {place}: {samples} {share} left out")
            }
            Reason::Computed => {
                format!(
                    "{recording}: {channel} is left out: it was computed from an angle that the model predicts too, and holds nothing that the angle does not"
                )
            }
            Reason::Imputed => {
                format!(
                    "{recording}: {channel} has spikes {place}: {samples} {share} replaced by values from their neighbours"
                )
            }
        }
    }
}

/// Time of a row, s; steps within a segment of the recording are taken to be even. The recording must not be empty.
pub(crate) fn time_of(dataset: &Dataset, row: u64) -> f64 {
    let segments = dataset.segments();
    let index = segments.partition_point(|segment| segment.end_row() <= row).min(segments.len() - 1);
    let segment = &segments[index];
    segment.start_s + (row - segment.first_row) as f64 * segment.sample_time_s
}

/// Ascending ranges of rows that do not touch.
pub(super) type Rows = Vec<Range<u64>>;

/// Samples of one recording that are not used as measured.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Mask {
    /// Per output, the rows that are left out. May have fewer entries than there are outputs.
    pub(crate) left_out: Vec<Rows>,
    /// Per input, ascending rows and their imputed values in the recording's unit. May have fewer entries than there are inputs.
    pub(crate) imputed: Vec<Vec<(u64, f64)>>,
}

impl Mask {
    /// Replaces the imputed values of an input; `values` are those of `rows`.
    pub(crate) fn impute(&self, input: usize, rows: Range<u64>, values: &mut [f64]) {
        let Some(imputed) = self.imputed.get(input) else { return };
        let first = imputed.partition_point(|(row, _)| *row < rows.start);
        let here = imputed[first..].iter().take_while(|(row, _)| *row < rows.end);
        here.for_each(|(row, value)| values[(row - rows.start) as usize] = *value);
    }

    /// Sets the values of an output that are left out to NaN; `values` are those of `rows`.
    pub(crate) fn leave_out(&self, output: usize, rows: Range<u64>, values: &mut [f64]) {
        let Some(left_out) = self.left_out.get(output) else { return };
        let first = left_out.partition_point(|own| own.end <= rows.start);
        for own in left_out[first..].iter().take_while(|own| own.start < rows.end) {
            let here = own.start.max(rows.start) - rows.start..own.end.min(rows.end) - rows.start;
            values[here.start as usize..here.end as usize].fill(f64::NAN);
        }
    }

    /// Leaves out more rows of an output.
    pub(crate) fn add(&mut self, output: usize, rows: Vec<Range<u64>>) {
        if self.left_out.len() <= output {
            self.left_out.resize(output + 1, Vec::new());
        }
        let mut all = std::mem::take(&mut self.left_out[output]);
        all.extend(rows);
        self.left_out[output] = joined(all);
    }
}

/// Sorts rows and joins ranges that touch.
pub(super) fn joined(mut rows: Rows) -> Rows {
    rows.sort_by_key(|rows| rows.start);
    let mut joined = Rows::new();
    for rows in rows {
        match joined.last_mut() {
            Some(last) if rows.start <= last.end => last.end = last.end.max(rows.end),
            _ => joined.push(rows),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_changed_where_they_stand() {
        let mut mask = Mask { imputed: vec![vec![(3, 30.0), (12, 120.0)]], ..Mask::default() };
        mask.add(1, vec![8..10, 4..6, 5..7, 30..40]);
        assert_eq!(mask.left_out, [vec![], vec![4..7, 8..10, 30..40]]);
        let mut values: Vec<f64> = (5..15).map(f64::from).collect();
        mask.impute(0, 5..15, &mut values);
        mask.impute(1, 5..15, &mut values);
        assert_eq!(values[7], 120.0);
        mask.leave_out(0, 5..15, &mut values);
        mask.leave_out(1, 5..15, &mut values);
        let missing: Vec<usize> = (0..10).filter(|k| values[*k].is_nan()).collect();
        assert_eq!(missing, [0, 1, 3, 4]);
    }
}
