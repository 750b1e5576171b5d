//! Physical parameters of a model, their priors, and new values for them.

/// Largest value of a parameter, SI: the equations of much larger ones overflow.
pub const LARGEST_VALUE: f64 = 1e30;

/// A normal prior of a parameter, for instance from a catalogue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Expected value, SI.
    pub value: f64,
    /// Standard deviation, SI.
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
    /// Unit in the model file.
    pub file_unit: String,
    /// Size of `file_unit` in `unit`.
    pub file_factor: f64,
    /// Least and greatest possible value, SI.
    pub bounds: (f64, f64),
    /// Whether it is taken as exact and is not estimated.
    pub fixed: bool,
    /// Origin of the value.
    pub source: String,
    /// Prior, where the file gives one.
    pub prior: Option<Prior>,
}

/// A new value for a parameter in a model file.
#[derive(Debug, Clone, PartialEq)]
pub struct Update {
    /// Parameter name.
    pub name: String,
    /// Value, SI.
    pub value: f64,
    /// 95 % interval, SI; `None` removes the file's.
    pub ci95: Option<[f64; 2]>,
    /// Origin of the value.
    pub source: String,
}
