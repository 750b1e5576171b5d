//! The set-up of the next identification or diagnosis.

use egui::{CollapsingHeader, RichText, Ui};
use socam_chart::theme;
use socam_model::Model;
use socam_workbench::Workspace;

use super::{parameters, roles};
use crate::model_choice;
use crate::together::level;

/// Draws the set-up. Returns another model if one was chosen.
pub(in crate::platform) fn ui(ui: &mut Ui, workspace: &mut Workspace) -> Option<Model> {
    let wanted = model_choice::ui(ui, workspace);
    let (model, revision) = (workspace.model().clone(), workspace.revision());
    let Workspace { setup, entries, in_sight, .. } = workspace;
    setup.changes.belong_to(revision);
    if entries.is_empty() {
        let text = "No recording is open: press Ctrl+O, or drop files here.";
        ui.label(RichText::new(text).color(theme::weak(ui)));
    } else {
        roles::ui(ui, &mut setup.roles, entries);
        range(ui, &mut setup.range_s, *in_sight);
    }
    let header = CollapsingHeader::new(setup.changes.summary(&model)).id_salt("start values");
    header.show(ui, |ui| parameters::ui(ui, &mut setup.changes, &model));
    wanted
}

/// The range that is read of each recording.
fn range(ui: &mut Ui, range_s: &mut Option<[f64; 2]>, in_sight: Option<[f64; 2]>) {
    ui.horizontal_wrapped(|ui| {
        level(ui);
        match *range_s {
            Some([from, to]) => {
                ui.label(format!("{} s to {} s of each recording", six(from), six(to)));
                let whole = ui.button("Whole recordings");
                if whole.on_hover_text("Read all of each recording").clicked() {
                    *range_s = None;
                }
            }
            None => {
                ui.label(RichText::new("Whole recordings").color(theme::weak(ui)));
                ui.add_enabled_ui(in_sight.is_some(), |ui| {
                    let button = ui.button("Range in sight");
                    let button =
                        button.on_hover_text("Read what the Time view has in sight of each recording");
                    let button =
                        button.on_disabled_hover_text("Zoom in the Time view: its range can then be fitted");
                    if button.clicked() {
                        *range_s = in_sight;
                    }
                });
            }
        }
    });
}

/// A time to the microsecond, without zeros at its end.
fn six(time_s: f64) -> f64 {
    (1e6 * time_s).round() / 1e6
}
