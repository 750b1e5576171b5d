//! Recordings over time: a chart per channel, all with the same time axis, and two cursors.

mod cursors;
mod difference;
mod list;

use std::collections::BTreeSet;

use egui::{Key, RichText, Role, ScrollArea, Sense, Stroke, Ui, WidgetInfo, vec2};
use socam_recording::Channel;

use crate::draw::chart::{self, Chart, Curve, Flag, MarkerShape, Seen, Style, range_of, with_room};
use crate::recording::{Recording, short};
use crate::samples::envelope;
use crate::theme;
pub(crate) use difference::thinned;

/// A recording in the list, and how it is shown.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The recording.
    pub recording: Recording,
    /// Whether it is drawn.
    pub shown: bool,
    /// How much later it is drawn than its own time says, s.
    pub shift_s: f64,
}

/// What the view over time remembers.
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

/// Height below which a chart cannot be read.
const LEAST_HEIGHT: f32 = 92.0;

impl Review {
    /// Shows everything again.
    pub fn fit(&mut self) {
        self.x = None;
        self.y.clear();
    }

    /// Shows a stretch of time, s.
    pub fn show_span(&mut self, x: [f64; 2]) {
        self.x = Some(x);
    }

    /// The time that is shown, s.
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
    pub fn ui(&mut self, ui: &mut Ui, entries: &mut Vec<Entry>, seen: &mut Vec<Seen>) {
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
                let x_moved = self.one(ui, entries, channel, (x, size, is_last), seen);
                moved = moved.or(x_moved);
            }
        });
        if moved.is_some() {
            self.x = moved;
        }
    }

    /// One channel's chart. Returns the time axis where the user moved it.
    fn one(
        &mut self,
        ui: &mut Ui,
        entries: &[Entry],
        channel: &Channel,
        (x, size, is_last): ([f64; 2], egui::Vec2, bool),
        seen: &mut Vec<Seen>,
    ) -> Option<[f64; 2]> {
        let column = channel.column_name();
        let unit = channel.unit.symbol();
        let mut title = format!("{}, {unit}", channel.name);
        let mut drawing = Chart::new(("review", &column), "", size);
        drawing.when_empty = "no value here";
        drawing.x = x;
        if is_last {
            drawing.x_label = "time, s".into();
        }
        match self.reference.filter(|reference| *reference < entries.len()) {
            Some(reference) => {
                title = format!(
                    "{} minus {}, {unit}",
                    channel.name,
                    short(&entries[reference].recording.about.name)
                );
                drawing.curves = difference::curves(ui, entries, reference, channel, x, size.x as usize);
                if drawing.curves.is_empty() {
                    drawing.when_empty = difference::WHY_NONE;
                }
            }
            None => drawing.curves = curves(ui, entries, channel, x, size.x as usize),
        }
        drawing.title = title;
        let values =
            drawing.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
        let own = self.y.iter().find(|(name, _)| *name == column).map(|(_, y)| *y);
        drawing.y = own.unwrap_or_else(|| drawing.fitted(range_of(values)));
        gaps(ui, entries, x, size.x, &mut drawing);
        drawing.flags = marks(ui, entries, x);
        drawing.flag_words = is_last;
        if let Some(cursors) = self.cursors {
            let colour = ui.visuals().strong_text_color();
            let flag = |(x, text): (f64, &str)| Flag { x, text: text.into(), colour };
            drawing.flags.extend(cursors.into_iter().zip(["A", "B"]).map(flag));
            drawing.flags.sort_by(|a, b| a.x.total_cmp(&b.x));
        }
        let shown = drawing.show(ui, seen);
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
}

/// The channels of all recordings that are drawn, each once, in the order in which they first come.
fn channels(entries: &[Entry]) -> Vec<Channel> {
    let mut channels: Vec<Channel> = Vec::new();
    for channel in
        entries.iter().filter(|entry| entry.shown).flat_map(|entry| &entry.recording.about.channels)
    {
        if !channels.contains(channel) {
            channels.push(channel.clone());
        }
    }
    channels
}

