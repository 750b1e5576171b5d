//! The way from an alarm to a diagnosis.

use egui::Ui;

/// The button that leads from an alarm to a diagnosis; whether it was pressed.
pub(crate) fn diagnose_button(ui: &mut Ui) -> bool {
    let why = "Opens what was recorded since the change, and leads to Diagnosis";
    ui.button("Diagnose from here").on_hover_text(why).clicked()
}
