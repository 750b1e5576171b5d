//! The charts of the live view: one for each channel, with its numbers beside it.

use egui::{Label, RichText, Ui, vec2};

use super::Live;
use super::readings::{self, Reading};
use socam_chart::chart::{self, Chart, Curve, Flag, Scale, Seen, Style, range_of};
use socam_chart::theme;
use socam_recording::{Channel, Unit};
use socam_workbench::about::Happening;
use socam_workbench::connection::{Connection, Link};

/// Label of the horizontal axis.
const TIME: &str = "time since the link was opened, s";

impl Live {
    /// Draws the charts.
    pub(super) fn charts(&mut self, ui: &mut Ui, bench: &Connection, seen: &mut Vec<Seen>) {
        if bench.buffer().rows() == 0 {
            let (title, advice) = match bench.link() {
                Link::Closed => (
                    "No device is connected",
                    "Name one at the left and press Connect: `sim` is a virtual bench in this program, `serial` the board on USB. Forms lists others, such as lines of text, drives and CAN buses.",
                ),
                _ => (
                    "Waiting for samples",
                    "The device is asked, or listened to; its channels appear here as soon as it sends.",
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
        let x = [from_s, from_s + self.window_s];
        let room = ui.available_height();
        let is_scrolled = (height + 3.0) * channels + chart::X_AXIS > room + 1.0;
        let part = if is_scrolled { room - chart::X_AXIS } else { room };
        let charts = egui::ScrollArea::vertical().auto_shrink(false).max_height(part);
        let columns = charts.show(ui, |ui| self.rows(ui, bench, (x, height), &readings, seen)).inner;
        if is_scrolled {
            chart::ruler(ui, &columns, x, Scale::Linear, TIME);
        }
    }

    /// A chart and the numbers of each channel, one below the other.
    fn rows(
        &self,
        ui: &mut Ui,
        bench: &Connection,
        (x, height): ([f64; 2], f32),
        readings: &[Reading],
        seen: &mut Vec<Seen>,
    ) -> Vec<egui::Rangef> {
        let mut columns = Vec::new();
        let buffer = self.shown(bench);
        let beside = readings::width(ui.available_width());
        let width = ui.available_width() - beside - ui.spacing().item_spacing.x;
        let blocks = buffer.blocks(x, width as usize);
        let (flags, gaps) = (flags(ui, bench, x), self.gaps(ui, bench, x, width));
        for ((index, channel), reading) in buffer.channels().iter().enumerate().zip(readings) {
            let is_last = index + 1 == buffer.channels().len();
            let size = vec2(width, if is_last { height + chart::X_AXIS } else { height });
            let parts = buffer.line(index, &blocks);
            let mut drawing = Chart::new(("live", index), title(channel), size);
            drawing.x = x;
            drawing.x_label = if is_last { TIME.into() } else { String::new() };
            let range = range_of(parts.iter().flatten().map(|point| point[1]));
            let (range, has_limit) = with_limit(range, reading.limit);
            drawing.y = drawing.fitted(range);
            drawing.flags.clone_from(&flags);
            drawing.flag_words = is_last;
            drawing.shaded.clone_from(&gaps);
            let name = channel.name.clone();
            drawing.curves = vec![Curve { name, colour: theme::line(ui, index), parts, style: Style::Solid }];
            if let Some(limit) = reading.limit.filter(|_| has_limit) {
                drawing.curves.push(Curve {
                    name: limit_words(bench).into(),
                    colour: theme::alarm(ui),
                    parts: [-limit, limit].map(|level| x.map(|x| [x, level]).to_vec()).to_vec(),
                    style: Style::Dashed,
                });
            }
            ui.horizontal_top(|ui| {
                columns.push(drawing.show(ui, seen).frame.x_range());
                readings::draw(ui, channel, reading, vec2(beside, height));
            });
        }
        columns
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
                let why = "They did not arrive from the device, or the window did not draw for a minute; gaps are shaded. A recording does not pass through the window: what it has is said at the left.";
                let words = RichText::new(text).small().color(theme::alarm(ui));
                ui.add(Label::new(words).extend()).on_hover_text(why);
            }
        });
    }

    /// Gaps in which samples were lost, not pauses such as of a board that is set up; those that share a pixel share a mark.
    fn gaps(&self, ui: &Ui, bench: &Connection, x: [f64; 2], width: f32) -> Vec<([f64; 2], egui::Color32)> {
        let colour = theme::weak(ui).gamma_multiply(0.3);
        let per_pixel = (x[1] - x[0]) / f64::from(width.max(1.0));
        let mut gaps: Vec<([f64; 2], egui::Color32)> = Vec::new();
        for [from, to] in
            self.shown(bench).holes().iter().filter(|hole| hole.missed > 0).map(|hole| hole.span)
        {
            let is_new = gaps.last().is_none_or(|(last, _)| to - last[1] > per_pixel);
            if is_new && to > x[0] && from < x[1] {
                gaps.push(([from.max(x[0]), to.min(x[1])], colour));
            }
        }
        gaps
    }
}

/// Name and unit of a channel; a plain number, as of a device that states no unit, has none.
fn title(channel: &Channel) -> String {
    if channel.unit == Unit::One {
        channel.name.clone()
    } else {
        format!("{}, {}", channel.name, channel.unit)
    }
}

/// What the line of a limit is.
fn limit_words(bench: &Connection) -> &'static str {
    if bench.offer().is_some() { "limit of the run" } else { "limit at which the board stops" }
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
        Flag::new(event.time_s, text, colour)
    };
    visible.map(flag).collect()
}

/// Share of a limit that a chart spans at least: noise of a bench at rest is not enlarged to fill it.
const LEAST_SPAN: f64 = 0.02;
/// Share of a limit from which on it is drawn.
const NEAR: f64 = 0.6;

/// The range of a chart with a limit, and whether the lines of the limit are in it.
fn with_limit(range: Option<[f64; 2]>, limit: Option<f64>) -> (Option<[f64; 2]>, bool) {
    let (Some([low, high]), Some(limit)) = (range, limit) else { return (range, false) };
    if low.abs().max(high.abs()) > NEAR * limit {
        return (Some([low.min(-limit), high.max(limit)]), true);
    }
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low).max(LEAST_SPAN * limit));
    (Some([middle - half, middle + half]), false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_at_rest_stays_small_and_a_limit_is_drawn_when_it_is_near() {
        let (range, has_limit) = with_limit(Some([-0.01, 0.03]), Some(100.0));
        assert_eq!((range, has_limit), (Some([-0.99, 1.01]), false));
        assert_eq!(with_limit(Some([-10.0, 70.0]), Some(100.0)), (Some([-100.0, 100.0]), true));
        assert_eq!(with_limit(Some([-10.0, 50.0]), Some(100.0)), (Some([-10.0, 50.0]), false));
        assert_eq!(with_limit(Some([-1.0, 1.0]), None), (Some([-1.0, 1.0]), false));
    }
}
