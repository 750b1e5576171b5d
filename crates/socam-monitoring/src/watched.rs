//! Monitoring of a whole recording.

use serde::Serialize;
use socam_recording::Dataset;

use crate::alarm::{Alarm, Event, Summary};
use crate::error::MonitorError;
use crate::monitor::Monitor;

/// Alarms of monitored recordings, schema `socam.watch/1`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Document {
    schema: &'static str,
    /// Name of the model.
    pub model: String,
    /// Results by recording, in the order in which they were monitored.
    pub recordings: Vec<Watched>,
}

impl Document {
    /// Creates the document from recordings that were monitored against a model.
    #[must_use]
    pub fn new(model: impl Into<String>, recordings: Vec<Watched>) -> Self {
        Self { schema: "socam.watch/1", model: model.into(), recordings }
    }
}

/// What came of monitoring a recording.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No block was judged: the recording is too short, or moves otherwise than the baseline.
    #[default]
    NotJudged,
    /// Blocks were judged, and none raised an alarm.
    AsUsual,
    /// At least one alarm was raised.
    Alarm,
}

/// A recording that was monitored from its beginning to its end.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Watched {
    /// Name of the recording.
    pub recording: String,
    /// Whether anything was judged, and what came of it.
    pub verdict: Verdict,
    /// `None` if the recording is too short for a baseline.
    pub baseline: Option<Summary>,
    /// Blocks that were judged.
    pub blocks_judged: usize,
    /// Blocks with more or less motion than the baseline, or with too few samples.
    pub blocks_not_judged: usize,
    /// Alarms, with their causes where these were sought.
    pub alarms: Vec<Alarm>,
    /// Number of the alarm and time of its end, s.
    pub returned: Vec<(usize, f64)>,
}

impl Watched {
    /// Monitors a recording; the events are in order of time.
    ///
    /// # Errors
    /// When the recording cannot be read, or the model cannot be evaluated on it.
    pub fn of(mut monitor: Monitor, data: &Dataset) -> Result<(Self, Vec<Event>), MonitorError> {
        let mut events = monitor.push_all(data)?;
        events.extend(monitor.finish()?);
        let mut watched = Self { recording: data.name().to_owned(), ..Self::default() };
        events.iter().for_each(|event| watched.take(event));
        let overlay = monitor.overlay();
        watched.baseline = overlay.baseline;
        (watched.blocks_judged, watched.blocks_not_judged) = (overlay.judged, overlay.not_judged);
        watched.verdict = match (overlay.judged, watched.alarms.is_empty()) {
            (_, false) => Verdict::Alarm,
            (0, true) => Verdict::NotJudged,
            (_, true) => Verdict::AsUsual,
        };
        Ok((watched, events))
    }

    fn take(&mut self, event: &Event) {
        match event {
            Event::Learned(_) => {}
            Event::Alarm(alarm) => self.alarms.push(alarm.clone()),
            Event::Named(alarm) => {
                if let Some(known) = self.alarms.iter_mut().find(|known| known.number == alarm.number) {
                    *known = alarm.clone();
                }
            }
            Event::Returned { number, time_s } => self.returned.push((*number, *time_s)),
        }
    }
}
