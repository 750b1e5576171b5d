//! The contents of a plot over time: curves, gaps and events of the recordings that are shown.

use egui::{Color32, Ui};

use socam_chart::chart::{Chart, Curve, Flag, MarkerShape, Style};
use socam_chart::theme;
use socam_samples::envelope;
use socam_workbench::display_units::{DisplayUnits, ShownIn};
use socam_workbench::entry::{Entry, name_among};
use socam_workbench::signal::Signal;

/// Opacity of the other recordings while one is highlighted.
const DIMMED: f32 = 0.16;
/// Markers of the second and later channels of a plot, with their names.
const MARKERS: [(MarkerShape, &str); 4] = [
    (MarkerShape::Diamond, "diamonds"),
    (MarkerShape::Square, "squares"),
    (MarkerShape::Up, "triangles"),
    (MarkerShape::Circle, "circles"),
];

/// Range and size for which curves are made.
#[derive(Clone, Copy)]
pub(super) struct Frame<'a> {
    /// The time axis, s.
    pub(super) x: [f64; 2],
    pub(super) pixels: usize,
    /// Number of the recording that is highlighted.
    pub(super) lit: Option<usize>,
    pub(super) units: &'a DisplayUnits,
    /// Whether the plot has several channels, so that curves are named by them.
    pub(super) is_shared: bool,
    /// Number of channels of the plot before those of which curves are made.
    pub(super) first: usize,
}

/// The channels of a plot with those of the left axis first, and the number of these.
pub(super) fn by_axis(signals: &[Signal]) -> (Vec<Signal>, usize) {
    let is_left = |signal: &&Signal| signals.first().is_some_and(|first| first.unit == signal.unit);
    let (left, right): (Vec<&Signal>, Vec<&Signal>) = signals.iter().partition(is_left);
    (left.iter().chain(&right).map(|signal| (*signal).clone()).collect(), left.len())
}

/// The unit of a plot's axis: that of its first channel.
pub(super) fn axis(signals: &[Signal], units: &DisplayUnits) -> ShownIn {
    signals.first().map_or_else(|| ShownIn { unit: String::new(), per_si: 1.0 }, |first| units.of(first))
}

/// The recordings that are shown and have a channel, the highlighted one last, on top of the others.
pub(super) fn having<'a>(
    entries: &'a [Entry],
    signal: &Signal,
    lit: Option<usize>,
) -> Vec<(&'a Entry, &'a std::sync::Arc<socam_samples::Samples>, usize)> {
    let shown = entries.iter().filter(|entry| entry.shown);
    let mut found: Vec<_> = shown
        .filter_map(|entry| entry.find(signal).map(|(samples, channel)| (entry, samples, channel)))
        .collect();
    found.sort_by_key(|(entry, ..)| Some(entry.number) == lit);
    found
}

/// The colour of a recording's lines: dimmed beside a highlighted one, and paler where many lie on each other.
pub(super) fn colour(ui: &Ui, entry: &Entry, lit: Option<usize>, curves: usize) -> Color32 {
    let colour = theme::line(ui, entry.number);
    match lit {
        Some(lit) if lit != entry.number => colour.gamma_multiply(DIMMED),
        Some(_) => colour,
        None => colour.gamma_multiply((8.0 / curves.max(1) as f32).sqrt().clamp(0.35, 1.0)),
    }
}

pub(super) fn curves(ui: &Ui, entries: &[Entry], signals: &[Signal], frame: Frame<'_>) -> Vec<Curve> {
    let mut curves = Vec::new();
    let per_si = axis(signals, frame.units).per_si;
    for (place, signal) in signals.iter().enumerate() {
        let place = place + frame.first;
        let having = having(entries, signal, frame.lit);
        for (entry, samples, channel) in &having {
            let shift = entry.shift_s;
            let mut line = envelope(samples, *channel, frame.x[0] - shift, frame.x[1] - shift, frame.pixels);
            line.parts.iter_mut().flatten().for_each(|point| *point = [point[0] + shift, per_si * point[1]]);
            let style = match (place, theme::style(entry.number)) {
                (0, Style::Solid) if line.sparse => Style::Dotted,
                (0, style) => style,
                _ => Style::Marked(MARKERS[(place - 1) % MARKERS.len()].0),
            };
            let name = if frame.is_shared {
                format!("{} of {}", signal.name, name_among(entries, entry))
            } else {
                name_among(entries, entry).to_owned()
            };
            let colour = tinted(ui, colour(ui, entry, frame.lit, having.len()), place);
            curves.push(Curve { name, colour, parts: line.parts, style });
        }
    }
    curves
}

