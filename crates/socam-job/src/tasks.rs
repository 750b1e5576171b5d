//! The tasks by name.

use serde_json::{Map, Value};

use crate::error::{JobError, Result};
use crate::options::{Described, Settings, describe, from_keywords};
use crate::{Check, Compare, Design, Diagnose, FleetRow, Identify, Record, Response, Simulate, Watch};

/// Names of the tasks.
const NAMES: &str =
    "check, identify, response, diagnose, compare, watch, simulate, design, fleet_row, record";

/// Calls a function of settings for the task of this name.
macro_rules! by_name {
    ($task:expr, $function:ident $(, $argument:expr)?) => {
        match $task {
            "check" => $function::<Check>($($argument)?),
            "identify" => $function::<Identify>($($argument)?),
            "response" => $function::<Response>($($argument)?),
            "diagnose" => $function::<Diagnose>($($argument)?),
            "compare" => $function::<Compare>($($argument)?),
            "watch" => $function::<Watch>($($argument)?),
            "simulate" => $function::<Simulate>($($argument)?),
            "design" => $function::<Design>($($argument)?),
            "fleet_row" => $function::<FleetRow>($($argument)?),
            "record" => $function::<Record>($($argument)?),
            task => Err(JobError::Keyword(format!("there is no task `{task}`; the tasks are {NAMES}"))),
        }
    };
}

/// The options of the task of this name.
///
/// # Errors
/// [`JobError::Keyword`] where there is no such task.
pub fn described(task: &str) -> Result<Vec<Described>> {
    by_name!(task, describe)
}

/// Options of the task of this name, given as keywords, as words of its command.
///
/// # Errors
/// [`JobError::Keyword`] where there is no such task, for an unknown option or a value of another type, [`JobError::Value`] for an invalid
/// value.
pub fn words(task: &str, given: Map<String, Value>) -> Result<Vec<String>> {
    fn of<T: Settings>(given: Map<String, Value>) -> Result<Vec<String>> {
        crate::options::words(&from_keywords::<T>(given)?)
    }
    by_name!(task, of, given)
}
