//! The set-up of an identification, and the running one.

use egui::{Button, RichText, Ui};

use super::run::{self, Found, Method};
use crate::job::Attempt;
use crate::workspace::{Request, Workspace};
use socam_chart::theme;

/// The method of the next identification, and the running one.
#[derive(Debug, Default)]
pub(super) struct Start {
    method: Method,
    attempt: Attempt<Found>,
}

impl Start {
    pub(super) fn is_busy(&self) -> bool {
        self.attempt.is_running()
    }

    /// The result, once.
    pub(super) fn poll(&mut self) -> Option<Found> {
        self.attempt.poll()
    }

    pub(super) fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        ui.add_space(4.0);
        if self.attempt.ui(ui) {
            return;
        }
        if let Some(model) = workspace.setup_ui(ui) {
            workspace.request(Request::Model(Box::new(model)));
        }
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.method, Method::OutputError, "Output error")
                .on_hover_text("Least squares of the errors of the simulated outputs");
            ui.selectable_value(&mut self.method, Method::InverseDynamics, "Inverse dynamics").on_hover_text(
                "Linear regression of the measured force of an axis with one coordinate on its motion",
            );
        });
        let chosen = workspace.setup.chosen(&workspace.entries, workspace.model());
        let button = Button::new(RichText::new("Identify parameters").strong());
        if ui.add_enabled(chosen.is_ok(), button).clicked()
            && let Ok(chosen) = &chosen
        {
            let (chosen, method) = (chosen.clone(), self.method);
            let plain = workspace.model().clone();
            self.attempt.start("reading recordings", ui.ctx(), move |handle| {
                run::identify(&chosen, &plain, method, handle)
            });
        }
        if let Err(why) = &chosen {
            ui.label(RichText::new(why).color(theme::weak(ui)));
        }
        if let Some(problem) = &self.attempt.problem {
            ui.label(RichText::new(problem).color(theme::alarm(ui)));
        }
        ui.separator();
    }
}
