//! Models of drivetrains.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::json;
use socam_model::{BUILTIN, Intersample, Role};

use crate::errors::Raised;

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

    /// What it describes.
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

    /// The model with other values of parameters (SI), of which some may be held fixed.
    fn with_parameters(&self, values: Vec<(String, Option<f64>)>, fix: bool) -> PyResult<Self> {
        let mut model = self.0.clone();
        for (name, value) in values {
            model.set_parameter(&name, value, fix).map_err(Raised::raised)?;
        }
        model.equations(&model.values()).map_err(Raised::raised)?;
        Ok(Self(model))
    }

    /// The model with how its inputs move between samples: hold, linear, band-limited, or auto; all inputs, or one by its name.
    #[pyo3(signature = (kind, channel = None))]
    fn with_between(&self, kind: &str, channel: Option<&str>) -> PyResult<Self> {
        let mut model = self.0.clone();
        let between: Option<Intersample> = match kind {
            "auto" => None,
            kind => Some(kind.parse().map_err(|_| {
                let words = "auto, hold, linear and band-limited";
                PyValueError::new_err(format!("between: `{kind}` is none of {words}"))
            })?),
        };
        let inputs =
            model.inputs().filter(|input| !input.quantity.is_clock()).map(|input| input.name.clone());
        let inputs: Vec<String> = inputs.collect();
        let named: Vec<_> = inputs.iter().filter(|input| channel.is_none_or(|name| name == *input)).collect();
        if named.is_empty() {
            let message = format!("between: inputs of {} are {}", model.name, inputs.join(", "));
            return Err(PyValueError::new_err(message));
        }
        for input in named {
            model.set_intersample(input, between).map_err(Raised::raised)?;
        }
        Ok(Self(model))
    }

    /// The model with an effect of the catalogue at a place, its parameters in SI.
    fn with_effect(&self, effect: &str, place: &str, values: Vec<(String, f64)>) -> PyResult<Self> {
        let values: Vec<(&str, f64)> = values.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        self.0.with_effect(effect, place, &values).map(Self).map_err(Raised::raised)
    }
}