/// The samples of the curves that are nearest to a time, s, in the order of [`curves`].
pub(super) fn readings(
    entries: &[Entry],
    signals: &[Signal],
    frame: Frame<'_>,
    at: f64,
) -> Vec<Option<[f64; 2]>> {
    let mut readings = Vec::new();
    let per_si = axis(signals, frame.units).per_si;
    for signal in signals {
        readings.extend(having(entries, signal, frame.lit).into_iter().map(|(entry, samples, channel)| {
            let nearest = samples.value_at(channel, at - entry.shift_s);
            nearest.map(|[time, value]| [time + entry.shift_s, per_si * value])
        }));
    }
    readings
}

/// Later channels of a plot are between the recording's colour and that of the text.
fn tinted(ui: &Ui, colour: Color32, place: usize) -> Color32 {
    let share = [0.0, 0.55, 0.3, 0.75][place % 4];
    let ink = ui.visuals().strong_text_color().gamma_multiply(f32::from(colour.a()) / 255.0);
    colour.lerp_to_gamma(ink, share)
}

/// Names of the channels of a plot, ordered [`by_axis`], with their markers, and the unit of the left axis.
pub(super) fn title(signals: &[Signal], shown: &[Signal], units: &DisplayUnits) -> String {
    let left = signals.first().map_or("", |first| first.unit.as_str());
    let visible = || signals.iter().enumerate().filter(|(_, signal)| shown.contains(signal));
    let names = visible().map(|(place, signal)| {
        let side = if signal.unit == left { "" } else { ", right axis" };
        match place.checked_sub(1) {
            None => signal.name.clone(),
            Some(later) => format!("{} ({}{side})", signal.name, MARKERS[later % MARKERS.len()].1),
        }
    });
    let unit = axis(signals, units).unit;
    format!("{}, {unit}", names.collect::<Vec<_>>().join(" and "))
}

/// Names of channels and the unit in which they are shown.
pub(super) fn label(signals: &[Signal], shown: &[Signal], units: &DisplayUnits) -> String {
    let names = signals.iter().filter(|signal| shown.contains(signal)).map(|signal| signal.name.as_str());
    format!("{}, {}", names.collect::<Vec<_>>().join(" and "), axis(signals, units).unit)
}

/// Shades the gaps between segments of a recording.
pub(super) fn gaps(ui: &Ui, entries: &[Entry], x: [f64; 2], width: f32, drawing: &mut Chart) {
    let per_pixel = (x[1] - x[0]) / f64::from(width.max(1.0));
    for entry in entries.iter().filter(|entry| entry.shown) {
        let colour = theme::line(ui, entry.number).gamma_multiply(0.16);
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

/// Shades times at which a recording has rows and a curve has no value. Ranges of a few samples in a picture of many have no pixel of their
/// own: the list counts them.
pub(super) fn missing(ui: &Ui, entries: &[Entry], signals: &[Signal], lit: Option<usize>, chart: &mut Chart) {
    let all = signals.iter().flat_map(|signal| having(entries, signal, lit));
    for (curve, (entry, samples, _)) in chart.curves.iter().zip(all) {
        let colour = theme::line(ui, entry.number).gamma_multiply(0.16);
        for pair in curve.parts.windows(2) {
            let (Some(end), Some(start)) = (pair[0].last(), pair[1].first()) else { continue };
            let middle_s = 0.5 * (end[0] + start[0]) - entry.shift_s;
            if samples.segments().iter().any(|own| (own.start_s..=own.end_s).contains(&middle_s)) {
                chart.shaded.push(([end[0], start[0]], colour));
            }
        }
    }
}

/// Marks of events. Parts of a profile are many and all alike: they are short lines at the bottom.
pub(super) fn marks(ui: &Ui, entries: &[Entry], x: [f64; 2]) -> Vec<Flag> {
    let mut flags = Vec::new();
    for entry in entries.iter().filter(|entry| entry.shown) {
        for event in &entry.recording.about.events {
            let at = event.time_s + entry.shift_s;
            // The start of a recording is not marked.
            if (x[0]..=x[1]).contains(&at) && event.kind != "start" {
                let is_grave = event.kind == "fault" || event.kind == "stop";
                let own = || theme::line(ui, entry.number);
                let colour = if is_grave { theme::alarm(ui) } else { own() };
                let text = if event.kind == "phase" {
                    event.text.clone()
                } else {
                    format!("{}: {}", event.kind, event.text)
                };
                flags.push(Flag { is_short: event.kind == "phase", ..Flag::new(at, text, colour) });
            }
        }
        for note in &entry.notes {
            let at = note.time_s + entry.shift_s;
            if (x[0]..=x[1]).contains(&at) {
                flags.push(Flag::new(at, format!("note: {}", note.text), theme::line(ui, entry.number)));
            }
        }
    }
    flags.sort_by(|a, b| a.x.total_cmp(&b.x).then_with(|| a.text.cmp(&b.text)));
    // Simultaneous events of several recordings with the same text are marked once.
    let together = 1e-3 * (x[1] - x[0]);
    flags.dedup_by(|later, earlier| later.text == earlier.text && later.x - earlier.x < together);
    flags
}
