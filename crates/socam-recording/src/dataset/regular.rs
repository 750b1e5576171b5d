//! Irregular time stamps: measures them, leaves them for an integration from stamp to stamp, or resamples a recording to a regular grid.
//!
//! The grid's step is the median step or a whole fraction of it. Inputs are interpolated from their true time stamps, by their own
//! intersample behaviour. Every other sample is moved to the grid's nearest point, by the polynomial through its neighbours; points
//! without a sample have no value. Steps longer than [`BRIDGED`] median steps remain gaps.

use super::data::Dataset;
use super::grid::{Carry, Resampled, Resampler};
use crate::Channel;
use crate::error::Result;
use crate::segments::{Segment, SegmentFinder};
use crate::warning::Warning;

/// A step that differs from the median by more than this share of it is irregular.
const UNEVEN: f64 = 0.05;
/// Share of irregular steps above which a recording is irregular.
const IRREGULAR: f64 = 0.02;
/// Longest step that is interpolated over, in median steps.
pub(super) const BRIDGED: f64 = 4.0;

/// Statistics of the time steps of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// Median, s.
    pub median_s: f64,
    /// Shortest and longest, s.
    pub range_s: (f64, f64),
    /// Number of steps that are not a multiple of the median.
    pub irregular: u64,
    /// Number of all steps.
    pub count: u64,
}

impl Steps {
    /// Whether time stamps are too irregular for a constant rate.
    #[must_use]
    pub fn are_irregular(&self) -> bool {
        self.irregular as f64 > IRREGULAR * self.count as f64
    }
}

impl Dataset {
    /// Statistics of its time steps, in one pass.
    ///
    /// ```
    /// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
    /// let steps = data.steps()?;
    /// assert_eq!((steps.count, steps.irregular, steps.are_irregular()), (999, 0, false));
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the file cannot be read again.
    pub fn steps(&self) -> Result<Steps> {
        let median_s = self.sample_time_s;
        let mut steps = Steps {
            median_s,
            range_s: (f64::INFINITY, 0.0),
            irregular: 0,
            count: self.rows.saturating_sub(1),
        };
        let mut last = None;
        for block in self.blocks_in(0..self.rows, &[])? {
            for time_s in block?.time_s {
                if let Some(last) = last.replace(time_s) {
                    let step_s: f64 = time_s - last;
                    steps.range_s = (steps.range_s.0.min(step_s), steps.range_s.1.max(step_s));
                    // A lost sample leaves a step of two.
                    let whole = (step_s / median_s).round().max(1.0);
                    steps.irregular += u64::from((step_s - whole * median_s).abs() > UNEVEN * median_s);
                }
            }
        }
        Ok(steps)
    }

    /// The recording for views of it: irregular samples of all channels are interpolated on a regular grid, regular ones stay as they are.
    ///
    /// # Errors
    /// As [`Self::on_regular_grid`].
    pub fn regular(self) -> Result<Self> {
        let data = self.on_even_times()?;
        if data.steps()?.are_irregular() { data.on_regular_grid(1, |_| Carry::Smooth) } else { Ok(data) }
    }

    /// The recording for an integration from stamp to stamp: its rows as they are, and a gap only where a step is longer than four median
    /// steps. [`Segment::sample_time_s`](crate::Segment::sample_time_s) is then the mean step, and
    /// [`Segment::jitter_s`](crate::Segment::jitter_s) the largest deviation from it.
    ///
    /// ```
    /// use socam_recording::{Channel, Dataset, Unit};
    ///
    /// // Every third sample is late by half a step, and one is missing.
    /// let rows = (0..100).filter(|k| *k != 50);
    /// let time_s: Vec<f64> = rows.map(|k| 0.01 * (f64::from(k) + if k % 3 == 0 { 0.5 } else { 0.0 })).collect();
    /// let speed = time_s.iter().map(|t| 3.0 * t).collect();
    /// let data = Dataset::from_columns("run", vec![Channel::new("speed", Unit::RadPerS)], time_s, vec![speed])?;
    /// let uneven = data.clone().on_its_stamps()?;
    /// assert!(data.segments().len() > 1 && uneven.segments().len() == 1);
    /// assert!(uneven.has_uneven_steps() && uneven.rows() == data.rows());
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the recording cannot be read again.
    pub fn on_its_stamps(self) -> Result<Self> {
        let steps = self.steps()?;
        let mut finder = SegmentFinder::with_gaps(BRIDGED);
        for block in self.blocks_in(0..self.rows, &[])? {
            block?.time_s.iter().for_each(|time_s| finder.push(*time_s));
        }
        let (segments, sample_time_s) = finder.finish();
        let note = format!(
            "its time stamps are irregular (steps of {:.3} to {:.3} ms, half of them below {:.3} ms): it is integrated from stamp to stamp, and {} steps above {:.1} ms are gaps",
            1e3 * steps.range_s.0,
            1e3 * steps.range_s.1,
            1e3 * steps.median_s,
            segments.len().saturating_sub(1),
            1e3 * BRIDGED * steps.median_s,
        );
        let mut warnings = self.warnings.clone();
        warnings.push(Warning::Note(note));
        Ok(Self { segments, sample_time_s, uneven: true, warnings, ..self })
    }

