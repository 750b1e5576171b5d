//! The rows of channels: shown or hidden, dragged into plots, and what is derived from them.

use egui::{
    Align, Align2, Button, Checkbox, CursorIcon, FontId, Layout, RichText, Role, Sense, TextStyle, Ui,
    WidgetInfo, vec2,
};

use super::{Dragged, Review, elided};
use crate::review::derive::Form;
use crate::review::units;
use socam_chart::theme;
use socam_workbench::arrangement::Plot;
use socam_workbench::derivation::Operation;
use socam_workbench::entry::Entry;
use socam_workbench::signal::Signal;

impl Review {
    pub(super) fn channels(&mut self, ui: &mut Ui, all: &[Signal], entries: &[Entry]) {
        if !all.is_empty() {
            ui.separator();
            ui.label(RichText::new("Channels").strong());
        }
        let recorded = |signal: &Signal| {
            let mut channels = entries.iter().flat_map(|entry| &entry.recording.about.channels);
            channels.any(|own| own.name == signal.name)
        };
        for signal in all.iter().filter(|signal| self.is_found(&signal.label())).cloned().collect::<Vec<_>>()
        {
            let is_derived = !recorded(&signal);
            ui.push_id(signal.label(), |ui| self.channel(ui, &signal, all, is_derived));
        }
        preview(ui);
    }

    fn channel(&mut self, ui: &mut Ui, signal: &Signal, all: &[Signal], is_derived: bool) {
        let label = self.units.label(signal);
        let was_on = !self.plots.hidden.contains(signal);
        let mut on = was_on;
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                self.channel_menu(ui, signal, all);
                if is_derived {
                    let name = format!("Remove {}", signal.name);
                    let remove = ui.add(Button::new("x").frame(false));
                    remove.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
                    if remove.on_hover_text(&name).clicked() {
                        self.derivations.all.retain(|own| own.name() != signal.name);
                    }
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    let font = TextStyle::Button.resolve(ui.style());
                    let room =
                        ui.available_width() - ui.spacing().icon_width - ui.spacing().icon_spacing - 2.0;
                    let text = elided(ui, &label, &font, room);
                    let check = ui.add(Checkbox::new(&mut on, text));
                    check.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, was_on, &label));
                    let has_changed = check.changed();
                    let check = check.interact(Sense::drag());
                    check.dnd_set_drag_payload(Dragged(signal.clone()));
                    if has_changed && ui.input(|input| input.modifiers.alt) {
                        self.only(signal, all);
                    } else if has_changed {
                        self.show_channel(signal, on);
                    }
                    check.on_hover_text(format!("{label}\nDrag it into a plot, or to the edge of one"));
                });
            });
        });
    }

    fn show_channel(&mut self, signal: &Signal, on: bool) {
        if on {
            self.plots.hidden.remove(signal);
        } else {
            self.plots.hidden.insert(signal.clone());
        }
    }

    /// Shows one channel alone; all of them if it is alone already.
    fn only(&mut self, signal: &Signal, all: &[Signal]) {
        let is_alone = all.iter().all(|own| self.plots.hidden.contains(own) == (own != signal));
        for own in all {
            self.show_channel(own, is_alone || own == signal);
        }
    }

    fn channel_menu(&mut self, ui: &mut Ui, signal: &Signal, all: &[Signal]) {
        let place = ui.scope_id().with("menu of a channel");
        let was_open = ui.data(|data| data.get_temp::<bool>(place)).unwrap_or(false);
        let is_hovered = ui.rect_contains_pointer(ui.max_rect().with_min_x(ui.clip_rect().left()));
        let button = ui.scope(|ui| {
            // A finger does not hover.
            if !is_hovered && !was_open && !ui.input(egui::InputState::has_touch_screen) {
                ui.set_opacity(0.0);
            }
            ui.spacing_mut().button_padding = vec2(4.0, 0.0);
            ui.menu_button("...", |ui| self.channel_actions(ui, signal, all))
        });
        ui.data_mut(|data| data.insert_temp(place, button.inner.inner.is_some()));
        let said = format!("More about {}", signal.name);
        button.inner.response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &said));
    }

    fn channel_actions(&mut self, ui: &mut Ui, signal: &Signal, all: &[Signal]) {
        if ui.button("Only this channel").on_hover_text("Alt+click on the name; again shows all").clicked() {
            self.only(signal, all);
        }
        if ui.button("Spectrogram of it").clicked() {
            self.add(Plot::Spectrogram(signal.clone()));
        }
        if ui.button("Histogram of it").clicked() {
            self.add(Plot::Histogram(signal.clone()));
        }
        units::of_channel(ui, &mut self.units, signal);
        ui.menu_button("XY plot over", |ui| {
            for x in all.iter().filter(|own| *own != signal) {
                if ui.button(x.label()).clicked() {
                    self.add(Plot::Xy { y: signal.clone(), x: x.clone() });
                }
            }
        });
        ui.menu_button("Derive", |ui| {
            for operation in Operation::ALL {
                if ui.button(operation.name()).on_hover_text(operation.sentence()).clicked() {
                    self.form = Some(Form::of(&signal.name, operation));
                }
            }
        });
    }
}

/// The name of the channel that is dragged, beside the pointer.
fn preview(ui: &Ui) {
    let Some(dragged) = egui::DragAndDrop::payload::<Dragged>(ui.ctx()) else { return };
    let Some(at) = ui.input(|input| input.pointer.interact_pos()) else { return };
    ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    let layer = egui::LayerId::new(egui::Order::Tooltip, egui::Id::unique("dragged channel"));
    let painter = ui.ctx().layer_painter(layer);
    let galley = painter.layout_no_wrap(
        dragged.0.label(),
        FontId::proportional(12.5),
        ui.visuals().strong_text_color(),
    );
    let place = Align2::LEFT_CENTER.anchor_size(at + vec2(14.0, 0.0), galley.size());
    painter.rect_filled(place.expand2(vec2(6.0, 3.0)), 4.0, ui.visuals().selection.bg_fill);
    painter.galley(place.min, galley, theme::weak(ui));
}
