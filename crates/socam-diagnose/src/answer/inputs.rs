//! What the document is made from.

use socam_identify::Identification;

use crate::{context::Context, proof::Outcome, selection::Path};

/// Results of all stages of a diagnosis.
pub(crate) struct Inputs<'a> {
    pub(crate) context: &'a Context<'a>,
    pub(crate) path: &'a Path,
    /// Outcome on the held-out recordings.
    pub(crate) held_out: &'a Outcome,
    /// Estimates of the base model's parameters.
    pub(crate) before: &'a Identification,
    /// Estimates of the corrected model's parameters.
    pub(crate) after: &'a Identification,
    /// Noise floor of each output, SI.
    pub(crate) floor: &'a [f64],
}
