//! What every result of a recording says: the first fields of its JSON, and what an early end leaves.

use std::path::Path;

use serde::Serialize;
use socam_recording::RecordingSummary;

/// The first fields of `socam.run/1`.
#[derive(Serialize)]
pub(super) struct Summary {
    schema: &'static str,
    recording: String,
    samples: u64,
    lost: u64,
    missed: u64,
    overflowed: u64,
    refused: u64,
}

impl Summary {
    pub(super) fn of(path: &Path, summary: &RecordingSummary) -> Self {
        Self {
            schema: "socam.run/1",
            recording: path.display().to_string(),
            samples: summary.written,
            lost: summary.lost,
            missed: summary.missed,
            overflowed: summary.overflowed,
            refused: summary.refused,
        }
    }
}

/// Why a recording ended early, and where it is.
pub(crate) fn ended_early(reason: impl std::fmt::Display, path: &Path) -> String {
    format!("{reason} (what was recorded until then is in {})", path.display())
}
