//! Residuals before and after: over speed, angle, torque and frequency for each channel, over time for each recording.

use maud::{Markup, html};
use socam_findings::{
    Diagnosis, Evidence,
    evidence::{Binned, ChannelEvidence, RecordingTraces, Spectrum, Trace},
};
use socam_model::{Model, Motion};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series};

use super::{tables, words};

/// Largest size of all traces together, bytes, so that a page opens quickly.
const TRACE_BYTES: usize = 700_000;
/// Bytes of a trace's path per pixel column: two extremes.
const BYTES_PER_COLUMN: usize = 12;
/// Least number of pixel columns of a trace.
const LEAST_COLUMNS: usize = 60;
/// Number of samples up to which each is drawn as a mark.
const FEW_SAMPLES: usize = 50;
/// Half-width of a 95 % interval in standard errors.
const INTERVAL_95: f64 = 1.96;

/// Label of the base model's residuals.
fn before_label(after: &[f64]) -> &'static str {
    if after.is_empty() { "base model" } else { "before" }
}

/// All pictures of all channels, the channel that the base model misses most first.
pub(super) fn residuals(evidence: &Evidence, diagnosis: &Diagnosis, model: &Model) -> Markup {
    let missed = |channel: &ChannelEvidence| {
        let fit = diagnosis.fit.channels.iter().find(|(name, _)| *name == channel.name).map(|(_, fit)| fit);
        let rms = fit.and_then(|fit| fit.holdout_rms_before.or(fit.rms_before));
        fit.and_then(|fit| tables::in_noise_floors(rms, fit.noise_std)).unwrap_or(0.0)
    };
    let mut channels: Vec<&ChannelEvidence> = evidence.channels.iter().collect();
    channels.sort_by(|a, b| missed(b).total_cmp(&missed(a)));
    let traces: usize = evidence.recordings.iter().map(|recording| 2 * recording.channels.len()).sum();
    let columns = (TRACE_BYTES / BYTES_PER_COLUMN / traces.max(1)).clamp(LEAST_COLUMNS, COLUMNS);
    html! {
        @for channel in channels {
            section class="channel" {
                h3 { code { (channel.name) } }
                (shapes(channel, model.motion))
                h4 { "Over time" }
                div class="plots" {
                    @for recording in &evidence.recordings {
                        @for trace in recording.channels.iter().filter(|trace| trace.channel == channel.name) {
                            (over_time(channel, recording, trace, columns))
                        }
                    }
                }
            }
        }
    }
}

fn shapes(channel: &ChannelEvidence, motion: Motion) -> Markup {
    let rotates = motion == Motion::Rotation;
    let (angle, torque) = if rotates { ("Angle", "Torque") } else { ("Position", "Force") };
    let (speed_unit, angle_unit, torque_unit) =
        if rotates { ("rad/s", "rad", "N m") } else { ("m/s", "m", "N") };
    let shapes = [
        (&channel.over_speed, "Speed", speed_unit),
        (&channel.over_angle, angle, angle_unit),
        (&channel.over_torque, torque, torque_unit),
    ];
    html! {
        div class="plots" {
            @for (binned, over, unit) in shapes {
                @if let Some(binned) = binned { (over_bins(channel, binned, over, unit)) }
            }
            @if let Some(spectrum) = &channel.spectrum { (over_frequency(channel, spectrum)) }
        }
    }
}

fn over_bins(channel: &ChannelEvidence, binned: &Binned, over: &str, unit: &str) -> Markup {
    let interval = |std: &[f64]| std.iter().map(|std| INTERVAL_95 * std).collect::<Vec<_>>();
    let (before, after) = (interval(&binned.before_std), interval(&binned.after_std));
    let mut series = vec![Series {
        label: before_label(&binned.after),
        class: "before",
        mark: Mark::Circles,
        x: &binned.x,
        y: &binned.before,
        spread: &before,
    }];
    if !binned.after.is_empty() {
        series.push(Series {
            label: "after; bars: 95 % intervals",
            class: "after",
            mark: Mark::Squares,
            x: &binned.x,
            y: &binned.after,
            spread: &after,
        });
    }
    let plot = Plot {
        title: format!("Mean residual of {} over {}", channel.name, over.to_lowercase()),
        x: Axis::new(over, unit),
        y: Axis::new("Mean residual", &channel.unit),
        series,
        columns: COLUMNS,
    };
    html! { figure { figcaption { "Over " (over.to_lowercase()) } (plot) } }
}

fn over_frequency(channel: &ChannelEvidence, spectrum: &Spectrum) -> Markup {
    html! { figure { figcaption { "Over frequency" } (spectrum_plot(channel, spectrum)) } }
}

fn spectrum_plot<'a>(channel: &ChannelEvidence, spectrum: &'a Spectrum) -> Plot<'a> {
    let line = |label, class, y| Series {
        label,
        class,
        mark: Mark::Line,
        x: &spectrum.frequency_hz,
        y,
        spread: &[],
    };
    let mut series = vec![line(before_label(&spectrum.after), "before", spectrum.before.as_slice())];
    if !spectrum.after.is_empty() {
        series.push(line("after", "after", &spectrum.after));
    }
    if !spectrum.noise.is_empty() {
        series.push(line("noise floor", "noise", &spectrum.noise));
    }
    Plot {
        title: format!("Amplitude spectrum of the residual of {}", channel.name),
        x: Axis::logarithmic("Frequency", "Hz"),
        y: Axis::logarithmic("Residual", &format!("{}/√Hz", words::unit(&channel.unit))),
        series,
        columns: COLUMNS,
    }
}

fn over_time(
    channel: &ChannelEvidence,
    recording: &RecordingTraces,
    trace: &Trace,
    columns: usize,
) -> Markup {
    let marks =
        if trace.time_s.len() > FEW_SAMPLES { [Mark::Trace; 2] } else { [Mark::Circles, Mark::Squares] };
    let line = |label, class, mark, x, y| Series { label, class, mark, x, y, spread: &[] };
    let mut series = vec![line(
        before_label(&trace.after),
        "before",
        marks[0],
        trace.time_s.as_slice(),
        trace.before.as_slice(),
    )];
    if !trace.after.is_empty() {
        series.push(line("after", "after", marks[1], &trace.time_s, &trace.after));
    }
    // Upper and lower edge of the noise floor; NaN separates the two lines.
    let ends = [trace.time_s.first(), trace.time_s.last()].map(|end| end.copied().unwrap_or(f64::NAN));
    let floor = 2.0 * channel.noise_std;
    let edges = ([ends[0], ends[1], f64::NAN, ends[0], ends[1]], [floor, floor, f64::NAN, -floor, -floor]);
    if floor > 0.0 {
        series.push(line("±2 noise floors", "noise", Mark::Line, &edges.0, &edges.1));
    }
    let plot = Plot {
        title: format!("Residual of {} in {} over time", channel.name, recording.name),
        x: Axis::new("Time", "s"),
        y: Axis::new("Residual", &channel.unit),
        series,
        columns,
    };
    html! {
        figure {
            figcaption {
                span class="recording" { (recording.name) }
                @if recording.held_out { span class="badge" { "held out" } }
            }
            (plot)
        }
    }
}
