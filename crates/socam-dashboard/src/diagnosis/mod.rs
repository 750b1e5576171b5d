//! A diagnosis: the bench with the places of findings, residuals, rivals and the suggested experiment.

mod banner;
mod choice;
mod drawing;
mod evidence;
mod findings;

use std::sync::Arc;

use egui::{ScrollArea, Ui};
use socam_chart::chart::{self, Seen};
use socam_findings::headline::{self, headline};
use socam_findings::{Diagnosis, Evidence};
use socam_model::{Channel, Model, Quantity};
use socam_workbench::display_units::DisplayUnits;
use socam_workbench::rail::{Step, Tone, Verdict};
use socam_workbench::{Request, Workspace};

use crate::layout;
use crate::view::{Help, ViewPanel};
pub use choice::{Over, Sides};

/// Shows a diagnosis.
#[derive(Debug, Default)]
pub struct DiagnosisPage {
    pub(crate) shown: Option<Shown>,
    /// Residuals that are drawn.
    pub sides: Sides,
    /// The horizontal axis of the residuals.
    pub over: Over,
    channel: usize,
    recording: usize,
    /// The place that was clicked in the drawing.
    selected: Option<String>,
    /// Width of the drawing for which the finding was brought into sight.
    scrolled: Option<f32>,
    /// Whether what to record next is to be brought into sight.
    seeks_next: bool,
    /// Whether the rail has the verdict of what is shown; false too while a diagnosis runs.
    is_told: bool,
}

/// A diagnosis with its residuals and model.
#[derive(Debug)]
pub(crate) struct Shown {
    pub(crate) diagnosis: Diagnosis,
    pub(crate) evidence: Option<Evidence>,
    pub(crate) model: Model,
}

impl ViewPanel for DiagnosisPage {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        self.panels(ui, workspace, seen, ["No diagnosis yet", EMPTY], |_, _, _| {});
    }

    fn poll(&mut self, _: &egui::Context, workspace: &mut Workspace) {
        self.tell(workspace, false);
    }

    fn uses_recordings(&self) -> bool {
        false
    }

    fn help() -> Help {
        &[
            (
                "drawing",
                "the place of each finding is framed and numbered; rivals are dashed; click an element to see what was found there",
            ),
            (
                "over speed; over angle; over torque; over frequency; over time; recording; channel",
                "where the model and the recordings disagree: residuals of every channel, or over time of one of them",
            ),
            (
                "measured and predicted",
                "the channel that the findings improve most, before and after, where the model misses it most",
            ),
            ("measured shape", "the torque that is missing, as the recordings have it, with no law assumed"),
            ("fit", "what remains of each channel beside its noise"),
            ("before; after; both", "residuals of the model as it was and with the findings added"),
            ("Make it the input signal", "what to record next, ready to be armed"),
        ]
    }
}

/// Whether a board's command, a voltage or a speed, is an input of a model.
fn commands(model: &Model) -> bool {
    let is_commanded = |channel: &Channel| matches!(channel.quantity, Quantity::Speed | Quantity::Voltage);
    model.inputs().any(is_commanded)
}

