//! The contents of a channel's chart: curves, gaps and events of the recordings that are shown.

use egui::Ui;
use socam_recording::Channel;

use super::entry::Entry;
use crate::draw::chart::{Chart, Curve, Flag, Style};
use crate::samples::envelope;
use crate::theme;

pub(super) fn curves(
    ui: &Ui,
    entries: &[Entry],
    channel: &Channel,
    x: [f64; 2],
    pixels: usize,
) -> Vec<Curve> {
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

/// Shades the gaps between segments of a recording.
pub(super) fn gaps(ui: &Ui, entries: &[Entry], x: [f64; 2], width: f32, drawing: &mut Chart) {
    let per_pixel = (x[1] - x[0]) / f64::from(width.max(1.0));
    for (number, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.shown) {
        let colour = theme::line(ui, number).gamma_multiply(0.16);
        let mut last = f64::NEG_INFINITY;
        for pair in entry.recording.samples.segments().windows(2) {
            let gap = [pair[0].end_s + entry.shift_s, pair[1].start_s + entry.shift_s];
            let visible = gap[1] > x[0] && gap[0] < x[1];
            // Gaps closer than a pixel share one mark.
            if visible && gap[1] - last > per_pixel {
                drawing.shaded.push((gap, colour));
                last = gap[1];
            }
        }
    }
}

pub(super) fn marks(ui: &Ui, entries: &[Entry], x: [f64; 2]) -> Vec<Flag> {
    let mut flags = Vec::new();
    for (number, entry) in entries.iter().enumerate().filter(|(_, entry)| entry.shown) {
        for event in &entry.recording.about.events {
            let at = event.time_s + entry.shift_s;
            // The start of a recording is not marked.
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
    // Simultaneous events of several recordings with the same text are marked once.
    let together = 1e-3 * (x[1] - x[0]);
    flags.dedup_by(|later, earlier| later.text == earlier.text && later.x - earlier.x < together);
    flags
}
