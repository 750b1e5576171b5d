//! The set-up of an identification, and the running one.

use super::super::attempt;
use egui::{Button, RichText, Ui};

use super::super::fitting::setup;
use super::run::{self, Found, Method};
use crate::progress::wake;
use socam_chart::theme;
use socam_workbench::job::Attempt;
use socam_workbench::{Request, Workspace};

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
        if attempt::ui(ui, &mut self.attempt) {
            return;
        }
        if let Some(model) = setup::ui(ui, workspace) {
            workspace.request(Request::Model(Box::new(model)));
        }
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.method, Method::OutputError, "Output error")
                .on_hover_text("Least squares of the errors of the simulated outputs");
            ui.selectable_value(&mut self.method, Method::InverseDynamics, "Inverse dynamics").on_hover_text(
                "Linear regression of the measured force of an axis with one coordinate on its motion",
            );
        });
        let chosen = workspace.chosen();
        let button = Button::new(RichText::new("Identify parameters").strong());
        if ui.add_enabled(chosen.is_ok(), button).clicked()
            && let Ok(chosen) = &chosen
        {
            let (chosen, method) = (chosen.clone(), self.method);
            let plain = workspace.model().clone();
            self.attempt.start("reading recordings", &wake(ui.ctx()), move |handle| {
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
