//! A diagnosis on a thread of its own: its options, progress and result.

use std::sync::Arc;

use egui::{RichText, Ui};
use socam_answer::{Diagnosis, Evidence};
use socam_diagnose::{Options, diagnose};
use socam_identify::{Observer, Progress, ProgressMonitor, Stage};
use socam_model::Model;
use socam_recording::Dataset;

use crate::job::{CANCELLED, Handle, Job};
use crate::recording::{Recording, short};
use crate::theme;

/// The result.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) diagnosis: Diagnosis,
    pub(super) evidence: Evidence,
    pub(super) model: Model,
}

type Outcome = Result<Answer, String>;

/// Options of the next diagnosis, and the running one.
#[derive(Debug, Default)]
pub(super) struct Maker {
    /// Held-out recordings.
    held_out: Vec<String>,
    job: Option<Job<Outcome>>,
    problem: Option<String>,
}

impl Maker {
    pub(super) fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    pub(super) fn start(
        &mut self,
        ctx: &egui::Context,
        model: Model,
        names: Vec<String>,
        held_out: Vec<String>,
    ) {
        self.problem = None;
        let (kept, fitted) = names.into_iter().partition(|name| held_out.contains(name));
        self.held_out = held_out;
        self.job = Some(start(ctx, model, fitted, kept));
    }

    /// The result, once.
    pub(super) fn poll(&mut self) -> Option<Answer> {
        let outcome = self.job.as_ref().and_then(Job::poll)?;
        self.job = None;
        match outcome.and_then(|outcome| outcome) {
            Ok(answer) => return Some(answer),
            Err(sentence) if sentence == CANCELLED => {}
            Err(sentence) => self.problem = Some(sentence),
        }
        None
    }

    /// Draws the options of the next diagnosis, or the progress of the running one.
    pub(super) fn ui(&mut self, ui: &mut Ui, recordings: &[&Recording], model: &Model, is_first: bool) {
        if let Some(job) = &self.job {
            if job.ui(ui) {
                self.job = None;
            }
            return;
        }
        if let Some(problem) = &self.problem {
            ui.label(RichText::new(problem).color(theme::alarm(ui)));
        }
        let usable = recordings.iter().filter(|recording| recording.path.is_some());
        let names: Vec<String> = usable.map(|recording| recording.about.name.clone()).collect();
        if names.is_empty() {
            if is_first {
                let advice = "A diagnosis takes recordings that are files: drop some here, or press Ctrl+O.";
                ui.label(RichText::new(advice).color(theme::weak(ui)));
            }
            return;
        }
        let header = egui::CollapsingHeader::new("Diagnose the open recordings").default_open(is_first);
        header.show(ui, |ui| {
            for name in &names {
                let mut out = self.held_out.contains(name);
                let choice = ui.checkbox(&mut out, format!("hold out {}", short(name)));
                if choice.on_hover_text("never fitted, only predicted: the proof").changed() {
                    self.held_out.retain(|own| own != name);
                    self.held_out.extend(out.then(|| name.clone()));
                }
            }
            let any = names.iter().any(|name| !self.held_out.contains(name));
            if ui.add_enabled(any, egui::Button::new("Diagnose")).clicked() {
                self.start(ui.ctx(), model.clone(), names, self.held_out.clone());
            }
        });
    }
}

struct Follow(Handle);

impl Observer for Follow {
    fn progress(&self, progress: &Progress) {
        let stage = match progress.stage {
            Stage::Start { number, of } => format!("start {number} of {of}"),
            Stage::Descent { round } => format!("descent {round}"),
            Stage::Intervals => "intervals".into(),
        };
        self.0.doing(format!("Diagnosing: {stage}, step {}", progress.step));
    }

    fn stop(&self) -> bool {
        self.0.is_cancelled()
    }
}

fn start(ctx: &egui::Context, model: Model, training: Vec<String>, holdout: Vec<String>) -> Job<Outcome> {
    Job::start("Reading recordings", ctx, move |handle| {
        let open = |names: &[String]| {
            names
                .iter()
                .map(|name| Dataset::open(name))
                .collect::<Result<Vec<_>, _>>()
                .map_err(|e| e.to_string())
        };
        let (training, holdout) = (open(&training)?, open(&holdout)?);
        let options =
            Options { watch: ProgressMonitor::by(Arc::new(Follow(handle.clone()))), ..Options::default() };
        let answer = diagnose(&model, &training, &holdout, &options).map_err(|error| error.to_string())?;
        if handle.is_cancelled() {
            return Err(CANCELLED.into());
        }
        Ok(Answer { diagnosis: answer.diagnosis, evidence: answer.evidence, model })
    })
}
