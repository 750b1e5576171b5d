//! Summary of the rows of a fleet's table.

use std::path::PathBuf;

use pyo3::prelude::*;
use serde::Serialize;
use socam_fleet::{Summary, Table};
use socam_job::rules::check_rate;

use crate::errors::Raised;

/// The summary of a table.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct FleetSummary {
    summary: Summary,
    table: PathBuf,
}

#[derive(Serialize)]
struct Document<'s> {
    table: String,
    #[serde(flatten)]
    summary: &'s Summary,
}

#[pymethods]
impl FleetSummary {
    /// Summarises a table; its lists have this false discovery rate.
    #[new]
    fn new(py: Python<'_>, table: PathBuf, fdr: f64) -> PyResult<Self> {
        check_rate("fdr", "--fdr", fdr).map_err(Raised::raised)?;
        let made = py.detach(|| Summary::of(Table::open(&table)?, fdr));
        Ok(Self { summary: made.map_err(Raised::raised)?, table })
    }

    /// The document `socam.fleet-summary/1`, as `socam-host fleet --json` prints it.
    fn json(&self) -> PyResult<String> {
        let document = Document { table: self.table.display().to_string(), summary: &self.summary };
        serde_json::to_string_pretty(&document).map_err(Raised::raised)
    }

    /// The fleet's page; `about` are lines about its origin.
    fn page(&self, py: Python<'_>, about: Vec<String>) -> PyResult<String> {
        py.detach(|| socam_report::fleet::page(&self.summary, &self.table, &about)).map_err(Raised::raised)
    }
}
