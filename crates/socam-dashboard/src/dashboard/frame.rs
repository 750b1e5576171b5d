//! The frame around every view: menus, tabs, the emergency stop, and messages.

use egui::{Align, Button, Frame, Layout as Direction, Margin, RichText, Stroke, Ui};

use super::Dashboard;
use crate::live;
use crate::view::View;
use socam_chart::theme;

/// Width from which on menus, tabs, the state of the bench and the emergency stop fit in one row, points.
const ONE_ROW: f32 = 1140.0;

impl Dashboard {
    /// Menus and tabs at the left, the state of the bench and the emergency stop at the right; the tabs are a row of their own where there
    /// is no room. The height depends on the width only, so that no button moves while a bench runs.
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
                self.views.live.lamp(ui);
            });
        });
        if !is_one_row {
            ui.horizontal_wrapped(|ui| self.tabs(ui));
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
        #[cfg(target_arch = "wasm32")]
        let is_asking = false;
        #[cfg(not(target_arch = "wasm32"))]
        let is_asking = self.native.is_some();
        if self.notices.is_empty() && self.opening.is_empty() && self.saving.is_empty() && !is_asking {
            return;
        }
        egui::Panel::top("messages").show(ui, |ui| {
            #[cfg(not(target_arch = "wasm32"))]
            self.asking(ui);
            self.opening.retain(|job| !job.ui(ui));
            self.saving.retain(|job| !job.ui(ui));
            let (mut put_away, mut to_map) = (None, None);
            for (index, notice) in self.notices.iter().enumerate() {
                let ground = if notice.grave { theme::alarm_ground(ui) } else { ui.visuals().faint_bg_color };
                Frame::new().fill(ground).corner_radius(4).inner_margin(Margin::symmetric(8, 4)).show(
                    ui,
                    |ui| {
                        ui.horizontal(|ui| {
                            if ui.button("Dismiss").clicked() {
                                put_away = Some(index);
                            }
                            if let Some(run) = &notice.to_map
                                && ui.button("Write a mapping").clicked()
                            {
                                (put_away, to_map) = (Some(index), Some(run.clone()));
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
            #[cfg(not(target_arch = "wasm32"))]
            match to_map.as_deref().map(crate::foreign::propose_mapping) {
                Some(Ok(said)) => self.say(said),
                Some(Err(sentence)) => self.warn(sentence),
                None => {}
            }
            #[cfg(target_arch = "wasm32")]
            let _: Option<String> = to_map;
        });
    }

    /// Says that a dialog of the desktop is open, which another window may cover.
    #[cfg(not(target_arch = "wasm32"))]
    fn asking(&mut self, ui: &mut Ui) {
        let Some(native) = &self.native else { return };
        let (purpose, name) = (native.purpose, native.name.clone());
        ui.horizontal(|ui| {
            if ui.button("Choose here").clicked() {
                self.choose_here(ui.ctx(), purpose, &name);
            }
            ui.label(format!("A window of the desktop asks for a file: {}", purpose.title()));
        });
    }
}
