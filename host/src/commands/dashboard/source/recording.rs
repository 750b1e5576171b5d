//! The recording of a source from the window: begun and ended by a press, in the crash-safe file of `record`.

use std::path::PathBuf;

use socam_recording::{Recorder, RecordingHeader, SampleRow, Status};
use socam_sources::Counts;

use crate::commands::record::source::metadata;
use crate::commands::record::{attachment, source_result};
use crate::device::source::{Listener, Row, SourceEnd, SourceReport, clock_text};

/// Interval of the statuses in the recording.
const STATUS_EVERY_NS: i64 = 1_000_000_000;

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
            path,
            header,
            open: None,
            before: listener.timeline.counts(),
            interruptions: listener.interruptions,
        })
    }
}

/// A recording that is made.
pub(super) struct Recording {
    pub(super) path: PathBuf,
    header: RecordingHeader,
    open: Option<Open>,
    /// What was counted before it.
    before: Counts,
    interruptions: u64,
}

/// A recording whose file is open.
struct Open {
    recorder: Recorder,
    /// Time and number of its first row.
    first: (i64, u64),
    /// Times of its last row and of its last status, ns since the first row.
    last_ns: i64,
    status_ns: i64,
    written: u64,
}

impl Recording {
    /// Records rows; returns whether the recording begins with these. `damaged`: damaged messages so far.
    /// An error is one sentence.
    pub(super) fn take(&mut self, rows: &[Row], damaged: u64) -> Result<bool, String> {
        let Some(first) = rows.first() else { return Ok(false) };
        let begins = self.open.is_none();
        let open = match &mut self.open {
            Some(open) => open,
            None => {
                self.header.start_unix_ns = self.header.start_unix_ns.saturating_add_signed(first.arrival_ns);
                let recorder =
                    Recorder::create(&self.path, &self.header).map_err(|error| error.to_string())?;
                let first = (first.time_ns, first.sequence);
                self.open.insert(Open { recorder, first, last_ns: 0, status_ns: 0, written: 0 })
            }
        };
        let samples: Vec<SampleRow<'_>> = rows
            .iter()
            .map(|row| SampleRow {
                device_time_ns: row.time_ns - open.first.0,
                sequence: row.sequence - open.first.1,
                flags: 0,
                raw_counts: &[],
                values: &row.values,
            })
            .collect();
        open.last_ns = samples.last().map_or(open.last_ns, |row| row.device_time_ns);
        open.written += open.recorder.push_samples(&samples) as u64;
        if open.last_ns - open.status_ns >= STATUS_EVERY_NS {
            open.status(damaged.saturating_sub(self.before.damaged));
        }
        Ok(begins)
    }

    /// Records an event at the time of the last row.
    pub(super) fn event(&mut self, kind: &str, text: String) {
        if let Some(open) = &mut self.open {
            open.recorder.event(&super::event(open.last_ns, kind, text));
        }
    }

    /// Number of recorded and of lost rows.
    pub(super) fn counts(&self) -> [u64; 2] {
        self.open.as_ref().map_or([0; 2], |open| [open.written, open.recorder.lost()])
    }

    /// Whether the file can no longer be written, as on a full disk.
    pub(super) fn has_failed(&self) -> bool {
        self.open.as_ref().is_some_and(|open| open.recorder.has_failed())
    }

    /// Closes the file. Returns the result in words, and whether nothing is missing. `reason`: why the device can no longer be used.
    pub(super) fn finish(self, listener: &Listener, reason: Option<String>) -> (String, bool) {
        let timeline = &listener.timeline;
        let Some(mut open) = self.open else {
            return ("ended before a sample had arrived, so that there is no file".into(), false);
        };
        let (now, before) = (timeline.counts(), self.before);
        let counts = Counts {
            repeated: now.repeated - before.repeated,
            late: now.late - before.late,
            jumps: now.jumps - before.jumps,
            damaged: now.damaged - before.damaged,
        };
        open.status(counts.damaged);
        if let Some(text) = clock_text(timeline.clock_map().as_ref()) {
            open.recorder.event(&super::event(open.last_ns, "note", text));
        }
        let duration_s = open.last_ns as f64 * 1e-9;
        let summary = match open.recorder.finish() {
            Ok(summary) => summary,
            Err(error) => {
                return (
                    format!("{error} (what was recorded until then is in {})", self.path.display()),
                    false,
                );
            }
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
        let text = source_result::text(&self.path, &report, false);
        let text = text.trim_end().replace('\n', "; ");
        (reason.map_or(text.clone(), |reason| format!("{reason}; {text}")), is_whole)
    }
}

impl Open {
    fn status(&mut self, damaged: u64) {
        self.status_ns = self.last_ns;
        let lost = self.recorder.lost();
        self.recorder.status(&Status {
            device_time_ns: self.last_ns,
            state: "listening".into(),
            overruns: 0,
            lost,
            link_errors: damaged,
        });
    }
}
