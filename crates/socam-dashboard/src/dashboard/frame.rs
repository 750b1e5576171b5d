//! The frame around every view: menus, tabs, the emergency stop, and messages.

use egui::{Align, Button, Frame, Layout as Direction, Margin, RichText, Stroke, Ui};

use super::Dashboard;
use crate::view::View;
use crate::{live, theme};

/// Width from which on menus, tabs, the state of the bench and the emergency stop fit in one row, points.
const ONE_ROW: f32 = 1060.0;

impl Dashboard {
    /// Menus and tabs at the left, the emergency stop at the right; in two rows where there is no room for one.
    pub(super) fn bar(&mut self, ui: &mut Ui) {
        let is_one_row = ui.available_width() >= ONE_ROW;
        ui.horizontal(|ui| {
            self.menus(ui);
            if is_one_row {
                ui.separator();
                self.tabs(ui);
            }
            if !live::REACHABLE {
                return;
            }
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                let text = RichText::new("EMERGENCY STOP").strong().color(egui::Color32::WHITE);
                let stop = ui.add(Button::new(text).fill(theme::STOP).stroke(Stroke::NONE));
                self.stop_button = stop.rect;
                if stop.on_hover_text("Cuts the command at once, from every view (Esc)").clicked() {
                    self.views.live.emergency_stop();
                }
                if is_one_row {
                    self.views.live.lamp(ui);
                }
            });
        });
        if !is_one_row {
            ui.horizontal_wrapped(|ui| {
                self.tabs(ui);
                if live::REACHABLE {
                    ui.separator();
                    self.views.live.lamp(ui);
                }
            });
        }
    }

    fn tabs(&mut self, ui: &mut Ui) {
        for view in View::reachable() {
            if ui.selectable_label(self.layout.view == view, view.name()).clicked() {
                self.layout.view = view;
            }
        }
    }

    /// Errors, remarks and running jobs, below the menus.
    pub(super) fn messages(&mut self, ui: &mut Ui) {
        if self.notices.is_empty() && self.opening.is_empty() && self.saving.is_empty() {
            return;
        }
        egui::Panel::top("messages").show(ui, |ui| {
            self.opening.retain(|job| !job.ui(ui));
            self.saving.retain(|job| !job.ui(ui));
            let mut put_away = None;
            for (index, notice) in self.notices.iter().enumerate() {
                let ground = if notice.grave { theme::alarm_ground(ui) } else { ui.visuals().faint_bg_color };
                Frame::new().fill(ground).corner_radius(4).inner_margin(Margin::symmetric(8, 4)).show(
                    ui,
                    |ui| {
                        ui.horizontal(|ui| {
                            if ui.button("Dismiss").clicked() {
                                put_away = Some(index);
                            }
                            ui.add(egui::Label::new(&notice.text).wrap());
                            ui.allocate_space(egui::vec2(ui.available_width(), 0.0));
                        });
                    },
                );
            }
            if let Some(index) = put_away {
                self.notices.remove(index);
            }
        });
    }
}
