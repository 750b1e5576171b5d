//! A page without data.

use egui::{Ui, vec2};

use crate::theme;

/// Says in place of charts that there are no data yet, and what to do.
pub fn empty_state(ui: &mut Ui, title: &str, advice: &str) {
    let height = ui.available_height();
    ui.add_space((0.32 * height).max(8.0));
    ui.vertical_centered(|ui| {
        let width = ui.available_width().min(480.0);
        ui.allocate_ui(vec2(width, 0.0), |ui| {
            ui.vertical_centered(|ui| {
                ui.heading(title);
                ui.add_space(4.0);
                ui.label(egui::RichText::new(advice).color(theme::weak(ui)));
            });
        });
    });
}
