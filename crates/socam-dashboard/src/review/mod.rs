//! Recordings over time: a chart per channel, all with the same time axis, and two cursors.

mod content;
mod cursors;
mod difference;
mod entry;
mod list;

use std::collections::BTreeSet;

use egui::{Key, RichText, ScrollArea, Ui, vec2};
use socam_recording::Channel;

use crate::draw::chart::{self, Chart, Flag, Seen, range_of, with_room};
use crate::recording::short;
use crate::theme;
use crate::view::{Help, ViewPanel};
use crate::workspace::Workspace;
pub(crate) use difference::thinned;
pub use entry::Entry;
use entry::channels;
pub(crate) use entry::swatch;

/// State of the view over time.
#[derive(Debug, Default)]
pub struct Review {
    /// The time axis of all charts, s; `None` shows everything.
    x: Option<[f64; 2]>,
    /// Vertical axes that the user set, by channel column name.
    y: Vec<(String, [f64; 2])>,
    /// Names of channels that are hidden.
    hidden: BTreeSet<String>,
    /// Cursors A and B, s.
    pub cursors: Option<[f64; 2]>,
    /// Which cursor the next click moves.
    next: usize,
    /// The recording that others are compared with.
    pub reference: Option<usize>,
}

impl ViewPanel for Review {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        self.draw(ui, &mut workspace.entries, &mut workspace.seen);
    }

    fn help() -> Help {
        &[
            (
                "drag; wheel; Shift+wheel",
                "pan, zoom, scroll; dragging with the right button zooms to a box (Esc cancels), a click of it copies the picture; the axes can be dragged",
            ),
            ("Fit all; Home; double click", "shows everything; arrows pan and zoom"),
            (
                "Cursors A, B; C; click",
                "cursors A and B, set in turns by clicks; the table below has values and differences",
            ),
            ("Zoom to A..B", "shows what is between the cursors"),
            ("a name; Close ...", "shows or hides a recording or a channel; closes it"),
            ("shift of ...", "0.000 s beside a recording: draws it so much later or earlier"),
            ("Difference to", "draws every other recording minus this one"),
            ("shaded; vertical lines", "gaps, and events of the recording"),
        ]
    }
}

/// Least height of a chart, points.
const LEAST_HEIGHT: f32 = 92.0;

impl Review {
    /// Shows all data.
    pub fn fit(&mut self) {
        self.x = None;
        self.y.clear();
    }

