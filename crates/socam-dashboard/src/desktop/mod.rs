//! Parts for the desktop only: a bench, fits, fleets, files of other programs, dialogs.

mod attempt;
pub mod diagnose;
mod files;
mod fitting;
pub mod fleet;
mod foreign;
mod frame;
pub mod identify;
pub mod live;
mod native;
mod own;
mod views;
pub mod watch;

pub use own::Found;
pub(crate) use own::{Own, can_be_mapped, save};
pub use views::Views;

/// Whether a bench can be reached from here.
pub(crate) const HAS_BENCH: bool = true;
