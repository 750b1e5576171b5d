//! The charts of the watch: measurement and model over each other, and the tests beside their threshold.

use egui::{RichText, Ui, vec2};
use socam_monitoring::{BlockSignals, Overlay, Symptom};

use super::episodes::Episode;
use socam_chart::beside::{self, measured, predicted};
use socam_chart::chart::{self, Chart, Curve, Flag, Seen, Style, range_of};
use socam_chart::theme;

/// A sample between blocks is missing where they lie farther apart than this many sample times.
const APART: f64 = 1.5;

/// Kinds of test statistics, in the order of their colours.
const KINDS: [&str; 3] =
    ["mean of a channel's error", "power of a channel's error", "apparent value of a parameter"];

/// Draws a chart per output, and one of all tests: over the window of the watch, or around the selected alarm.
pub(super) fn draw(
    ui: &mut Ui,
    overlay: &Overlay,
    (selected, episode): (Option<usize>, Option<&Episode>),
    seen: &mut Vec<Seen>,
) {
    let around = episode.map(|episode| Overlay { blocks: episode.blocks.clone(), ..overlay.clone() });
    let overlay = around.as_ref().unwrap_or(overlay);
    let ends = overlay.blocks.iter().flat_map(|block| [block.time_s.first(), block.time_s.last()]);
    let Some(x) = range_of(ends.flatten().copied()) else {
        chart::empty_state(
            ui,
            "Waiting for samples",
            "The model and the measurement appear here block by block.",
        );
        return;
    };
    let place = match (selected, episode.is_some()) {
        (Some(number), true) => format!("around alarm {number}"),
        (Some(number), false) => format!("the last samples (those around alarm {number} are no longer kept)"),
        (None, _) => "the last samples".to_owned(),
    };
    legend(ui, &place);
    let count = overlay.channels.len() + 1;
    let height =
        ((ui.available_height() - chart::X_AXIS - 20.0 - 4.0 * count as f32) / count as f32).max(84.0);
    let flags = flags(ui, overlay, selected, x);
    ui.spacing_mut().item_spacing.y = 3.0;
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for (index, channel) in overlay.channels.iter().enumerate() {
            let title = format!("{}, {}", channel.name, channel.unit);
            let size = vec2(ui.available_width(), height);
            let mut chart = Chart::new(("watch", index), title, size);
            chart.x = x;
            let pixels = size.x as usize;
            chart.curves = vec![
                predicted("model", theme::good(ui), parts(overlay, pixels, |block| &block.model[index])),
                measured(ui, parts(overlay, pixels, |block| &block.measured[index])),
            ];
            let values =
                chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
            chart.y = chart.fitted(range_of(values));
            chart.flags.clone_from(&flags);
            chart.flag_words = false;
            chart.show(ui, seen);
        }
        tests(ui, overlay, (x, height), flags, seen);
    });
}

/// The lines of the charts, and the part of the time that they show.
fn legend(ui: &mut Ui, place: &str) {
    ui.horizontal_wrapped(|ui| {
        beside::legend(ui, "measured", beside::ink(ui), Style::Thin);
        let model = "model, running freely from the start of each block";
        beside::legend(ui, model, theme::good(ui), Style::Broad);
        ui.label(RichText::new(place).small().strong());
    });
}

/// The largest test of each channel or parameter group over time; 1 is the threshold.
fn tests(
    ui: &mut Ui,
    overlay: &Overlay,
    (x, height): ([f64; 2], f32),
    mut flags: Vec<Flag>,
    seen: &mut Vec<Seen>,
) {
    let size = vec2(ui.available_width(), height + chart::X_AXIS);
    let mut chart = Chart::new(("watch", "tests"), "largest test, in units of its threshold", size);
    chart.x = x;
    chart.x_label = "time, s".into();
    chart.when_empty = "nothing was judged yet";
    ui.horizontal_wrapped(|ui| {
        for (number, name) in KINDS.into_iter().enumerate() {
            beside::legend(ui, name, theme::line(ui, number), Style::Solid);
        }
        beside::legend(ui, "threshold", beside::ink(ui), Style::Dashed);
    });
    for (number, name) in KINDS.into_iter().enumerate() {
        let largest = |block: &BlockSignals| {
            let own =
                overlay.statistics.iter().zip(&block.tests).filter(|(symptom, _)| kind(symptom) == number);
            let largest = own.map(|(_, value)| *value).reduce(f64::max);
            largest.zip(block.time_s.last()).map(|(value, time)| [*time, value])
        };
        let line: Vec<[f64; 2]> = overlay.blocks.iter().filter_map(|block| largest(block)).collect();
        let parts = if line.is_empty() { Vec::new() } else { vec![line] };
        let (colour, style) = (theme::line(ui, number), theme::style(number));
        chart.curves.push(Curve { name: name.into(), colour, parts, style });
    }
    let threshold = Curve {
        name: "threshold".into(),
        // Not a colour of one of the tests.
        colour: beside::ink(ui),
        parts: vec![x.map(|x| [x, 1.0]).to_vec()],
        style: Style::Dashed,
    };
    chart.curves.push(threshold);
    let values = chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
    chart.y = chart.fitted(range_of(values.chain([0.0])));
    chart.flags.append(&mut flags);
    chart.show(ui, seen);
}

fn kind(symptom: &Symptom) -> usize {
    match symptom {
        Symptom::Level(_) => 0,
        Symptom::Power(_) => 1,
        Symptom::Parameter(_) => 2,
    }
}

/// Onset and time of each alarm in sight; the selected one is explained.
fn flags(ui: &Ui, overlay: &Overlay, selected: Option<usize>, x: [f64; 2]) -> Vec<Flag> {
    let mut flags = Vec::new();
    for alarm in &overlay.alarms {
        let is_selected = selected.is_none_or(|number| number == alarm.number);
        let colour = theme::alarm(ui).gamma_multiply(if is_selected { 1.0 } else { 0.4 });
        for (at, word) in [(alarm.onset_s, "change"), (alarm.time_s, "alarm")] {
            if (x[0]..=x[1]).contains(&at) {
                flags.push(Flag::new(at, format!("{word} {}", alarm.number), colour));
            }
        }
    }
    flags.sort_by(|a, b| a.x.total_cmp(&b.x));
    flags
}

/// A signal of all blocks, in parts without gaps, thinned to the width of the picture.
fn parts(
    overlay: &Overlay,
    pixels: usize,
    signal: impl Fn(&BlockSignals) -> &Vec<f64>,
) -> Vec<Vec<[f64; 2]>> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for block in &overlay.blocks {
        let step_s = block.time_s.windows(2).next().map_or(f64::INFINITY, |pair| pair[1] - pair[0]);
        if let (Some(last), Some(next)) = (points.last(), block.time_s.first())
            && next - last[0] > APART * step_s
        {
            points.push([*next, f64::NAN]);
        }
        points.extend(block.time_s.iter().zip(signal(block)).map(|(time, value)| [*time, *value]));
    }
    socam_chart::thin::thinned(&points, pixels)
}
