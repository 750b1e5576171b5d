//! Files of one recording that follow one another as one dataset, and a part of a dataset.
//!
//! Rows go from each file to the joined dataset while it is open, and one file is open at a time: no more is in memory than one file and
//! what [`super::keep`] allows.

use std::sync::Arc;

use super::data::Dataset;
use super::grid::Resampled;
use super::keep::{Kept, Memory};
use super::source::{Source, SpillSource};
use crate::clock_time::Epoch;
use crate::error::{RecordingError, Result};
use crate::format::Format;
use crate::segments::GAP_STEPS;
use crate::selection::{Selection, Span};
use crate::statistics::Running;
use crate::table::Table;
use crate::warning::Warning;

/// Sample times between two files of which the second begins its time anew: a gap for every command, as long as none that is bridged.
const UNKNOWN_STEPS: f64 = 10.0;

/// Sampling times of two files that differ by more than this factor belong to different recordings.
const SAME_RATE: f64 = 1.5;

const NO_ROOM: &str =
    "there is room for it neither in memory nor in the folder of temporary files; free some";

const DAY_S: f64 = 86_400.0;

impl Dataset {
    /// What a selection names, of files that `open` opens one by one, whole or in part: joins those that follow one another, and cuts by
    /// clock times. All that opens recordings does it here.
    ///
    /// # Errors
    /// The errors of `open`; also when files do not follow one another or differ in their channels, or the recording has no clock times.
    pub fn open_by<E: From<RecordingError>>(
        selection: &Selection,
        mut open: impl FnMut(&Selection) -> Result<Self, E>,
    ) -> Result<Self, E> {
        if selection.is_plain() {
            return open(selection);
        }
        let whole = if selection.more.is_empty() {
            open(&Selection::whole(&selection.path))?
        } else {
            let mut joining: Option<Joining> = None;
            for path in selection.files() {
                let next = open(&Selection::whole(path))?;
                match &mut joining {
                    None => joining = Some(Joining::with(next, 1 + selection.more.len())?),
                    Some(joining) => joining.append(&next)?,
                }
            }
            match joining {
                Some(joining) => joining.finish(selection.name())?,
                None => return open(selection),
            }
        };
        let span = selection.span_within(whole.epoch, (whole.start_s(), whole.end_s()))?;
        Ok(if span == Span::ALL { whole } else { whole.part(span, selection)? })
    }

    /// The rows of a span.
    fn part(self, span: Span, selection: &Selection) -> Result<Self> {
        let mut out = Resampled::new(self.channels.len(), self.rows);
        copy(&self, &(0..self.channels.len()).collect::<Vec<_>>(), 0.0, span, &mut out)?;
        if out.is_empty() {
            return Err(RecordingError::NoSamples { path: selection.name().into(), is_whole: false });
        }
        self.without_rows().with_rows(out, selection.name(), NO_ROOM)
    }

    /// All but its rows, which need memory.
    fn without_rows(self) -> Self {
        Self { source: Source::Memory(Arc::new(Memory::existing(Table::default()))), ..self }
    }

    /// Itself with these rows and this name; `no_room` is the problem where nothing can hold them.
    pub(super) fn with_rows(self, mut out: Resampled, name: String, no_room: &str) -> Result<Self> {
        out.flush();
        let Resampled { tally, kept, .. } = out;
        let (segments, sample_time_s) = tally.finder.finish();
        let source = match kept.finish() {
            Kept::Memory(memory) => Source::Memory(memory.into()),
            Kept::Spill(spill) => {
                Source::Spill(SpillSource { spill, columns: (0..self.channels.len()).collect() }.into())
            }
            Kept::Nothing => return Err(RecordingError::Table { name, problem: no_room.into() }),
        };
        let statistics = tally.running.into_iter().map(Running::finish).collect();
        Ok(Self { name, statistics, segments, sample_time_s, rows: tally.rows, source, ..self })
    }
}

/// Appends the rows of a span, later by `shift_s`.
fn copy(data: &Dataset, channels: &[usize], shift_s: f64, span: Span, out: &mut Resampled) -> Result<()> {
    for block in data.blocks_in(0..data.rows, channels)? {
        let block = block?;
        for (row, time_s) in block.time_s.iter().enumerate() {
            let time_s = time_s + shift_s;
            if span.contains(time_s) {
                out.push(time_s, block.columns.iter().map(|column| column.values()[row]));
            }
        }
    }
    Ok(())
}

/// Files being joined.
struct Joining {
    /// The first file without its rows, and with the warnings of all.
    all: Dataset,
    first_start_s: f64,
    out: Resampled,
    /// Name of the last file.
    last: String,
    end_s: f64,
    sample_time_s: f64,
}

impl Joining {
    fn with(first: Dataset, files: usize) -> Result<Self> {
        let mut out = Resampled::new(first.channels.len(), first.rows * files as u64);
        copy(&first, &(0..first.channels.len()).collect::<Vec<_>>(), 0.0, Span::ALL, &mut out)?;
        let (last, end_s, sample_time_s) = (first.name.clone(), first.end_s(), first.sample_time_s);
        let (first_start_s, mut all) = (first.start_s(), first.without_rows());
        all.format = Format::Memory;
        if all.contents.is_some() {
            let note = "events, notes and attachments are those of the first file";
            all.warnings.push(Warning::Note(note.into()));
        }
        Ok(Self { all, first_start_s, out, last, end_s, sample_time_s })
    }