    /// The recording cut after every `rows` rows into parts, each a segment of its own: without its last row, which makes a gap to the next.
    /// Times and angles are those of the whole recording.
    ///
    /// ```
    /// use socam_recording::{Channel, Dataset, Unit};
    ///
    /// let time_s: Vec<f64> = (0..25).map(|k| 0.1 * f64::from(k)).collect();
    /// let speed = time_s.iter().map(|t| 2.0 * t).collect();
    /// let data = Dataset::from_columns("run", vec![Channel::new("speed", Unit::RadPerS)], time_s, vec![speed])?;
    /// let parts = data.in_parts(10)?;
    /// assert_eq!(parts.segments().iter().map(|part| part.rows).collect::<Vec<_>>(), [9, 9, 5]);
    /// assert_eq!((parts.rows(), parts.segments()[1].first_row, parts.segments()[2].start_s), (23, 9, 2.0));
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the recording cannot be read again.
    pub fn in_parts(&self, rows: u64) -> Result<Self> {
        let length = rows.max(2);
        let loaded = self.load_all()?;
        let kept = |values: &[f64]| -> Vec<f64> {
            let rows = values.iter().zip(1_u64..).filter(|(_, number)| number % length != 0);
            rows.map(|(value, _)| *value).collect()
        };
        let part = |whole: &Segment, number: u64| {
            let first = whole.first_row.max(number * length);
            let end = whole.end_row().min((number + 1) * length - 1);
            let (start_s, end_s) = (loaded.time_s.get(first as usize)?, loaded.time_s.get(end as usize - 1)?);
            // One row was left out of each part before this one.
            let first_row = first - number;
            let rows = end.checked_sub(first).filter(|rows| *rows > 0)?;
            Some(Segment { first_row, rows, start_s: *start_s, end_s: *end_s, ..*whole })
        };
        let parts = self.segments.iter().flat_map(|whole| {
            let numbers = whole.first_row / length..whole.end_row().div_ceil(length);
            numbers.filter_map(|number| part(whole, number))
        });
        let segments = parts.collect();
        let columns = loaded.columns.iter().map(|column| kept(column.values())).collect();
        let copy = self.with_columns(kept(&loaded.time_s), columns)?;
        Ok(Self { segments, sample_time_s: self.sample_time_s, ..copy })
    }

    /// A recording in memory with other values, of all rows of this one or of its first: as even or uneven, and with the same segments where
    /// it has all rows.
    ///
    /// # Errors
    /// As [`Dataset::from_columns`].
    pub fn with_columns(&self, time_s: Vec<f64>, columns: Vec<Vec<f64>>) -> Result<Self> {
        let copy = Self::from_columns(self.name(), self.channels().to_vec(), time_s, columns)?;
        let copy = Self { parts: self.parts, ..copy };
        if copy.rows == self.rows {
            let segments = self.segments.clone();
            return Ok(Self { segments, sample_time_s: self.sample_time_s, uneven: self.uneven, ..copy });
        }
        if self.uneven { copy.on_its_stamps() } else { Ok(copy) }
    }

    /// The recording on a regular grid of `parts` points per median step; `carry` says how each channel is resampled.
    ///
    /// ```
    /// use socam_recording::{Carry, Channel, Dataset, Unit};
    ///
    /// // Samples that are late by up to a third of a step.
    /// let time_s: Vec<f64> = (0..100).map(|k| 0.01 * (f64::from(k) + f64::from(k % 3) / 9.0)).collect();
    /// let speed = time_s.iter().map(|t| 3.0 * t).collect();
    /// let data = Dataset::from_columns("run", vec![Channel::new("speed", Unit::RadPerS)], time_s, vec![speed])?;
    /// let regular = data.on_regular_grid(2, |_| Carry::Linear)?;
    /// assert!(data.steps()?.are_irregular() && !regular.steps()?.are_irregular());
    /// assert_eq!(regular.rows_per_sample(), 2);
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the recording cannot be read again, or there is room for the grid neither in memory nor on disk.
    pub fn on_regular_grid(&self, parts: u32, carry: impl Fn(&Channel) -> Carry) -> Result<Self> {
        let steps = self.steps()?;
        let median_s = steps.median_s;
        let step_s = median_s / f64::from(parts.max(1));
        let carries: Vec<Carry> = self.channels.iter().map(carry).collect();
        let expected_rows = ((self.end_s() - self.start_s()) / step_s) as u64;
        let mut out = Resampled::new(carries.len(), expected_rows);
        let mut segment: Option<Resampler> = None;
        let mut gaps = 0;
        for block in self.blocks()? {
            let block = block?;
            for (row, time_s) in block.time_s.iter().enumerate() {
                let values: Vec<f64> = block.columns.iter().map(|column| column.values()[row]).collect();
                if let Some(open) = segment.take_if(|open| *time_s - open.last_s() > BRIDGED * median_s) {
                    open.finish(&carries, &mut out);
                    gaps += 1;
                }
                let open = segment.get_or_insert_with(|| Resampler::new(*time_s, step_s));
                open.push((*time_s, values), &carries, &mut out);
            }
        }
        if let Some(open) = segment {
            open.finish(&carries, &mut out);
        }
        let (least_ms, most_ms) = (1e3 * steps.range_s.0, 1e3 * steps.range_s.1);
        let note = format!(
            "its time stamps are irregular (steps of {least_ms:.3} to {most_ms:.3} ms, half of them below {:.3} ms): it was put on a grid of {:.3} ms, inputs interpolated and every other sample shifted to the nearest point along its own curve; {gaps} steps above {:.1} ms are left as gaps",
            1e3 * steps.median_s,
            1e3 * step_s,
            1e3 * BRIDGED * steps.median_s,
        );
        self.resampled(out, parts, note)
    }

    /// The recording with these rows in place of its own, `parts` for each sample, and a note about them.
    pub(super) fn resampled(&self, out: Resampled, parts: u32, note: String) -> Result<Self> {
        let mut all = Self { parts, uneven: false, ..self.clone() };
        all.warnings.push(Warning::Note(note));
        all.with_rows(
            out,
            self.name.clone(),
            "there is room neither in memory nor on disk for its regular grid",
        )
    }
}

#[cfg(test)]
mod tests;
