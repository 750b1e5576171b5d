//! The diagnosis view: the bench with the places of findings, residuals, rivals and the suggested experiment.

mod choice;
mod drawing;
mod evidence;
mod findings;
// A browser shows diagnoses but cannot make them.
#[cfg(not(target_arch = "wasm32"))]
mod maker;

use egui::{Align, Frame, Layout, Margin, RichText, ScrollArea, Ui};
use socam_answer::document::{ProofOutcome, Validation, Verdict};
use socam_answer::{Diagnosis, Evidence};
use socam_model::Model;

use crate::draw::chart::{self, Seen};
#[cfg(not(target_arch = "wasm32"))]
use crate::files::Purpose;
use crate::view::{Help, ViewPanel};
#[cfg(not(target_arch = "wasm32"))]
use crate::workspace::Content;
use crate::workspace::{Request, Workspace};
use crate::{layout, theme};
pub use choice::{Over, Sides};

/// State of the view.
#[derive(Debug, Default)]
pub struct DiagnosisView {
    shown: Option<Shown>,
    /// Which residuals are drawn.
    pub sides: Sides,
    /// The horizontal axis of the residuals.
    pub over: Over,
    channel: usize,
    recording: usize,
    /// The place that was clicked in the drawing.
    selected: Option<String>,
    #[cfg(not(target_arch = "wasm32"))]
    maker: maker::Maker,
}

/// A diagnosis with its residuals and model.
#[derive(Debug)]
struct Shown {
    diagnosis: Diagnosis,
    evidence: Option<Evidence>,
    model: Model,
    /// Text of the corrected model's file, of a diagnosis that was made here.
    #[cfg(not(target_arch = "wasm32"))]
    model_toml: Option<String>,
}

/// What a report is written from.
#[cfg(not(target_arch = "wasm32"))]
#[derive(Debug)]
pub struct Report {
    diagnosis: Diagnosis,
    evidence: Evidence,
    model: Model,
    model_toml: String,
}

