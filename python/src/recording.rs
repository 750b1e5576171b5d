//! Recordings: from files, bytes and columns, and their columns for numpy and Arrow.

use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use pyo3::IntoPyObjectExt;
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use socam_recording::{Channel, Dataset, Selection, Shared, Unit, export_csv, import_mcap};

use crate::arrow;
use crate::errors::{Raised, RecordingError};
use crate::waiting;

/// Names of recordings, with the wildcards of this one expanded.
#[pyfunction]
pub(crate) fn expand(run: String) -> PyResult<Vec<String>> {
    socam_recording::expand(&[run]).map_err(Raised::raised)
}

/// A recording over time: channels in SI units and their samples.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Recording {
    pub(crate) data: Dataset,
    /// The file that it was read from.
    pub(crate) path: Option<PathBuf>,
    samples: OnceLock<Shared>,
    /// Keeps the temporary file of bytes in memory as long as it may be read again.
    _file: Option<Arc<tempfile::TempPath>>,
}

impl Recording {
    pub(crate) fn new(data: Dataset) -> Self {
        Self { data, path: None, samples: OnceLock::new(), _file: None }
    }

    fn samples(&self, py: Python<'_>) -> PyResult<&Shared> {
        if let Some(samples) = self.samples.get() {
            return Ok(samples);
        }
        let read = py.detach(|| self.data.shared()).map_err(Raised::raised)?;
        Ok(self.samples.get_or_init(|| read))
    }
}

#[pymethods]
impl Recording {
    /// Opens a file of any format, or a part of it: `RUN@FROM..TO` in seconds or clock times.
    #[staticmethod]
    fn open(py: Python<'_>, run: String) -> PyResult<Self> {
        let selection = Selection::parse(&run).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let path = selection.path.clone();
        let opened = waiting::run(py, None, move |_| socam_import::open_selection(&selection))?;
        Ok(Self { path: Some(path), ..Self::new(opened.map_err(Raised::raised)?) })
    }

