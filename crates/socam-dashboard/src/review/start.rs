//! The page of a window in which no recording is open: what can be opened, and a bench to try.

use std::path::Path;

use egui::{Button, RichText, Ui};
use socam_chart::chart;
use socam_workbench::recording::short;
use socam_workbench::{Request, Workspace};

/// Most recent files that are listed.
const LISTED: usize = 6;

/// Draws the page. Returns what was asked for.
pub(super) fn ui(ui: &mut Ui, workspace: &Workspace) -> Option<Request> {
    let mut wanted = None;
    chart::empty_state(
        ui,
        "No recording is open",
        "Drop recordings here, or press Ctrl+O. Several can be open at a time: they differ by colour, and from the ninth on by marks. A table of numbers opens as it is; its units can be set afterwards.",
    );
    ui.vertical_centered(|ui| {
        ui.add_space(10.0);
        let size = egui::vec2(220.0, 30.0);
        let open = ui.add_sized(size, Button::new(RichText::new("Open...").strong()));
        if open.on_hover_text("Recordings, models, results (Ctrl+O)").clicked() {
            wanted = Some(Request::Ask);
        }
        if workspace.has_bench {
            let bench = ui.add_sized(size, Button::new("Try the virtual bench"));
            let why =
                "Connects to a bench in this program, which is armed, run and recorded like one of iron";
            if bench.on_hover_text(why).clicked() {
                wanted = Some(Request::VirtualBench);
            }
        }
        let recent: Vec<&String> = workspace.recent.iter().take(LISTED).collect();
        if recent.is_empty() {
            return;
        }
        ui.add_space(8.0);
        ui.label(RichText::new("Opened before").strong());
        for run in recent {
            let folder =
                Path::new(run).parent().map(|folder| folder.display().to_string()).unwrap_or_default();
            let text = format!("{}   {}", short(run), short(&folder));
            let button = ui.add(Button::new(text).frame(false).truncate());
            if button.on_hover_text(run).clicked() {
                wanted = Some(Request::Open(run.clone()));
            }
        }
    });
    wanted
}
