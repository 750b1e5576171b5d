//! The tile of a table of values: the rows in sight of one recording, times and all channels that are drawn.

use std::ops::Range;

use egui::{Align, ComboBox, Layout, RichText, Role, ScrollArea, Ui, WidgetInfo, vec2};

use super::rows::text_of;
use super::{Drawing, Review};
use socam_chart::theme;
use socam_samples::Samples;
use socam_workbench::Request;
use socam_workbench::display_units::DisplayUnits;
use socam_workbench::entry::Entry;
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

/// Widths of the columns of times and of values, height of a row, points.
const TIME: f32 = 110.0;
const VALUE: f32 = 120.0;
const ROW: f32 = 18.0;
/// Most rows that are copied.
const MOST_COPIED: usize = 100_000;

/// A column: its head, the samples and the channel, the factor from SI.
struct Column<'a> {
    head: String,
    samples: &'a Samples,
    channel: usize,
    per_si: f64,
}

impl Review {
    pub(super) fn table_of_values(&mut self, ui: &mut Ui, drawing: &mut Drawing<'_>, tile: u64) {
        let shown: Vec<&Entry> = drawing.entries.iter().filter(|entry| entry.shown).collect();
        let wanted = self.tables.get(&tile).copied();
        let Some(entry) = shown.iter().find(|entry| Some(entry.number) == wanted).or(shown.first()) else {
            return;
        };
        let columns = columns(entry, &drawing.drawn, &self.units);
        let samples = &entry.recording.samples;
        let [from, to] = drawing.x.map(|time| time - entry.shift_s);
        let rows = samples.row_at(from)..samples.row_at(to.next_up()).max(samples.row_at(from));
        let (mut chosen, mut problem) = (entry.number, None);
        ui.horizontal_wrapped(|ui| {
            ui.add_space(4.0);
            ui.label(RichText::new("Values").strong());
            let name = short(&entry.recording.about.name);
            let choice = ComboBox::from_id_salt((tile, "table")).width(160.0).selected_text(name).truncate();
            let choice = choice.show_ui(ui, |ui| {
                for own in &shown {
                    ui.selectable_value(&mut chosen, own.number, short(&own.recording.about.name));
                }
            });
            choice.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "recording"));
            let count = socam_plot::words::counted(rows.len(), "row", "rows");
            let copy = ui.small_button("Copy rows").on_hover_text("As text with tabs, for a spreadsheet");
            if copy.clicked() && rows.len() > MOST_COPIED {
                problem = Some(format!("{count} are in sight and at most {MOST_COPIED} are copied; zoom in"));
            } else if copy.clicked() {
                ui.ctx().copy_text(text(samples, &columns, rows.clone(), entry.shift_s));
            }
            ui.label(RichText::new(format!("{count} in sight")).small().color(theme::weak(ui)));
        });
        drawing.requests.extend(problem.map(Request::Warn));
        if chosen != entry.number {
            self.tables.insert(tile, chosen);
        }
        grid(ui, (tile, samples, &columns), rows, entry.shift_s);
    }
}

fn columns<'a>(entry: &'a Entry, signals: &[Signal], units: &DisplayUnits) -> Vec<Column<'a>> {
    let of = |signal: &Signal| {
        let (samples, channel) = entry.find(signal)?;
        Some(Column { head: units.label(signal), samples, channel, per_si: units.of(signal).per_si })
    };
    signals.iter().filter_map(of).collect()
}

/// Heads, and below them the rows that are in sight of the tile; only these are read.
fn grid(
    ui: &mut Ui,
    (tile, samples, columns): (u64, &Samples, &[Column<'_>]),
    rows: Range<usize>,
    shift_s: f64,
) {
    ScrollArea::horizontal().id_salt((tile, "across")).auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(6.0, 0.0);
        let width = TIME + (VALUE + 6.0) * columns.len() as f32;
        ui.set_min_width(width + 16.0);
        let widths = || std::iter::once(TIME).chain(std::iter::repeat(VALUE));
        let line = |ui: &mut Ui, texts: &mut dyn Iterator<Item = RichText>| {
            ui.horizontal(|ui| {
                for (text, width) in texts.zip(widths()) {
                    let layout = Layout::right_to_left(Align::Center);
                    ui.allocate_ui_with_layout(vec2(width, ROW), layout, |ui| {
                        ui.set_min_width(width);
                        ui.add(egui::Label::new(text).truncate());
                    });
                }
            });
        };
        let heads = std::iter::once("time, s").chain(columns.iter().map(|column| column.head.as_str()));
        let weak = theme::weak(ui);
        line(ui, &mut heads.map(|head| RichText::new(head).small().color(weak)));
        ui.separator();
        let scroll = ScrollArea::vertical().id_salt((tile, "rows")).auto_shrink(false);
        scroll.show_rows(ui, ROW, rows.len(), |ui, seen| {
            let part = rows.start + seen.start..(rows.start + seen.end).min(rows.end);
            for cells in cells(samples, columns, part, shift_s) {
                line(ui, &mut cells.into_iter().map(|cell| RichText::new(cell).monospace()));
            }
        });
    });
}

/// The texts of rows: the time, then the values.
fn cells(samples: &Samples, columns: &[Column<'_>], rows: Range<usize>, shift_s: f64) -> Vec<Vec<String>> {
    let of = |column: &Column<'_>| column.samples.values(column.channel, rows.clone());
    let values: Vec<Vec<f64>> = columns.iter().map(of).collect();
    let row = |(row, time): (usize, f64)| {
        let value = |(column, values): (&Column<'_>, &Vec<f64>)| match values[row] {
            value if value.is_finite() => text_of(Some(column.per_si * value)),
            _ => "no value".into(),
        };
        let time = format!("{:.6}", time + shift_s);
        std::iter::once(time).chain(columns.iter().zip(&values).map(value)).collect()
    };
    samples.times(rows.clone()).into_iter().enumerate().map(row).collect()
}

fn text(samples: &Samples, columns: &[Column<'_>], rows: Range<usize>, shift_s: f64) -> String {
    let heads = std::iter::once("time, s").chain(columns.iter().map(|column| column.head.as_str()));
    let lines = cells(samples, columns, rows, shift_s).into_iter().map(|cells| cells.join("\t"));
    let lines = std::iter::once(heads.collect::<Vec<_>>().join("\t")).chain(lines);
    lines.collect::<Vec<_>>().join("\n") + "\n"
}
