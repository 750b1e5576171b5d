//! The fleet view: all machines at the left; what they say together, or one machine, in the middle.

mod folder;
mod history;
mod kinds;
mod listing;
mod lists;
mod machine;
mod machines;
mod opened;
mod overview;
mod row;

use egui::{Key, Ui};
use socam_fleet::Row;

use crate::layout;
use crate::progress::wake;
use crate::view::{Help, ViewPanel};
use folder::Folder;
use listing::{Listing, Wish};
use machine::Page;
pub use opened::Opened;
use overview::Section;
use socam_chart::chart::{self, Seen};
use socam_workbench::Workspace;
use socam_workbench::job::Attempt;

/// The false discovery rate at first.
const FDR: f64 = 0.05;

/// State of the view.
#[derive(Debug, Default)]
pub struct FleetView {
    fleet: Option<Fleet>,
}

/// The fleet that is shown.
#[derive(Debug)]
struct Fleet {
    opened: Opened,
    fdr: f64,
    listing: Listing,
    wish: Wish,
    section: Section,
    /// Place of the machine that is looked at.
    selected: Option<usize>,
    page: Page,
    reading: Attempt<(usize, Vec<Row>)>,
    folder: Folder,
}

impl ViewPanel for FleetView {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        let Some(fleet) = &mut self.fleet else {
            egui::CentralPanel::default().show(ui, |ui| {
                chart::empty_state(ui, "No fleet is open", EMPTY);
            });
            return;
        };
        let usual = (0.42 * ui.available_width()).clamp(280.0, 860.0);
        let width = layout::panel(ui, "fleet", usual);
        let panel = egui::Panel::left("fleet").default_size(width).size_range(220.0..=900.0);
        let panel = panel.show(ui, |ui| fleet.machines(ui));
        // The usual width depends on the window's until the user has chosen one.
        if (panel.response.rect.width() - usual).abs() > 1.0 {
            layout::keep_panel(ui, "fleet", panel.response.rect.width());
        }
        egui::CentralPanel::default().show(ui, |ui| match fleet.selected {
            Some(place) => fleet.machine(ui, place, workspace, seen),
            None => fleet.overview(ui, seen),
        });
        if fleet.selected.is_some() && goes_back(ui) {
            fleet.selected = None;
        }
    }

    fn poll(&mut self, ctx: &egui::Context, _: &mut Workspace) {
        if let Some(fleet) = &mut self.fleet {
            fleet.read(ctx);
        }
    }

    fn is_busy(&self) -> bool {
        self.fleet.as_ref().is_some_and(|fleet| fleet.reading.is_running() || fleet.has_to_read())
    }

    /// A recording that is opened from here is shown over time.
    fn uses_recordings(&self) -> bool {
        false
    }

    fn help() -> Help {
        &[
            ("Search machines; Only those that stand out ...", "which machines the list at the left shows"),
            ("Machine ...", "shows the machine: its recordings by date, and its parameters over the dates"),
            ("All machines; Esc", "goes back from a machine to what all machines say together"),
            (
                "False discovery rate",
                "of each list at most this share is false on average; a greater one lists more machines",
            ),
            (
                "Missing physics: ...; Changes: ...; Differences: ...; Without a verdict: ...",
                "what is missing by effect and place; parameters that change over the dates; machines that differ from their sisters; recordings that no verdict was made of, and why",
            ),
            (
                "Finding ...; Show all machines",
                "leaves those machines in the list that have this finding, and draws its sizes; shows all again",
            ),
            ("Recording ...", "unfolds what was found in the recording, in sentences, and its warnings"),
            (
                "Open ...; Open all recordings",
                "opens recordings of the machine over time, beside the model that the fleet was diagnosed with; Check, Identify and Diagnosis then use them",
            ),
            (
                "Folder of the recordings; Look there",
                "where the recordings are, if neither beside the table nor in a folder there",
            ),
        ]
    }
}

/// Whether Esc was pressed, and for nothing else.
fn goes_back(ui: &Ui) -> bool {
    let is_free =
        !ui.ctx().egui_wants_keyboard_input() && ui.memory(|memory| memory.top_modal_layer().is_none());
    is_free && ui.input(|input| input.key_pressed(Key::Escape))
}

impl FleetView {
    /// Shows a fleet.
    pub fn show(&mut self, opened: Opened) {
        let listing = Listing::of(&opened.survey, FDR);
        let section = Section::first(&listing.summary);
        self.fleet = Some(Fleet {
            opened,
            fdr: FDR,
            listing,
            wish: Wish::default(),
            section,
            selected: None,
            page: Page::default(),
            reading: Attempt::default(),
            folder: Folder::default(),
        });
    }

    /// Looks at a machine of the fleet, if it has one of that name.
    pub fn select(&mut self, machine: &str) {
        if let Some(fleet) = &mut self.fleet {
            fleet.selected = listing::place(&fleet.opened.survey, machine);
        }
    }

    /// Name of the machine that is looked at.
    #[must_use]
    pub fn selected(&self) -> Option<&str> {
        let fleet = self.fleet.as_ref()?;
        Some(fleet.opened.survey.machines[fleet.selected?].name.as_str())
    }
}

impl Fleet {
    /// Takes the rows that were read, and reads those of the machine that is looked at.
    fn read(&mut self, ctx: &egui::Context) {
        if let Some((place, rows)) = self.reading.poll() {
            self.page = Page::of(place, rows);
        }
        if let Some(place) = self.selected.filter(|_| self.has_to_read() && !self.reading.is_running()) {
            let (path, name) = (self.opened.path.clone(), self.opened.survey.machines[place].name.clone());
            let title = format!("Reading the recordings of {name}");
            self.page = Page::of(place, Vec::new());
            self.reading
                .start(&title, &wake(ctx), move |handle| Ok((place, opened::rows_of(&path, &name, handle)?)));
        }
    }

    fn has_to_read(&self) -> bool {
        self.selected.is_some_and(|place| self.page.place != Some(place))
    }

    /// Short name of the table's file.
    fn file(&self) -> String {
        socam_workbench::recording::short(&self.opened.path.display().to_string()).to_owned()
    }
}

const EMPTY: &str = "Open a fleet table (FLEET.parquet, written by `socam-host fleet`) with Ctrl+O, or drop it here. This view then shows how many machines the model fits, which effects are missing how often and where, and which machines change or differ from the others.";
