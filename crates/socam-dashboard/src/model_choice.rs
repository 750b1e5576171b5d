//! Choice of the model of the window: one that is built in, or was used before.

use egui::{ComboBox, Ui};
use socam_model::{BUILTIN, Model};
use socam_workbench::Workspace;
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
        let shown = ComboBox::from_id_salt("model").width(230.0).selected_text(title(model));
        let shown = shown.show_ui(ui, |ui| {
            for (name, text) in BUILTIN {
                if ui.selectable_label(model.text == *text, format!("{name}, built in")).clicked() {
                    wanted = Model::builtin(name);
                }
            }
            for other in known.iter().filter(|other| !is_built_in(other)) {
                if ui.selectable_label(model.text == other.text, title(other)).clicked() {
                    wanted = Some(other.clone());
                }
            }
        });
        shown.response.labelled_by(label.id).on_hover_text("A model file is opened with Ctrl+O");
    });
    wanted
}

fn title(model: &Model) -> String {
    let kind = if is_built_in(model) { "built in" } else { "from a file or a fit" };
    format!("{}, {kind}", model.name)
}
