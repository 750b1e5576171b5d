//! Physical parameters of a model, their priors, and new values for them.

/// A quantity known beforehand, for instance from a catalogue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Expected value, SI.
    pub value: f64,
    /// Its standard uncertainty, SI.
    pub std: f64,
}

/// A physical parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name, unique in the model.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// SI unit.
    pub unit: String,
    /// Unit of the file.
    pub file_unit: String,
    /// What one `file_unit` is worth in SI.
    pub file_factor: f64,
    /// Least and greatest value that makes sense, SI.
    pub bounds: (f64, f64),
    /// Known exactly, not to be estimated.
    pub fixed: bool,
    /// Where the value comes from.
    pub source: String,
    /// What is known of it beforehand.
    pub prior: Option<Prior>,
}

/// A new value for a parameter in a model file.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// Parameter name.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// 95 % interval, SI, where there is one.
    pub ci95: Option<[f64; 2]>,
    /// Where the value comes from.
    pub source: String,
}
