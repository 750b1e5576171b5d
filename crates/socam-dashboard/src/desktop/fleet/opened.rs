//! The table of a fleet in the form in which it is kept for display: all tests and a few numbers of each machine, not its rows.

use std::path::{Path, PathBuf};

use socam_fleet::{Row, Survey, Table, table::About};
use socam_model::Model;

use socam_workbench::job::Handle;
use socam_workbench::recording::short;

/// Greatest false discovery rate that can be chosen.
pub(super) const MOST_FDR: f64 = 0.5;
/// Rows between two reports of progress.
const BETWEEN: usize = 512;

/// A fleet that is open.
#[derive(Debug)]
pub struct Opened {
    /// The table's file.
    pub path: PathBuf,
    pub(super) about: About,
    pub(super) survey: Survey,
    /// The model of the table, where it is built in.
    pub(super) model: Option<Model>,
}

impl Opened {
    /// Reads a table; its rows are read again when a machine is looked at.
    ///
    /// # Errors
    /// When it cannot be read, is damaged or of another version, or reading was cancelled; one sentence.
    pub fn read(path: &Path, handle: &Handle) -> Result<Self, String> {
        handle.doing(format!("Reading {}", short(&path.display().to_string())));
        let table = Table::open(path).map_err(|error| error.to_string())?;
        let about = table.about.clone();
        let count = table.count_in_file().max(1);
        let goes_on =
            |row: usize| !row.is_multiple_of(BETWEEN) || handle.reached(row as f32 / count as f32).is_ok();
        let rows = table.enumerate().take_while(|(row, _)| goes_on(*row)).map(|(_, row)| row);
        let survey = Survey::of(rows, MOST_FDR).map_err(|error| error.to_string())?;
        handle.reached(1.0)?;
        let model = Model::builtin(&about.model).filter(|model| about.is_of(model));
        Ok(Self { path: path.into(), about, survey, model })
    }
}

/// The recordings of one machine by date.
///
/// # Errors
/// When the table cannot be read any more, or reading was cancelled; one sentence.
pub(super) fn rows_of(path: &Path, machine: &str, handle: &Handle) -> Result<Vec<Row>, String> {
    let table = Table::of_machine(path, machine).map_err(|error| error.to_string())?;
    let rows = table.take_while(|_| !handle.is_cancelled());
    let mut rows = rows.collect::<Result<Vec<Row>, _>>().map_err(|error| error.to_string())?;
    handle.reached(1.0)?;
    rows.sort_by(|a, b| (a.date, &a.recording).cmp(&(b.date, &b.recording)));
    Ok(rows)
}
