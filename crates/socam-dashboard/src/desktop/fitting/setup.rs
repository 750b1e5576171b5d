//! The set-up of the next identification or diagnosis.

use egui::{CollapsingHeader, RichText, Ui};
use socam_chart::theme;
use socam_model::Model;
use socam_workbench::Workspace;

use super::{parameters, roles};
use crate::model_choice;

/// Draws the set-up. Returns another model if one was chosen.
pub(in crate::platform) fn ui(ui: &mut Ui, workspace: &mut Workspace) -> Option<Model> {
    let wanted = model_choice::ui(ui, workspace);
    let (model, revision) = (workspace.model().clone(), workspace.revision());
    let Workspace { setup, entries, .. } = workspace;
    setup.changes.belong_to(revision);
    if entries.is_empty() {
        let text = "No recording is open: press Ctrl+O, or drop files here.";
        ui.label(RichText::new(text).color(theme::weak(ui)));
    } else {
        roles::ui(ui, &mut setup.roles, entries);
    }
    let header = CollapsingHeader::new(setup.changes.summary(&model)).id_salt("start values");
    header.show(ui, |ui| parameters::ui(ui, &mut setup.changes, &model));
    wanted
}
