//! A formula that was found in the place of a curve.

use socam_model::NewLaw;

use crate::{context::FittedModel, document::RivalFormula};

/// A formula that predicts as well as a curve.
#[derive(Debug, Clone)]
pub(crate) struct FoundFormula {
    /// The law, its parameters at their fit and with their intervals.
    pub(crate) law: NewLaw,
    /// The last model with the law, at its fit.
    pub(crate) fitted: FittedModel,
    /// The curve, and other formulas that were fitted, the simplest of those that predict alike first.
    pub(crate) rivals: Vec<RivalFormula>,
}
