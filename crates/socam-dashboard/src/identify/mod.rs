//! The view that identifies: set-up at the left, parameters with intervals, measured against predicted.

#[cfg(not(target_arch = "wasm32"))]
mod predictions;
mod result;
#[cfg(not(target_arch = "wasm32"))]
mod run;
#[cfg(not(target_arch = "wasm32"))]
mod start;

use egui::{ScrollArea, Ui};

#[cfg(not(target_arch = "wasm32"))]
use crate::layout;
use crate::parameters::Identification;
use crate::view::{Help, ViewPanel};
use crate::workspace::Workspace;
use socam_chart::chart;

/// State of the view.
#[derive(Debug, Default)]
pub struct Identify {
    /// The identification that is shown.
    pub shown: Option<Identification>,
    /// What only an identification that was made here has.
    #[cfg(not(target_arch = "wasm32"))]
    found: Option<run::Found>,
    #[cfg(not(target_arch = "wasm32"))]
    start: start::Start,
    #[cfg(not(target_arch = "wasm32"))]
    pictures: predictions::Pictures,
}

impl ViewPanel for Identify {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        #[cfg(not(target_arch = "wasm32"))]
        {
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
        }
        egui::CentralPanel::default().show(ui, |ui| self.contents(ui, workspace));
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn poll(&mut self, _: &egui::Context, _: &mut Workspace) {
        if let Some(found) = self.start.poll() {
            self.shown = Some(found.shown.clone());
            self.pictures = predictions::Pictures::default();
            self.found = Some(found);
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn is_busy(&self) -> bool {
        self.start.is_busy()
    }

    fn uses_recordings(&self) -> bool {
        cfg!(not(target_arch = "wasm32"))
    }

    fn help() -> Help {
        &[
            (
                "Model; ...: fit; ...: hold out; ...: no",
                "the model, and the recordings that are fitted to it together; those that are held out are only predicted, as a proof; the diagnosis has the same set-up",
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
                "Identify parameters",
                "fits the free parameters to all recordings together, in the background; Cancel gives it up",
            ),
            ("Use as model", "what was found becomes the model of all views"),
            (
                "Save model file...; Save as JSON...",
                "the model with what was found, and the result for scripts",
            ),
            (
                "signals; residuals; predicted recording",
                "measured against predicted, or the difference, of each channel",
            ),
        ]
    }
}

impl Identify {
    /// Shows an identification from a file.
    pub(crate) fn show(&mut self, identification: Identification) {
        self.shown = Some(identification);
        #[cfg(not(target_arch = "wasm32"))]
        {
            self.found = None;
        }
    }

    fn contents(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        let Some(shown) = &self.shown else {
            chart::empty_state(ui, "No identification yet", EMPTY);
            return;
        };
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(found) = self.found.as_ref().filter(|found| !found.predictions.is_empty()) {
            let height = (0.45 * ui.available_height()).max(150.0);
            egui::Panel::bottom("predicted").default_size(height).resizable(true).show(ui, |ui| {
                self.pictures.ui(ui, &found.predictions, &mut workspace.seen);
            });
        }
        #[cfg(target_arch = "wasm32")]
        let _ = workspace;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| result::ui(ui, shown));
    }
}

#[cfg(not(target_arch = "wasm32"))]
const EMPTY: &str = "Choose recordings and a model at the left and press Identify parameters. Every parameter is then shown with its 95 % interval, and what the recordings do not determine is named. A saved result (.json) can be opened with Ctrl+O or dropped here.";
#[cfg(target_arch = "wasm32")]
const EMPTY: &str = "Drop a saved result (.json) here: every parameter is shown with its 95 % interval, and what the recordings do not determine is named.";