#[cfg(not(target_arch = "wasm32"))]
impl Report {
    /// Writes the folder of `diagnose --report`.
    ///
    /// # Errors
    /// When there is such a folder already, or it cannot be written; one sentence.
    pub(crate) fn write(&self, folder: &std::path::Path) -> Result<(), String> {
        if folder.exists() {
            return Err(format!("{} exists already; choose another name", folder.display()));
        }
        socam_diagnose::report::write(
            folder,
            &self.diagnosis,
            &self.evidence,
            &self.model,
            Some(&self.model_toml),
        )
        .map_err(|error| error.to_string())
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl Shown {
    /// Draws what can be done with a diagnosis that was made here.
    fn offers(&self, ui: &mut Ui, workspace: &mut Workspace) {
        let Some((evidence, text)) = self.evidence.as_ref().zip(self.model_toml.as_ref()) else { return };
        ui.horizontal_wrapped(|ui| {
            if ui.button("Save report...").clicked() {
                let report = Report {
                    diagnosis: self.diagnosis.clone(),
                    evidence: evidence.clone(),
                    model: self.model.clone(),
                    model_toml: text.clone(),
                };
                let content = Content::Report(Box::new(report));
                workspace.request(Request::SaveAs(Purpose::SaveReport, "diagnosis".into(), content));
            }
            if ui.button("Use as model").clicked() {
                match Model::parse(text) {
                    Ok(model) => workspace.request(Request::Model(Box::new(model))),
                    Err(error) => workspace.request(Request::Warn(error.to_string())),
                }
            }
            if ui.button("Save model file...").clicked() {
                let content = Content::Bytes(text.clone().into_bytes());
                workspace.request(Request::SaveAs(Purpose::SaveModel, "corrected.toml".into(), content));
            }
        });
        ui.add_space(4.0);
    }
}

impl ViewPanel for DiagnosisView {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        let mut wanted = None;
        let width = layout::panel(ui, "findings", 372.0);
        let panel = egui::Panel::left("findings").default_size(width).size_range(250.0..=640.0);
        let panel = panel.show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                #[cfg(not(target_arch = "wasm32"))]
                self.maker.ui(ui, workspace);
                if let Some(shown) = &self.shown {
                    #[cfg(not(target_arch = "wasm32"))]
                    shown.offers(ui, workspace);
                    wanted = findings::list(ui, &shown.diagnosis, &mut self.selected);
                }
            });
        });
        layout::keep_panel(ui, "findings", panel.response.rect.width());
        egui::CentralPanel::default().show(ui, |ui| self.pictures(ui, &mut workspace.seen));
        if let Some(profile) = wanted {
            workspace.request(Request::Signal(Box::new(profile)));
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn poll(&mut self, _: &egui::Context, _: &mut Workspace) {
        if let Some(answer) = self.maker.poll() {
            self.show(answer.diagnosis, Some(answer.evidence), answer.model);
            if let Some(shown) = &mut self.shown {
                shown.model_toml = Some(answer.model_toml);
            }
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn is_busy(&self) -> bool {
        self.maker.is_busy()
    }

    fn help() -> Help {
        &[
            (
                "Diagnose; Set-up",
                "asks whether the recordings that are fitted need physics that the model lacks, which, and where; those that are held out are the proof",
            ),
            (
                "False alarms; Most effects",
                "the share of complete models of which it is said that something is missing; the greatest number of effects that are added",
            ),
            (
                "Save report...",
                "writes a page with all pictures, the result for scripts and the corrected model into a new folder",
            ),
            ("Use as model; Save model file...", "the corrected model"),
            (
                "drawing",
                "the place of each finding is framed and numbered; rivals are dashed; click an element to see what was found there",
            ),
            (
                "over speed; over angle; over torque; over frequency; over time; recording; channel",
                "where the model and the recordings part: residuals of every channel, or over time of one of them",
            ),
            ("measured shape", "the torque that is missing, as the recordings have it, with no law assumed"),
            ("fit", "what remains of each channel beside its noise"),
            ("before; after; both", "residuals of the model as it was and with the findings added"),
            ("Make it the input signal", "what to record next, ready to be armed"),
        ]
    }
}

impl DiagnosisView {
    /// Begins a diagnosis as it is set up.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn start(&mut self, ctx: &egui::Context, workspace: &Workspace) {
        self.maker.start(ctx, workspace);
    }

    /// Shows a diagnosis of a model.
    pub fn show(&mut self, diagnosis: Diagnosis, evidence: Option<Evidence>, model: Model) {
        self.selected = None;
        (self.channel, self.recording) = (0, 0);
        // The axis is the one that shows the strongest finding best.
        if let Some(finding) = diagnosis.findings.first() {
            let region = &finding.region;
            self.over = match () {
                // A file has no residuals, but may have a measured shape.
                () if evidence.is_none() && finding.curve.is_some() => Over::Shape,
                () if evidence.is_none() => Over::Fit,
                // A spectrum shows narrow bands.
                () if region.frequency_hz.is_some_and(|[low, high]| high < 4.0 * low) => Over::Frequency,
                () if region.torque_nm.is_some() => Over::Torque,
                () => Over::Speed,
            };
        }
        self.shown = Some(Shown {
            diagnosis,
            evidence,
            model,
            #[cfg(not(target_arch = "wasm32"))]
            model_toml: None,
        });
    }

    /// Adds residuals to the diagnosis that is shown.
    pub(crate) fn evidence(&mut self, evidence: Evidence) {
        if let Some(shown) = &mut self.shown {
            shown.evidence = Some(evidence);
        }
    }

    fn pictures(&mut self, ui: &mut Ui, seen: &mut Vec<Seen>) {
        let Some(shown) = &self.shown else {
            chart::empty_state(ui, "No diagnosis yet", EMPTY);
            return;
        };
        verdict(ui, &shown.diagnosis);
        drawing::bench(ui, &shown.model, &shown.diagnosis, &mut self.selected);
        ui.add_space(2.0);
        ui.horizontal_wrapped(|ui| {
            for over in Over::ALL {
                if ui.selectable_label(self.over == over, over.name()).clicked() {
                    self.over = over;
                }
            }
            ui.separator();
            for (sides, name) in [(Sides::Before, "before"), (Sides::After, "after"), (Sides::Both, "both")] {
                ui.selectable_value(&mut self.sides, sides, name);
            }
        });
        let view = choice::Choice {
            sides: self.sides,
            over: self.over,
            channel: &mut self.channel,
            recording: &mut self.recording,
        };
        evidence::ui(ui, &shown.diagnosis, shown.evidence.as_ref(), view, seen);
    }
}

#[cfg(not(target_arch = "wasm32"))]
const EMPTY: &str = "Choose recordings and a model at the left and press Diagnose. The drawing then shows where model and recordings part. A saved report is opened by its diagnosis.json, with Ctrl+O, or by dropping its folder here.";
#[cfg(target_arch = "wasm32")]
const EMPTY: &str =
    "Drop the diagnosis.json of a report here. The drawing then shows where model and recordings part.";

fn is_contradicted(diagnosis: &Diagnosis) -> bool {
    diagnosis.held_out.as_ref().is_some_and(|held_out| held_out.outcome == ProofOutcome::Failed)
}

fn verdict(ui: &mut Ui, diagnosis: &Diagnosis) {
    let (text, colour) = match diagnosis.verdict {
        Verdict::Adequate => {
            ("The model explains these recordings: nothing is missing that they could show", theme::good(ui))
        }
        Verdict::MissingPhysics => ("The model leaves physics out", theme::alarm(ui)),
        Verdict::Unexplained => {
            ("The model leaves something out that has no name in the catalogue", theme::alarm(ui))
        }
    };
    let proof = match diagnosis.validation {
        Validation::Holdout if is_contradicted(diagnosis) => "the proof on held-out recordings failed",
        Validation::Holdout => "proven on recordings that were held out",
        Validation::LeaveOneOut => "not proven: compared on each recording in turn, fitted to the others",
        Validation::Blocks => "not proven: compared on each part of the recordings in turn",
    };
    let ground =
        if diagnosis.verdict == Verdict::Adequate { theme::card(ui) } else { theme::alarm_ground(ui) };
    Frame::new().fill(ground).corner_radius(6).inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(text).strong().size(15.0).color(colour));
            let rest = format!("{proof}; false alarms: {} %", 100.0 * diagnosis.false_alarm_rate);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(RichText::new(rest).small().color(theme::weak(ui)));
            });
        });
    });
}
