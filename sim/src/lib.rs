//! A bench in software: the drivetrain, its drive and its sensors, and a board that speaks the wire protocol.
//!
//! * [`Truth`]: what the simulated drivetrain really is: a model, changed parameters, concealed physics.
//! * [`Plant`]: its equations of motion, solved by an error-controlled stiff solver.
//!
//! # Conventions
//!
//! SI everywhere, units in names, times in seconds. Sensors are sampled at one instant, without skew between channels. The
//! same seed gives the same numbers on every run. Nothing here prints or panics.

mod error;
mod plant;
mod truth;

pub use error::SimError;
pub use plant::{Effort, Plant, Trajectory};
pub use truth::{Concealed, Override, Truth};
