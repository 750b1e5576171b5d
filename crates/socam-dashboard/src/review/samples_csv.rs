//! The samples in sight as CSV: all of them, with a column for each channel that is drawn, in SI, so that the file can be opened again.

use std::fmt::Write as _;

use socam_recording::Channel;
use socam_workbench::entry::{Entry, signals};
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

use super::Review;

/// Most rows of a file.
const MOST_ROWS: usize = 5_000_000;
/// Rows that are read at once.
const BLOCK: usize = 65_536;

impl Review {
    /// The rows in sight of all shown recordings, one recording after the other. Where there are several, the first column names them.
    ///
    /// # Errors
    /// When nothing is drawn, or too many rows are in sight; one sentence.
    pub(crate) fn samples_csv(&self, entries: &[Entry]) -> Result<String, String> {
        let drawn = self.plots.drawn(&signals(entries));
        let shown: Vec<&Entry> = entries.iter().filter(|entry| entry.shown).collect();
        let rows = |entry: &Entry| {
            let samples = &entry.recording.samples;
            let [from, to] = self.span(entries).map(|time| time - entry.shift_s);
            samples.row_at(from)..samples.row_at(to.next_up()).max(samples.row_at(from))
        };
        let count: usize = shown.iter().map(|entry| rows(entry).len()).sum();
        if drawn.is_empty() || count == 0 {
            return Err("no channel is drawn, so there is nothing to export".into());
        }
        if count > MOST_ROWS {
            return Err(format!("{count} rows are in sight and at most {MOST_ROWS} are exported; zoom in"));
        }
        let is_many = shown.len() > 1;
        let mut text = if is_many { "recording,time_s".to_owned() } else { "time_s".to_owned() };
        for signal in &drawn {
            let head = head(&shown, signal);
            text += &if head.contains([',', '"']) {
                format!(",\"{}\"", head.replace('"', "'"))
            } else {
                format!(",{head}")
            };
        }
        text.push('\n');
        for entry in shown {
            let name = short(&entry.recording.about.name).replace([',', '"'], "_");
            let rows = rows(entry);
            let found: Vec<_> = drawn.iter().map(|signal| entry.find(signal)).collect();
            let mut begin = rows.start;
            while begin < rows.end {
                let part = begin..(begin + BLOCK).min(rows.end);
                begin = part.end;
                let times = entry.recording.samples.times(part.clone());
                let values: Vec<Vec<f64>> = found
                    .iter()
                    .map(|found| {
                        found
                            .map_or_else(Vec::new, |(samples, channel)| samples.values(channel, part.clone()))
                    })
                    .collect();
                for (row, time) in times.into_iter().enumerate() {
                    if is_many {
                        let _ = write!(text, "{name},");
                    }
                    let _ = write!(text, "{:.9}", time + entry.shift_s);
                    for column in &values {
                        match column.get(row).filter(|value| value.is_finite()) {
                            // Samples are kept as 32 bits.
                            Some(value) => drop(write!(text, ",{}", *value as f32)),
                            None => text.push(','),
                        }
                    }
                    text.push('\n');
                }
            }
        }
        Ok(text)
    }
}

/// The column name of a recorded channel, or the name of a derived one with its unit.
fn head(shown: &[&Entry], signal: &Signal) -> String {
    let is_it = |own: &&Channel| own.name == signal.name && own.unit.symbol() == signal.unit;
    let recorded = shown.iter().find_map(|entry| entry.recording.about.channels.iter().find(is_it));
    recorded.map_or_else(|| format!("{} [{}]", signal.name, signal.unit), Channel::column_name)
}
