//! Experiment design: the most informative profile within the limits of a rig.
//!
//! Profiles of several families are run on a virtual bench of the model without noise; the sensitivities of the model along each give
//! its Fisher information ([`socam_identify::Information`]). [`sharpest`] minimises the widest interval of the quantities that can be
//! determined, [`telling_apart`] maximises the misfit that remains after a fit of a rival model. The best of a first round are refined.
//!
//! SI inside, unit in the name. Nothing here prints.

mod error;
mod family;
mod goal;
mod proposal;
mod rig;
mod search;

pub use error::DesignError;
pub use goal::{Width, widths};
pub use proposal::{Document, SCHEMA, five_steps};
pub use rig::{Limits, Rig};
pub use search::{Design, Tried, predicted_intervals, sharpest, telling_apart};