fn curves(ui: &Ui, entries: &[Entry], channel: &Channel, x: [f64; 2], pixels: usize) -> Vec<Curve> {
    let mut curves = Vec::new();
    for (number, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.shown) {
        let Some(index) = entry.recording.about.channels.iter().position(|own| own == channel) else {
            continue;
        };
        let shift = entry.shift_s;
        let mut line = envelope(&entry.recording.samples, index, x[0] - shift, x[1] - shift, pixels);
        line.parts.iter_mut().flatten().for_each(|point| point[0] += shift);
        let style = match theme::style(number) {
            Style::Solid if line.sparse => Style::Dotted,
            style => style,
        };
        let name = entry.recording.about.name.clone();
        curves.push(Curve { name, colour: theme::line(ui, number), parts: line.parts, style });
    }
    curves
}

/// Shades what no sample covers between two segments of a recording, as wide as it is.
fn gaps(ui: &Ui, entries: &[Entry], x: [f64; 2], width: f32, drawing: &mut Chart) {
    let per_pixel = (x[1] - x[0]) / f64::from(width.max(1.0));
    for (number, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.shown) {
        let colour = theme::line(ui, number).gamma_multiply(0.16);
        let mut last = f64::NEG_INFINITY;
        for pair in entry.recording.samples.segments().windows(2) {
            let gap = [pair[0].end_s + entry.shift_s, pair[1].start_s + entry.shift_s];
            let visible = gap[1] > x[0] && gap[0] < x[1];
            // Of gaps closer than a pixel one mark is enough.
            if visible && gap[1] - last > per_pixel {
                drawing.shaded.push((gap, colour));
                last = gap[1];
            }
        }
    }
}

fn marks(ui: &Ui, entries: &[Entry], x: [f64; 2]) -> Vec<Flag> {
    let mut flags = Vec::new();
    for (number, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.shown) {
        for event in &entry.recording.about.events {
            let at = event.time_s + entry.shift_s;
            // That it began is no news.
            if (x[0]..=x[1]).contains(&at) && event.kind != "start" {
                let is_grave = event.kind == "fault" || event.kind == "stop";
                let colour =
                    if is_grave { theme::alarm(ui) } else { theme::line(ui, number).gamma_multiply(0.75) };
                let text = if event.kind == "phase" {
                    event.text.clone()
                } else {
                    format!("{}: {}", event.kind, event.text)
                };
                flags.push(Flag { x: at, text, colour });
            }
        }
    }
    flags.sort_by(|a, b| a.x.total_cmp(&b.x).then_with(|| a.text.cmp(&b.text)));
    // Of runs of one profile, what happens to all at once is said once.
    let together = 1e-3 * (x[1] - x[0]);
    flags.dedup_by(|later, earlier| later.text == earlier.text && later.x - earlier.x < together);
    flags
}

/// A small square of a line's colour, with its marker where it has one.
pub(crate) fn swatch(ui: &mut Ui, number: usize, name: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
    let painter = ui.painter();
    let colour = theme::line(ui, number);
    painter.rect(rect, 2.0, colour, Stroke::NONE, egui::StrokeKind::Inside);
    let ink = ui.visuals().extreme_bg_color;
    let corners = |corners: &[(f32, f32)]| {
        let corners = corners.iter().map(|(x, y)| rect.center() + vec2(*x, *y)).collect();
        painter.add(egui::Shape::convex_polygon(corners, ink, Stroke::NONE));
    };
    match theme::marker(number) {
        None => {}
        Some(MarkerShape::Diamond) => corners(&[(0.0, -4.5), (4.5, 0.0), (0.0, 4.5), (-4.5, 0.0)]),
        Some(MarkerShape::Square) => corners(&[(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)]),
        Some(MarkerShape::Up) => corners(&[(0.0, -4.0), (4.0, 3.0), (-4.0, 3.0)]),
        Some(MarkerShape::Down) => corners(&[(0.0, 4.0), (-4.0, -3.0), (4.0, -3.0)]),
        Some(_) => drop(painter.circle_filled(rect.center(), 3.0, ink)),
    }
    let name = name.to_owned();
    response.widget_info(move || WidgetInfo::labeled(Role::Image, true, format!("colour of {name}")));
}
