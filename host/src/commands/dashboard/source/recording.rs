//! The recording of a source from the window: begun and ended by a press, in the crash-safe file of `record`.

use std::path::PathBuf;

use socam_recording::{RecordingHeader, SampleRow};
use socam_sources::Counts;

use crate::commands::record::source::metadata;
use crate::commands::record::{attachment, source_result, summary::ended_early};
use crate::device::source::{Listener, Row, SourceEnd, SourceReport, SourceWriter, clock_text, sample};

/// What every recording of a device says of it.
pub(super) struct Header {
    pub(super) name: String,
    /// Time of day at which the link was opened, ns since 1970.
    pub(super) opened_unix_ns: u64,
    pub(super) description: Option<String>,
    pub(super) model: String,
    /// What the device does not state, in one sentence.
    pub(super) unstated: Option<String>,
}

impl Header {
    /// Begins a recording; its file is created by the first row. An error is one sentence.
    pub(super) fn begin(
        &self,
        path: PathBuf,
        note: String,
        listener: &Listener,
    ) -> Result<Recording, String> {
        if let Some(sentence) = &self.unstated {
            return Err(format!(
                "{sentence}: a recording needs that, so write the description, replace each \"?\" in it, and connect again"
            ));
        }
        let mut header = RecordingHeader::new(listener.device.channels().to_vec());
        header.metadata = metadata(&self.name, &*listener.device, &listener.timeline);
        if !note.is_empty() {
            header.metadata.insert("note".into(), note);
        }
        let description = self.description.iter().flat_map(|text| attachment("device.toml", text.clone()));
        header.attachments.extend(description);
        header.attachments.extend(attachment("model.toml", self.model.clone()));
        // Until a row has arrived, this is the time of day at which the link was opened.
        header.start_unix_ns = self.opened_unix_ns;
        Ok(Recording {
            file: SourceWriter::new(path, header),
            first: None,
            before: listener.timeline.counts(),
            interruptions: listener.interruptions,
        })
    }
}

/// A recording that is made.
pub(super) struct Recording {
    pub(super) file: SourceWriter,
    /// Time and number of its first row.
    first: Option<(i64, u64)>,
    /// What was counted before it.
    before: Counts,
    interruptions: u64,
}

impl Recording {
    /// Records rows; returns whether the recording begins with these. `damaged`: damaged messages so far.
    /// An error is one sentence.
    pub(super) fn take(&mut self, rows: &[Row], damaged: u64) -> Result<bool, String> {
        let Some(first) = rows.first() else { return Ok(false) };
        let begins = self.file.begin(first.arrival_ns).map_err(|error| error.to_string())?;
        let (first_ns, first) = *self.first.get_or_insert((first.time_ns, first.sequence));
        let samples: Vec<SampleRow<'_>> = rows
            .iter()
            .map(|row| sample(row.time_ns - first_ns, row.sequence - first, &row.values))
            .collect();
        self.file.push(&samples, damaged.saturating_sub(self.before.damaged));
        Ok(begins)
    }

    /// Records an event at the time of the last row.
    pub(super) fn event(&mut self, kind: &str, text: String) {
        self.file.event(&self.file.event_now(kind, text));
    }

    /// Closes the file. Returns the result in words, and whether nothing is missing. `reason`: why the device can no longer be used.
    pub(super) fn finish(mut self, listener: &Listener, reason: Option<String>) -> (String, bool) {
        let timeline = &listener.timeline;
        let (now, before) = (timeline.counts(), self.before);
        let counts = Counts {
            repeated: now.repeated - before.repeated,
            late: now.late - before.late,
            jumps: now.jumps - before.jumps,
            damaged: now.damaged - before.damaged,
        };
        self.file.status(counts.damaged);
        if let Some(text) = clock_text(timeline.clock_map().as_ref()) {
            self.event("note", text);
        }
        let path = self.file.path.clone();
        let (summary, duration_s) = match self.file.finish() {
            Ok(Some(made)) => made,
            Ok(None) => {
                return ("ended before a sample had arrived, so that there is no file".into(), false);
            }
            Err(error) => return (ended_early(error, &path), false),
        };
        let is_whole = summary.lost == 0 && reason.is_none();
        let report = SourceReport {
            summary,
            end: SourceEnd::Finished,
            duration_s,
            counts,
            interruptions: listener.interruptions - self.interruptions,
            strangers: listener.strangers(),
            clock: timeline.clock_map(),
            arrival_spread_s: timeline.arrival_spread_s(),
            counted_by: timeline.counted_by(),
        };
        let text = source_result::text(&path, &report, false);
        let text = text.trim_end().replace('\n', "; ");
        (reason.map_or(text.clone(), |reason| format!("{reason}; {text}")), is_whole)
    }
}