    /// Shows a range of time, s.
    pub fn show_span(&mut self, x: [f64; 2]) {
        self.x = Some(x);
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

    /// Draws the list and the charts.
    fn draw(&mut self, ui: &mut Ui, entries: &mut Vec<Entry>, seen: &mut Vec<Seen>) {
        if let Some(closed) = list::panel(self, ui, entries) {
            entries.remove(closed);
            self.reference = None;
        }
        if !entries.is_empty() {
            cursors::panel(self, ui, entries);
        }
        egui::CentralPanel::default().show(ui, |ui| {
            if entries.is_empty() {
                chart::empty_state(
                    ui,
                    "No recording is open",
                    "Drop .mcap, .csv or .m files here, or press Ctrl+O. Several can be open at a time: each gets its own colour.",
                );
                return;
            }
            self.toolbar(ui, entries);
            self.charts(ui, entries, seen);
            self.keys(ui, entries);
        });
    }

    fn toolbar(&mut self, ui: &mut Ui, entries: &[Entry]) {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Fit all").on_hover_text("Show everything (Home, or double-click a chart)").clicked()
            {
                self.fit();
            }
            let mut on = self.cursors.is_some();
            if ui
                .toggle_value(&mut on, "Cursors A, B")
                .on_hover_text("Click a chart to set A, then B (C)")
                .clicked()
            {
                self.toggle_cursors(entries);
            }
            if let Some([a, b]) = self.cursors
                && ui.button("Zoom to A..B").clicked()
                && a != b
            {
                self.x = Some([a.min(b), a.max(b)]);
            }
            if entries.len() > 1 {
                ui.separator();
                let label = ui.label("Difference to");
                let name = |index: Option<usize>| {
                    index
                        .and_then(|i| entries.get(i))
                        .map_or("none", |entry| short(&entry.recording.about.name))
                };
                let chosen = egui::ComboBox::from_id_salt("reference")
                    .selected_text(name(self.reference))
                    .width(150.0);
                let chosen = chosen.show_ui(ui, |ui| {
                    ui.selectable_value(&mut self.reference, None, "none");
                    for index in 0..entries.len() {
                        ui.selectable_value(&mut self.reference, Some(index), name(Some(index)));
                    }
                });
                chosen.response.labelled_by(label.id);
            }
            ui.label(
                RichText::new("drag: pan   wheel: zoom   Shift+wheel: scroll   right-drag: zoom to box")
                    .small()
                    .color(theme::weak(ui)),
            );
        });
    }

    fn toggle_cursors(&mut self, entries: &[Entry]) {
        let [from, to] = self.span(entries);
        self.cursors = match self.cursors {
            Some(_) => None,
            None => Some([from + (to - from) / 3.0, from + (to - from) * 2.0 / 3.0]),
        };
        self.next = 0;
    }

    fn keys(&mut self, ui: &Ui, entries: &[Entry]) {
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key| ui.input(|input| input.key_pressed(key) && input.modifiers.is_none());
        let [from, to] = self.span(entries);
        let width = to - from;
        if pressed(Key::Home) {
            self.fit();
        }
        if pressed(Key::C) {
            self.toggle_cursors(entries);
        }
        for (key, by) in [(Key::ArrowLeft, -0.1), (Key::ArrowRight, 0.1)] {
            if pressed(key) {
                self.x = Some([from + by * width, to + by * width]);
            }
        }
        for (key, by) in [(Key::ArrowUp, 0.2), (Key::ArrowDown, -0.25)] {
            if pressed(key) {
                self.x = Some([from + by * 0.5 * width, to - by * 0.5 * width]);
            }
        }
    }

    fn charts(&mut self, ui: &mut Ui, entries: &[Entry], seen: &mut Vec<Seen>) {
        let channels: Vec<Channel> = channels(entries)
            .into_iter()
            .filter(|channel| !self.hidden.contains(&channel.column_name()))
            .collect();
        if channels.is_empty() {
            let (title, advice) = if entries.iter().any(|entry| entry.shown) {
                ("Every channel is hidden", "Tick a channel in the list at the left to draw it.")
            } else {
                ("Every recording is hidden", "Tick a recording in the list at the left to draw it.")
            };
            chart::empty_state(ui, title, advice);
            return;
        }
        let room = ui.available_size();
        let spacing = 3.0;
        let axis = chart::X_AXIS;
        let height =
            ((room.y - axis - spacing * channels.len() as f32) / channels.len() as f32).max(LEAST_HEIGHT);
        let x = self.span(entries);
        let mut moved = None;
        let bars_only =
            egui::scroll_area::ScrollSource { scroll_bar: true, ..egui::scroll_area::ScrollSource::NONE };
        ScrollArea::vertical().scroll_source(bars_only).auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = spacing;
            for (index, channel) in channels.iter().enumerate() {
                let is_last = index + 1 == channels.len();
                let size = vec2(ui.available_width(), if is_last { height + axis } else { height });
                let x_moved = self.channel_chart(ui, entries, channel, (x, size, is_last), seen);
                moved = moved.or(x_moved);
            }
        });
        if moved.is_some() {
            self.x = moved;
        }
    }

    /// Draws the chart of one channel. Returns the time axis where the user moved it.
    fn channel_chart(
        &mut self,
        ui: &mut Ui,
        entries: &[Entry],
        channel: &Channel,
        (x, size, is_last): ([f64; 2], egui::Vec2, bool),
        seen: &mut Vec<Seen>,
    ) -> Option<[f64; 2]> {
        let column = channel.column_name();
        let chart = self.contents(ui, entries, channel, (x, size, is_last));
        let shown = chart.show(ui, seen);
        if shown.response.double_clicked() {
            self.fit();
            return None;
        }
        if shown.response.clicked()
            && let (Some(cursors), Some(at)) = (&mut self.cursors, shown.pointer_x)
        {
            cursors[self.next % 2] = at;
            self.next += 1;
        }
        if shown.y_moved {
            self.y.retain(|(name, _)| *name != column);
            self.y.push((column, shown.y));
        }
        shown.x_moved.then_some(shown.x)
    }

    /// The chart of one channel: curves, or differences to the reference, with gaps, events and cursors.
    fn contents(
        &self,
        ui: &Ui,
        entries: &[Entry],
        channel: &Channel,
        (x, size, is_last): ([f64; 2], egui::Vec2, bool),
    ) -> Chart {
        let column = channel.column_name();
        let unit = channel.unit.symbol();
        let mut chart = Chart::new(("review", &column), format!("{}, {unit}", channel.name), size);
        chart.when_empty = "no value here";
        chart.x = x;
        if is_last {
            chart.x_label = "time, s".into();
        }
        match self.reference.filter(|reference| *reference < entries.len()) {
            Some(reference) => {
                let name = short(&entries[reference].recording.about.name);
                chart.title = format!("{} minus {name}, {unit}", channel.name);
                chart.curves = difference::curves(ui, entries, reference, channel, x, size.x as usize);
                if chart.curves.is_empty() {
                    chart.when_empty = difference::WHY_NONE;
                }
            }
            None => chart.curves = content::curves(ui, entries, channel, x, size.x as usize),
        }
        let values = chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
        let set_by_user = self.y.iter().find(|(name, _)| *name == column).map(|(_, y)| *y);
        chart.y = set_by_user.unwrap_or_else(|| chart.fitted(range_of(values)));
        content::gaps(ui, entries, x, size.x, &mut chart);
        chart.flags = content::marks(ui, entries, x);
        chart.flag_words = is_last;
        if let Some(cursors) = self.cursors {
            let colour = ui.visuals().strong_text_color();
            let flag = |(x, text): (f64, &str)| Flag { x, text: text.into(), colour };
            chart.flags.extend(cursors.into_iter().zip(["A", "B"]).map(flag));
            chart.flags.sort_by(|a, b| a.x.total_cmp(&b.x));
        }
        chart
    }
}
