//! Parts for the desktop only: a bench, fits, fleets, files of other programs, dialogs.

mod attempt;
mod checking;
mod columns;
pub mod diagnose;
mod files;
mod fitting;
pub mod fleet;
mod foreign;
mod frame;
pub mod identify;
mod letters;
pub mod live;
mod native;
mod own;
mod responding;
mod session;
mod views;
pub mod watch;

pub(crate) use checking::{CheckOptions, check};
pub(crate) use letters::Letters;
pub use own::Found;
pub(crate) use own::{Own, save};
pub(crate) use responding::ResponseOptions;
pub(crate) use socam_job::Check as CheckTask;
pub use views::Views;

/// Whether a bench can be reached from here.
pub(crate) const HAS_BENCH: bool = true;
