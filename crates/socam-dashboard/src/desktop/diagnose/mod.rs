//! The view that diagnoses: set-up and findings at the left, the bench and its residuals.

mod maker;
mod report;

use std::sync::LazyLock;

use egui::{Context, Ui};
use socam_chart::chart::Seen;
use socam_findings::{Diagnosis, Evidence};
use socam_model::Model;
use socam_workbench::Workspace;

use crate::diagnosis::DiagnosisPage;
use crate::view::{Help, ViewPanel};
use maker::Maker;
use report::Made;

/// State of the view.
#[derive(Debug, Default)]
pub struct Diagnose {
    /// The diagnosis that is shown.
    pub page: DiagnosisPage,
    maker: Maker,
    /// Data that only a diagnosis made here has.
    made: Option<Made>,
}

impl ViewPanel for Diagnose {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        let Self { page, maker, made } = self;
        let empty = if maker.is_busy() { RUNNING } else { EMPTY };
        page.panels(ui, workspace, seen, empty, |ui, workspace, shown| {
            maker.ui(ui, workspace);
            if let Some((shown, made)) = shown.zip(made.as_ref()) {
                made.offers(ui, workspace, shown);
            }
        });
    }

    fn poll(&mut self, _: &Context, workspace: &mut Workspace) {
        if let Some(answer) = self.maker.poll() {
            self.show(answer.diagnosis, Some(answer.evidence), answer.model);
            self.made = Some(answer.made);
        }
        self.page.tell(workspace, self.maker.is_busy());
    }

    fn command(&self, workspace: &Workspace) -> Option<String> {
        self.maker.command(workspace)
    }

    fn is_busy(&self) -> bool {
        self.maker.is_busy()
    }

    fn can_start(&self) -> bool {
        !self.maker.is_busy()
    }

    fn start(&mut self, ctx: &Context, workspace: &mut Workspace) {
        self.begin(ctx, workspace);
    }

    fn has_report(&self) -> bool {
        self.made.is_some() && self.page.shown.as_ref().is_some_and(|shown| shown.evidence.is_some())
    }

    fn save_report(&self, workspace: &mut Workspace) {
        if let Some((shown, made)) = self.page.shown.as_ref().zip(self.made.as_ref()) {
            made.save_report(workspace, shown);
        }
    }

    fn help() -> Help {
        static ALL: LazyLock<Vec<(&str, &str)>> = LazyLock::new(|| [MAKING, DiagnosisPage::help()].concat());
        &ALL
    }
}

impl Diagnose {
    /// Starts a diagnosis with the present set-up.
    pub(crate) fn begin(&mut self, ctx: &Context, workspace: &Workspace) {
        self.maker.start(ctx, workspace);
    }

    /// Shows a diagnosis of a model.
    pub fn show(&mut self, diagnosis: Diagnosis, evidence: Option<Evidence>, model: Model) {
        self.page.show(diagnosis, evidence, model);
        self.made = None;
        self.maker.fold();
    }
}

/// Help on the controls of a diagnosis that is made here.
const MAKING: Help = &[
    (
        "Diagnose; Set-up",
        "asks whether the recordings that are fitted need physics that the model lacks, which, and where; those that are held out are the proof",
    ),
    (
        "Range in sight; Whole recordings",
        "what is read of each recording: all of it, or the range that the Time view has in sight, as RUN@FROM..TO in the command",
    ),
    (
        "False alarms; Most effects",
        "the share of complete models of which it is said that something is missing; the greatest number of effects that are added",
    ),
    (
        "More options",
        "the options of the command diagnose: start state, materiality, seed, motion of inputs between their samples; hover over one to read what it does",
    ),
    ("Same as; Copy", "the command that does the same in a terminal, and what it lacks"),
    (
        "Save report...",
        "writes a page with all pictures, the result for scripts and the corrected model into a new folder",
    ),
    ("Use as model; Save model file...", "the corrected model"),
];

const EMPTY: [&str; 2] = [
    "No diagnosis yet",
    "Choose recordings and a model at the left and press Diagnose. The drawing then shows where the model and the recordings disagree. A saved report is opened by its diagnosis.json, with Ctrl+O, or by dropping its folder here.",
];
const RUNNING: [&str; 2] =
    ["A diagnosis runs", "Its progress is at the left. The other views can be used meanwhile."];
