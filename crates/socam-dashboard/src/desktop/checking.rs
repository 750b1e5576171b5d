//! Options of the check, and the command that does the same.

use egui::{RichText, Ui};
use socam_chart::theme;
use socam_job::{Check, Grid};
use socam_model::Model;
use socam_recording::check;
use socam_workbench::entry::Entry;
use socam_workbench::recording::Recording;

use super::fitting::options::{First, Form, Layout, Offered};
use super::fitting::{command, sentence};

impl Offered for Check {
    const LAYOUT: Layout = Layout {
        first: &[
            First::new("ratio_tolerance", "Tolerance of speed ratios"),
            First::new("input", "Input, without a model"),
        ],
        left_out: &["model"],
        is_headed: false,
    };
}

/// The options of the check.
#[derive(Debug, Default)]
pub(crate) struct CheckOptions(Form<Check>);

impl CheckOptions {
    /// The settings; `None` while one cannot be meant.
    pub(crate) fn task(&self) -> Option<Check> {
        self.0.settings().ok().cloned()
    }

    /// What the recordings are for, in words.
    pub(crate) fn subject(&self, model: &Model) -> String {
        match self.task().and_then(|task| task.input) {
            Some(input) => format!("the input {input} and any model"),
            None => format!("the model {}", model.name),
        }
    }

    /// Draws the options, and the command on the open recordings.
    pub(crate) fn ui(&mut self, ui: &mut Ui, model: &Model, entries: &[Entry]) {
        ui.horizontal_wrapped(|ui| {
            crate::together::level(ui);
            self.0.ui(ui)
        });
        if let Err(problem) = self.0.settings() {
            return drop(ui.label(RichText::new(problem).color(theme::alarm(ui))));
        }
        if let Some((line, notes)) = self.line(model, entries) {
            command::ui(ui, &line, &notes);
        }
    }

    /// The command on the open recordings.
    pub(crate) fn command(&self, model: &Model, entries: &[Entry]) -> Option<String> {
        self.line(model, entries).map(|(line, _)| line)
    }

    /// The command, and what it lacks.
    fn line(&self, model: &Model, entries: &[Entry]) -> Option<(String, Vec<String>)> {
        let mut task = self.task()?;
        let mut notes = Vec::new();
        if task.input.is_none() {
            (task.model, notes) = command::named(model);
        }
        let recordings = entries.iter().map(|entry| &entry.recording);
        Some((command::of(&task, recordings, ("", &[]))?, notes))
    }
}

/// Checks a recording as the command does.
///
/// # Errors
/// When it cannot be read, or lacks what is checked; one sentence.
pub(crate) fn check(task: &Check, model: &Model, recording: &Recording) -> Result<check::Check, String> {
    let data = Grid::View.apply(recording.dataset()?).map_err(|error| error.to_string())?;
    task.run(task.input.is_none().then_some(model), &data).map_err(sentence)
}