    /// Opens a file that is in memory. Its format is determined from its content.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, name: String, content: &[u8]) -> PyResult<Self> {
        let written = tempfile::NamedTempFile::new().and_then(|mut file| {
            file.write_all(content)?;
            file.flush()?;
            Ok(file.into_temp_path())
        });
        let file =
            written.map_err(|e| RecordingError::new_err(format!("no temporary file can be written: {e}")))?;
        let path = file.to_path_buf();
        let selection = Selection::whole(&path);
        let opened = waiting::run(py, None, move |_| socam_import::open_selection(&selection))?;
        // Errors name the file; the path of the temporary file would mean nothing to the caller.
        let named = |error: socam_import::ImportError| {
            RecordingError::new_err(error.to_string().replace(&path.display().to_string(), &name))
        };
        let data = opened.map_err(named)?.with_name(&name);
        Ok(Self { path: Some(path), _file: Some(Arc::new(file)), ..Self::new(data) })
    }

    /// Makes a recording of columns: times in s, and values by column names that end in their unit, NaN where a value is missing.
    #[staticmethod]
    #[pyo3(signature = (name, time_s: "object", columns: "list[tuple[str, object]]"))]
    fn from_columns(
        py: Python<'_>,
        name: String,
        time_s: PyBuffer<f64>,
        columns: Vec<(String, PyBuffer<f64>)>,
    ) -> PyResult<Self> {
        let channel = |column: &str| {
            Channel::from_column_name(column).ok_or_else(|| {
                let units: Vec<&str> = Unit::ALL.iter().map(|unit| unit.suffix()).collect();
                PyValueError::new_err(format!(
                    "the column `{column}` does not say its unit; end its name in one of {}",
                    units.join(", ")
                ))
            })
        };
        let channels = columns.iter().map(|(column, _)| channel(column)).collect::<PyResult<Vec<_>>>()?;
        let values = columns.iter().map(|(_, values)| values.to_vec(py)).collect::<PyResult<Vec<_>>>()?;
        let data = Dataset::from_columns(name, channels, time_s.to_vec(py)?, values);
        Ok(Self::new(data.map_err(|error| PyValueError::new_err(error.to_string()))?))
    }

    /// Name in results.
    #[getter]
    fn name(&self) -> &str {
        self.data.name()
    }

    /// Number of rows.
    #[getter]
    fn rows(&self) -> u64 {
        self.data.rows()
    }

    /// Time of the first row, s.
    #[getter]
    fn start_s(&self) -> f64 {
        self.data.start_s()
    }

    /// Time of the last row, s.
    #[getter]
    fn end_s(&self) -> f64 {
        self.data.end_s()
    }

    /// Median step of time, s.
    #[getter]
    fn sample_time_s(&self) -> f64 {
        self.data.sample_time_s()
    }

    /// First row of each part without gaps.
    #[getter]
    fn segments(&self) -> Vec<u64> {
        self.data.segments().iter().map(|segment| segment.first_row).collect()
    }

    /// Number of samples lost while recording.
    #[getter]
    fn lost_samples(&self) -> u64 {
        self.data.lost_samples()
    }

    /// Whether the file is whole: not cut off, nothing damaged, no sample lost.
    #[getter]
    fn is_complete(&self) -> bool {
        self.data.is_complete()
    }

    /// Warnings about parts that were not read and about missing samples.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.data.warnings().iter().map(ToString::to_string).collect()
    }

    /// Column names, with the unit's suffix, and symbols of the units.
    #[getter]
    fn channels(&self) -> Vec<(String, String)> {
        let channels = self.data.channels().iter();
        channels.map(|channel| (channel.column_name(), channel.unit.symbol().to_owned())).collect()
    }

    /// Index of a channel, by its name or its column's name.
    fn channel_index(&self, name: &str) -> PyResult<usize> {
        self.data.channel_index(name).map_err(Raised::raised)
    }

    /// The values of a channel by its index, or the times.
    #[pyo3(signature = (channel = None))]
    fn column(&self, py: Python<'_>, channel: Option<usize>) -> PyResult<Column> {
        if channel.is_some_and(|channel| channel >= self.data.channels().len()) {
            return Err(PyIndexError::new_err("there is no such channel"));
        }
        Ok(Column { samples: self.samples(py)?.clone(), channel })
    }

    /// The columns as an Arrow stream, `t_s` first, without copies.
    #[pyo3(signature = (requested_schema = None) -> "object")]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A consumer may request other types, but must accept these.
        drop(requested_schema);
        let stream = arrow::stream(self.data.channels(), self.samples(py)?);
        let stream = stream.map_err(|error| RecordingError::new_err(error.to_string()))?;
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// Writes the recording as .csv or .mcap.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let written = match path.extension().and_then(|extension| extension.to_str()) {
            Some("csv") => py.detach(|| export_csv(&self.data, &path)),
            Some("mcap") => py.detach(|| import_mcap(&self.data, 0, Default::default(), Vec::new(), &path)),
            _ => {
                let message = format!("`{}`: a recording is written as .csv or .mcap", path.display());
                return Err(PyValueError::new_err(message));
            }
        };
        written.map_err(Raised::raised)
    }
}

/// Values of one column in the memory of the recording, for `numpy.asarray`.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Column {
    samples: Shared,
    channel: Option<usize>,
}

#[pymethods]
impl Column {
    fn __len__(&self) -> usize {
        self.samples.time_s().len()
    }

    /// Address, type and length, from which numpy makes a read-only array.
    #[getter]
    fn __array_interface__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<HashMap<&'static str, Bound<'py, PyAny>>> {
        let values = arrow::values(&self.samples, self.channel);
        let kind = if cfg!(target_endian = "little") { "<f8" } else { ">f8" };
        Ok(HashMap::from([
            ("version", 3.into_bound_py_any(py)?),
            ("typestr", kind.into_bound_py_any(py)?),
            ("shape", (values.len(),).into_bound_py_any(py)?),
            ("data", (values.as_ptr() as usize, true).into_bound_py_any(py)?),
        ]))
    }
}

/// The recordings' data.
pub(crate) fn all(recordings: &[Py<Recording>]) -> Vec<Dataset> {
    recordings.iter().map(|recording| recording.get().data.clone()).collect()
}

/// The files from which recordings were read.
pub(crate) fn paths(all: &[Py<Recording>]) -> Vec<&Path> {
    all.iter().filter_map(|recording| recording.get().path.as_deref()).collect()
}