    fn append(&mut self, next: &Dataset) -> Result<()> {
        let channels = self.channels_of(next)?;
        self.compare_rates(next)?;
        let shift_s = self.shift_of(next)?;
        let start_s = next.start_s() + shift_s;
        let step_s = start_s - self.end_s;
        if step_s > GAP_STEPS * self.sample_time_s {
            self.note(format!(
                "between `{}` and `{}` is a gap of {:.6} s, from {} s to {} s",
                self.last, next.name, step_s, self.end_s, start_s
            ));
        }
        copy(next, &channels, shift_s, Span::ALL, &mut self.out)?;
        for warning in &next.warnings {
            if !self.all.warnings.contains(warning) {
                let warning = Box::new(warning.clone());
                self.all.warnings.push(Warning::InFile { file: next.name.clone(), warning });
            }
        }
        self.all.lost_samples += next.lost_samples;
        self.all.cut = next.cut.clone().or(self.all.cut.take());
        self.end_s = next.end_s() + shift_s;
        if self.sample_time_s == 0.0 {
            self.sample_time_s = next.sample_time_s;
        }
        self.last.clone_from(&next.name);
        Ok(())
    }

    fn finish(self, name: String) -> Result<Dataset> {
        self.all.with_rows(self.out, name, NO_ROOM)
    }

    fn note(&mut self, text: String) {
        self.all.warnings.push(Warning::Note(text));
    }

    fn problem(&self, next: &Dataset, problem: String) -> RecordingError {
        let text = format!("{}+{}", self.last, next.name);
        RecordingError::Pattern { text, problem: format!("cannot be joined: {problem}") }
    }

    /// Place in the next file of each channel.
    fn channels_of(&self, next: &Dataset) -> Result<Vec<usize>> {
        let place = |own| next.channels.iter().position(|theirs| theirs == own);
        let places: Option<Vec<usize>> = self.all.channels.iter().map(place).collect();
        places.filter(|places| places.len() == next.channels.len()).ok_or_else(|| {
            let names = |data: &Dataset| {
                data.channels.iter().map(crate::Channel::column_name).collect::<Vec<_>>().join(", ")
            };
            let problem = format!(
                "the first has the channels {}, and the second {}; files of one recording have the same",
                names(&self.all),
                names(next)
            );
            self.problem(next, problem)
        })
    }

    fn compare_rates(&self, next: &Dataset) -> Result<()> {
        let (own_s, theirs_s) = (self.sample_time_s, next.sample_time_s);
        if own_s > 0.0 && theirs_s > 0.0 && own_s.max(theirs_s) > SAME_RATE * own_s.min(theirs_s) {
            let problem = format!(
                "the first has a sample every {own_s} s, and the second every {theirs_s} s; files of one recording have the same"
            );
            return Err(self.problem(next, problem));
        }
        Ok(())
    }

    /// What the times of the next file are to be shifted by.
    fn shift_of(&mut self, next: &Dataset) -> Result<f64> {
        let start_s = next.start_s();
        let shift_s = match (self.all.epoch, next.epoch) {
            (Some(Epoch::Date(first)), Some(Epoch::Date(own))) => {
                (i128::from(own) - i128::from(first)) as f64 / 1e9
            }
            // Midnight may lie between two files, and a gap of more than half a day is rather a wrong order.
            (Some(Epoch::Midnight), Some(Epoch::Midnight)) => {
                DAY_S * ((self.end_s - start_s) / DAY_S - 0.5).ceil().max(0.0)
            }
            (None, None) if start_s <= self.end_s && self.begins_anew(next) => {
                let step_s = UNKNOWN_STEPS * self.sample_time_s.max(next.sample_time_s);
                self.note(format!(
                    "`{}` counts its time anew and states no date: how much time passed since `{}` is not known, and it is put {step_s} s after its end, with a gap between",
                    next.name, self.last
                ));
                self.end_s + step_s - start_s
            }
            (None, None) => 0.0,
            _ => {
                let problem =
                    "only one of them states when it was recorded, so that their order in time is not known";
                return Err(self.problem(next, problem.into()));
            }
        };
        if start_s + shift_s <= self.end_s {
            let at = |time_s: f64| match self.all.epoch {
                Some(epoch) => epoch.clock_time(time_s),
                None => format!("{time_s} s"),
            };
            let problem = format!(
                "the second begins at {}, and the first ends at {}; name files in the order of their times, of which none overlap",
                at(start_s + shift_s),
                at(self.end_s)
            );
            return Err(self.problem(next, problem));
        }
        Ok(shift_s)
    }

    /// Whether a file begins where the first one began, to a sample.
    fn begins_anew(&self, next: &Dataset) -> bool {
        (next.start_s() - self.first_start_s).abs() <= GAP_STEPS * self.sample_time_s
    }
}

#[cfg(test)]
mod tests;
