//! Effects that can be hidden in a machine, their places and their sizes.

mod conceal;
mod effect;
mod places;
mod size;

pub(super) use conceal::conceal;
pub use effect::Hidden;
pub(super) use effect::{NAMED, OUTSIDE};
pub(super) use places::places;
pub(super) use size::hide;
