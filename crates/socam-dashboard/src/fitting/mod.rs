//! What an identification and a diagnosis share: which recordings, which model, what is fixed; opened recordings; progress.

mod follow;
mod opened;
mod parameters;
mod roles;
mod setup;

pub(crate) use follow::watch;
pub(crate) use opened::{dataset, datasets};
pub use roles::Role;
pub(crate) use setup::Chosen;
pub use setup::Setup;
