//! A diagnosis on a thread of its own: its set-up, progress and result.

use egui::{Button, CollapsingHeader, RichText, Slider, Ui};
use socam_answer::{Diagnosis, Evidence};
use socam_diagnose::{DiagnoseError, HeldOut, Options, diagnose, refuse_copies};
use socam_identify::IdentifyError;
use socam_model::Model;
use socam_recording::Selection;

use super::report::{Made, provenance};
use crate::fitting::{Chosen, dataset, datasets, watch};
use crate::job::{Attempt, CANCELLED, Handle};
use crate::recording::Recording;
use crate::theme;
use crate::workspace::{Request, Workspace};

/// The result.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) diagnosis: Diagnosis,
    pub(super) evidence: Evidence,
    pub(super) model: Model,
    pub(super) made: Made,
}

/// Options of the next diagnosis, and the running one.
#[derive(Debug)]
pub(super) struct Maker {
    false_alarms_percent: f64,
    most_effects: usize,
    attempt: Attempt<Answer>,
    /// Whether the set-up is to be folded.
    folds: bool,
}

impl Default for Maker {
    fn default() -> Self {
        let usual = Options::default();
        Self {
            false_alarms_percent: 100.0 * usual.false_alarm_rate,
            most_effects: usual.most_effects,
            attempt: Attempt::default(),
            folds: false,
        }
    }
}

impl Maker {
    pub(super) fn is_busy(&self) -> bool {
        self.attempt.is_running()
    }

    /// Begins a diagnosis, or says why it cannot.
    pub(super) fn start(&mut self, ctx: &egui::Context, workspace: &Workspace) {
        match workspace.setup.chosen(&workspace.entries, workspace.model()) {
            Ok(chosen) => {
                let options = Options {
                    false_alarm_rate: 0.01 * self.false_alarms_percent,
                    most_effects: self.most_effects,
                    ..Options::default()
                };
                let work = move |handle: &Handle| answer(&chosen, options, handle);
                self.attempt.start("reading recordings", ctx, work);
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
        if self.attempt.ui(ui) {
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
        if let Some(model) = workspace.setup_ui(ui) {
            workspace.request(Request::Model(Box::new(model)));
        }
        ui.horizontal(|ui| {
            let label = ui.label("False alarms").on_hover_text(
                "Share of complete models of which a diagnosis says that something is missing",
            );
            let slider =
                Slider::new(&mut self.false_alarms_percent, 0.1..=20.0).logarithmic(true).suffix(" %");
            ui.add(slider.max_decimals(1)).labelled_by(label.id);
        });
        ui.horizontal(|ui| {
            let label = ui.label("Most effects");
            ui.add(egui::DragValue::new(&mut self.most_effects).range(1..=6)).labelled_by(label.id);
        });
        let chosen = workspace.setup.chosen(&workspace.entries, workspace.model());
        let button = Button::new(RichText::new("Diagnose").strong());
        if ui.add_enabled(chosen.is_ok(), button).clicked() {
            self.start(ui.ctx(), workspace);
        }
        match &chosen {
            Err(why) => drop(ui.label(RichText::new(why).color(theme::weak(ui)))),
            Ok(chosen) if chosen.held_out.is_empty() => {
                let advice = "Nothing is held out: what is found will not be proven.";
                ui.label(RichText::new(advice).small().color(theme::weak(ui)));
            }
            Ok(_) => {}
        }
    }
}

fn answer(chosen: &Chosen, options: Options, handle: &Handle) -> Result<Answer, String> {
    // Outputs that are missing at most points of a finer grid would have no spectra.
    let training = datasets(&chosen.training, &chosen.model, 1, handle)?;
    handle.doing("hashing the recordings".into());
    refuse_copies(&selections(&chosen.training)?, &selections(&chosen.held_out)?)
        .map_err(|e| e.to_string())?;
    let used = chosen.training.iter().chain(&chosen.held_out);
    let provenance = provenance(
        &chosen.model,
        used.filter_map(|own| Some((own.about.name.as_str(), own.path.as_deref()?))),
    )?;
    let open = |own: &Recording| dataset(own, &chosen.model, 1);
    let held_out =
        chosen.held_out.iter().fold(HeldOut::none(), |all, own| all.with(&own.about.name, move || open(own)));
    let options = Options { watch: watch(handle), ..options };
    let answer = diagnose(&chosen.model, &training, held_out, &options).map_err(|error| match error {
        DiagnoseError::Identify(IdentifyError::Cancelled) => CANCELLED.into(),
        error => error.to_string(),
    })?;
    if handle.is_cancelled() {
        return Err(CANCELLED.into());
    }
    Ok(Answer {
        diagnosis: answer.diagnosis,
        evidence: answer.evidence,
        model: chosen.model.clone(),
        made: Made { model_toml: answer.model_toml, provenance },
    })
}

/// The files of those recordings that are read from one.
fn selections(recordings: &[Recording]) -> Result<Vec<Selection>, String> {
    let from_files = recordings.iter().filter(|own| own.path.is_some());
    let each = from_files.map(|own| Selection::parse(&own.about.name).map_err(|error| error.to_string()));
    each.collect()
}
