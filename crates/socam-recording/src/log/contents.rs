//! Contents of a log apart from samples.

use std::collections::BTreeMap;

use super::names::{TIME_ZERO, TIME_ZERO_MIDNIGHT};
use super::sample::{Event, Status};
use crate::clock_time::Epoch;

/// Contents of a log apart from samples.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct LogContents {
    /// The program that wrote it.
    pub library: String,
    /// Time of the day at device time 0, ns since 1970 (UTC); `None` when the log does not say.
    pub start_unix_ns: Option<u64>,
    /// Planned duration when the recording was started, s.
    pub planned_duration_s: Option<f64>,
    /// Board, firmware, host versions, operator's notes, by name.
    pub metadata: BTreeMap<String, String>,
    /// Name, media type and length of each attachment; [`read_attachments`](crate::read_attachments) reads them.
    pub attachments: Vec<AttachmentInfo>,
    /// Events in order (the first ten thousand).
    pub events: Vec<Event>,
    /// The last status, if there was one.
    pub last_status: Option<Status>,
}

impl LogContents {
    /// What the clock showed at time 0, where the log knows it.
    pub(crate) fn epoch(&self) -> Option<Epoch> {
        match self.metadata.get(TIME_ZERO) {
            Some(text) => (text == TIME_ZERO_MIDNIGHT).then_some(Epoch::Midnight),
            None => {
                self.start_unix_ns.filter(|ns| *ns > 0).and_then(|ns| i64::try_from(ns).ok()).map(Epoch::Date)
            }
        }
    }

    /// Description of what is missing from a cut recording whose last sample is at `last_s`.
    pub(crate) fn missing_after(&self, last_s: Option<f64>) -> String {
        let last_s = last_s.unwrap_or(0.0);
        let rest = match self.planned_duration_s {
            Some(planned_s) if planned_s > last_s => {
                format!("the last {:.3} s of the planned {planned_s} s", planned_s - last_s)
            }
            _ => format!("all after {last_s} s (of a running recording, at most its last second)"),
        };
        format!("{rest}, and the index at its end")
    }
}

/// An attachment's name and size.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct AttachmentInfo {
    /// Name of the attachment.
    pub name: String,
    /// Media type of the attachment.
    pub media_type: String,
    /// Length of the attachment, bytes.
    pub bytes: u64,
}
