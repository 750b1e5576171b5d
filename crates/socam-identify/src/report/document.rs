//! The result as scripts read it, and as a model file.

use serde_json::{Value, json};
use socam_model::{Model, ModelError, Update};
use socam_recording::Dataset;

use crate::{
    IdentifyError,
    inverse_dynamics::force_error_percent,
    optimiser::{descent::End, output_error::evaluate},
    problem::{Options, Problem},
    report::{Fit, Identification, Source},
};

/// Fit of a recording that was not fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// Name of the recording.
    pub recording: String,
    /// How well its channels are predicted.
    pub fit: Fit,
    /// Force error of inverse dynamics, per cent of the norm of the force.
    pub force_error_percent: Option<f64>,
}

impl Identification {
    /// Predicts a recording that was not fitted; of `model`, the one that was fitted.
    ///
    /// # Errors
    /// When the recording lacks a channel or cannot be read, or the prediction overflows.
    pub fn validate(
        &self,
        model: &Model,
        dataset: &Dataset,
        options: &Options,
    ) -> Result<Validation, IdentifyError> {
        let problem = Problem::new(model, std::slice::from_ref(dataset), options.clone())?;
        let force_error_percent = match self.method {
            "inverse-dynamics" => Some(force_error_percent(model, &self.point, dataset)?),
            _ => None,
        };
        let fit = evaluate(&problem, &self.point)?;
        Ok(Validation { recording: dataset.name().to_owned(), fit, force_error_percent })
    }

    /// The document, [`crate::SCHEMA`]. `training` holds recordings that were fitted by inverse dynamics and their force error.
    #[must_use]
    pub fn document(&self, training: &[(String, f64)], validation: &[Validation]) -> Value {
        // Names are strings and numbers are finite or null, so nothing can fail.
        let mut document = serde_json::to_value(self).unwrap_or_default();
        if !training.is_empty() {
            let one = |(recording, error): &(String, f64)| json!({ "recording": recording, "force_error_percent": error });
            document["training"] = training.iter().map(one).collect();
        }
        let one = |own: &Validation| json!({ "recording": own.recording, "fit": own.fit, "force_error_percent": own.force_error_percent });
        document["validation"] = validation.iter().map(one).collect();
        document
    }

    /// The text of a model file with the identified values.
    ///
    /// # Errors
    /// When the model's text cannot take them.
    pub fn model_text(&self, model: &Model) -> Result<String, ModelError> {
        let recordings = self.recordings.join(", ");
        let each = self.parameters.iter().zip(&self.point);
        let updates: Vec<Update> = each
            .filter(|(parameter, _)| parameter.source != Source::Fixed)
            .filter(|(parameter, _)| model.parameter(&parameter.name).is_some())
            .map(|(parameter, value)| Update {
                name: parameter.name.clone(),
                value: *value,
                ci95: parameter.ci95[0]
                    .zip(parameter.ci95[1])
                    .map(|(low, high)| [low, high])
                    .filter(|_| parameter.identifiable),
                source: if parameter.identifiable && self.end == End::Interrupted {
                    format!("best so far of an interrupted search ({}) from {recordings}", self.method)
                } else if parameter.identifiable {
                    format!("identified ({}) from {recordings}", self.method)
                } else {
                    format!("not determined by {recordings}; part of the fit only")
                },
            })
            .collect();
        model.text_with(&updates)
    }
}
