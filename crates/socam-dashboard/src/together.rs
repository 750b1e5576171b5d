//! A label and its control that stay beside each other in a row that is wrapped.

use egui::{InnerResponse, TextStyle, Ui, WidgetText};

/// Makes a row, of which the next widget is the first one, as high as a button: a label that begins it stands at the height of the others.
pub(crate) fn level(ui: &mut Ui) {
    let height = row_height(ui);
    ui.set_row_height(height);
}

/// Height of a row with buttons, points.
pub(crate) fn row_height(ui: &Ui) -> f32 {
    let height = ui.text_style_height(&TextStyle::Button) + 2.0 * ui.spacing().button_padding.y;
    height.max(ui.spacing().interact_size.y)
}

/// Room that a control of so many points and its label take in a row; begins a new row where the rest of this one is narrower.
pub(crate) fn keep(ui: &mut Ui, label: &str, width: f32) {
    let font = TextStyle::Body.resolve(ui.style());
    let label =
        WidgetText::from(label).into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, font);
    let needed = label.size().x + ui.spacing().item_spacing.x + width;
    let is_at_the_start = ui.cursor().left() <= ui.max_rect().left() + 1.0;
    if !is_at_the_start && ui.available_size_before_wrap().x < needed {
        ui.end_row();
        level(ui);
    }
}

/// A label with a list at its right.
pub(crate) fn together<R>(
    ui: &mut Ui,
    label: &str,
    width: f32,
    list: impl FnOnce(&mut Ui) -> InnerResponse<R>,
) {
    keep(ui, label, width);
    let label = ui.label(label);
    list(ui).response.labelled_by(label.id);
}
