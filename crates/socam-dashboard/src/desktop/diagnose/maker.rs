//! A diagnosis on a thread of its own: its set-up, progress and result.

use super::super::attempt;
use egui::{Button, CollapsingHeader, RichText, Ui};
use socam_diagnose::refuse_copies;
use socam_findings::{Diagnosis, Evidence};
use socam_job::{Diagnose, Grid, HeldOutRecording};
use socam_model::Model;
use socam_recording::Selection;

use super::super::fitting::options::{First, Form, Layout, Offered};
use super::super::fitting::{command, datasets, monitor, sentence, setup};
use super::report::{Made, provenance};
use crate::progress::wake;
use socam_chart::theme;
use socam_workbench::job::{Attempt, CANCELLED, Handle};
use socam_workbench::recording::Recording;
use socam_workbench::setup::Chosen;
use socam_workbench::{Request, Workspace};

/// The result.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) diagnosis: Diagnosis,
    pub(super) evidence: Evidence,
    pub(super) model: Model,
    pub(super) made: Made,
}

impl Offered for Diagnose {
    const LAYOUT: Layout = Layout {
        first: &[
            First { is_percent: true, ..First::new("false_alarm_rate", "False alarms") },
            First::new("most", "Most effects"),
        ],
        // Tables of steady states, to which `repeatability` belongs, are not diagnosed in the window.
        left_out: &["model", "fixed", "start_values", "repeatability"],
        is_headed: false,
    };
}

/// Options of the next diagnosis, and the running one.
#[derive(Debug, Default)]
pub(super) struct Maker {
    form: Form<Diagnose>,
    attempt: Attempt<Answer>,
    /// Whether the set-up is to be folded.
    folds: bool,
}

impl Maker {
    pub(super) fn is_busy(&self) -> bool {
        self.attempt.is_running()
    }

    /// Begins a diagnosis, or says why it cannot.
    pub(super) fn start(&mut self, ctx: &egui::Context, workspace: &Workspace) {
        match self.form.settings().and_then(|task| Ok((task.clone(), workspace.chosen()?))) {
            Ok((task, chosen)) => {
                let work = move |handle: &Handle| answer(&task, &chosen, handle);
                self.attempt.start("reading recordings", &wake(ctx), work);
            }
            Err(why) => self.attempt.problem = Some(why),
        }
    }

    /// Folds the set-up: a result needs the room.
    pub(super) fn fold(&mut self) {
        self.folds = true;
    }

    /// The result, once.
    pub(super) fn poll(&mut self) -> Option<Answer> {
        let answer = self.attempt.poll();
        self.folds |= answer.is_some();
        answer
    }

    /// Draws the set-up of the next diagnosis, or the progress of the running one.
    pub(super) fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        ui.add_space(4.0);
        if attempt::ui(ui, &mut self.attempt) {
            return;
        }
        let header = CollapsingHeader::new("Set-up").id_salt("set-up of a diagnosis").default_open(true);
        // The result needs the room; the set-up is folded once when it comes.
        let fold = std::mem::take(&mut self.folds).then_some(false);
        header.open(fold).show(ui, |ui| self.options(ui, workspace));
        if let Some(problem) = &self.attempt.problem {
            ui.label(RichText::new(problem).color(theme::alarm(ui)));
        }
    }

    fn options(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        if let Some(model) = setup::ui(ui, workspace) {
            workspace.request(Request::Model(Box::new(model)));
        }
        self.form.ui(ui);
        let chosen = workspace.chosen();
        let task = self.form.settings().cloned();
        ui.horizontal_wrapped(|ui| {
            let button = Button::new(RichText::new("Diagnose").strong());
            if ui.add_enabled(chosen.is_ok() && task.is_ok(), button).clicked() {
                self.start(ui.ctx(), workspace);
            }
            if let Err(problem) = &task {
                ui.label(RichText::new(problem).color(theme::alarm(ui)));
            }
        });
        match &chosen {
            Err(why) => drop(ui.label(RichText::new(why).color(theme::weak(ui)))),
            Ok(chosen) if chosen.held_out.is_empty() => {
                let advice = "Nothing is held out: what is found will not be confirmed.";
                ui.label(RichText::new(advice).small().color(theme::weak(ui)));
            }
            Ok(_) => {}
        }
        if let Ok(chosen) = &chosen
            && let Some((line, notes)) = self.line(workspace, chosen)
        {
            command::ui(ui, &line, &notes);
        }
    }

    /// The command that does the same.
    pub(super) fn command(&self, workspace: &Workspace) -> Option<String> {
        self.line(workspace, &workspace.chosen().ok()?).map(|(line, _)| line)
    }

    /// The command, and what it lacks.
    fn line(&self, workspace: &Workspace, chosen: &Chosen) -> Option<(String, Vec<String>)> {
        let mut task = self.form.settings().ok()?.clone();
        let notes = command::name_model(&mut task.model, workspace.model(), &chosen.model);
        Some((command::of(&task, &chosen.training, ("--holdout", &chosen.held_out))?, notes))
    }
}

fn answer(task: &Diagnose, chosen: &Chosen, handle: &Handle) -> Result<Answer, String> {
    let model = task.model.changed(chosen.model.clone()).map_err(sentence)?;
    let training = datasets(&chosen.training, Grid::Fit, handle)?;
    handle.doing("hashing the recordings".into());
    refuse_copies(&selections(&chosen.training)?, &selections(&chosen.held_out)?)
        .map_err(|e| e.to_string())?;
    let used = chosen.training.iter().chain(&chosen.held_out);
    let provenance = provenance(&model, used.filter_map(|own| Some((own.about.name.as_str(), own.path()?))))?;
    let held_out = chosen.held_out.iter().cloned().map(unopened).collect();
    let done = task.run(model, &training, held_out, monitor(handle)).map_err(sentence)?;
    if handle.is_cancelled() {
        return Err(CANCELLED.into());
    }
    Ok(Answer {
        diagnosis: done.answer.diagnosis,
        evidence: done.answer.evidence,
        model: done.model,
        made: Made { model_toml: done.answer.model_toml, provenance },
    })
}

/// A recording that is read after the last choice.
fn unopened(recording: Recording) -> HeldOutRecording {
    HeldOutRecording::Unopened(recording.about.name.clone(), Box::new(move || recording.dataset()))
}

/// The files of those recordings that are read from one.
fn selections(recordings: &[Recording]) -> Result<Vec<Selection>, String> {
    let from_files = recordings.iter().filter(|own| own.path().is_some());
    let each = from_files.map(|own| Selection::parse(&own.about.name).map_err(|error| error.to_string()));
    each.collect()
}
