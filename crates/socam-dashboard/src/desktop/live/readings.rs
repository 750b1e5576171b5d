//! Numbers beside the charts: the present value of each channel, its extremes in the run, its limit.

use egui::{Align2, FontId, Pos2, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::Live;
use socam_chart::theme;
use socam_recording::Unit;
use socam_workbench::connection::Connection;

/// Time between two pictures of the numbers, s: faster ones cannot be read.
const EVERY_S: f64 = 0.2;

/// Content of the numbers beside a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reading {
    pub(super) value: f32,
    /// Least and greatest value since the run began.
    pub(super) extremes: Option<[f32; 2]>,
    pub(super) limit: Option<f64>,
}

/// The readings that are shown, and since when, s.
#[derive(Debug, Default)]
pub(super) struct Readings {
    shown: Vec<Reading>,
    since_s: f64,
}

impl Live {
    /// The readings of all channels; they change five times a second.
    pub(super) fn readings(&mut self, bench: &Connection, now_s: f64) -> Vec<Reading> {
        let channels = self.shown(bench).channels().len();
        let is_due = !(0.0..EVERY_S).contains(&(now_s - self.readings.since_s));
        if is_due || self.readings.shown.len() != channels {
            let reading = |channel| Reading {
                value: self.shown(bench).latest(channel),
                extremes: bench.last_run().and_then(|run| run.extremes(channel)),
                limit: bench.limit(channel),
            };
            let shown = (0..channels).map(reading).collect();
            self.readings = Readings { shown, since_s: now_s };
        }
        self.readings.shown.clone()
    }
}

/// Width of the numbers, points: with and without room to spare.
pub(super) fn width(room: f32) -> f32 {
    if room > 560.0 { 172.0 } else { 116.0 }
}

/// Draws a reading: large digits and a unit, then extremes and limit.
pub(super) fn draw(ui: &mut Ui, channel: &socam_recording::Channel, reading: &Reading, size: egui::Vec2) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let decimals = decimals(reading);
    let number = |value: f32| rounded(value, decimals);
    let value = if reading.value.is_finite() { number(reading.value) } else { "none".into() };
    let unit = if channel.unit == Unit::One { String::new() } else { channel.unit.to_string() };
    let is_wide = size.x > 150.0;
    let large = if is_wide { (0.28 * size.y).clamp(20.0, 34.0) } else { 17.0 };
    let painter = ui.painter_at(rect);
    let colour = ui.visuals().strong_text_color();
    // The unit has a fixed place, so that the digits of all channels end at the same one.
    let unit_at = rect.right() - if is_wide { 38.0 } else { 34.0 };
    let base = rect.top() + large + 8.0;
    painter.text(pos2(unit_at, base), Align2::RIGHT_BOTTOM, &value, FontId::monospace(large), colour);
    let small = FontId::proportional(11.5);
    let beside = pos2(unit_at + 4.0, base - 0.14 * large);
    painter.text(beside, Align2::LEFT_BOTTOM, &unit, small.clone(), colour);
    let mut lines = Vec::new();
    if let Some([low, high]) = reading.extremes {
        lines.push(format!("{} to {}", number(low), number(high)));
    }
    if let Some(limit) = reading.limit {
        lines.push(format!("limit ±{limit:.decimals$}"));
    }
    for (line, text) in lines.iter().enumerate() {
        let at: Pos2 = pos2(unit_at, base + 2.0) + vec2(0.0, 14.0 * line as f32);
        painter.text(at, Align2::RIGHT_TOP, text, small.clone(), theme::weak(ui));
    }
    let said = format!("{} is {value} {unit}; {}", channel.name, lines.join(", "));
    let why = "The latest value; then the least and the greatest value since the run began, and the magnitude at which the run is stopped";
    response.on_hover_text(why).widget_info(|| WidgetInfo::labeled(Role::Label, true, said.clone()));
}

/// A number of so many decimals; zero has no sign.
fn rounded(value: f32, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|digit| matches!(digit, '0' | '.')) => rest.to_owned(),
        _ => text,
    }
}

/// Number of decimals: four digits of the limit, or of the largest value where there is none, so that the width does not change with each sample.
fn decimals(reading: &Reading) -> usize {
    let largest = reading.extremes.map_or(0.0, |[low, high]| f64::from(low.abs().max(high.abs())));
    let scale = reading.limit.unwrap_or(if largest > 0.0 { largest } else { 10.0 });
    (3.0 - scale.log10().floor()).clamp(0.0, 4.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        assert_eq!([rounded(-0.004, 2), rounded(-0.0, 1), rounded(-0.006, 2)], ["0.00", "0.0", "-0.01"]);
    }

    #[test]
    fn four_digits_are_shown_at_the_limit() {
        let decimals = |limit, high| {
            let extremes = Some([0.0, high]);
            decimals(&Reading { value: 0.0, extremes, limit })
        };
        assert_eq!(
            [decimals(Some(149.2), 3.0), decimals(Some(4.8), 3.0), decimals(Some(38.0), 3.0)],
            [1, 3, 2]
        );
        assert_eq!([decimals(None, 0.0), decimals(None, 2500.0), decimals(None, 0.004)], [2, 0, 4]);
    }
}
