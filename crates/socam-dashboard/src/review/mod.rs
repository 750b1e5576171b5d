//! Recordings over time: plots in tiles, all with the same time axis, and two cursors.

mod align;
mod clock;
mod content;
mod cursors;
mod derive;
mod difference;
mod help;
mod histogram;
mod keys;
mod list;
mod notes;
mod over_time;
mod panes;
mod plots;
mod rows;
mod samples_csv;
mod spectrogram;
mod start;
mod statistics;
mod toolbar;
mod units;
mod values;
mod views;
mod xy;

use std::collections::BTreeMap;

use egui::{ComboBox, Role, Ui, WidgetInfo};

use crate::progress::{self, wake};
use crate::view::{Help, ViewPanel};
use derive::Form;
use notes::Notes;
use plots::Plots;
use socam_chart::chart::{self, Chart, Seen, Shown, hover::Linked, range_of, with_room};
use socam_workbench::arrangement::{Arrangement, Plot};
use socam_workbench::derivation::{Derivation, Operation};
use socam_workbench::derivations::Derivations;
use socam_workbench::display_units::DisplayUnits;
use socam_workbench::entry::{Entry, signals};
use socam_workbench::signal::Signal;
use socam_workbench::spectrum_settings::SpectrumSettings;
use socam_workbench::{Request, Workspace};
use views::Views;

/// State of the view over time.
#[derive(Debug, Default)]
pub struct Review {
    /// The time axis of all plots, s; `None` shows everything.
    pub x: Option<[f64; 2]>,
    /// Time axes of plots that are not linked with the others, s, by the titles of plots.
    own_x: Vec<(String, [f64; 2])>,
    /// Vertical axes that the user set, by the titles of plots.
    y: Vec<(String, [f64; 2])>,
    plots: Plots,
    derivations: Derivations,
    /// Units in which channels are shown.
    pub units: DisplayUnits,
    /// How spectra and spectrograms are made: of the view over frequency, too.
    pub spectra: SpectrumSettings,
    /// Whether the time axis has clock times.
    clock_time: bool,
    /// Whether a fit can be made from here: not in a browser.
    can_fit: bool,
    /// The dialog in which a channel is derived.
    form: Option<Form>,
    /// The window of notes.
    notes: Option<Notes>,
    /// Whether the marks of events are hidden.
    hides_events: bool,
    /// Cursors A and B, s.
    pub cursors: Option<[f64; 2]>,
    /// Index of the cursor that the next click moves.
    next: usize,
    /// The recording that others are compared with.
    pub reference: Option<usize>,
    /// Text for which the list is searched.
    search: String,
    /// Whether the search is to get the keyboard.
    searching: bool,
    /// Number of the recording that is highlighted: the one that the pointer is on in the list.
    lit: Option<usize>,
    /// The tile whose menu is open.
    menu_of: Option<egui_tiles::TileId>,
    /// States of XY plots and spectrograms, by their tiles.
    xy: BTreeMap<u64, xy::Xy>,
    spectrograms: BTreeMap<u64, spectrogram::Spectrogram>,
    histograms: BTreeMap<u64, histogram::Counted>,
    /// Numbers of the recordings that tables of values show, by their tiles.
    tables: BTreeMap<u64, usize>,
    /// The recording that is being laid over another one.
    aligning: Option<align::Aligning>,
    /// Shifts among which one is to be chosen.
    offered: Option<align::Offered>,
    /// Position of the pointer on the time axis.
    linked: Linked,
    views: Views,
}

/// Data for drawing one pass.
struct Drawing<'a> {
    entries: &'a [Entry],
    /// The channels of the shown recordings.
    signals: &'a [Signal],
    /// Those of `signals` that are drawn over time.
    drawn: Vec<Signal>,
    /// The time axis, s.
    x: [f64; 2],
    time_axis: clock::TimeAxis,
    seen: &'a mut Vec<Seen>,
    /// Requests to the window.
    requests: Vec<Request>,
    /// Horizontal extents of spectrograms and of plots with two axes: plots over time above and below leave the room of their colour bars.
    bars: Vec<egui::Rangef>,
    /// Horizontal extents of the plots over time.
    columns: Vec<egui::Rangef>,
}