impl DiagnosisPage {
    /// Draws the panels of the diagnosis, with `above` over the list of findings. `empty` are the title and the text where there is no diagnosis.
    pub(crate) fn panels(
        &mut self,
        ui: &mut Ui,
        workspace: &mut Workspace,
        seen: &mut Vec<Seen>,
        empty: [&str; 2],
        above: impl FnOnce(&mut Ui, &mut Workspace, Option<&Shown>),
    ) {
        let mut wanted = findings::Next::default();
        let width = layout::panel(ui, "findings", 372.0);
        let panel = egui::Panel::left("findings").default_size(width).size_range(250.0..=640.0);
        let panel = panel.show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                above(ui, workspace, self.shown.as_ref());
                if let Some(shown) = &self.shown {
                    let take =
                        if workspace.has_bench { "Make it the input signal" } else { "Save it as a file" };
                    let take = commands(&shown.model).then_some(take);
                    wanted = findings::list(ui, &shown.diagnosis, &mut self.selected, take);
                    if std::mem::take(&mut self.seeks_next)
                        && let Some(place) = wanted.place
                    {
                        ui.scroll_to_rect(place, Some(egui::Align::TOP));
                    }
                }
            });
        });
        layout::keep_panel(ui, "findings", panel.response.rect.width());
        egui::CentralPanel::default().show(ui, |ui| self.pictures(ui, &workspace.units, seen, empty));
        if let Some(profile) = wanted.profile {
            workspace.request(Request::Signal(Box::new(profile)));
        }
    }

    /// Tells the verdict, the findings and what to record next to the rail, once.
    pub(crate) fn tell(&mut self, workspace: &mut Workspace, is_running: bool) {
        if is_running {
            workspace.rail.set(Step::Diagnose, Verdict::Running, []);
            self.is_told = false;
            return;
        }
        if std::mem::replace(&mut self.is_told, true) {
            return;
        }
        let Some(shown) = &self.shown else {
            return workspace.rail.set(Step::Diagnose, Verdict::NotDone, []);
        };
        let diagnosis = &shown.diagnosis;
        let headline = headline(diagnosis);
        let tone = if headline.tone == headline::Tone::Adequate { Tone::Good } else { Tone::Alarm };
        let recordings = || diagnosis.recordings.iter().map(|own| own.name.clone());
        workspace.rail.set(Step::Diagnose, Verdict::Done { words: headline.title, tone }, recordings());
        let next = match &diagnosis.suggested_experiment {
            Some(next) => next.sentence.clone(),
            None => "nothing is left to tell apart".into(),
        };
        workspace.rail.set(Step::RecordNext, Verdict::Done { words: next, tone: Tone::Quiet }, recordings());
        workspace.rail.diagnosis = Some(Arc::new(diagnosis.clone()));
    }

    /// Brings what to record next into sight.
    pub(crate) fn seek_next(&mut self) {
        self.seeks_next = true;
    }

    /// Shows a diagnosis of a model.
    pub fn show(&mut self, diagnosis: Diagnosis, evidence: Option<Evidence>, model: Model) {
        (self.selected, self.scrolled, self.is_told) = (None, None, false);
        (self.channel, self.recording) = (0, 0);
        // The first picture is the one of the report; without it, the axis is the one that shows the strongest finding best.
        if diagnosis.overlay.is_some() {
            self.over = Over::Signals;
        } else if let Some(finding) = diagnosis.findings.first() {
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
        self.shown = Some(Shown { diagnosis, evidence, model });
    }

    fn pictures(
        &mut self,
        ui: &mut Ui,
        units: &DisplayUnits,
        seen: &mut Vec<Seen>,
        [title, text]: [&str; 2],
    ) {
        let Self { shown, sides, over, channel, recording, selected, scrolled, .. } = self;
        let Some(Shown { diagnosis, evidence, model }) = shown else {
            chart::empty_state(ui, title, text);
            return;
        };
        let drawing_height = drawing::height(model, diagnosis, ui.available_width());
        let width = ui.available_width();
        let is_low = ui.available_height() < drawing_height + LEAST_PICTURE
            || evidence.as_ref().is_some_and(|evidence| evidence::is_stacked(evidence, width));
        let mut charts = |ui: &mut Ui| {
            choice::ui(ui, over, sides);
            let view = choice::Choice {
                units,
                motion: model.motion,
                sides: *sides,
                over: *over,
                channel,
                recording,
            };
            evidence::ui(ui, diagnosis, evidence.as_ref(), view, seen);
        };
        if is_low {
            // All of it below each other, the charts first: the drawing would push them out of sight.
            ScrollArea::vertical().id_salt("pictures").auto_shrink(false).show(ui, |ui| {
                banner::banner(ui, diagnosis);
                ui.allocate_ui(egui::vec2(ui.available_width(), LEAST_CHART), |ui| {
                    ui.set_max_height(LEAST_CHART);
                    charts(ui);
                });
                ui.add_space(4.0);
                drawing::bench(ui, model, diagnosis, selected, scrolled);
            });
            return;
        }
        banner::banner(ui, diagnosis);
        egui::Panel::bottom("bench").frame(egui::Frame::NONE).show_separator_line(false).show(ui, |ui| {
            ui.add_space(4.0);
            drawing::bench(ui, model, diagnosis, selected, scrolled);
        });
        charts(ui);
    }
}

/// Height that headline, choices and a chart take at least beside the drawing, points; with less, the page is scrolled.
const LEAST_PICTURE: f32 = 330.0;
/// Height of the charts on a page that is scrolled, points.
const LEAST_CHART: f32 = 290.0;

const EMPTY: &str = "Drop the diagnosis.json of a report here. The drawing then shows where the model and the recordings disagree.";
