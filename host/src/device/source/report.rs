//! Settings and result of a recording of a source.

use socam_recording::RecordingSummary;
use socam_sources::{ClockMap, Counts};

use super::writer::SourceWriter;
use crate::serve::Serve;

/// The settings of a recording of a source.
pub(crate) struct SourcePlan {
    /// Name of the device in messages.
    pub(crate) name: String,
    /// The recording; times of arrival are those since the link was opened.
    pub(crate) file: SourceWriter,
    /// Time from the first to the last sample; `None` until it is stopped.
    pub(crate) duration_s: Option<f64>,
    /// Whoever looks at it while it runs.
    pub(crate) serve: Option<Serve>,
}

/// How a recording of a source ended; the recorded samples are kept in any case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum SourceEnd {
    /// It lasted as long as planned.
    Finished,
    /// The operator stopped it.
    Stopped,
    /// The device is gone, in words.
    Gone(String),
    /// A run that commanded the device was ended, for this reason.
    Ended(String),
}

/// The result of a recording of a source.
#[derive(Debug, Clone)]
pub(crate) struct SourceReport {
    pub(crate) summary: RecordingSummary,
    pub(crate) end: SourceEnd,
    /// Time from the first to the last sample, s.
    pub(crate) duration_s: f64,
    pub(crate) counts: Counts,
    /// Times at which the link broke and came back.
    pub(crate) interruptions: u64,
    /// Packets of other senders, which were left out.
    pub(crate) strangers: u64,
    pub(crate) clock: Option<ClockMap>,
    /// Largest spread of times of arrival that samples took their times from, s.
    pub(crate) arrival_spread_s: f64,
    /// How lost samples are counted, in words.
    pub(crate) counted_by: String,
}

/// The device's clock against the host's, as text.
pub(crate) fn clock_text(clock: Option<&ClockMap>) -> Option<String> {
    let clock = clock?;
    Some(format!(
        "over {:.1} s the device's clock ran {:+.1} ppm against the host's, within {:.3} ms; samples arrived up to {:.1} ms late; \
         the link's constant delay is not known",
        clock.over_s,
        clock.drift * 1e6,
        clock.uncertainty_s * 1e3,
        clock.latest_s * 1e3
    ))
}
