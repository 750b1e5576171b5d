//! Residuals before and after the correction, over speed, angle, torque, frequency and time.

mod fit;
mod overlay;

use egui::{Color32, ComboBox, RichText, Ui, vec2};
use socam_findings::document::Over as CurveOver;
use socam_findings::evidence::{Binned, ChannelEvidence};
use socam_findings::{Diagnosis, Evidence};
use socam_model::Motion;

use super::choice::{Choice, Over, Sides};
use socam_chart::chart::{Chart, Curve, Scale, Seen, Style, range_of, with_room};
use socam_chart::theme;
use socam_chart::thin::thinned;
use socam_workbench::display_units::{DisplayUnits, ShownIn};
use socam_workbench::signal::Signal;

pub(super) fn ui(
    ui: &mut Ui,
    diagnosis: &Diagnosis,
    evidence: Option<&Evidence>,
    choice: Choice<'_>,
    seen: &mut Vec<Seen>,
) {
    match (choice.over, evidence) {
        (Over::Fit, _) => fit::fit(ui, diagnosis, choice.sides, choice.units),
        (Over::Signals, _) => match &diagnosis.overlay {
            Some(shown) => overlay::ui(ui, shown, choice.sides, choice.units, seen),
            None => drop(ui.label(RichText::new(NO_SIGNALS).color(theme::weak(ui)))),
        },
        (Over::Shape, _) => shapes(ui, diagnosis, choice.units, seen),
        (_, None) => {
            ui.label(RichText::new(
                "The file of a diagnosis holds no residuals. Open its recordings and press Diagnose at the left to see them; the measured shape and the fit are in the file.",
            ).color(theme::weak(ui)));
        }
        (Over::Time, Some(evidence)) => time(ui, evidence, choice, seen),
        (_, Some(evidence)) => over(ui, evidence, choice, seen),
    }
}

/// A diagnosis of steady states, or of an earlier version.
const NO_SIGNALS: &str = "This diagnosis holds no measured and predicted signals.";

fn colours(ui: &Ui) -> [Color32; 2] {
    [theme::alarm(ui), theme::good(ui)]
}

/// One chart per output channel, side by side where there is room.
fn over(ui: &mut Ui, evidence: &Evidence, choice: Choice<'_>, seen: &mut Vec<Seen>) {
    let count = evidence.channels.len().max(1) as f32;
    let noise = if choice.over == Over::Frequency {
        "grey: noise"
    } else {
        "grey: noise of single samples, ±1 standard deviation; ribbons: ±2 standard errors of the mean"
    };
    ui.horizontal_wrapped(|ui| legend(ui, choice.sides, noise));
    let mut all = |ui: &mut Ui, size| {
        for channel in &evidence.channels {
            if choice.over == Over::Frequency {
                spectrum(ui, channel, &choice, size, seen);
            } else {
                binned(ui, channel, &choice, size, seen);
            }
        }
    };
    if is_stacked(evidence, ui.available_width()) {
        return all(ui, vec2(ui.available_width(), STACKED));
    }
    let size = vec2((ui.available_width() - 8.0 * (count - 1.0)) / count, ui.available_height().max(120.0));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        all(ui, size);
    });
}

/// Whether one chart per channel is too narrow side by side, so that they are drawn below each other.
pub(super) fn is_stacked(evidence: &Evidence, width: f32) -> bool {
    let count = evidence.channels.len().max(1) as f32;
    (width - 8.0 * (count - 1.0)) / count < NARROW
}

/// What the colours are, in a row; `noise` says what is grey.
fn legend(ui: &mut Ui, sides: Sides, noise: &str) {
    let [before, after] = colours(ui);
    let texts = [
        (sides != Sides::After, "before: the model as it was", before),
        (sides != Sides::Before, "after: with the findings added", after),
        (true, noise, theme::weak(ui)),
    ];
    for (_, text, colour) in texts.into_iter().filter(|(on, ..)| *on) {
        ui.label(RichText::new(text).small().color(colour));
    }
}

fn binned(
    ui: &mut Ui,
    channel: &ChannelEvidence,
    choice: &Choice<'_>,
    size: egui::Vec2,
    seen: &mut Vec<Seen>,
) {
    let rotates = choice.motion == Motion::Rotation;
    let (binned, axis, unit) = match choice.over {
        Over::Angle if rotates => (&channel.over_angle, "angle at the channel within one turn", "rad"),
        Over::Angle => (&channel.over_angle, "position at the channel", "m"),
        Over::Torque if rotates => (&channel.over_torque, "torque at the channel", "N m"),
        Over::Torque => (&channel.over_torque, "force at the channel", "N"),
        _ if rotates => (&channel.over_speed, "speed at the channel", "rad/s"),
        _ => (&channel.over_speed, "speed at the channel", "m/s"),
    };
    let (x, y) = (shown_in(choice.units, "", unit), shown_in(choice.units, &channel.name, &channel.unit));
    let title = format!("{}: mean residual, {}", channel.name, y.unit);
    let mut chart = Chart::new(("evidence", &channel.name), title, size);
    // Side by side in a small window, long names would overlap.
    let axis = if size.x < NARROW { axis.split(' ').next().unwrap_or(axis) } else { axis };
    chart.x_label = format!("{axis}, {}", x.unit);
    chart.when_empty = "these recordings do not move along this axis";
    if let Some(binned) = binned {
        fill(ui, &mut chart, binned, channel.noise_std * y.per_si, [x.per_si, y.per_si], choice.sides);
    }
    chart.show(ui, seen);
}

