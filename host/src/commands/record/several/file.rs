//! The recording of several devices.

use std::path::Path;

use anyhow::bail;
use socam_recording::{Channel, MACHINE_KEY, RecordingHeader, RecordingSummary};

use super::attended::Ready;
use super::merge::Merged;
use crate::commands::align::DEVICE_CHANNELS;
use crate::commands::record::{Args, attachment};
use crate::device::source::{SourceAddress, SourceWriter, sample};
use crate::live_watch::LiveWatch;

/// What the recording says of the devices.
pub(super) fn header(
    args: &Args,
    addresses: &[SourceAddress],
    ready: &[Ready],
    (channels, begin_unix_ns): (Vec<Channel>, u64),
    order: &[usize],
) -> anyhow::Result<RecordingHeader> {
    let mut names = channels.iter().map(|channel| channel.name.as_str());
    let own = order.iter().map(|device| {
        let of_device: Vec<&str> = names.by_ref().take(ready[*device].channels.len()).collect();
        of_device.join(", ")
    });
    let device_channels = own.collect::<Vec<_>>().join("; ");
    let mut header = RecordingHeader::new(channels);
    header.start_unix_ns = begin_unix_ns;
    header.planned_duration_s = args.record.duration_s;
    header.replace = args.force;
    let all = |of: &dyn Fn(usize) -> String| (0..ready.len()).map(of).collect::<Vec<_>>().join("; ");
    let metadata = &mut header.metadata;
    metadata.insert("device".into(), all(&|index| addresses[index].to_string()));
    metadata.insert(DEVICE_CHANNELS.into(), device_channels);
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
    writer: SourceWriter,
    duration_s: Option<f64>,
    watch: Option<LiveWatch>,
    /// Time of the first row since the recorder began, ns, and its number.
    first: Option<(i64, u64)>,
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
            writer: SourceWriter::new(path.into(), header),
            duration_s,
            watch,
            first: None,
            is_over: false,
            is_stopped: false,
        }
    }

    /// Whether it has lasted as long as planned, or its file can no longer be written.
    pub(super) fn is_over(&self) -> bool {
        self.is_over || self.writer.has_failed()
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
        self.writer.begin(row.time_ns)?;
        let samples = [sample(device_time_ns, row.sequence.saturating_sub(first), &row.values)];
        self.writer.push(&samples, 0);
        if let Some(watch) = &mut self.watch {
            watch.take(&samples);
        }
        Ok(())
    }

    /// Records an event at the time of the last row.
    pub(super) fn event(&mut self, kind: &str, text: String) {
        self.writer.event(&self.writer.event_now(kind, text));
    }

    /// Records what the watch has to say.
    pub(super) fn watch(&mut self) {
        while let Some(event) = self.watch.as_ref().and_then(LiveWatch::event) {
            self.writer.event(&event);
        }
    }

    /// Closes the file.
    pub(super) fn finish(mut self, gone: Option<String>) -> anyhow::Result<Made> {
        self.writer.status(0);
        if let Some(reason) = &gone {
            self.event("fault", reason.clone());
        }
        for event in self.watch.as_mut().map(LiveWatch::finish).unwrap_or_default() {
            self.writer.event(&event);
        }
        let Some((summary, duration_s)) = self.writer.finish()? else {
            bail!("{}, before the first sample", gone.unwrap_or_else(|| "stopped".into()));
        };
        Ok(Made { summary, duration_s, is_stopped: self.is_stopped, gone })
    }
}
