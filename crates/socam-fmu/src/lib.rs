//! Functional Mock-up Units (FMI 3.0, co-simulation and model exchange) of model files.
//!
//! The crate is built twice from the same source. As a shared library it is the program inside every FMU: it reads the model file from the
//! FMU's resources and exports the C functions of FMI (`ffi`). As a Rust library it packs FMUs: [`fmu`] writes the description of
//! the model's variables and puts it into a zip archive with the model file and the shared library.
//!
//! The numerics are those of `socam_identify::Predictor`; inputs are held over a communication step. `docs/fmi.md` says how a variable
//! relates to the model file.

mod description;
mod error;
mod ffi;
mod package;
mod rates;
mod simulation;
mod variables;

pub use error::FmuError;
pub use package::{fmu, library};
pub use simulation::{Simulation, Snapshot};
pub use variables::{Variable, VariableRole, variables};
