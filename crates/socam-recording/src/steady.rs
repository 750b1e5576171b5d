//! Tables of steady states: one row per operating point, as the thesis' table 5.1.

use std::path::Path;

use crate::Channel;
use crate::cell::number;
use crate::channel::{TableColumn, table_columns};
use crate::csv_lines::CsvLines;
use crate::error::{RecordingError, Result};
use crate::format::{self, Format};
use crate::line_problem::LineProblem;
use crate::warning::Warning;

/// A table of operating points, all of it in memory.
///
/// ```
/// use socam_recording::Steady;
///
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("points.csv");
/// std::fs::write(&path, "point_1,speed_rad_s,torque_Nm\n1,10,0.2\n2,20,\n").unwrap();
/// let table = Steady::open(&path)?;
/// assert_eq!(table.column("torque"), Some(vec![Some(0.2), None]));
/// assert_eq!(table.column("force"), None);
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Steady {
    /// The file's path as given.
    pub name: String,
    /// Channels; each row has its values in this order.
    pub channels: Vec<Channel>,
    /// Operating points in the file's order; at least one.
    pub rows: Vec<SteadyRow>,
    /// Columns that are not read.
    pub warnings: Vec<Warning>,
}

/// One operating point.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyRow {
    /// The point's number or label value (column `point_1`).
    pub point: f64,
    /// Values in the channels' units; `None` where the cell is empty.
    pub values: Vec<Option<f64>>,
}

impl Steady {
    /// Reads a CSV whose first column is `point_1`.
    ///
    /// # Errors
    /// When the file cannot be read, is another format, or a cell of a column with a unit is not a finite number.
    pub fn open(path: &Path) -> Result<Self> {
        if format::detect(path)? != Format::SteadyStates {
            return Err(RecordingError::NotSteadyStates { path: path.into() });
        }
        let mut lines = CsvLines::open(path)?;
        let header = lines.header("point_1")?;
        let (columns, warnings) = table_columns(&header);
        if columns.is_empty() {
            return Err(RecordingError::NoChannels { path: path.into() });
        }
        let mut rows = Vec::new();
        while lines.next()? {
            rows.push(row(&lines, &columns).map_err(|problem| lines.error(problem))?);
        }
        if rows.is_empty() {
            return Err(RecordingError::NoSamples { path: path.into(), is_whole: true });
        }
        Ok(Self {
            name: path.display().to_string(),
            channels: columns.into_iter().map(|column| column.channel).collect(),
            rows,
            warnings,
        })
    }

    /// Values of one channel over all points, by its name or column name; `None` when there is no such channel.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<Vec<Option<f64>>> {
        let index =
            self.channels.iter().position(|channel| channel.name == name || channel.column_name() == name)?;
        Some(self.rows.iter().map(|row| row.values[index]).collect())
    }
}

fn row(lines: &CsvLines, columns: &[TableColumn]) -> Result<SteadyRow, LineProblem> {
    let point = number(&lines.record[0], "point_1")?
        .ok_or_else(|| LineProblem::MissingTime { column: "point_1".into() })?;
    let values =
        columns.iter().map(|column| column.value(&lines.record[column.cell])).collect::<Result<_, _>>()?;
    Ok(SteadyRow { point, values })
}
