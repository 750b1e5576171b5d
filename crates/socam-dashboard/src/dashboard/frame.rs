//! The frame around every view: menus, tabs, the emergency stop, and messages.

use egui::{
    Align, Align2, Button, Context, Frame, Id, Layout as Direction, Margin, Order, RichText, Stroke, Ui,
};

use socam_core::State;
use socam_workbench::watch::Tone;
use socam_workbench::{Request, View};

use super::Dashboard;
use crate::departure::diagnose_button;
use crate::platform::{HAS_BENCH, Views};
use crate::progress;
use socam_chart::theme;

/// Width above which menus, tabs, the state of the bench and the emergency stop fit in one row, points.
const ONE_ROW: f32 = 1215.0;
/// Greatest width of messages, points.
const MESSAGE_WIDTH: f32 = 720.0;
/// How long a remark is shown, s.
const REMARK_S: f64 = 12.0;

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
            if HAS_BENCH {
                let side = Direction::right_to_left(Align::Center);
                self.stop_button = ui.with_layout(side, |ui| self.bench(ui)).inner;
            }
        });
        if !is_one_row {
            ui.horizontal_wrapped(|ui| self.tabs(ui));
        }
    }

    /// The emergency stop, whose place it returns, and the state of the bench.
    pub(super) fn bench(&mut self, ui: &mut Ui) -> egui::Rect {
        // Without a board it can do nothing, and is no louder than other controls.
        let text = RichText::new("EMERGENCY STOP").strong();
        let button = if self.workspace.bench.is_commanded() {
            Button::new(text.color(egui::Color32::WHITE))
                .fill(theme::STOP)
                .stroke(Stroke::new(1.0, theme::STOP))
        } else {
            Button::new(text.color(theme::weak(ui)))
        };
        let stop = ui.add(button);
        let place = stop.rect;
        if stop.on_hover_text("Cuts the command at once, from every view (Esc)").clicked() {
            self.workspace.bench.emergency_stop();
        }
        let bench = &self.workspace.bench;
        let colour = match (bench.is_connected(), bench.state()) {
            (false, _) => theme::weak(ui),
            (true, Some(State::Fault)) => theme::alarm(ui),
            (true, _) => theme::good(ui),
        };
        // A bench that moves is seen at a glance.
        let text = RichText::new(bench.state_text()).strong().color(colour);
        let is_moving =
            bench.is_connected() && matches!(bench.state(), Some(State::Running | State::Stopping));
        if is_moving {
            let ground = theme::good(ui);
            let ink = ui.visuals().extreme_bg_color;
            Frame::new().fill(ground).corner_radius(4).inner_margin(Margin::symmetric(8, 2)).show(ui, |ui| {
                ui.label(text.color(ink));
            });
        } else {
            ui.label(text);
        }
        self.watch_state(ui);
        place
    }

    /// The state of the watch; a click leads to its view.
    fn watch_state(&mut self, ui: &mut Ui) {
        let Some(watch) = &self.workspace.watch else { return };
        let colour = match watch.tone {
            Tone::Quiet => theme::weak(ui),
            Tone::Good => theme::good(ui),
            Tone::Alarm => theme::alarm(ui),
        };
        let text = RichText::new(format!("Watch: {}", watch.text)).strong().color(colour);
        if ui.add(Button::new(text)).on_hover_text("Shows the view of the watch").clicked() {
            self.layout.view = View::Watch;
        }
    }

    fn tabs(&mut self, ui: &mut Ui) {
        for view in Views::NAMES {
            let is_shown = self.layout.view == *view;
            let tab = ui.selectable_label(is_shown, view.name());
            if is_shown {
                let line = Stroke::new(2.0, theme::good(ui));
                ui.painter().hline(tab.rect.x_range(), tab.rect.bottom(), line);
            }
            if tab.clicked() {
                self.layout.view = *view;
            }
        }
    }

    /// Errors, remarks and running jobs, over the lower edge of the window, so that no control moves when one comes or goes. A remark
    /// goes by itself, an error when it is dismissed.
    pub(super) fn messages(&mut self, ctx: &Context) {
        let now_s = ctx.input(|input| input.time);
        for notice in &mut self.notices {
            notice.shown_s.get_or_insert(now_s);
        }
        self.notices.retain(|notice| notice.grave || notice.shown_s.is_none_or(|at| now_s - at < REMARK_S));
        let is_asking = self.is_asking();
        if self.notices.is_empty() && self.opening.is_empty() && self.saving.is_empty() && !is_asking {
            return;
        }
        let room = ctx.content_rect().size();
        egui::Area::new(Id::unique("messages"))
            .order(Order::Foreground)
            .anchor(Align2::CENTER_BOTTOM, [0.0, -8.0])
            .show(ctx, |ui| {
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_width((room.x - 40.0).min(MESSAGE_WIDTH));
                    egui::ScrollArea::vertical().max_height(room.y / 2.0).show(ui, |ui| {
                        self.asking(ui);
                        self.opening.retain(|job| !progress::job(ui, job));
                        self.saving.retain(|job| !progress::job(ui, job));
                        self.show_notices(ui);
                    });
                });
            });
    }

    fn show_notices(&mut self, ui: &mut Ui) {
        let (mut put_away, mut asked) = (None, None);
        for (index, notice) in self.notices.iter().enumerate() {
            if !notice.grave {
                ui.ctx().request_repaint_after_secs(1.0);
            }
            let ground = if notice.grave { theme::alarm_ground(ui) } else { ui.visuals().faint_bg_color };
            Frame::new().fill(ground).corner_radius(4).inner_margin(Margin::symmetric(8, 4)).show(ui, |ui| {
                ui.horizontal(|ui| {
                    if ui.button("Dismiss").clicked() {
                        put_away = Some(index);
                    }
                    if notice.departure.is_some() && diagnose_button(ui) {
                        asked = notice.departure;
                    }
                    ui.add(egui::Label::new(&notice.text).wrap());
                    ui.allocate_space(egui::vec2(ui.available_width(), 0.0));
                });
            });
        }
        if let Some(index) = put_away {
            self.notices.remove(index);
        }
        if let Some(departure) = asked {
            self.workspace.request(Request::Diagnose(departure));
        }
    }
}
