//! The view that identifies: set-up at the left, parameters with intervals, measured against predicted.

mod predictions;
mod residual_tests;
mod run;
mod start;

use egui::{ScrollArea, Ui};
use socam_chart::chart::Seen;
use socam_workbench::Workspace;
use socam_workbench::identification::Identification;

use crate::identification::IdentificationPage;
use crate::layout;
use crate::view::{Help, ViewPanel};

/// State of the view.
#[derive(Debug, Default)]
pub struct Identify {
    /// The identification that is shown.
    pub page: IdentificationPage,
    /// Data that only an identification made here has.
    found: Option<run::Found>,
    start: start::Start,
    pictures: predictions::Pictures,
}

impl ViewPanel for Identify {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        let width = layout::panel(ui, "identify", 372.0);
        let panel = egui::Panel::left("identify").default_size(width).size_range(250.0..=640.0);
        let panel = panel.show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                self.start.ui(ui, workspace);
                if let Some(found) = &self.found {
                    found.offers(ui, workspace);
                }
            });
        });
        layout::keep_panel(ui, "identify", panel.response.rect.width());
        egui::CentralPanel::default().show(ui, |ui| {
            if let Some(found) = self.found.as_ref().filter(|found| !found.predictions.is_empty()) {
                let height = (0.45 * ui.available_height()).max(150.0);
                egui::Panel::bottom("predicted").default_size(height).resizable(true).show(ui, |ui| {
                    self.pictures.ui(ui, &found.predictions, &workspace.units, seen);
                });
            }
            let empty = if self.start.is_busy() { RUNNING } else { EMPTY };
            self.page.contents(ui, workspace, empty);
        });
    }

    fn poll(&mut self, _: &egui::Context, workspace: &mut Workspace) {
        if let Some(found) = self.start.poll() {
            self.page.show(found.shown.clone());
            self.pictures = predictions::Pictures::default();
            self.found = Some(found);
        }
        self.page.tell(workspace, self.start.is_busy());
    }

    fn command(&self, workspace: &Workspace) -> Option<String> {
        self.start.command(workspace)
    }

    fn is_busy(&self) -> bool {
        self.start.is_busy()
    }

    fn can_start(&self) -> bool {
        !self.start.is_busy()
    }

    fn start(&mut self, ctx: &egui::Context, workspace: &mut Workspace) {
        self.start.begin(ctx, workspace);
    }

    fn help() -> Help {
        &[
            (
                "Model; ...: fit; ...: hold out; ...: no",
                "the model, and the recordings that are fitted to it together; those that are held out are only predicted, as a proof; the diagnosis has the same set-up",
            ),
            (
                "Range in sight; Whole recordings",
                "what is read of each recording: all of it, or the range that the Time view has in sight, as RUN@FROM..TO in the command",
            ),
            (
                "Start values: ...; ...: fixed; ...: start value; Values of the model",
                "parameters that are known and not fitted, and where the others start, SI; with bounds of the model file",
            ),
            (
                "Output error; Inverse dynamics",
                "how it is fitted: by the errors of the simulated outputs, or, for an axis with one coordinate, by linear regression of the force on the motion",
            ),
            (
                "More options",
                "the options of the command identify: band, start state, known noise, start points, motion of inputs between their samples; hover over one to read what it does",
            ),
            (
                "Identify parameters",
                "fits the free parameters to all recordings together, in the background; Cancel gives it up",
            ),
            ("Same as; Copy", "the command that does the same in a terminal, and what it lacks"),
            ("Use as model", "what was found becomes the model of all views"),
            (
                "Save model file...; Save as JSON...",
                "the model with what was found, and the result for scripts",
            ),
            (
                "Go to Diagnosis",
                "the model leaves something out, which its parameters have taken up: a diagnosis says what and where",
            ),
            (
                "signals; residuals; whiteness; by input; correlated input; predicted recording",
                "measured against predicted, the difference, its autocorrelation with the band in which 95 % of the lags of white residuals are, or its correlation with an input with the band for residuals that do not depend on it (neither needs to be white), of each channel; at positive lags the input is earlier, what lies beyond at negative ones is feedback",
            ),
        ]
    }
}

impl Identify {
    /// Shows an identification from a file.
    pub(crate) fn show(&mut self, identification: Identification) {
        self.page.show(identification);
        self.found = None;
    }
}

const EMPTY: [&str; 2] = [
    "No identification yet",
    "Choose recordings and a model at the left and press Identify parameters. Every parameter is then shown with its 95 % interval, and what the recordings do not determine is named. A saved result (.json) can be opened with Ctrl+O or dropped here.",
];
const RUNNING: [&str; 2] =
    ["An identification runs", "Its progress is at the left. The other views can be used meanwhile."];
