//! Notations of formulas in the languages of the targets.

pub(crate) use socam_model::formula::{Dialect, Formula};

/// Powers as `^`, pi as `pi`.
pub(crate) const CARET: Dialect = Dialect { power: "^", pi: "pi" };
/// Python with the names of `math`.
pub(crate) const PYTHON: Dialect = Dialect { power: "**", pi: "pi" };
/// Modelica.
pub(crate) const MODELICA: Dialect = Dialect { power: "^", pi: "Modelica.Constants.pi" };

#[cfg(test)]
mod tests;