impl Drawing<'_> {
    /// Whether a plot in this part of the window has a spectrogram above or below it.
    fn leaves_room(&self, rect: egui::Rect) -> bool {
        let is_same =
            |bar: &egui::Rangef| (bar.min - rect.left()).abs() < 2.0 && (bar.max - rect.right()).abs() < 2.0;
        self.bars.iter().any(is_same)
    }

    /// Draws a chart.
    fn show(&mut self, ui: &mut Ui, chart: Chart) -> Shown {
        let is_over_time = chart.stack.is_some();
        let shown = chart.show(ui, self.seen);
        if is_over_time {
            self.columns.push(shown.frame.x_range());
        }
        shown
    }
}

impl ViewPanel for Review {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, seen: &mut Vec<Seen>) {
        let is_start = workspace.entries.is_empty();
        self.can_fit = workspace.has_bench;
        let mut requests = self.draw(ui, &mut workspace.entries, seen);
        if is_start {
            egui::CentralPanel::default().show(ui, |ui| requests.extend(start::ui(ui, workspace)));
        }
        workspace.in_sight = self.x;
        workspace.spectra = self.spectra;
        requests.into_iter().for_each(|request| workspace.request(request));
    }

    fn poll(&mut self, ctx: &egui::Context, workspace: &mut Workspace) {
        if let Some(problem) = self.derivations.poll(&wake(ctx), &mut workspace.entries) {
            workspace.request(Request::Warn(problem));
        }
        let aligned = self.take_alignment(&mut workspace.entries);
        aligned.into_iter().for_each(|request| workspace.request(request));
        self.xy.values_mut().for_each(xy::Xy::poll);
        self.spectrograms.values_mut().for_each(spectrogram::Spectrogram::poll);
        self.histograms.values_mut().for_each(histogram::Counted::poll);
    }

    fn is_busy(&self) -> bool {
        self.derivations.is_busy()
            || self.aligning.is_some()
            || self.xy.values().any(xy::Xy::is_busy)
            || self.spectrograms.values().any(spectrogram::Spectrogram::is_busy)
            || self.histograms.values().any(histogram::Counted::is_busy)
    }

    fn has_history(&self) -> bool {
        true
    }

    fn undo(&mut self, workspace: &mut Workspace) {
        self.undo_last(&mut workspace.entries);
    }

    fn redo(&mut self, workspace: &mut Workspace) {
        self.step(&mut workspace.entries, Views::redo);
    }

    fn help() -> Help {
        help::HELP
    }
}

impl Review {
    /// Shows all data.
    pub fn fit(&mut self) {
        self.x = None;
        self.y.clear();
        self.own_x.clear();
    }

    /// The plots, hidden and derived channels.
    #[must_use]
    pub fn arrangement(&self) -> Arrangement {
        Arrangement {
            units: self.units.clone(),
            spectra: self.spectra,
            clock_time: self.clock_time,
            ..self.plots.arrangement(&self.derivations.all)
        }
    }

    /// Shows the plots of a layout.
    pub fn arrange(&mut self, arrangement: &Arrangement) {
        self.plots = Plots::of(arrangement);
        self.derivations.all.clone_from(&arrangement.derived);
        self.units.clone_from(&arrangement.units);
        self.spectra = arrangement.spectra.within_limits();
        self.clock_time = arrangement.clock_time;
    }

    /// Derives a channel.
    pub fn derive(&mut self, derivation: Derivation) {
        self.derivations.add(derivation);
    }

    /// Opens the dialog in which a channel is derived.
    pub fn ask_for_channel(&mut self, of: &str) {
        self.form = Some(Form::of(of, Operation::default()));
    }

    /// Opens the dialog with a formula.
    pub fn ask_for_formula(&mut self, text: &str) {
        self.form = Some(Form::of(text, Operation::Formula));
    }

