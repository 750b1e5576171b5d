//! The file of a recording of devices: created by its first row, with a status in each second of it.

use std::path::PathBuf;

use socam_recording::{Event, Recorder, RecordingHeader, RecordingSummary, Result, SampleRow, Status};

/// Interval of the statuses in the recording, ns.
const STATUS_EVERY_NS: i64 = 1_000_000_000;

/// A recording whose file is created by its first row. What is said of it before that is not kept.
pub(crate) struct SourceWriter {
    pub(crate) path: PathBuf,
    /// Its start is the time of day at which times of arrival begin, and that of the first row from [`Self::begin`] on.
    pub(crate) header: RecordingHeader,
    recorder: Option<Recorder>,
    /// Time of the last row, ns since the first one. Who takes rows of one read together sets it at each, for events between them.
    pub(crate) last_ns: i64,
    /// Time of the last status, ns since the first row.
    status_ns: i64,
    written: u64,
}

/// A row of a device, which has neither flags nor counts of a converter.
pub(crate) fn sample(device_time_ns: i64, sequence: u64, values: &[f64]) -> SampleRow<'_> {
    SampleRow { device_time_ns, sequence, flags: 0, raw_counts: &[], values }
}

impl SourceWriter {
    pub(crate) fn new(path: PathBuf, header: RecordingHeader) -> Self {
        Self { path, header, recorder: None, last_ns: 0, status_ns: 0, written: 0 }
    }

    /// Creates the file, unless there is one, for a first row that arrived at a time, ns; returns whether it was created.
    ///
    /// # Errors
    /// When the file cannot be created.
    pub(crate) fn begin(&mut self, arrival_ns: i64) -> Result<bool> {
        if self.has_begun() {
            return Ok(false);
        }
        self.header.start_unix_ns = self.header.start_unix_ns.saturating_add_signed(arrival_ns);
        self.recorder = Some(Recorder::create(&self.path, &self.header)?);
        Ok(true)
    }

    pub(crate) fn has_begun(&self) -> bool {
        self.recorder.is_some()
    }

    /// Whether the file can no longer be written, as on a full disk.
    pub(crate) fn has_failed(&self) -> bool {
        self.recorder.as_ref().is_some_and(Recorder::has_failed)
    }

    /// Records rows, and a status if one is due. `damaged`: damaged messages so far.
    pub(crate) fn push(&mut self, rows: &[SampleRow<'_>], damaged: u64) {
        let (Some(recorder), Some(last)) = (&mut self.recorder, rows.last()) else { return };
        self.written += recorder.push_samples(rows) as u64;
        self.last_ns = last.device_time_ns;
        if self.last_ns - self.status_ns >= STATUS_EVERY_NS {
            self.status(damaged);
        }
    }

    /// Records an event with its own time.
    pub(crate) fn event(&mut self, event: &Event) {
        if let Some(recorder) = &mut self.recorder {
            recorder.event(event);
        }
    }

    /// An event at the time of the last row.
    pub(crate) fn event_now(&self, kind: &str, text: String) -> Event {
        Event { device_time_ns: self.last_ns, kind: kind.into(), text }
    }

    /// Records a status at the time of the last row. `damaged`: damaged messages so far.
    pub(crate) fn status(&mut self, damaged: u64) {
        self.status_ns = self.last_ns;
        if let Some(recorder) = &mut self.recorder {
            let (device_time_ns, lost) = (self.last_ns, recorder.lost());
            let state = "listening".into();
            recorder.status(&Status { device_time_ns, state, overruns: 0, lost, link_errors: damaged });
        }
    }

    /// Number of recorded and of lost rows.
    #[cfg(feature = "window")]
    pub(crate) fn counts(&self) -> [u64; 2] {
        self.recorder.as_ref().map_or([0; 2], |recorder| [self.written, recorder.lost()])
    }

    /// Closes the file. Returns its counts and the time from the first to the last row, s; `None` if no row came.
    ///
    /// # Errors
    /// When writing has failed at any time.
    pub(crate) fn finish(self) -> Result<Option<(RecordingSummary, f64)>> {
        let summary = self.recorder.map(Recorder::finish).transpose()?;
        Ok(summary.map(|summary| (summary, self.last_ns as f64 * 1e-9)))
    }
}
