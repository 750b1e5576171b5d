//! The recording of several devices.

use std::path::{Path, PathBuf};

use anyhow::bail;
use socam_recording::{
    Channel, Event, MACHINE_KEY, Recorder, RecordingHeader, RecordingSummary, SampleRow, Status,
};

use super::attended::Ready;
use super::merge::Merged;
use crate::commands::record::{Args, attachment};
use crate::device::source::SourceAddress;
use crate::live_watch::LiveWatch;

/// Interval of the statuses in the recording, ns.
const STATUS_EVERY_NS: i64 = 1_000_000_000;

/// What the recording says of the devices.
pub(super) fn header(
    args: &Args,
    addresses: &[SourceAddress],
    ready: &[Ready],
    (channels, begin_unix_ns): (Vec<Channel>, u64),
) -> anyhow::Result<RecordingHeader> {
    let mut header = RecordingHeader::new(channels);
    header.start_unix_ns = begin_unix_ns;
    header.planned_duration_s = args.record.duration_s;
    header.replace = args.force;
    let all = |of: &dyn Fn(usize) -> String| (0..ready.len()).map(of).collect::<Vec<_>>().join("; ");
    let metadata = &mut header.metadata;
    metadata.insert("device".into(), all(&|index| addresses[index].to_string()));
    metadata.insert("device_kind".into(), all(&|index| ready[index].kind.clone()));
    let counted = all(&|index| format!("of {} counted {}", addresses[index], ready[index].counted_by));
    metadata.insert("lost_samples".into(), counted);
    metadata.insert("times".into(), "rows of the fastest device at their times on the host's clock; values of others interpolated, at the nearest row, or missing".into());
    metadata.insert("host".into(), env!("CARGO_PKG_VERSION").into());
    metadata.extend(args.note.clone().map(|note| ("note".into(), note)));
    metadata.extend(args.machine.clone().map(|machine| (MACHINE_KEY.into(), machine)));
    for (number, text) in (1..).zip(ready.iter().map(|ready| &ready.description)) {
        let name = format!("device-{number}.toml");
        header.attachments.extend(text.iter().flat_map(|text| attachment(&name, text.clone())));
    }
    header.attachments.extend(attachment("model.toml", socam_job::model_text(&args.bench.model)?));
    Ok(header)
}

/// The result of the recording.
#[derive(Debug)]
pub(super) struct Made {
    pub(super) summary: RecordingSummary,
    pub(super) duration_s: f64,
    pub(super) is_stopped: bool,
    /// Why one of the devices is gone.
    pub(super) gone: Option<String>,
}

/// A recording whose file is created by its first row.
pub(super) struct File {
    path: PathBuf,
    header: RecordingHeader,
    duration_s: Option<f64>,
    watch: Option<LiveWatch>,
    recorder: Option<Recorder>,
    /// Time of the first row since the recorder began, ns, and its number.
    first: Option<(i64, u64)>,
    /// Time of the last row since the first one, ns, and that of the last status.
    last_ns: i64,
    status_ns: i64,
    is_over: bool,
    /// Whether the operator stopped it.
    pub(super) is_stopped: bool,
}

impl File {
    pub(super) fn new(
        path: &Path,
        header: RecordingHeader,
        duration_s: Option<f64>,
        watch: Option<LiveWatch>,
    ) -> Self {
        Self {
            path: path.into(),
            header,
            duration_s,
            watch,
            recorder: None,
            first: None,
            last_ns: 0,
            status_ns: 0,
            is_over: false,
            is_stopped: false,
        }
    }

    /// Whether it has lasted as long as planned, or its file can no longer be written.
    pub(super) fn is_over(&self) -> bool {
        self.is_over || self.recorder.as_ref().is_some_and(Recorder::has_failed)
    }

    /// Records a row.
    pub(super) fn push(&mut self, row: &Merged) -> anyhow::Result<()> {
        let (first_ns, first) = *self.first.get_or_insert((row.time_ns, row.sequence));
        let device_time_ns = row.time_ns - first_ns;
        if self.duration_s.is_some_and(|duration_s| device_time_ns as f64 * 1e-9 >= duration_s) {
            self.is_over = true;
        }
        if self.is_over {
            return Ok(());
        }
        let recorder = match &mut self.recorder {
            Some(recorder) => recorder,
            None => {
                self.header.start_unix_ns = self.header.start_unix_ns.saturating_add_signed(row.time_ns);
                self.recorder.insert(Recorder::create(&self.path, &self.header)?)
            }
        };
        let sequence = row.sequence.saturating_sub(first);
        let sample = SampleRow { device_time_ns, sequence, flags: 0, raw_counts: &[], values: &row.values };
        self.last_ns = device_time_ns;
        recorder.push_samples(std::slice::from_ref(&sample));
        if let Some(watch) = &mut self.watch {
            watch.take(std::slice::from_ref(&sample));
        }
        if self.last_ns - self.status_ns >= STATUS_EVERY_NS {
            self.status();
        }
        Ok(())
    }

    /// Records an event at the time of the last row.
    pub(super) fn event(&mut self, kind: &str, text: &str) {
        let event = Event { device_time_ns: self.last_ns, kind: kind.into(), text: text.into() };
        if let Some(recorder) = &mut self.recorder {
            recorder.event(&event);
        }
    }

    /// Records what the watch has to say.
    pub(super) fn watch(&mut self) {
        while let Some(event) = self.watch.as_ref().and_then(LiveWatch::event) {
            if let Some(recorder) = &mut self.recorder {
                recorder.event(&event);
            }
        }
    }

    fn status(&mut self) {
        self.status_ns = self.last_ns;
        if let Some(recorder) = &mut self.recorder {
            let lost = recorder.lost();
            recorder.status(&Status {
                device_time_ns: self.last_ns,
                state: "listening".into(),
                overruns: 0,
                lost,
                link_errors: 0,
            });
        }
    }

    /// Closes the file.
    pub(super) fn finish(mut self, gone: Option<String>) -> anyhow::Result<Made> {
        self.status();
        if let Some(reason) = &gone {
            self.event("fault", reason);
        }
        let events = self.watch.as_mut().map(LiveWatch::finish).unwrap_or_default();
        let Some(mut recorder) = self.recorder.take() else {
            bail!("{}, before the first sample", gone.unwrap_or_else(|| "stopped".into()));
        };
        for event in &events {
            recorder.event(event);
        }
        let duration_s = self.last_ns as f64 * 1e-9;
        Ok(Made { summary: recorder.finish()?, duration_s, is_stopped: self.is_stopped, gone })
    }
}
