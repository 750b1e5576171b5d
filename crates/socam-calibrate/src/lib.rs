//! Calibration: measured pairs in, sensors, motor and couplings with uncertainty out.
//!
//! [`Pairs`] reads tables as people write them from instruments; [`tasks`] recognises what they calibrate and fits a [`Line`] to
//! each, robustly against outliers; [`steady`] extracts such pairs from recordings. [`regression`] is the estimator, which can also use
//! prior knowledge. [`sensors`] brings the uncertainty of calibrated sensors into a fit. [`first_run`] evaluates the first run of a
//! gearmotor. [`edit_calibration`] writes what was measured into the text of a calibration.
//!
//! SI inside, unit in the name. Nothing here prints.

mod edit;
mod error;
pub mod first_run;
mod line;
mod pairs;
pub mod regression;
pub mod sensors;
pub mod steady;
pub mod tasks;

pub use edit::{MeasuredMotor, MeasuredSensor, edit_calibration};
pub use error::CalibrateError;
pub use line::{Estimate, Line, Nonlinearity};
pub use pairs::{Measured, Pairs};
