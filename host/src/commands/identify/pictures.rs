//! Bode plots, poles and zeros, and the pages that hold them.

use std::path::Path;

use anyhow::Context;
use socam_frequency::{
    Complex,
    rational::{Fit, Point},
    response::{Driven, Line},
};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series};

use super::frf::{Answer, decibel};
use crate::output;

/// A series that owns its numbers.
pub(super) struct Curve {
    label: &'static str,
    class: &'static str,
    mark: Mark,
    x: Vec<f64>,
    y: Vec<f64>,
    spread: Vec<f64>,
}

/// A plot that owns its numbers.
pub(super) struct Drawn {
    title: String,
    x: Axis,
    y: Axis,
    curves: Vec<Curve>,
}

impl Drawn {
    pub(super) fn plot(&self) -> Plot<'_> {
        let series = self.curves.iter().map(|curve| Series {
            label: curve.label,
            class: curve.class,
            mark: curve.mark,
            x: &curve.x,
            y: &curve.y,
            spread: &curve.spread,
        });
        Plot {
            title: self.title.clone(),
            x: self.x.clone(),
            y: self.y.clone(),
            series: series.collect(),
            columns: COLUMNS,
        }
    }
}

/// A plot with the name of its file.
pub(super) struct Picture {
    pub(super) name: &'static str,
    pub(super) plot: Drawn,
}

/// A part of a page.
pub(super) struct Section {
    pub(super) title: String,
    pub(super) sentences: Vec<String>,
    pub(super) pictures: Vec<Picture>,
    /// Rows of text, the first a head.
    pub(super) tables: Vec<Vec<Vec<String>>>,
}

/// A page that needs nothing else.
pub(super) fn page(title: &str, about: &str, sections: &[Section]) -> String {
    use maud::{DOCTYPE, PreEscaped, Render, html};
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(socam_plot::STYLE)) }
            }
            body {
                h1 { (title) }
                p class="over" { (about) }
                main {
                    @for section in sections {
                        section {
                            h2 { (section.title) }
                            @for sentence in &section.sentences { p { (sentence) } }
                            div class="plots" {
                                @for picture in &section.pictures { figure { (picture.plot.plot().render()) } }
                            }
                            @for rows in &section.tables {
                                div class="scroll" { table {
                                    @for (index, row) in rows.iter().enumerate() {
                                        tr { @for cell in row { @if index == 0 { th { (cell) } } @else { td { (cell) } } } }
                                    }
                                } }
                            }
                        }
                    }
                }
            }
        }
    }
    .into_string()
}

/// Writes files into a folder, each whole or not at all.
pub(super) fn write_all(dir: &Path, files: &[(String, String)]) -> anyhow::Result<()> {
    std::fs::create_dir_all(dir).with_context(|| format!("cannot make the folder `{}`", dir.display()))?;
    for (name, text) in files {
        output::write_whole(&dir.join(name), text)?;
    }
    Ok(())
}

fn frequency() -> Axis {
    Axis::logarithmic("Frequency", "Hz")
}

/// Phases in degrees that do not jump.
fn unwrapped(values: &[Complex<f64>]) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last: Option<f64> = None;
    values
        .iter()
        .map(|value| {
            let phase = value.arg().to_degrees();
            if let Some(last) = last {
                turns -= 360.0 * ((phase - last) / 360.0).round();
            }
            last = Some(phase);
            phase + turns
        })
        .collect()
}

/// Magnitude, phase, coherence and the output's lines.
pub(super) fn response(answer: &Answer<'_>) -> Vec<Picture> {
    let lines = &answer.response.lines;
    let (output, input) = (&answer.pair.output.name, &answer.pair.input.name);
    let x: Vec<f64> = lines.iter().map(|line| line.frequency_hz).collect();
    let values: Vec<Complex<f64>> = lines.iter().map(|line| line.response).collect();
    let curve = |label, class, mark, y, spread| Curve { label, class, mark, x: x.clone(), y, spread };
    let sizes =
        |values: &[Complex<f64>]| values.iter().map(|value| decibel(value.norm())).collect::<Vec<f64>>();
    let band = magnitude_band(lines);
    let phase_spread: Vec<f64> = lines.iter().map(Line::phase_half_width_deg).collect();
    let estimated = unwrapped(&values);
    // The model's phase on the turn of the estimate's.
    let shift = |(model, own): (f64, &f64)| model - 360.0 * ((model - own) / 360.0).round();
    let modelled: Vec<f64> = unwrapped(&answer.model).into_iter().zip(&estimated).map(shift).collect();
    let magnitude = Drawn {
        title: format!("Magnitude of {output} per {input}"),
        x: frequency(),
        y: Axis::new("Magnitude", "dB"),
        curves: vec![
            curve("95 % interval", "after", Mark::Band, band.0, band.1),
            curve("model", "before", Mark::Line, sizes(&answer.model), Vec::new()),
            curve("estimate", "after", Mark::Line, sizes(&values), Vec::new()),
        ],
    };
    let phase = Drawn {
        title: format!("Phase of {output} per {input}"),
        x: frequency(),
        y: Axis::new("Phase", "degrees"),
        curves: vec![
            curve("95 % interval", "after", Mark::Band, estimated.clone(), phase_spread),
            curve("model", "before", Mark::Line, modelled, Vec::new()),
            curve("estimate", "after", Mark::Line, estimated, Vec::new()),
        ],
    };
    let coherence = Drawn {
        title: format!("Coherence of {output} and {input}"),
        x: frequency(),
        y: Axis::new("Coherence", "1"),
        curves: vec![curve("", "after", Mark::Line, lines.iter().map(|l| l.coherence).collect(), Vec::new())],
    };
    let mut pictures = vec![
        Picture { name: "magnitude", plot: magnitude },
        Picture { name: "phase", plot: phase },
        Picture { name: "coherence", plot: coherence },
    ];
    pictures.extend(distortion(answer));
    pictures
}

