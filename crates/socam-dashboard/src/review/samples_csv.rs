//! The samples in sight as CSV: all of them, with a column for each channel that is drawn, in SI, so that the file can be opened again.

use std::fmt::Write as _;
use std::ops::Range;
use std::sync::Arc;

use socam_chart::export::quoted;
use socam_recording::Channel;
use socam_samples::Samples;
use socam_workbench::entry::{Entry, signals};
use socam_workbench::job::Handle;
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

use super::Review;

/// Most rows of a file.
const MOST_ROWS: usize = 5_000_000;
/// Rows that are read at once.
const BLOCK: usize = 65_536;

/// What is in sight, to be written on another thread.
pub(crate) struct SamplesTable {
    heads: Vec<String>,
    recordings: Vec<Part>,
    rows: usize,
}

/// The rows of one recording.
struct Part {
    name: String,
    samples: Arc<Samples>,
    shift_s: f64,
    rows: Range<usize>,
    columns: Vec<Option<(Arc<Samples>, usize)>>,
}

impl Review {
    /// The rows in sight of all shown recordings, one recording after the other.
    ///
    /// # Errors
    /// When nothing is drawn, or too many rows are in sight; one sentence.
    pub(crate) fn in_sight(&self, entries: &[Entry]) -> Result<SamplesTable, String> {
        let drawn = self.plots.drawn(&signals(entries));
        let shown: Vec<&Entry> = entries.iter().filter(|entry| entry.shown).collect();
        let part = |entry: &&Entry| {
            let samples = &entry.recording.samples;
            let [from, to] = self.span(entries).map(|time| time - entry.shift_s);
            let column = |signal: &Signal| entry.find(signal).map(|(samples, own)| (samples.clone(), own));
            Part {
                name: quoted(short(&entry.recording.about.name)),
                samples: samples.clone(),
                shift_s: entry.shift_s,
                rows: samples.row_at(from)..samples.row_at(to.next_up()).max(samples.row_at(from)),
                columns: drawn.iter().map(column).collect(),
            }
        };
        let recordings: Vec<Part> = shown.iter().map(part).collect();
        let rows = recordings.iter().map(|part| part.rows.len()).sum();
        if drawn.is_empty() || rows == 0 {
            return Err("no channel is drawn, so there is nothing to export".into());
        }
        if rows > MOST_ROWS {
            return Err(format!("{rows} rows are in sight and at most {MOST_ROWS} are exported; zoom in"));
        }
        let heads = drawn.iter().map(|signal| quoted(&head(&shown, signal))).collect();
        Ok(SamplesTable { heads, recordings, rows })
    }
}

impl SamplesTable {
    /// The text of the file. Where there are several recordings, the first column names them.
    ///
    /// # Errors
    /// When the job was cancelled.
    pub(crate) fn text(&self, handle: &Handle) -> Result<String, String> {
        let is_many = self.recordings.len() > 1;
        let mut text = if is_many { "recording,time_s".to_owned() } else { "time_s".to_owned() };
        for head in &self.heads {
            let _ = write!(text, ",{head}");
        }
        text.push('\n');
        let mut written = 0;
        for part in &self.recordings {
            for begin in part.rows.clone().step_by(BLOCK) {
                handle.reached(written as f32 / self.rows as f32)?;
                let block = begin..(begin + BLOCK).min(part.rows.end);
                written += block.len();
                part.write(&mut text, block, is_many);
            }
        }
        Ok(text)
    }
}

impl Part {
    fn write(&self, text: &mut String, rows: Range<usize>, is_named: bool) {
        let values = |(samples, channel): &(Arc<Samples>, usize)| samples.values(*channel, rows.clone());
        let columns: Vec<Option<Vec<f64>>> =
            self.columns.iter().map(|column| column.as_ref().map(values)).collect();
        for (row, time) in self.samples.times(rows.clone()).into_iter().enumerate() {
            if is_named {
                let _ = write!(text, "{},", self.name);
            }
            let _ = write!(text, "{:.9}", time + self.shift_s);
            for column in &columns {
                let value = column.as_ref().and_then(|column| column.get(row));
                match value.filter(|value| value.is_finite()) {
                    // Samples are kept as 32 bits.
                    Some(value) => drop(write!(text, ",{}", *value as f32)),
                    None => text.push(','),
                }
            }
            text.push('\n');
        }
    }
}

/// The column name of a recorded channel, or the name of a derived one with its unit.
fn head(shown: &[&Entry], signal: &Signal) -> String {
    let is_it = |own: &&Channel| own.name == signal.name && own.unit.symbol() == signal.unit;
    let recorded = shown.iter().find_map(|entry| entry.recording.about.channels.iter().find(is_it));
    recorded.map_or_else(|| format!("{} [{}]", signal.name, signal.unit), Channel::column_name)
}
