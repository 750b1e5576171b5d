//! Options of frequency responses, and the command that does the same.

use egui::{RichText, Ui};
use socam_chart::theme;
use socam_job::Response;
use socam_model::Model;
use socam_response::Settings;
use socam_workbench::recording::Recording;

use super::fitting::command;
use super::fitting::options::{First, Form, Layout, Offered};

impl Offered for Response {
    const LAYOUT: Layout = Layout {
        first: &[First::new("band", "Band, Hz")],
        left_out: &["model", "fixed", "start_values", "between", "outputs"],
        is_headed: true,
    };
}

/// The options of frequency responses.
#[derive(Debug, Default)]
pub(crate) struct ResponseOptions(Form<Response>);

impl ResponseOptions {
    /// The settings; `None` while one cannot be meant.
    pub(crate) fn settings(&self) -> Option<Settings> {
        self.0.settings().ok().map(|task| task.signals.settings(task.band))
    }

    /// Draws the options, and the commands that estimate the response of the output's column over the input's from each recording.
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        model: &Model,
        columns: [&str; 2],
        shown: &[(usize, &Recording)],
    ) {
        ui.horizontal(|ui| self.0.ui(ui));
        let mut task = match self.0.settings() {
            Ok(task) => task.clone(),
            Err(problem) => return drop(ui.label(RichText::new(problem).color(theme::alarm(ui)))),
        };
        let Some(output) = output(model, columns) else {
            let text =
                "No command does the same: identify --method frf takes the input and an output of the model.";
            return drop(ui.label(RichText::new(text).small().color(theme::weak(ui))));
        };
        task.signals.outputs = vec![output.to_owned()];
        let (name, mut notes) = command::named(model);
        task.model.model = name;
        let has = |recording: &&Recording| columns.iter().all(|column| recording.has_column(column));
        let used = shown.iter().map(|(_, recording)| *recording).filter(has);
        let lines = used.map(|recording| command::of(&task, [recording], ("", &[])));
        let Some(lines) = lines.collect::<Option<Vec<String>>>().filter(|lines| !lines.is_empty()) else {
            return;
        };
        if lines.len() > 1 {
            notes.push(format!("Copy copies {} commands, one for each recording.", lines.len()));
        }
        command::ui(ui, &lines.join("\n"), &notes);
    }
}

/// The name of the model's output that the command takes, where the columns are those of the model's only input and of an output.
fn output<'m>(model: &'m Model, [input, output]: [&str; 2]) -> Option<&'m str> {
    let mut inputs = model.inputs().filter(|channel| !channel.quantity.is_clock());
    let is_input = inputs.next().is_some_and(|only| only.column == input) && inputs.next().is_none();
    let found = model.outputs().find(|channel| channel.column == output)?;
    is_input.then_some(found.name.as_str())
}
