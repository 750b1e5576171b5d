//! Common parts of identification and diagnosis: the set-up as it is drawn, opened recordings, progress.

mod follow;
mod opened;
mod parameters;
mod roles;
pub(super) mod setup;

pub(super) use follow::monitor;
pub(super) use opened::{dataset, datasets};
