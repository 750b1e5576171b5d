//! An identification on a thread of its own.

use egui::Ui;
use serde_json::Value;
use socam_identify::Options;
use socam_job::{Grid, Identify};
use socam_model::Model;

use super::super::fitting::{datasets, monitor, sentence};
use super::predictions::{self, Predicted};
use socam_workbench::identification::Identification;
use socam_workbench::job::{CANCELLED, Handle};
use socam_workbench::origin::Origin;
use socam_workbench::purpose::Purpose;
use socam_workbench::setup::Chosen;
use socam_workbench::{Content, Request, Workspace};

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

/// Fits the chosen recordings and predicts all of them.
pub(super) fn identify(task: &Identify, chosen: &Chosen, handle: &Handle) -> Result<Found, String> {
    let model = task.model.changed(chosen.model.clone()).map_err(sentence)?;
    let training = datasets(&chosen.training, Grid::Fit, handle)?;
    let held_out = datasets(&chosen.held_out, Grid::Fit, handle)?;
    let paths = chosen.training.iter().filter_map(|recording| recording.path());
    let calibrated = task.calibrated(model, paths).map_err(sentence)?;
    let mut done = task.run(&calibrated, &training, &held_out, monitor(handle)).map_err(sentence)?;
    handle.reached(0.95)?;
    handle.doing("predictions".into());
    done.result.warnings.extend(calibrated.warnings.iter().cloned());
    let document = serde_json::to_value(done.document()).map_err(|error| error.to_string())?;
    let shown = serde_json::from_value(document.clone()).map_err(|error| error.to_string())?;
    let text = done.model_text().map_err(sentence)?;
    let options = task.options(&calibrated.model).map_err(sentence)?;
    let options = Options { progress: monitor(handle), ..options };
    let mut predictions = Vec::new();
    for (data, is_held_out) in [(&training, false), (&held_out, true)] {
        // A model that was regressed may not follow the recordings when it is simulated.
        let signals = predictions::of(&calibrated.model, data, &done.result, &options, is_held_out);
        predictions.extend(signals.unwrap_or_default());
    }
    if handle.is_cancelled() {
        return Err(CANCELLED.into());
    }
    let model = Model::parse(&text).map_err(|error| error.to_string())?;
    Ok(Found { document, shown, model, predictions })
}

impl Found {
    /// Draws what can be done with the result.
    pub(super) fn offers(&self, ui: &mut Ui, workspace: &mut Workspace) {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Use as model").clicked() {
                workspace.origins.note(&self.model, Origin::Identification);
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
