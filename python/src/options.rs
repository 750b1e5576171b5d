//! Keyword arguments as options of a task.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyInt, PyString};
use serde_json::{Map, Number, Value};
use socam_job::{Settings, options};

use crate::errors::Raised;

/// The settings of a task; `given` holds the options of its command by their names.
pub(crate) fn settings<T: Settings>(given: Option<&Bound<'_, PyDict>>) -> PyResult<T> {
    options::from_keywords(object(given)?).map_err(Raised::raised)
}

/// The options of a task as a JSON list: name, flag, kind, default, choices, help.
#[pyfunction]
pub(crate) fn described(task: &str) -> PyResult<String> {
    let all = socam_job::described(task).map_err(Raised::raised)?;
    serde_json::to_string(&all).map_err(Raised::raised)
}

/// Keyword arguments as a JSON object.
pub(crate) fn object(given: Option<&Bound<'_, PyDict>>) -> PyResult<Map<String, Value>> {
    let each = given.into_iter().flatten();
    each.map(|(name, own)| Ok((name.extract()?, value(&own)?))).collect()
}

/// A value of Python, numpy and pathlib as JSON; numbers are exact.
fn value(given: &Bound<'_, PyAny>) -> PyResult<Value> {
    if given.is_none() {
        return Ok(Value::Null);
    }
    if given.is_instance_of::<PyBool>() {
        return Ok(Value::Bool(given.extract()?));
    }
    if given.is_instance_of::<PyString>() {
        return Ok(Value::String(given.extract()?));
    }
    if given.hasattr("__fspath__")? {
        return Ok(Value::String(given.call_method0("__fspath__")?.extract()?));
    }
    // An array of numpy has `__index__`, too.
    if given.is_instance_of::<PyInt>() || (given.hasattr("__index__")? && !given.hasattr("__len__")?) {
        return given.extract::<u64>().map(Value::from).or_else(|_| given.extract::<i64>().map(Value::from));
    }
    if let Ok(number) = given.extract::<f64>() {
        // JSON has no infinity: it is passed as text, and the error contains it.
        return Ok(Number::from_f64(number).map_or_else(|| Value::String(number.to_string()), Value::Number));
    }
    if given.hasattr("items")? {
        let mut pairs = Map::new();
        for pair in given.call_method0("items")?.try_iter()? {
            let (name, own): (String, Bound<'_, PyAny>) = pair?.extract()?;
            pairs.insert(name, value(&own)?);
        }
        return Ok(Value::Object(pairs));
    }
    match given.try_iter() {
        Ok(all) => all.map(|own| value(&own?)).collect::<PyResult<Vec<_>>>().map(Value::Array),
        Err(_) => {
            let kind = given.get_type().name()?.to_string();
            Err(PyTypeError::new_err(format!(
                "an option is a number, a text, a list or a mapping, not {kind}"
            )))
        }
    }
}
