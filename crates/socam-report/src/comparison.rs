//! A comparison as a page: measured against simulated first.

use maud::{Markup, Render, html};
use socam_compare::{ChannelComparison, Comparison, Verdict, number, sentences};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series, words};

use crate::scaffold::{self, Head, heading, heads};

/// Heads of the table of channels.
const CHANNELS: [&str; 8] =
    ["channel", "unit", "std measured", "rms of error", "share", "delay, ms", "gain", "differs"];

/// The page of a comparison as HTML. `about`: command, date and files, each a line.
#[must_use]
pub fn page(comparison: &Comparison, about: &[String]) -> String {
    let title = match comparison.verdict {
        Verdict::Agree => "Simulation and recording agree",
        Verdict::NothingCompared => "Nothing was compared",
        Verdict::Differ => "Simulation and recording differ",
    };
    let over = html! { (comparison.simulation) " beside " (comparison.recording) };
    let main = html! {
        section { @for sentence in sentences(comparison) { p { (sentence) } } (table(comparison)) }
        @for channel in &comparison.channels { (section(channel)) }
        section {
            h2 { "About this comparison" }
            @for warning in &comparison.warnings { p { (warning) } }
            @for line in about { p { (line) } }
        }
    };
    scaffold::page(title, "", &heading(title, &over), &main)
}

fn table(comparison: &Comparison) -> Markup {
    scaffold::table(&html! {
        (heads(&CHANNELS.map(Head::Text)))
        @for channel in &comparison.channels {
            tr {
                td { (channel.name) }
                td { (words::unit(channel.unit)) }
                td { (number(channel.measured_std)) }
                td { (number(channel.error_rms)) }
                td { (number(100.0 * channel.error_share)) " %" }
                td { (channel.delay_s.map_or_else(|| "-".into(), |delay| number(1e3 * delay.value))) }
                td { (channel.gain.map_or_else(|| "-".into(), |gain| number(gain.value))) }
                td { (if channel.differs { "yes" } else { "no" }) }
            }
        }
    })
}

fn section(channel: &ChannelComparison) -> Markup {
    let drawn = &channel.drawn;
    let error: Vec<f64> = drawn.measured.iter().zip(&drawn.simulated).map(|(a, b)| a - b).collect();
    let time = Axis::new("time", "s");
    let value = Axis::new(&channel.name, channel.unit);
    let series = |label, class, x, y| Series { label, class, mark: Mark::Line, x, y, spread: &[] };
    let whole = Plot {
        title: format!("{} measured and simulated", channel.name),
        x: time.clone(),
        y: value.clone(),
        series: vec![
            series("measured", "before", &drawn.time_s, &drawn.measured),
            series("simulated", "after", &drawn.time_s, &drawn.simulated),
        ],
        columns: COLUMNS,
    };
    let (from, to) = closest_look(&drawn.time_s, &error);
    let part = Plot {
        title: format!("{} where the error is largest", channel.name),
        x: time.clone(),
        y: value,
        series: vec![
            series("measured", "before", &drawn.time_s[from..to], &drawn.measured[from..to]),
            series("simulated", "after", &drawn.time_s[from..to], &drawn.simulated[from..to]),
        ],
        columns: COLUMNS,
    };
    let over_time = Plot {
        title: format!("Error of {} over time", channel.name),
        x: time,
        y: Axis::new("measured - simulated", channel.unit),
        series: vec![series("", "third", &drawn.time_s, &error)],
        columns: COLUMNS,
    };
    let over_speed = channel.over_speed.as_ref().map(|over| Plot {
        title: format!("Error of {} over {}", channel.name, over.channel),
        x: Axis::new(&over.channel, over.unit),
        y: Axis::new("measured - simulated", channel.unit),
        series: vec![Series {
            label: "mean and standard deviation of each bin",
            class: "third",
            mark: Mark::Circles,
            x: &over.speed,
            y: &over.mean,
            spread: &over.std,
        }],
        columns: COLUMNS,
    });
    // A logarithmic axis has no zero.
    let skip = 1.min(drawn.frequency_hz.len());
    let density = Plot {
        title: format!("Power density of {} and of its error", channel.name),
        x: Axis::logarithmic("frequency", "Hz"),
        y: Axis::logarithmic("power density", &format!("({})\u{b2}/Hz", channel.unit)),
        series: vec![
            series("measured", "before", &drawn.frequency_hz[skip..], &drawn.measured_density[skip..]),
            series("error", "third", &drawn.frequency_hz[skip..], &drawn.error_density[skip..]),
        ],
        columns: COLUMNS,
    };
    html! {
        section {
            h2 { (channel.name) }
            div class="plots" {
                figure { (whole.render()) }
                figure { (part.render()) }
                figure { (over_time.render()) }
                @if let Some(plot) = over_speed { figure { (plot.render()) } }
                figure { (density.render()) }
            }
        }
    }
}

/// Rows around the largest error: a fiftieth of the recording.
fn closest_look(time_s: &[f64], error: &[f64]) -> (usize, usize) {
    let n = time_s.len();
    let width = (n / 50).max(20).min(n);
    let held = error.iter().enumerate().filter(|(_, e)| e.is_finite());
    let worst = held.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(row, _)| row);
    let from = worst.saturating_sub(width / 2).min(n - width);
    (from, from + width)
}
