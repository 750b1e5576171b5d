//! What can be done with a diagnosis that was made here: its report is saved, its model used.

use std::path::Path;

use egui::Ui;
use socam_answer::{Diagnosis, Evidence};
use socam_model::Model;
use socam_report::{FileHash, Provenance};

use super::Shown;
use crate::files::Purpose;
use crate::workspace::{Content, Request, Workspace};

/// What only a diagnosis that was made here has.
#[derive(Debug, Clone)]
pub(super) struct Made {
    /// Text of the corrected model's file.
    pub(super) model_toml: String,
    /// When it was made, and from which files.
    pub(super) provenance: Provenance,
}

/// When a diagnosis is made, and the hashes of its model and recordings; those that are in memory only have none.
pub(super) fn provenance<'a>(
    model: &Model,
    files: impl Iterator<Item = (&'a str, &'a Path)>,
) -> Result<Provenance, String> {
    let hash = |(name, path): (&str, &Path)| {
        FileHash::of_file(name, path).map_err(|error| format!("cannot read {}: {error}", path.display()))
    };
    Ok(Provenance {
        command: String::new(),
        date: jiff::Timestamp::now().strftime("%Y-%m-%d %H:%M UTC").to_string(),
        files: std::iter::once(Ok(FileHash::of_content(&model.name, model.text.as_bytes())))
            .chain(files.map(hash))
            .collect::<Result<_, String>>()?,
    })
}

/// What a report is written from.
#[derive(Debug)]
pub struct Report {
    diagnosis: Diagnosis,
    evidence: Evidence,
    model: Model,
    made: Made,
}

impl Report {
    /// Writes the folder of `diagnose --report`.
    ///
    /// # Errors
    /// When there is such a folder already, or it cannot be written; one sentence.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), String> {
        if folder.exists() {
            return Err(format!("{} exists already; choose another name", folder.display()));
        }
        let Self { diagnosis, evidence, model, made } = self;
        let models = (model, Some(made.model_toml.as_str()));
        socam_report::diagnosis::write(folder, diagnosis, evidence, models, &made.provenance)
            .map_err(|error| error.to_string())
    }
}

impl Shown {
    /// Draws what can be done with a diagnosis that was made here.
    pub(super) fn offers(&self, ui: &mut Ui, workspace: &mut Workspace) {
        let Some((evidence, made)) = self.evidence.as_ref().zip(self.made.as_ref()) else { return };
        ui.horizontal_wrapped(|ui| {
            if ui.button("Save report...").clicked() {
                let report = Report {
                    diagnosis: self.diagnosis.clone(),
                    evidence: evidence.clone(),
                    model: self.model.clone(),
                    made: made.clone(),
                };
                let content = Content::Report(Box::new(report));
                workspace.request(Request::SaveAs(Purpose::SaveReport, "diagnosis".into(), content));
            }
            if ui.button("Use as model").clicked() {
                match Model::parse(&made.model_toml) {
                    Ok(model) => workspace.request(Request::Model(Box::new(model))),
                    Err(error) => workspace.request(Request::Warn(error.to_string())),
                }
            }
            if ui.button("Save model file...").clicked() {
                let content = Content::Bytes(made.model_toml.clone().into_bytes());
                workspace.request(Request::SaveAs(Purpose::SaveModel, "corrected.toml".into(), content));
            }
        });
        ui.add_space(4.0);
    }
}
