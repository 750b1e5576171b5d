//! A model as a functional mock-up unit (FMI 3.0, co-simulation).
//!
//! [`unit_bytes`] packs a model file, its `modelDescription.xml` and this crate's shared library into one `.fmu`. The library reads the model
//! from the unit's resources, so that one library serves every model. [`Unit`] is an instance without C.
//!
//! # Numerics
//! Each step is one sample of [`socam_identify::Predictor`]: exact in the linear part, error-controlled in force laws. Inputs are held over
//! a step, as FMI has it.

mod description;
#[allow(unsafe_code, non_snake_case)]
// FMI is a C interface: exported symbols, and pointers that the importer owns.
mod ffi;
mod pack;
mod unit;

pub use description::description;
pub use pack::{FmuError, LIBRARY, library_beside, unit_bytes};
pub use unit::{Causality, Unit, Variable};
