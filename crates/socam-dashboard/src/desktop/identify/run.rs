//! An identification on a thread of its own.

use egui::Ui;
use serde_json::Value;
use socam_identify::{Document, IdentifyError, Options, Problem};
use socam_model::Model;

use super::super::fitting::{datasets, monitor};
use super::predictions::{self, Predicted};
use socam_workbench::identification::Identification;
use socam_workbench::job::{CANCELLED, Handle};
use socam_workbench::purpose::Purpose;
use socam_workbench::setup::Chosen;
use socam_workbench::{Content, Request, Workspace};

/// Method of estimation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Method {
    /// Parameters are estimated from the errors of the simulated outputs.
    #[default]
    OutputError,
    /// Parameters are estimated by regression of the force on the motion.
    InverseDynamics,
}

/// Result of an identification.
#[derive(Debug)]
pub(super) struct Found {
    /// The document of `identify --json`.
    document: Value,
    /// Fields of the document that are shown.
    pub(super) shown: Identification,
    /// The model with the identified parameters.
    model: Model,
    /// Measured and predicted signals.
    pub(super) predictions: Vec<Predicted>,
}

/// Fits the chosen recordings and predicts all of them. `plain` is the model as its file has it.
pub(super) fn identify(
    chosen: &Chosen,
    plain: &Model,
    method: Method,
    handle: &Handle,
) -> Result<Found, String> {
    let parts = socam_expectation::GRID_PARTS;
    let training = datasets(&chosen.training, &chosen.model, parts, handle)?;
    let held_out = datasets(&chosen.held_out, &chosen.model, parts, handle)?;
    let (model, warnings) = with_gains(chosen, method)?;
    let options = Options { try_other_intersamples: true, watch: monitor(handle), ..Options::default() };
    let mut result = match method {
        Method::OutputError => {
            let problem = Problem::new(&model, &training, options.clone()).map_err(sentence)?;
            socam_identify::output_error(&problem).map_err(sentence)?
        }
        Method::InverseDynamics => socam_identify::inverse_dynamics(&model, &training).map_err(sentence)?,
    };
    handle.reached(0.95)?;
    handle.doing("predictions".into());
    result.warnings.extend(warnings);
    let validation =
        socam_identify::validate(&model, &held_out, &result, &options, None).map_err(sentence)?;
    let errors = socam_identify::force_errors(&model, &training, &result).map_err(sentence)?;
    let document = Document { result: &result, training: &errors, validation: &validation };
    let document = serde_json::to_value(document).map_err(|error| error.to_string())?;
    let shown = serde_json::from_value(document.clone()).map_err(|error| error.to_string())?;
    let text = result.model_text(plain).map_err(|error| error.to_string())?;
    let mut predictions = Vec::new();
    for (data, is_held_out) in [(&training, false), (&held_out, true)] {
        // A model that was regressed may not follow the recordings when it is simulated.
        predictions.extend(predictions::of(&model, data, &result, &options, is_held_out).unwrap_or_default());
    }
    if handle.is_cancelled() {
        return Err(CANCELLED.into());
    }
    let model = Model::parse(&text).map_err(|error| error.to_string())?;
    Ok(Found { document, shown, model, predictions })
}

/// The model with gains of sensors whose calibration is part of the recordings, and warnings.
fn with_gains(chosen: &Chosen, method: Method) -> Result<(Model, Vec<String>), String> {
    let paths = chosen.training.iter().filter_map(|recording| recording.path());
    let (calibration, warnings) = socam_calibrate::sensors::of_recordings(paths);
    let model = match calibration.filter(|_| method == Method::OutputError) {
        Some(calibration) => socam_calibrate::sensors::with_sensor_gains(&chosen.model, &calibration)
            .map_err(|error| error.to_string())?,
        None => chosen.model.clone(),
    };
    Ok((model, warnings))
}

fn sentence(error: IdentifyError) -> String {
    match error {
        IdentifyError::Cancelled => CANCELLED.into(),
        error => error.to_string(),
    }
}

impl Found {
    /// Draws what can be done with the result.
    pub(super) fn offers(&self, ui: &mut Ui, workspace: &mut Workspace) {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Use as model").clicked() {
                workspace.request(Request::Model(Box::new(self.model.clone())));
            }
            if ui.button("Save model file...").clicked() {
                let content = Content::Bytes(self.model.text.clone().into_bytes());
                workspace.request(Request::SaveAs(Purpose::SaveModel, "model.toml".into(), content));
            }
            if ui.button("Save as JSON...").clicked() {
                let text = format!("{:#}\n", self.document);
                let content = Content::Bytes(text.into_bytes());
                workspace.request(Request::SaveAs(Purpose::SaveJson, "identification.json".into(), content));
            }
        });
    }
}
