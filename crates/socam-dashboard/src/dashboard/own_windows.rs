//! Views in windows of their own. Each has the emergency stop, by its button and by Esc; all other keys are those of the main window.

use egui::{Align, Context, Frame, Layout as Direction, Margin, Rect, Ui, ViewportBuilder, ViewportId};
use socam_chart::chart;
use socam_workbench::View;

use super::Dashboard;

/// Size of a new window, points.
const SIZE: [f32; 2] = [1000.0, 700.0];

impl Dashboard {
    /// Whether a view has a window of its own.
    pub(super) fn is_apart(&self, view: View) -> bool {
        self.apart.contains(&view)
    }

    /// Gives the view that is shown a window of its own.
    pub(crate) fn set_apart(&mut self) {
        let view = self.layout.view;
        if !self.is_apart(view) {
            self.apart.push(view);
        }
    }

    /// Shows a view in the main window again.
    fn take_back(&mut self, view: View) {
        self.apart.retain(|own| *own != view);
        self.layout.view = view;
    }

    /// In the place of a view that has a window of its own.
    pub(super) fn elsewhere(&mut self, ui: &mut Ui) {
        let view = self.layout.view;
        egui::CentralPanel::default().show(ui, |ui| {
            chart::empty_state(
                ui,
                &format!("{} has a window of its own", view.name()),
                "Close that window, or press the button, to have it here.",
            );
            ui.vertical_centered(|ui| {
                if ui.button("Show it here").clicked() {
                    self.take_back(view);
                }
            });
        });
    }

    /// Draws the views that have a window of their own.
    pub(super) fn own_windows(&mut self, ctx: &Context) {
        for view in self.apart.clone() {
            let title = format!("socam: {}, {}", view.name(), self.workspace.bench.state_text());
            let id = ViewportId::from_hash_of(("view", view.name()));
            let builder = ViewportBuilder::default().with_title(title).with_inner_size(SIZE);
            let is_closed = ctx.show_viewport_immediate(id, builder, |ui, _| self.own_window(ui, view));
            if is_closed {
                self.take_back(view);
            }
        }
    }

    /// Draws a window with one view; true when it is to be closed.
    fn own_window(&mut self, ui: &mut Ui, view: View) -> bool {
        let ctx = ui.ctx().clone();
        // As in the main window: before any control consumes the key.
        self.stop_if_asked(&ctx, Rect::NOTHING, true);
        let mut is_closed = ctx.input(|input| input.viewport().close_requested());
        egui::Panel::top("bar of a window")
            .frame(Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 6)))
            .show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.strong(view.name());
                    is_closed |= ui.button("Back to the main window").clicked();
                    let side = Direction::right_to_left(Align::Center);
                    let stop = ui.with_layout(side, |ui| self.bench(ui)).inner;
                    self.stop_if_asked(&ctx, stop, false);
                });
            });
        self.views.get(view).bar(ui, &mut self.workspace);
        let mut seen = Vec::new();
        self.views.get(view).ui(ui, &mut self.workspace, &mut seen);
        self.keep_picture(&ctx);
        is_closed
    }
}
