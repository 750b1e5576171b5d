//! The tasks by name.

use crate::error::{JobError, Result};
use crate::options::{Described, describe};
use crate::{Check, Compare, Design, Diagnose, FleetRow, Identify, Record, Response, Simulate, Watch};

/// Names of the tasks.
const NAMES: &str =
    "check, identify, response, diagnose, compare, watch, simulate, design, fleet_row, record";

/// The options of the task of this name.
///
/// # Errors
/// [`JobError::Keyword`] where there is no such task.
pub fn described(task: &str) -> Result<Vec<Described>> {
    match task {
        "check" => describe::<Check>(),
        "identify" => describe::<Identify>(),
        "response" => describe::<Response>(),
        "diagnose" => describe::<Diagnose>(),
        "compare" => describe::<Compare>(),
        "watch" => describe::<Watch>(),
        "simulate" => describe::<Simulate>(),
        "design" => describe::<Design>(),
        "fleet_row" => describe::<FleetRow>(),
        "record" => describe::<Record>(),
        _ => Err(JobError::Keyword(format!("there is no task `{task}`; the tasks are {NAMES}"))),
    }
}
