//! The set-up of an identification, and the running one.

use egui::{Button, RichText, Ui};

use super::run::{self, Found, Method};
use crate::job::{CANCELLED, Job};
use crate::theme;
use crate::workspace::{Request, Workspace};

/// The method of the next identification, and the running one.
#[derive(Debug, Default)]
pub(super) struct Start {
    method: Method,
    job: Option<Job<Result<Found, String>>>,
    problem: Option<String>,
}

impl Start {
    pub(super) fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// The result, once.
    pub(super) fn poll(&mut self) -> Option<Found> {
        let outcome = self.job.as_ref().and_then(Job::poll)?;
        self.job = None;
        match outcome.and_then(|outcome| outcome) {
            Ok(found) => return Some(found),
            Err(sentence) if sentence == CANCELLED => {}
            Err(sentence) => self.problem = Some(sentence),
        }
        None
    }

    pub(super) fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        ui.add_space(4.0);
        if let Some(job) = &self.job {
            if job.ui(ui) {
                self.job = None;
            }
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
            self.problem = None;
            let (chosen, method) = (chosen.clone(), self.method);
            let plain = workspace.model().clone();
            self.job = Some(Job::start("reading recordings", ui.ctx(), move |handle| {
                run::identify(&chosen, &plain, method, handle)
            }));
        }
        if let Err(why) = &chosen {
            ui.label(RichText::new(why).color(theme::weak(ui)));
        }
        if let Some(problem) = &self.problem {
            ui.label(RichText::new(problem).color(theme::alarm(ui)));
        }
        ui.separator();
    }
}