/// Width below which the name of a horizontal axis is its first word, points.
const NARROW: f32 = 260.0;
/// Height of charts below each other, points.
const STACKED: f32 = 150.0;

/// The unit in which a channel, or an axis without a name, is shown.
fn shown_in(units: &DisplayUnits, name: &str, unit: &str) -> ShownIn {
    units.of(&Signal { name: name.into(), unit: unit.into() })
}

/// Draws binned residuals; `noise_std` is in the unit that is shown, and `per_si` are the factors of both axes.
fn fill(ui: &Ui, chart: &mut Chart, binned: &Binned, noise_std: f64, per_si: [f64; 2], sides: Sides) {
    let [x_per_si, y_per_si] = per_si;
    let [before, after] = colours(ui);
    let lines = [
        ("before", sides != Sides::After, before, &binned.before, &binned.before_std),
        ("after", sides != Sides::Before, after, &binned.after, &binned.after_std),
    ];
    chart.x = range_of(binned.x.iter().map(|x| x_per_si * x)).map_or([0.0, 1.0], with_room);
    for (name, _, colour, values, errors) in lines.into_iter().filter(|line| line.1 && !line.3.is_empty()) {
        let points = binned.x.iter().zip(values).map(|(x, y)| [x_per_si * x, y_per_si * y]);
        let points: Vec<[f64; 2]> = points.collect();
        let parts = thinned(&points, usize::MAX / 4);
        chart.curves.push(Curve { name: name.into(), colour, parts, style: Style::Solid });
        let errors = errors.iter().map(|error| 2.0 * y_per_si * error);
        let band = points.iter().zip(errors).map(|([x, y], error)| [*x, y - error, y + error]);
        chart.bands.push((band.collect(), colour.gamma_multiply(0.22)));
    }
    let drawn = chart.bands.iter().flat_map(|(band, _)| band.iter().flat_map(|[_, low, high]| [*low, *high]));
    chart.y = chart.fitted(range_of(drawn.chain([0.0])));
    // Standard deviation of the noise of single samples; means of bins scatter less.
    let noise = [chart.x[0], chart.x[1]].map(|x| [x, -noise_std, noise_std]);
    chart.bands.insert(0, (noise.to_vec(), theme::weak(ui).gamma_multiply(0.16)));
}

fn spectrum(
    ui: &mut Ui,
    channel: &ChannelEvidence,
    choice: &Choice<'_>,
    size: egui::Vec2,
    seen: &mut Vec<Seen>,
) {
    let sides = choice.sides;
    let ShownIn { unit, per_si } = shown_in(choice.units, &channel.name, &channel.unit);
    let title = format!("{}: residual, {unit} per sqrt(Hz)", channel.name);
    let mut chart = Chart::new(("evidence", &channel.name), title, size);
    chart.x_label = "frequency, Hz".into();
    chart.scales = [Scale::Log; 2];
    chart.when_empty = "too short for a spectrum";
    if let Some(spectrum) = &channel.spectrum {
        let [before, after] = colours(ui);
        let lines = [
            ("noise", true, theme::weak(ui), &spectrum.noise),
            ("before", sides != Sides::After, before, &spectrum.before),
            ("after", sides != Sides::Before, after, &spectrum.after),
        ];
        for (name, _, colour, values) in lines.into_iter().filter(|line| line.1 && !line.3.is_empty()) {
            let points = spectrum.frequency_hz.iter().zip(values).map(|(f, y)| [*f, per_si * y]);
            let points = points.filter(|[f, y]| *f > 0.0 && *y > 0.0).collect();
            chart.curves.push(Curve { name: name.into(), colour, parts: vec![points], style: Style::Solid });
        }
        let all = || chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten());
        let (x, y) = (range_of(all().map(|p| p[0])), range_of(all().map(|p| p[1])));
        chart.x = x.unwrap_or([1.0, 10.0]);
        chart.y = y.map_or([0.1, 1.0], |range| chart.fitted(Some(range)));
    }
    chart.show(ui, seen);
}

