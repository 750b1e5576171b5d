//! The core of a fleet for engines that spread it over machines: a row for each recording, rows kept for a restart, and the table.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use arrow_array::{RecordBatchIterator, ffi_stream::FFI_ArrowArrayStream};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule};
use socam_fleet::{Content, FleetOptions, Frozen, Part, Row, Source, Table, table};

use crate::errors::{Raised, SocamError};
use crate::model::Model;
use crate::waiting;

/// The settings of all rows of a table: a model, options and a seed.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct FleetTask {
    model: socam_model::Model,
    options: FleetOptions,
    seed: u64,
}

#[pymethods]
impl FleetTask {
    /// Makes a task from a model and options as JSON; options that the text does not name have their defaults.
    #[new]
    fn new(model: &Model, options: &str, seed: u64) -> PyResult<Self> {
        let wrong = |error: serde_json::Error| PyValueError::new_err(format!("options: {error}"));
        let mut all = serde_json::to_value(FleetOptions::default()).map_err(wrong)?;
        let given: serde_json::Map<_, _> = serde_json::from_str(options).map_err(wrong)?;
        for (name, value) in given {
            if all.get(&name).is_none() {
                return Err(PyValueError::new_err(format!("options: there is none with the name {name}")));
            }
            all[name] = value;
        }
        Ok(Self { model: model.0.clone(), options: serde_json::from_value(all).map_err(wrong)?, seed })
    }

    /// The options as JSON.
    fn options(&self) -> PyResult<String> {
        serde_json::to_string(&self.options).map_err(Raised::raised)
    }

    /// The result of healthy recordings as JSON: the option `frozen` of a task, by which all others are screened. Names are used in errors.
    fn reference(&self, py: Python<'_>, named: Vec<(String, PathBuf)>) -> PyResult<Option<String>> {
        let sources: Vec<Source> =
            named.into_iter().map(|(name, path)| Source { name, ..Source::path(path) }).collect();
        let (model, options, seed) = (self.model.clone(), self.options.clone(), self.seed);
        let found =
            waiting::run(py, None, move |_| socam_fleet::reference(&sources, (&model, &options, seed)))?;
        let text = |frozen: &Frozen| serde_json::to_string(frozen).map_err(Raised::raised);
        found.map_err(Raised::raised)?.as_ref().map(text).transpose()
    }

    /// Diagnoses one recording, given as bytes or as a path. Returns its id, and its row unless `known` contains the id. If the caller
    /// could not fetch the recording, `problem` is the reason, and its row contains it.
    #[pyo3(signature = (name, *, content = None, path = None, problem = None, machine = None, date_ms = None, known = None))]
    #[expect(clippy::too_many_arguments, reason = "the Python half names each of them")]
    fn row(
        &self,
        py: Python<'_>,
        name: String,
        content: Option<&[u8]>,
        path: Option<PathBuf>,
        problem: Option<String>,
        machine: Option<String>,
        date_ms: Option<i64>,
        known: Option<Vec<String>>,
    ) -> PyResult<(String, Option<FleetRow>)> {
        let content = match (content, path, &problem) {
            (Some(bytes), None, None) => Content::Bytes(bytes.to_vec()),
            (None, Some(path), None) => Content::Path(path),
            // No file has an empty path.
            (None, None, Some(_)) => Content::Path(PathBuf::new()),
            _ => return Err(PyValueError::new_err("give either the content or the path of a recording")),
        };
        let source = Source { name, content, machine, date: date_ms };
        let (model, options, seed) = (self.model.clone(), self.options.clone(), self.seed);
        waiting::run(py, None, move |_| {
            let known: HashSet<String> = known.into_iter().flatten().collect();
            if !known.is_empty()
                && let Some(id) = source.id(&model, &options, seed).ok().filter(|id| known.contains(id))
            {
                return (id, None);
            }
            let mut row = socam_fleet::diagnose_one(&source, &model, &options, seed);
            if let Some(problem) = problem {
                row.message = problem;
            }
            (row.id.clone(), Some(FleetRow(row)))
        })
    }
}

/// Name, path, machine, and date in ms since 1970.
type Listed = (String, PathBuf, Option<String>, Option<i64>);

/// The recordings of a folder, or of a CSV list with the columns file, machine and date: name, path, machine, date in ms since 1970.
#[pyfunction]
pub(crate) fn fleet_sources(place: PathBuf) -> PyResult<Vec<Listed>> {
    Ok(listed(socam_fleet::sources(&place, &[]).map_err(Raised::raised)?))
}

