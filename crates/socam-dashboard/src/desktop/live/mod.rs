//! The live view: samples, state and control of the running bench.

mod bar;
mod charts;
mod controls;
mod drive;
mod fields;
mod help;
mod parts;
mod readings;
mod source;

use std::path::PathBuf;

use egui::{Frame, Margin, Ui};
use socam_chart::chart::Seen;
use socam_recording::ProfileFile;
use socam_workbench::buffer::Buffer;
use socam_workbench::connection::Connection;
use socam_workbench::input_signal::Preview;
use socam_workbench::{Request, View, Workspace};

use crate::progress::wake;
use crate::view::{Help, ViewPanel};
use parts::Action;
use readings::Readings;

/// The live view.
#[derive(Debug)]
pub struct Live {
    /// Samples of the picture that is held, while the buffer continues to fill.
    held: Option<Buffer>,
    readings: Readings,
    window_s: f64,
    /// A signal and its preview.
    preview: Option<(ProfileFile, Preview)>,
}

impl Default for Live {
    fn default() -> Self {
        Self { held: None, readings: Readings::default(), window_s: 10.0, preview: None }
    }
}

impl ViewPanel for Live {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        if workspace.bench.is_linked() {
            // 40 pictures per second, even if the pointer rests.
            ui.ctx().request_repaint_after_secs(1.0 / 40.0);
        }
        for action in self.panel(ui, workspace) {
            self.act(ui.ctx(), workspace, action);
        }
        egui::CentralPanel::default().show(ui, |ui| self.charts(ui, &workspace.bench, seen));
    }

    fn bar(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 6));
        egui::Panel::top("live bar").frame(frame).show(ui, |ui| bar::draw(ui, workspace));
    }

    fn poll(&mut self, ctx: &egui::Context, workspace: &mut Workspace) {
        if workspace.bench.is_linked() {
            // Other views show the state of the bench, too.
            ctx.request_repaint_after_secs(0.25);
        }
    }

    fn uses_recordings(&self) -> bool {
        false
    }

    fn help() -> Help {
        help::HELP
    }
}

impl Live {
    fn act(&mut self, ctx: &egui::Context, workspace: &mut Workspace, action: Action) {
        match action {
            Action::Connect => {
                self.held = None;
                workspace.connect(wake(ctx));
            }
            Action::Disconnect => workspace.bench.disconnect(),
            Action::Change(settings) => workspace.present_signal_mut().change(settings),
            Action::Load(name) => {
                if let Err(sentence) = workspace.take_form(name) {
                    workspace.bench.set_problem(Some(sentence));
                }
            }
            Action::Torques(is_torque) => {
                if let Err(sentence) = workspace.drive.set_torque(is_torque) {
                    workspace.bench.set_problem(Some(sentence));
                }
            }
            Action::AddNote => {
                let note = std::mem::take(&mut workspace.next_run.note);
                workspace.bench.note(note);
            }
            Action::WriteDescription(text) => write_description(workspace, text),
            Action::Look(path) => {
                workspace.request(Request::Open(path));
                workspace.request(Request::Show(View::Time));
            }
        }
    }

    /// Samples that the charts show.
    fn shown<'a>(&'a self, bench: &'a Connection) -> &'a Buffer {
        self.held.as_ref().unwrap_or(bench.buffer())
    }
}

/// Writes what is known of a device into a new file, with which it is connected to next.
fn write_description(workspace: &mut Workspace, text: String) {
    let name = workspace.stated.description.trim();
    let named = (!name.is_empty()).then(|| PathBuf::from(name)).filter(|path| !path.exists());
    let numbered = (1..).map(|number| workspace.next_run.folder.join(format!("device-{number}.toml")));
    let Some(path) = named.into_iter().chain(numbered).find(|path| !path.exists()) else { return };
    workspace.stated.description = path.display().to_string();
    workspace.request(Request::Save(path, text.into_bytes()));
}
