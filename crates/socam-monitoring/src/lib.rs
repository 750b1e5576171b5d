//! Monitors a running bench against its model: alarms at a stated rate of false alarms, with time, channel and possible causes.
//!
//! * [`Baseline::of`] estimates the distribution of the test statistics from healthy recordings.
//! * [`Monitor`] takes samples and returns [`Event`]s: an [`Alarm`] with its time, onset and channel, then its causes ([`Naming`]).
//! * [`Monitor::overlay`] is a snapshot for views: model and measurement over each other, innovations, tests.
//!
//! Memory is bounded by the window. Nothing is printed, and nothing depends on the time of day.

mod alarm;
mod baseline;
mod columns;
mod cutter;
mod error;
mod meter;
mod monitor;
mod naming;
mod null;
mod overlay;
mod sequential;
mod settings;
mod watched;

#[cfg(test)]
mod tests;

pub use alarm::{Alarm, Cause, Event, Naming, Summary, Symptom, Verdict};
pub use baseline::Baseline;
pub use error::MonitorError;
pub use monitor::Monitor;
pub use overlay::{BlockSignals, Judgement, Overlay, OverlayChannel, Phase};
pub use settings::Settings;
pub use watched::{Document, Verdict as RecordingVerdict, Watched};
