//! `socam` in Python: the compiled half of the package, `socam._socam`.
//!
//! Each file has the function of one command of `socam-host`, on values in memory. Recordings and models are classes; results are passed as
//! the JSON documents that the commands print, and the Python half makes objects of them. Long calls run on a thread of their own
//! (`waiting`), without Python's lock.

mod arrow;
mod checking;
mod comparison;
mod design;
mod diagnosis;
mod errors;
mod fleet;
mod identification;
mod model;
mod options;
mod recording;
mod response;
mod simulation;
mod summary;
mod waiting;
mod watching;

use pyo3::prelude::*;

/// The compiled half of the package `socam`.
#[pymodule]
mod _socam {
    #[pymodule_export]
    use crate::{
        checking::check,
        comparison::{Comparison, compare},
        design::design,
        diagnosis::{Diagnosis, diagnose},
        fleet::{FleetPart, FleetRow, FleetTask, fleet_list, fleet_sources, is_recording},
        identification::{Identification, identify},
        model::Model,
        options::described,
        recording::{Column, Recording, expand},
        response::frf,
        simulation::{profiles, replay, simulate},
        summary::FleetSummary,
        watching::watch,
    };

    /// Version of the package.
    #[pymodule_export]
    pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");
}