/// Middle and half-width of the magnitude's interval in dB.
fn magnitude_band(lines: &[Line]) -> (Vec<f64>, Vec<f64>) {
    lines
        .iter()
        .map(|line| {
            let [low, high] =
                line.magnitude_ci95().map(|size| decibel(size.max(1e-3 * line.response.norm())));
            (f64::midpoint(low, high), 0.5 * (high - low))
        })
        .unzip()
}

fn distortion(answer: &Answer<'_>) -> Option<Picture> {
    let distortion = answer.response.distortion.as_ref()?;
    let of = |label, class, mark, driven: Driven| {
        let own = distortion.lines.iter().filter(|line| line.driven == driven);
        let (x, y) = own.map(|line| (line.frequency_hz, line.amplitude)).unzip();
        Curve { label, class, mark, x, y, spread: Vec::new() }
    };
    let (x, y) = distortion.lines.iter().map(|line| (line.frequency_hz, line.noise)).unzip();
    let noise = Curve { label: "noise", class: "noise", mark: Mark::Line, x, y, spread: Vec::new() };
    let plot = Drawn {
        title: format!("Lines of {}", answer.pair.output.name),
        x: frequency(),
        y: Axis::logarithmic("Amplitude", answer.pair.output.unit),
        curves: vec![
            of("driven", "after", Mark::Points, Driven::Excited),
            of("even", "before", Mark::Points, Driven::Even),
            of("odd", "third", Mark::Points, Driven::Odd),
            noise,
        ]
        .into_iter()
        .filter(|curve| !curve.x.is_empty())
        .collect(),
    };
    Some(Picture { name: "lines", plot })
}

/// Magnitude and phase of a transfer function beside what it was fitted to, and its poles and zeros.
pub(super) fn transfer(name: &str, fit: &Fit, points: &[Point]) -> Vec<Picture> {
    let transfer = &fit.transfer;
    let ends = points.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), point| {
        (low.min(point.frequency_hz), high.max(point.frequency_hz))
    });
    let grid: Vec<f64> = (0..300).map(|i| ends.0 * (ends.1 / ends.0).powf(f64::from(i) / 299.0)).collect();
    let fitted: Vec<Complex<f64>> = grid.iter().map(|hz| transfer.response(*hz)).collect();
    let measured: Vec<Complex<f64>> = points.iter().map(|point| point.output / point.input).collect();
    let at: Vec<f64> = points.iter().map(|point| point.frequency_hz).collect();
    let sizes =
        |values: &[Complex<f64>]| values.iter().map(|value| decibel(value.norm())).collect::<Vec<f64>>();
    let phase = unwrapped(&fitted);
    // Each measured phase on the turn of the curve beside it.
    let beside = |hz: f64| phase[grid.partition_point(|g| *g < hz).min(grid.len() - 1)];
    let turned = at.iter().zip(&measured).map(|(hz, value)| {
        let own = value.arg().to_degrees();
        own - 360.0 * ((own - beside(*hz)) / 360.0).round()
    });
    let both = |title: &str, y: Axis, points: Vec<f64>, line: Vec<f64>| Drawn {
        title: format!("{title} of {name}"),
        x: frequency(),
        y,
        curves: vec![
            Curve {
                label: "data",
                class: "after",
                mark: Mark::Points,
                x: at.clone(),
                y: points,
                spread: Vec::new(),
            },
            Curve {
                label: "fit",
                class: "before",
                mark: Mark::Line,
                x: grid.clone(),
                y: line,
                spread: Vec::new(),
            },
        ],
    };
    let roots = |roots: Vec<Complex<f64>>| -> (Vec<f64>, Vec<f64>) {
        roots.iter().map(|root| (root.re, root.im)).unzip()
    };
    let (poles, zeros) = (roots(transfer.poles()), roots(transfer.zeros()));
    let map = Drawn {
        title: format!("Poles and zeros of {name}"),
        x: Axis::new("Real part", "1/s"),
        y: Axis::new("Imaginary part", "1/s"),
        curves: vec![
            Curve {
                label: "poles",
                class: "before",
                mark: Mark::Crosses,
                x: poles.0,
                y: poles.1,
                spread: Vec::new(),
            },
            Curve {
                label: "zeros",
                class: "after",
                mark: Mark::Points,
                x: zeros.0,
                y: zeros.1,
                spread: Vec::new(),
            },
        ],
    };
    vec![
        Picture {
            name: "magnitude",
            plot: both("Magnitude", Axis::new("Magnitude", "dB"), sizes(&measured), sizes(&fitted)),
        },
        Picture {
            name: "phase",
            plot: both("Phase", Axis::new("Phase", "degrees"), turned.collect(), phase.clone()),
        },
        Picture { name: "poles-zeros", plot: map },
    ]
}
