//! Choice of the model of the window: one that is built in, or was used before.

use egui::{ComboBox, Ui};
use socam_model::{BUILTIN, Model};
use socam_workbench::Workspace;
use socam_workbench::origin::numbered;
use socam_workbench::setup::is_built_in;

use crate::together::level;

/// Draws the model that is used, and others to choose: the embedded ones, and those that were open in this window. Returns another model
/// if one was chosen.
pub(crate) fn ui(ui: &mut Ui, workspace: &Workspace) -> Option<Model> {
    let (model, known) = (workspace.model(), workspace.known_models());
    let mut wanted = None;
    ui.horizontal_wrapped(|ui| {
        level(ui);
        let label = ui.label("Model");
        let others: Vec<&Model> = known.iter().filter(|other| !is_built_in(other)).collect();
        let titles = numbered(others.iter().map(|other| workspace.origins.title(other)).collect());
        let own = others.iter().position(|other| other.text == model.text);
        let own = own.map_or_else(|| workspace.origins.title(model), |at| titles[at].clone());
        let shown = ComboBox::from_id_salt("model").width(230.0).selected_text(own);
        let shown = shown.show_ui(ui, |ui| {
            for (name, text) in BUILTIN {
                if ui.selectable_label(model.text == *text, format!("{name}, built in")).clicked() {
                    wanted = Model::builtin(name);
                }
            }
            for (other, title) in others.iter().zip(titles) {
                if ui.selectable_label(model.text == other.text, title).clicked() {
                    wanted = Some((*other).clone());
                }
            }
        });
        shown.response.labelled_by(label.id).on_hover_text("A model file is opened with Ctrl+O");
    });
    wanted
}
