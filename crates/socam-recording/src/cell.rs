//! Cells of text tables.

use crate::error::excerpt;
use crate::line_problem::LineProblem;

/// A cell's number, `None` when it is empty.
pub(crate) fn number(cell: &[u8], column: &str) -> Result<Option<f64>, LineProblem> {
    let cell = cell.trim_ascii();
    if cell.is_empty() {
        return Ok(None);
    }
    let parsed = std::str::from_utf8(cell).ok().and_then(|c| c.parse().ok());
    match parsed {
        Some(value) if f64::is_finite(value) => Ok(Some(value)),
        Some(_) => Err(LineProblem::NotFinite { column: column.into(), found: excerpt(cell) }),
        None => Err(LineProblem::NotANumber { column: column.into(), found: excerpt(cell) }),
    }
}
