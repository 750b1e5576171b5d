//! Calibration: measured pairs in, sensors, motor and couplings with uncertainty out.
//!
//! [`Pairs`] reads tables as people write them from instruments; [`tasks`] recognises what they calibrate and fits a [`Line`] to
//! each, robustly against outliers; [`steady`] extracts such pairs from recordings. [`regression`] is the estimator, which can also use
//! prior knowledge. [`sensors`] brings the uncertainty of calibrated sensors into a fit.
//!
//! SI inside, unit in the name. Nothing here prints.

mod error;
mod line;
mod pairs;
pub mod regression;
pub mod sensors;
pub mod steady;
pub mod tasks;

pub use error::CalibrateError;
pub use line::{Estimate, Line, Nonlinearity};
pub use pairs::{Measured, Pairs};
