//! Common parts of identification and diagnosis: the set-up and the options as they are drawn, opened recordings, progress.

pub(super) mod command;
mod follow;
mod opened;
pub(super) mod options;
mod parameters;
mod roles;
pub(super) mod setup;

use socam_job::JobError;
use socam_workbench::job::CANCELLED;

pub(super) use follow::monitor;
pub(super) use opened::datasets;

/// The sentence of a task that could not be done.
pub(super) fn sentence(error: JobError) -> String {
    if error.is_cancelled() { CANCELLED.into() } else { error.in_keywords() }
}
