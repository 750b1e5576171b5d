//! The result of an identification, as its file has it.

mod result;

use egui::{ScrollArea, Ui};
use socam_chart::chart::{self, Seen};
use socam_workbench::identification::Identification;
use socam_workbench::rail::{Step, Tone, Verdict};
use socam_workbench::{Request, View, Workspace};

use crate::view::{Help, ViewPanel};

/// Shows an identification.
#[derive(Debug, Default)]
pub struct IdentificationPage {
    /// The identification that is shown.
    pub shown: Option<Identification>,
}

impl ViewPanel for IdentificationPage {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, _: &mut Vec<Seen>) {
        egui::CentralPanel::default()
            .show(ui, |ui| self.contents(ui, workspace, ["No identification yet", EMPTY]));
    }

    fn poll(&mut self, _: &egui::Context, workspace: &mut Workspace) {
        self.tell(workspace, false);
    }

    fn uses_recordings(&self) -> bool {
        false
    }

    fn help() -> Help {
        VERDICT
    }
}

impl IdentificationPage {
    /// Shows an identification.
    pub(crate) fn show(&mut self, identification: Identification) {
        self.shown = Some(identification);
    }

    /// Tells the verdict to the rail.
    pub(crate) fn tell(&self, workspace: &mut Workspace, is_running: bool) {
        let recordings = self.shown.as_ref().map(|shown| shown.recordings.clone()).unwrap_or_default();
        let verdict = match &self.shown {
            _ if is_running => Verdict::Running,
            None => Verdict::NotDone,
            Some(shown) => {
                let (words, tone) = match shown.verdict().explains {
                    Some(true) => ("the model explains them", Tone::Good),
                    Some(false) => ("the model leaves something out", Tone::Alarm),
                    None => ("fitted, not judged", Tone::Quiet),
                };
                Verdict::Done { words: words.into(), tone }
            }
        };
        workspace.rail.set(Step::Identify, verdict, recordings);
    }

    /// Draws the verdict and the tables, or the title and text of an empty view where there is none.
    pub(crate) fn contents(&self, ui: &mut Ui, workspace: &mut Workspace, [title, text]: [&str; 2]) {
        match &self.shown {
            Some(shown) => {
                let page = ScrollArea::vertical().auto_shrink(false);
                if page.show(ui, |ui| result::ui(ui, shown)).inner {
                    workspace.request(Request::Show(View::Diagnosis));
                }
            }
            None => chart::empty_state(ui, title, text),
        }
    }
}

const EMPTY: &str = "Drop a saved result (.json) here: every parameter is shown with its 95 % interval, and what the recordings do not determine is named.";

/// Explains the verdict.
pub(crate) const VERDICT: Help = &[(
    "Go to Diagnosis",
    "the model leaves something out, which its parameters have taken up: a diagnosis says what and where",
)];
