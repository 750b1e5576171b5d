//! A running bench watched against its model: an alarm at a stated rate of false alarms, with time, channel and possible causes.
//!
//! * [`Baseline::of`] learns from healthy recordings what the bench does under its model.
//! * [`Watch`] takes samples and returns [`Event`]s: an [`Alarm`] with its time, onset and channel, then its causes ([`Naming`]).
//! * [`Watch::overlay`] is a snapshot for views: model and measurement over each other, innovations, tests.
//!
//! Memory is bounded by the window. Nothing is printed, and nothing depends on the time of day.

mod alarm;
mod baseline;
mod columns;
mod cutter;
mod error;
mod meter;
mod naming;
mod null;
mod overlay;
mod sequential;
mod settings;
mod watch;
mod watched;

#[cfg(test)]
mod tests;

pub use alarm::{Alarm, Cause, Event, Naming, Summary, Symptom, Verdict};
pub use baseline::Baseline;
pub use error::WatchError;
pub use overlay::{BlockSignals, Overlay, OverlayChannel, Phase};
pub use settings::Settings;
pub use watch::Watch;
pub use watched::{Document, Watched};
