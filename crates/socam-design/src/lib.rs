//! The next experiment: the profile that would tell most, under the limits of a rig.
//!
//! Profiles of several families are run on a virtual bench of the model, without noise; what each would tell is read from the
//! slopes of the model along it ([`socam_identify::Information`]). [`sharpest`] shrinks the widest interval of what can be
//! determined, [`telling_apart`] leaves a rival model the most that it cannot imitate. The best of a first round is then refined.
//!
//! SI inside, unit in the name. Nothing here prints.

mod error;
mod family;
mod goal;
mod rig;
mod search;

pub use error::DesignError;
pub use goal::{Width, widths};
pub use rig::{Limits, Rig};
pub use search::{Design, Tried, foretell, sharpest, telling_apart};
