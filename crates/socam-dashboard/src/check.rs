//! The check view: the findings of `check` for the open recordings.

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use socam_model::Model;
use socam_recording::check::{Check, Severity, Verdict, check};

use crate::draw::chart;
use crate::job::Job;
use crate::recording::short;
use crate::review::Entry;
use crate::theme;
use crate::view::{Help, ViewPanel};
use crate::workspace::Workspace;

/// Relative tolerance of the ratio of mean speeds.
const RATIO_TOLERANCE: f64 = 0.01;

/// Results of the checks.
#[derive(Debug, Default)]
pub struct Checks {
    known: Vec<(String, Result<Check, String>)>,
    job: Option<(String, Job<Result<Check, String>>)>,
    /// The model that the results belong to.
    revision: u64,
}

impl ViewPanel for Checks {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        egui::CentralPanel::default().show(ui, |ui| self.contents(ui, &workspace.entries, workspace.model()));
    }

    fn poll(&mut self, _: &egui::Context, workspace: &mut Workspace) {
        if self.revision != workspace.revision() {
            *self = Self { revision: workspace.revision(), ..Self::default() };
        }
        if let Some((name, job)) = &self.job
            && let Some(result) = job.poll()
        {
            self.known.push((name.clone(), result.and_then(|result| result)));
            self.job = None;
        }
    }

    fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    fn help() -> Help {
        &[]
    }
}

impl Checks {
    fn contents(&mut self, ui: &mut Ui, entries: &[Entry], model: &Model) {
        if entries.is_empty() {
            chart::empty_state(
                ui,
                "No recording is open",
                "Open one with Ctrl+O: this view says whether it can carry a fit of the model, what stands in the way, and what to record instead.",
            );
            return;
        }
        self.work(ui, entries, model);
        ui.label(RichText::new(format!("Fit for use with the model {}?", model.name)).color(theme::weak(ui)));
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for name in entries.iter().map(|entry| &entry.recording.about.name) {
                match self.known.iter().find(|(known, _)| known == name) {
                    Some((_, Ok(check))) => one(ui, name, check),
                    Some((_, Err(sentence))) => {
                        ui.label(RichText::new(sentence).color(theme::alarm(ui)));
                    }
                    None => {
                        ui.label(
                            RichText::new(format!("{}: not checked yet", short(name))).color(theme::weak(ui)),
                        );
                    }
                }
            }
        });
    }

    fn work(&mut self, ui: &mut Ui, entries: &[Entry], model: &Model) {
        let unknown = |name: &str| self.known.iter().all(|(known, _)| known != name);
        let next = entries.iter().map(|entry| &entry.recording).find(|next| unknown(&next.about.name));
        if let (None, Some(recording)) = (&self.job, next) {
            let options = socam_expectation::of_model(model, RATIO_TOLERANCE);
            let (own, name) = (recording.clone(), recording.about.name.clone());
            let work = move |_: &crate::job::Handle| {
                check(&own.dataset()?, &options).map_err(|error| error.to_string())
            };
            let title = format!("Checking {}", short(&name));
            self.job = Some((name, Job::start(&title, ui.ctx(), work)));
        }
        if let Some((name, job)) = &self.job
            && job.ui(ui)
        {
            self.known.push((name.clone(), Err(format!("{}: the check was cancelled", short(name)))));
            self.job = None;
        }
    }
}

fn one(ui: &mut Ui, name: &str, check: &Check) {
    Frame::new().fill(theme::card(ui)).corner_radius(6).inner_margin(Margin::same(10)).show(ui, |ui| {
        let (verdict, colour) = match check.verdict {
            Verdict::Fit => ("fit for use", theme::good(ui)),
            Verdict::FitWithReservations => ("fit for use, with reservations", theme::good(ui)),
            Verdict::Unfit => ("not fit for use", theme::alarm(ui)),
        };
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(short(name)).strong());
            ui.label(RichText::new(verdict).strong().color(colour));
        });
        for finding in &check.findings {
            let (word, colour) = match finding.severity() {
                Severity::Prevents => ("prevents a fit", theme::alarm(ui)),
                Severity::Weakens => ("weakens a fit", theme::alarm(ui)),
                Severity::Note => ("note", theme::weak(ui)),
            };
            ui.add_space(3.0);
            ui.label(RichText::new(format!("{word}: {}", finding.sentence())).color(colour));
            ui.label(RichText::new(format!("instead: {}", finding.remedy())).small());
        }
        ui.allocate_space(egui::vec2(ui.available_width(), 0.0));
    });
    ui.add_space(6.0);
}
