//! Actions on a diagnosis that was made here: saving its report, using its model.

use std::path::Path;

use egui::Ui;
use socam_findings::{Diagnosis, Evidence};
use socam_model::Model;
use socam_report::{FileHash, Provenance};

use crate::diagnosis::Shown;
use socam_workbench::origin::Origin;
use socam_workbench::purpose::Purpose;
use socam_workbench::{Content, Request, Workspace};

/// Data that only a diagnosis made here has.
#[derive(Debug, Clone)]
pub(super) struct Made {
    /// Text of the corrected model's file.
    pub(super) model_toml: String,
    /// Time of the diagnosis, and the files on which it is based.
    pub(super) provenance: Provenance,
}

/// Time of a diagnosis, and the hashes of its model and recordings; recordings that are only in memory have no hash.
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

/// Data from which a report is written.
#[derive(Debug)]
struct Report {
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
    fn write(&self, folder: &Path) -> Result<(), String> {
        if folder.exists() {
            return Err(format!("{} exists already; choose another name", folder.display()));
        }
        let Self { diagnosis, evidence, model, made } = self;
        let models = (model, Some(made.model_toml.as_str()));
        socam_report::diagnosis::write(folder, diagnosis, evidence, models, &made.provenance)
            .map_err(|error| error.to_string())
    }
}

impl Made {
    /// Asks where to write the report.
    pub(super) fn save_report(&self, workspace: &mut Workspace, shown: &Shown) {
        let Some(evidence) = &shown.evidence else { return };
        let report = Report {
            diagnosis: shown.diagnosis.clone(),
            evidence: evidence.clone(),
            model: shown.model.clone(),
            made: self.clone(),
        };
        let content = Content::Report(Box::new(move |folder: &Path| report.write(folder)));
        workspace.request(Request::SaveAs(Purpose::SaveReport, "diagnosis".into(), content));
    }

    /// Draws what can be done with a diagnosis that was made here.
    pub(super) fn offers(&self, ui: &mut Ui, workspace: &mut Workspace, shown: &Shown) {
        if shown.evidence.is_none() {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            if ui.button("Save report...").clicked() {
                self.save_report(workspace, shown);
            }
            if ui.button("Use as model").clicked() {
                match Model::parse(&self.model_toml) {
                    Ok(model) => {
                        workspace.origins.note(&model, Origin::Diagnosis);
                        workspace.request(Request::Model(Box::new(model)));
                    }
                    Err(error) => workspace.request(Request::Warn(error.to_string())),
                }
            }
            if ui.button("Save model file...").clicked() {
                let content = Content::Bytes(self.model_toml.clone().into_bytes());
                workspace.request(Request::SaveAs(Purpose::SaveModel, "corrected.toml".into(), content));
            }
        });
        ui.add_space(4.0);
    }
}