    /// Adds a plot below the others.
    pub fn add(&mut self, plot: Plot) {
        self.plots.stack(plot, &[]);
    }

    /// The range of time that is shown, s.
    #[must_use]
    pub fn span(&self, entries: &[Entry]) -> [f64; 2] {
        self.x.unwrap_or_else(|| {
            let spans = entries.iter().filter(|entry| entry.shown).filter_map(|entry| {
                entry.recording.samples.span_s().map(|span| span.map(|time| time + entry.shift_s))
            });
            range_of(spans.flatten())
                .map_or([0.0, 1.0], |range| if range[0] < range[1] { range } else { with_room(range) })
        })
    }

    /// Draws the list and the plots. Returns the requests to the window.
    fn draw(&mut self, ui: &mut Ui, entries: &mut Vec<Entry>, seen: &mut Vec<Seen>) -> Vec<Request> {
        let mut requests = Vec::new();
        if let Some(closed) = self.list(ui, entries, &mut requests) {
            let entry = entries.remove(closed);
            self.views.keep_closed(closed, entry);
            self.reference = None;
            if entries.is_empty() {
                self.fit();
            }
        }
        let signals = signals(entries);
        self.plots.fit(&signals);
        if !entries.is_empty() {
            cursors::panel(self, ui, entries, &signals);
        }
        if entries.is_empty() {
            self.dialog(ui, &signals);
            self.remember(ui, entries, &signals);
            return requests;
        }
        egui::CentralPanel::default().show(ui, |ui| {
            requests.extend(self.toolbar(ui, entries, &signals));
            if let Some(job) = self.derivations.job() {
                progress::job(ui, job);
            }
            let x = self.span(entries);
            let drawn = self.plots.drawn(&signals);
            let bars = self.plots.bars();
            let mut drawing = Drawing {
                entries,
                signals: &signals,
                drawn,
                x,
                time_axis: clock::axis(entries, self.clock_time),
                seen,
                requests: Vec::new(),
                bars,
                columns: Vec::new(),
            };
            self.charts(ui, &mut drawing);
            requests.append(&mut drawing.requests);
            requests.extend(self.keys(ui, entries, &signals));
        });
        self.dialog(ui, &signals);
        if let Some(notes) = &mut self.notes
            && !notes.ui(ui.ctx(), entries)
        {
            self.notes = None;
        }
        self.remember(ui, entries, &signals);
        requests
    }

    fn charts(&mut self, ui: &mut Ui, drawing: &mut Drawing<'_>) {
        if self.plots.is_empty() {
            let (title, advice) = if drawing.entries.iter().any(|entry| entry.shown) {
                ("Every channel is hidden", "Tick a channel in the list at the left to draw it.")
            } else {
                ("Every recording is hidden", "Tick a recording in the list at the left to draw it.")
            };
            chart::empty_state(ui, title, advice);
            return;
        }
        self.tiles(ui, drawing);
    }

    fn dialog(&mut self, ui: &Ui, signals: &[Signal]) {
        let Some(form) = &mut self.form else { return };
        let (added, stays) = form.ui(ui.ctx(), signals);
        if let Some(derivation) = added {
            self.derive(derivation);
        }
        if !stays {
            self.form = None;
        }
    }
}

/// The stack of all plots over time: a time stands at the same place in each plot of a column.
fn stack() -> egui::Id {
    egui::Id::unique("plots over time")
}

/// A choice among the channels that are there.
fn choose_signal(ui: &mut Ui, id: (u64, &str), what: &str, chosen: &mut Signal, signals: &[Signal]) {
    let width = (0.5 * ui.max_rect().width() - 40.0).clamp(60.0, 190.0);
    let choice = ComboBox::from_id_salt(id).width(width).selected_text(chosen.label()).truncate();
    let response = choice.show_ui(ui, |ui| {
        for signal in signals {
            ui.selectable_value(chosen, signal.clone(), signal.label());
        }
    });
    response.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, what));
}
