//! The set-up of an identification, and the running one.

use super::super::attempt;
use egui::{Button, Context, RichText, Ui};
use socam_job::Identify;

use super::super::fitting::options::{First, Form, Layout, Offered};
use super::super::fitting::{command, setup};
use super::run::{self, Found};
use crate::progress::wake;
use socam_chart::theme;
use socam_workbench::job::{Attempt, Handle};
use socam_workbench::setup::Chosen;
use socam_workbench::{Request, Workspace};

impl Offered for Identify {
    const LAYOUT: Layout = Layout {
        first: &[First {
            // The others are over frequency.
            choices: &[
                ("output-error", "Least squares of the errors of the simulated outputs"),
                (
                    "inverse-dynamics",
                    "Linear regression of the measured force of an axis with one coordinate on its motion",
                ),
            ],
            ..First::new("method", "Method")
        }],
        left_out: &["model", "fixed", "start_values"],
        is_headed: false,
    };
}

/// The options of the next identification, and the running one.
#[derive(Debug, Default)]
pub(super) struct Start {
    form: Form<Identify>,
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
        self.form.ui(ui);
        let chosen = workspace.chosen();
        let task = self.task(chosen.as_ref().ok());
        ui.horizontal_wrapped(|ui| {
            let button = Button::new(RichText::new("Identify parameters").strong());
            if ui.add_enabled(chosen.is_ok() && task.is_ok(), button).clicked() {
                self.begin(ui.ctx(), workspace);
            }
            if let Err(problem) = &task {
                ui.label(RichText::new(problem).color(theme::alarm(ui)));
            }
        });
        if let Err(why) = &chosen {
            ui.label(RichText::new(why).color(theme::weak(ui)));
        }
        if let Ok(chosen) = &chosen
            && let Some((line, notes)) = self.line(workspace, chosen)
        {
            command::ui(ui, &line, &notes);
        }
        if let Some(problem) = &self.attempt.problem {
            ui.label(RichText::new(problem).color(theme::alarm(ui)));
        }
        ui.separator();
    }

    /// Begins an identification, or says why it cannot.
    pub(super) fn begin(&mut self, ctx: &Context, workspace: &Workspace) {
        match workspace.chosen().and_then(|chosen| Ok((self.task(Some(&chosen))?, chosen))) {
            Ok((task, chosen)) => {
                let work = move |handle: &Handle| run::identify(&task, &chosen, handle);
                self.attempt.start("reading recordings", &wake(ctx), work);
            }
            Err(why) => self.attempt.problem = Some(why),
        }
    }

    /// The command that does the same.
    pub(super) fn command(&self, workspace: &Workspace) -> Option<String> {
        self.line(workspace, &workspace.chosen().ok()?).map(|(line, _)| line)
    }

    /// The command, and what it lacks.
    fn line(&self, workspace: &Workspace, chosen: &Chosen) -> Option<(String, Vec<String>)> {
        let mut task = self.task(Some(chosen)).ok()?;
        let notes = command::name_model(&mut task.model, workspace.model(), &chosen.model);
        Some((command::of(&task, &chosen.training, ("--validate", &chosen.held_out))?, notes))
    }

    /// The settings, or why they cannot be meant.
    fn task(&self, chosen: Option<&Chosen>) -> Result<Identify, String> {
        let task = self.form.settings()?;
        let has_proof = chosen.is_none_or(|chosen| !chosen.held_out.is_empty());
        if task.band.is_some() && !has_proof {
            return Err("Band: it bounds the fit of recordings that are held out; hold one out.".into());
        }
        Ok(task.clone())
    }
}