/// The recordings of a CSV list that was fetched from `place`, in the form of `fleet_sources`.
#[pyfunction]
pub(crate) fn fleet_list(place: PathBuf, content: &[u8]) -> PyResult<Vec<Listed>> {
    Ok(listed(socam_fleet::entries(&place, content).map_err(Raised::raised)?))
}

fn listed(sources: Vec<Source>) -> Vec<Listed> {
    let each = sources.into_iter().filter_map(|source| match source.content {
        Content::Path(path) => Some((source.name, path, source.machine, source.date)),
        Content::Bytes(_) => None,
    });
    each.collect()
}

/// Whether a file of this name in a folder counts as a recording.
#[pyfunction]
pub(crate) fn is_recording(name: PathBuf) -> bool {
    socam_fleet::is_recording(&name)
}

/// The row of one recording, `socam.fleet/1`.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct FleetRow(Row);

#[pymethods]
impl FleetRow {
    /// The row as bytes, for a part file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = postcard::to_extend(&self.0, Vec::new());
        let bytes =
            bytes.map_err(|error| SocamError::new_err(format!("the row cannot be packed: {error}")))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The row as JSON.
    fn json(&self) -> PyResult<String> {
        serde_json::to_string(&self.0).map_err(Raised::raised)
    }

    /// Hash of the recording's bytes, the model, the options, the seed and the version.
    #[getter]
    fn id(&self) -> &str {
        &self.0.id
    }

    /// The row as an Arrow stream of one batch.
    #[pyo3(signature = (requested_schema = None) -> "object")]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let batch = socam_fleet::to_batch(std::slice::from_ref(&self.0)).map_err(Raised::raised)?;
        let stream = RecordBatchIterator::new([Ok(batch)], socam_fleet::schema());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(stream)), c"arrow_array_stream")
    }
}

/// The part file beside a table: finished rows, kept for a restart.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct FleetPart {
    part: Arc<Mutex<Part>>,
    task: Py<FleetTask>,
    target: PathBuf,
}

impl FleetPart {
    fn lock(&self) -> MutexGuard<'_, Part> {
        self.part.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl FleetPart {
    /// Opens the part file of a table, and takes over the rows of an earlier table.
    #[new]
    fn new(task: Py<FleetTask>, target: PathBuf) -> PyResult<Self> {
        let mut part = Part::open(&part_path(&target)).map_err(Raised::raised)?;
        if target.exists() {
            for row in Table::open(&target).map_err(Raised::raised)? {
                let row = row.map_err(Raised::raised)?;
                if !part.holds(&row.recording, &row.id) {
                    part.append(&row).map_err(Raised::raised)?;
                }
            }
        }
        Ok(Self { part: Arc::new(Mutex::new(part)), task, target })
    }

    /// Names and ids of the finished rows.
    fn known(&self) -> PyResult<Vec<(String, String)>> {
        let mut part = self.lock();
        let rows = part.rows(&|_, _| true).map(|row| row.map(|row| (row.recording, row.id)));
        rows.collect::<socam_fleet::Result<_>>().map_err(Raised::raised)
    }

    /// Appends a row, and returns its name and id.
    fn append(&self, row: &[u8]) -> PyResult<(String, String)> {
        let row: Row = postcard::from_bytes(row)
            .map_err(|error| SocamError::new_err(format!("these bytes are no row: {error}")))?;
        // A later row with the same id belongs to a file that could not be read again: its present problem counts.
        self.lock().append(&row).map_err(Raised::raised)?;
        Ok((row.recording, row.id))
    }

    /// Writes the table of these rows, by names and ids, and removes the part file. Returns their number.
    fn finish(&self, py: Python<'_>, wanted: Vec<(String, String)>) -> PyResult<u64> {
        let task = self.task.get();
        let about = table::About::new(&task.model, &task.options, task.seed);
        let wanted: HashSet<(String, String)> = wanted.into_iter().collect();
        let is_wanted = |name: &str, id: &str| wanted.contains(&(name.to_owned(), id.to_owned()));
        let written = py.detach(|| table::write(&self.target, &about, self.lock().rows(&is_wanted)));
        let count = written.map_err(Raised::raised)?;
        let part = part_path(&self.target);
        let removed = std::fs::remove_file(&part);
        removed.map_err(|e| SocamError::new_err(format!("cannot remove `{}`: {e}", part.display())))?;
        Ok(count)
    }
}

/// The part file has the name that `socam-host fleet` uses, so that either program can continue the other's work.
fn part_path(target: &Path) -> PathBuf {
    PathBuf::from(format!("{}.part", target.display()))
}
