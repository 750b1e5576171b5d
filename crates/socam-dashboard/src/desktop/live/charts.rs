//! The charts of the live view: one for each channel, with its numbers beside it.

use egui::{Label, RichText, Ui, vec2};

use super::Live;
use super::readings::{self, Reading};
use socam_chart::chart::{self, Chart, Curve, Flag, Seen, Style, range_of};
use socam_chart::theme;
use socam_workbench::about::Happening;
use socam_workbench::connection::{Connection, Link};

impl Live {
    /// Draws the charts.
    pub(super) fn charts(&mut self, ui: &mut Ui, bench: &Connection, seen: &mut Vec<Seen>) {
        if bench.buffer().rows() == 0 {
            let (title, advice) = match bench.link() {
                Link::Closed => (
                    "No board is connected",
                    "Name a device at the left and press Connect: `sim` is a virtual bench in this program, `serial` the board on USB, `tcp:HOST:PORT` one behind a network.",
                ),
                _ => (
                    "Waiting for samples",
                    "The board is connected; its channels appear here as soon as it measures.",
                ),
            };
            chart::empty_state(ui, title, advice);
            return;
        }
        self.tools(ui, bench);
        let readings = self.readings(bench, ui.input(|input| input.time));
        let channels = self.shown(bench).channels().len().max(1) as f32;
        let height = ((ui.available_height() - chart::X_AXIS - 4.0 * channels) / channels).max(70.0);
        // Until the window is full, samples begin at its left edge.
        let from_s = (self.shown(bench).end_s() - self.window_s).max(0.0);
        ui.spacing_mut().item_spacing.y = 3.0;
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            self.rows(ui, bench, ([from_s, from_s + self.window_s], height), &readings, seen);
        });
    }

    /// A chart and the numbers of each channel, one below the other.
    fn rows(
        &self,
        ui: &mut Ui,
        bench: &Connection,
        (x, height): ([f64; 2], f32),
        readings: &[Reading],
        seen: &mut Vec<Seen>,
    ) {
        let buffer = self.shown(bench);
        let beside = readings::width(ui.available_width());
        let width = ui.available_width() - beside - ui.spacing().item_spacing.x;
        let blocks = buffer.blocks(x, width as usize);
        let (flags, gaps) = (flags(ui, bench, x), self.gaps(ui, bench, x, width));
        for ((index, channel), reading) in buffer.channels().iter().enumerate().zip(readings) {
            let is_last = index + 1 == buffer.channels().len();
            let size = vec2(width, if is_last { height + chart::X_AXIS } else { height });
            let parts = buffer.line(index, &blocks);
            let mut drawing =
                Chart::new(("live", index), format!("{}, {}", channel.name, channel.unit), size);
            drawing.x = x;
            drawing.x_label =
                if is_last { "time since the link was opened, s".into() } else { String::new() };
            drawing.y = drawing.fitted(range_of(parts.iter().flatten().map(|point| point[1])));
            drawing.flags.clone_from(&flags);
            drawing.flag_words = is_last;
            drawing.shaded.clone_from(&gaps);
            let name = channel.name.clone();
            drawing.curves = vec![Curve { name, colour: theme::line(ui, index), parts, style: Style::Solid }];
            ui.horizontal_top(|ui| {
                drawing.show(ui, seen);
                readings::draw(ui, channel, reading, vec2(beside, height));
            });
        }
    }

    /// Draws the controls of the charts, and the number of samples that were lost.
    fn tools(&mut self, ui: &mut Ui, bench: &Connection) {
        ui.horizontal_wrapped(|ui| {
            let mut is_held = self.held.is_some();
            let hold = ui.toggle_value(&mut is_held, "Hold picture");
            if hold.on_hover_text("The bench and the recording go on").changed() {
                self.held = is_held.then(|| bench.buffer().clone());
            }
            ui.label("Window");
            for window_s in [2.0, 10.0, 30.0, 60.0] {
                ui.selectable_value(&mut self.window_s, window_s, format!("{window_s} s"));
            }
            let [missed, gaps] = self.shown(bench).missed();
            if missed > 0 {
                let plural = |count: u64, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
                let text = format!("{} missing in {}", plural(missed, "sample"), plural(gaps, "gap"));
                let why = "They did not arrive from the board, or the window did not draw for a minute; gaps are shaded. A recording does not pass through the window: what it has is said at the left.";
                let words = RichText::new(text).small().color(theme::alarm(ui));
                ui.add(Label::new(words).extend()).on_hover_text(why);
            }
        });
    }

    /// Gaps in the samples; those that share a pixel share a mark.
    fn gaps(&self, ui: &Ui, bench: &Connection, x: [f64; 2], width: f32) -> Vec<([f64; 2], egui::Color32)> {
        let colour = theme::weak(ui).gamma_multiply(0.3);
        let per_pixel = (x[1] - x[0]) / f64::from(width.max(1.0));
        let mut gaps: Vec<([f64; 2], egui::Color32)> = Vec::new();
        for [from, to] in self.shown(bench).holes().iter().map(|hole| hole.span) {
            let is_new = gaps.last().is_none_or(|(last, _)| to - last[1] > per_pixel);
            if is_new && to > x[0] && from < x[1] {
                gaps.push(([from.max(x[0]), to.min(x[1])], colour));
            }
        }
        gaps
    }
}

/// Notes, stops, faults and the beginning of a run.
fn flags(ui: &Ui, bench: &Connection, x: [f64; 2]) -> Vec<Flag> {
    let visible = bench.events().iter().filter(|event| (x[0]..=x[1]).contains(&event.time_s));
    let flag = |event: &Happening| {
        let is_grave = event.kind == "fault" || event.kind == "stop";
        let colour = if is_grave { theme::alarm(ui) } else { theme::weak(ui) };
        let text = match event.kind.as_str() {
            "start" => event.text.clone(),
            kind => format!("{kind}: {}", event.text),
        };
        Flag { x: event.time_s, text, colour }
    };
    visible.map(flag).collect()
}
