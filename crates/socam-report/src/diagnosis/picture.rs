//! The first picture: measured against predicted before and after, and the residuals below.

use maud::{Markup, html};
use socam_findings::{Diagnosis, document::Overlay};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series};

/// Heights of both plots on a wide screen.
const HEIGHTS: [f64; 2] = [270.0, 180.0];

/// The picture; nothing without recordings over time.
pub(super) fn first(diagnosis: &Diagnosis) -> Markup {
    let Some(overlay) = diagnosis.overlay.as_ref().filter(|overlay| !overlay.time_s.is_empty()) else {
        return html! {};
    };
    let noise = diagnosis.fit.channels.iter().find(|(name, _)| *name == overlay.channel);
    let noise = noise.and_then(|(_, fit)| fit.noise_std).unwrap_or_default();
    let (what, model) = match overlay.after.is_empty() {
        true => ("", "model"),
        false => (", the channel that the correction improves most,", "base model"),
    };
    html! {
        figure class="lead" id="picture" {
            figcaption {
                span {
                    code { (overlay.channel) } (what) " measured and predicted, in the part of " code { (overlay.recording) }
                    " that the " (model) " misses most"
                }
                @if overlay.held_out { span class="badge" { "held out" } }
            }
            (signals(overlay, |plot| plot.large(HEIGHTS[0])))
            (residuals(overlay, noise))
        }
    }
}

/// The signals as an SVG file; `None` without recordings over time.
pub(super) fn file(diagnosis: &Diagnosis) -> Option<String> {
    let overlay = diagnosis.overlay.as_ref().filter(|overlay| !overlay.time_s.is_empty())?;
    Some(signals(overlay, socam_plot::standalone))
}

/// Plots the measured signal with both predictions by `draw`.
fn signals<T>(overlay: &Overlay, draw: impl FnOnce(&Plot<'_>) -> T) -> T {
    let [measured, before, after] =
        [&overlay.measured, &overlay.before, &overlay.after].map(|values| numbers(values));
    let of = |label, class, y| line(label, class, &overlay.time_s, y);
    let mut series = vec![of("measured", "measured", &measured[..])];
    if after.is_empty() {
        series.push(of("predicted by the model", "before", &before));
    } else {
        series.push(of("predicted before", "before", &before));
        series.push(of("predicted after", "after", &after));
    }
    let title = format!("{} measured and predicted in {}", overlay.channel, overlay.recording);
    draw(&plot(overlay, (title, "Signal"), series))
}

/// Residuals beside the noise floor.
fn residuals(overlay: &Overlay, noise: f64) -> Markup {
    let [before, after] = [&overlay.residual_before, &overlay.residual_after].map(|values| numbers(values));
    let of = |label, class, y| line(label, class, &overlay.time_s, y);
    let mut series = vec![of(if after.is_empty() { "residual" } else { "before" }, "before", &before[..])];
    if !after.is_empty() {
        series.push(of("after", "after", &after));
    }
    let ends = [overlay.time_s.first(), overlay.time_s.last()].map(|end| end.copied().unwrap_or(f64::NAN));
    // NaN separates the two edges.
    let floor = 2.0 * noise;
    let edges = ([ends[0], ends[1], f64::NAN, ends[0], ends[1]], [floor, floor, f64::NAN, -floor, -floor]);
    if floor > 0.0 {
        series.push(line("±2 noise floors", "noise", &edges.0, &edges.1));
    }
    let title = format!("Residual of {} in {}", overlay.channel, overlay.recording);
    plot(overlay, (title, "Residual"), series).large(HEIGHTS[1])
}

fn line<'a>(label: &'a str, class: &'a str, x: &'a [f64], y: &'a [f64]) -> Series<'a> {
    Series { label, class, mark: Mark::Line, x, y, spread: &[] }
}

fn plot<'a>(overlay: &Overlay, (title, quantity): (String, &str), series: Vec<Series<'a>>) -> Plot<'a> {
    Plot {
        title,
        x: Axis::new("Time", "s"),
        y: Axis::new(quantity, &overlay.unit),
        series,
        // Extremes of each interval are all there.
        columns: 3 * COLUMNS,
    }
}

fn numbers(values: &[Option<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.unwrap_or(f64::NAN)).collect()
}