fn time(ui: &mut Ui, evidence: &Evidence, choice: Choice<'_>, seen: &mut Vec<Seen>) {
    let Some(recording) = evidence.recordings.get(*choice.recording).or(evidence.recordings.first()) else {
        return;
    };
    ui.horizontal_wrapped(|ui| {
        crate::together::level(ui);
        let label = ui.label("recording");
        let name = |index: usize| {
            let own = &evidence.recordings[index];
            format!(
                "{}{}",
                socam_workbench::recording::short(&own.name),
                if own.held_out { " (held out)" } else { "" }
            )
        };
        let shown = ComboBox::from_id_salt("evidence of")
            .width(260.0)
            .selected_text(name((*choice.recording).min(evidence.recordings.len() - 1)));
        let shown = shown.show_ui(ui, |ui| {
            for index in 0..evidence.recordings.len() {
                ui.selectable_value(choice.recording, index, name(index));
            }
        });
        shown.response.labelled_by(label.id);
        let label = ui.label("channel");
        let name = recording.channels.get(*choice.channel).map_or("", |trace| trace.channel.as_str());
        let shown = ComboBox::from_id_salt("channel of").selected_text(name).show_ui(ui, |ui| {
            for (index, trace) in recording.channels.iter().enumerate() {
                ui.selectable_value(choice.channel, index, &trace.channel);
            }
        });
        shown.response.labelled_by(label.id);
        legend(ui, choice.sides, "grey: noise, ±1 std");
    });
    let Some(trace) = recording.channels.get(*choice.channel).or(recording.channels.first()) else { return };
    let size = vec2(ui.available_width(), ui.available_height().max(120.0));
    let known = evidence.channels.iter().find(|channel| channel.name == trace.channel);
    let unit = known.map_or("", |channel| channel.unit.as_str());
    let ShownIn { unit, per_si } = shown_in(choice.units, &trace.channel, unit);
    let mut chart = Chart::new("evidence over time", format!("{}: residual, {unit}", trace.channel), size);
    chart.x_label = "time from the start of the recording, s".into();
    let [before, after] = colours(ui);
    let lines = [
        ("before", choice.sides != Sides::After, before, &trace.before),
        ("after", choice.sides != Sides::Before, after, &trace.after),
    ];
    for (name, _, colour, values) in lines.into_iter().filter(|line| line.1 && !line.3.is_empty()) {
        let points: Vec<[f64; 2]> =
            trace.time_s.iter().zip(values).map(|(time, value)| [*time, per_si * value]).collect();
        let parts = thinned(&points, size.x as usize);
        chart.curves.push(Curve { name: name.into(), colour, parts, style: Style::Solid });
    }
    chart.x = range_of(trace.time_s.iter().copied()).unwrap_or([0.0, 1.0]);
    chart.y =
        chart.fitted(range_of(chart.curves.iter().flat_map(|c| c.parts.iter().flatten().map(|p| p[1]))));
    if let Some(channel) = known {
        let noise_std = per_si * channel.noise_std;
        let noise = [chart.x[0], chart.x[1]].map(|x| [x, -noise_std, noise_std]);
        chart.bands.push((noise.to_vec(), theme::weak(ui).gamma_multiply(0.16)));
    }
    chart.show(ui, seen);
}

/// The measured shape of the missing torque or channel error.
fn shapes(ui: &mut Ui, diagnosis: &Diagnosis, units: &DisplayUnits, seen: &mut Vec<Seen>) {
    let curves: Vec<_> = diagnosis
        .findings
        .iter()
        .enumerate()
        .filter_map(|(n, f)| Some((n + 1, f, f.curve.as_ref()?)))
        .collect();
    if curves.is_empty() {
        ui.label(RichText::new("No finding of this diagnosis has a measured shape.").color(theme::weak(ui)));
        return;
    }
    let count = curves.len() as f32;
    let size = vec2((ui.available_width() - 8.0 * (count - 1.0)) / count, ui.available_height().max(120.0));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        for (number, finding, curve) in curves {
            let (x, y) = (shown_in(units, "", &curve.unit), shown_in(units, "", &curve.torque_unit));
            let title = format!(
                "{number}. {} at {}: what is missing, band: ±2 standard deviations, {}",
                finding.effect, finding.location, y.unit
            );
            let mut chart = Chart::new(("shape", number), title, size);
            let over = match curve.over {
                CurveOver::Speed => "speed",
                CurveOver::Angle => "angle",
                CurveOver::Torque => "torque",
                CurveOver::Time => "time",
                CurveOver::Frequency => "frequency",
            };
            chart.x_label = format!("{over}, {}", x.unit);
            let value = |value: &Option<f64>| y.per_si * value.unwrap_or(f64::NAN);
            let points: Vec<[f64; 2]> = curve
                .x
                .iter()
                .zip(&curve.torque)
                .map(|(at, torque)| [x.per_si * at, value(torque)])
                .collect();
            let band = points
                .iter()
                .zip(&curve.torque_std)
                .map(|([x, y], std)| [*x, y - 2.0 * value(std), y + 2.0 * value(std)]);
            let colour = theme::alarm(ui);
            let band: Vec<[f64; 3]> = band.collect();
            let reached: Vec<f64> = band.iter().flat_map(|[_, low, high]| [*low, *high]).collect();
            chart.bands.push((band, colour.gamma_multiply(0.22)));
            chart.x = range_of(points.iter().map(|point| point[0])).map_or([0.0, 1.0], with_room);
            chart.y = chart.fitted(range_of(points.iter().map(|point| point[1]).chain(reached).chain([0.0])));
            let parts = thinned(&points, usize::MAX / 4);
            chart.curves.push(Curve { name: finding.effect.clone(), colour, parts, style: Style::Dotted });
            chart.show(ui, seen);
        }
    });
}
