//! Models of drivetrains.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use socam_job::ModelSettings;
use socam_model::{BUILTIN, Role};

use crate::errors::Raised;
use crate::options::object;

/// A drivetrain's model file, checked and in SI.
#[pyclass(frozen, module = "socam._socam")]
pub(crate) struct Model(pub(crate) socam_model::Model);

#[pymethods]
impl Model {
    /// Reads the text of a model file.
    #[new]
    fn new(text: &str) -> PyResult<Self> {
        socam_model::Model::parse(text).map(Self).map_err(Raised::raised)
    }

    /// Names of the embedded models.
    #[staticmethod]
    fn builtin_names() -> Vec<&'static str> {
        BUILTIN.iter().map(|(name, _)| *name).collect()
    }

    /// Text of an embedded model.
    #[staticmethod]
    fn builtin_text(name: &str) -> Option<&'static str> {
        BUILTIN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
    }

    /// The model's name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// The model's description.
    #[getter]
    fn description(&self) -> &str {
        &self.0.description
    }

    /// The file's text.
    #[getter]
    fn text(&self) -> &str {
        &self.0.text
    }

    /// Parameters as a JSON list: name, value in SI, unit, fixed, source.
    fn parameters_json(&self) -> String {
        let parameter = |p: &socam_model::Parameter| json!({"name": p.name, "value": p.value, "unit": p.unit, "fixed": p.fixed, "source": p.source});
        self.0.parameters.iter().map(parameter).collect::<serde_json::Value>().to_string()
    }

    /// Channels: name, column of a recording, and whether it drives the model.
    #[getter]
    fn channels(&self) -> Vec<(String, String, bool)> {
        let channels = self.0.channels.iter();
        channels.map(|c| (c.name.clone(), c.column.clone(), c.role == Role::Input)).collect()
    }

    /// The bench as SVG.
    fn drawing(&self) -> String {
        socam_report::bench::svg(&self.0, &[])
    }

    /// The model with other values of parameters, with fixed parameters, and with other intersample behaviour of its inputs: the options
    /// `start_values`, `fixed` and `between` of every task.
    #[pyo3(signature = (**options: "object"))]
    fn changed(&self, options: Option<Bound<'_, PyDict>>) -> PyResult<Self> {
        let changes: ModelSettings =
            socam_job::options::read(object(options.as_ref())?).map_err(Raised::raised)?;
        changes.changed(self.0.clone()).map(Self).map_err(Raised::raised)
    }

    /// The model with an effect of the catalogue at a place, its parameters in SI.
    fn with_effect(&self, effect: &str, place: &str, values: Vec<(String, f64)>) -> PyResult<Self> {
        let values: Vec<(&str, f64)> = values.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        self.0.with_effect(effect, place, &values).map(Self).map_err(Raised::raised)
    }
}
