//! What an identification and a diagnosis share: the set-up as it is drawn; opened recordings; progress.

mod follow;
mod opened;
mod parameters;
mod roles;
pub(super) mod setup;

pub(super) use follow::monitor;
pub(super) use opened::{dataset, datasets};
