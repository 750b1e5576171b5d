//! Plan and result of a run.

use std::collections::BTreeMap;
use std::path::PathBuf;

use socam_core::Profile;
use socam_recording::{Attachment, Calibration, Event, RecordingSummary, SampleRow};
use socam_wire::{BoardStatus, EnableFeedback, SampleBatch};

/// The settings of a run.
pub(crate) struct Plan {
    /// The profile to run.
    pub(crate) profile: Profile,
    /// The calibration of the bench.
    pub(crate) calibration: Calibration,
    /// Sampling period.
    pub(crate) period_us: u32,
    /// Path of the recording.
    pub(crate) path: PathBuf,
    /// Whether an existing file is replaced.
    pub(crate) replace: bool,
    /// Metadata of the recording, by name.
    pub(crate) metadata: BTreeMap<String, String>,
    /// Attachments of the recording.
    pub(crate) attachments: Vec<Attachment>,
    /// Time of day at the first sample, ns since 1970.
    pub(crate) start_unix_ns: u64,
}

impl Plan {
    /// Duration of the profile with the ramp at its end, s.
    pub(crate) fn planned_s(&self) -> f64 {
        (self.profile.duration_us + u64::from(self.profile.ramp_us)) as f64 * 1e-6
    }
}

/// End of a run; the recorded samples are kept in any case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum End {
    /// The profile has ended.
    Finished,
    /// The operator stopped it.
    Stopped,
    /// The board stopped it, for this reason.
    Fault(String),
    /// The link broke, in words.
    Broken(String),
}

/// The result of a run.
#[derive(Debug, Clone)]
pub(crate) struct Report {
    /// Counts of the recording.
    pub(crate) summary: RecordingSummary,
    /// End of the run.
    pub(crate) end: End,
    /// Time from the first to the last sample, s.
    pub(crate) duration_s: f64,
    /// Place at which the board reads the drive's enable line back.
    pub(crate) enable_feedback: EnableFeedback,
}

/// Observes a run while it is recorded: a terminal or a window.
pub(crate) trait Monitor {
    /// Number of stops that the operator has requested: the first one ramps down, the second one stops at once.
    fn stops(&self) -> u32;
    /// The time of the run's last sample.
    fn reached(&mut self, _device_time_ns: i64) {}
    /// Samples received, recorded or not.
    fn samples(&mut self, _batch: &SampleBatch) {}
    /// An event of the recording, at the board's tick of the run's latest sample.
    fn event(&mut self, _event: &Event, _tick: Option<u32>) {}
    /// Samples as they are recorded.
    fn recorded(&mut self, _rows: &[SampleRow<'_>]) {}
    /// An alarm of the monitoring for the recording, with its own time.
    fn alarm(&mut self) -> Option<Event> {
        None
    }
    /// The last alarms for the recording, after its last sample.
    fn last_alarms(&mut self) -> Vec<Event> {
        Vec::new()
    }
    /// State of the board; damaged frames in both directions; samples recorded and lost.
    fn status(&mut self, _status: &BoardStatus, _link_errors: u64, _recorded: [u64; 2]) {}
    /// Kind and text of an event for the recording, at the present time: a note of the operator, or an alarm of the monitoring.
    fn mark(&mut self) -> Option<(&'static str, String)> {
        None
    }
}
