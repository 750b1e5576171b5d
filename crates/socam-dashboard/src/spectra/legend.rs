//! The legend of the frequency view.

use egui::{RichText, Ui, vec2};

use super::Shown;
use socam_chart::swatch::swatch;
use socam_workbench::recording::short;

/// The colour and short name of each recording.
pub(super) fn legend(ui: &mut Ui, shown: &[Shown<'_>]) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        for (number, recording) in shown {
            let full_name = &recording.about.name;
            let name = short(full_name);
            let beside = egui::Layout::left_to_right(egui::Align::Center);
            ui.allocate_ui_with_layout(vec2(LEGEND_ENTRY, ui.spacing().interact_size.y), beside, |ui| {
                ui.spacing_mut().item_spacing.x = 5.0;
                swatch(ui, *number, name);
                ui.add(egui::Label::new(RichText::new(name).small()).truncate()).on_hover_text(full_name);
            });
        }
    });
}

/// Greatest width of an entry, points.
const LEGEND_ENTRY: f32 = 180.0;
