//! Bode plots of a response, its coherence, and the output's lines.

use socam_frequency::{
    Complex,
    response::{Driven, Line},
};
use socam_plot::{Axis, COLUMNS, Mark, Plot, Series};
use socam_response::answer::{Answer, decibel};

/// A series that owns its numbers.
#[derive(Debug)]
pub struct Curve {
    /// Its name in the legend.
    pub label: String,
    /// Its class in the style sheet.
    pub class: &'static str,
    /// How it is drawn.
    pub mark: Mark,
    /// Abscissas.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// Half-widths of intervals; empty without.
    pub spread: Vec<f64>,
}

/// A plot that owns its numbers.
#[derive(Debug)]
pub struct Drawn {
    /// What it shows.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Its series, the lowest first.
    pub curves: Vec<Curve>,
}

impl Drawn {
    /// The plot, to be drawn.
    #[must_use]
    pub fn plot(&self) -> Plot<'_> {
        let series = self.curves.iter().map(|curve| Series {
            label: &curve.label,
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
#[derive(Debug)]
pub struct Picture {
    /// Its name.
    pub name: &'static str,
    /// The plot.
    pub plot: Drawn,
}

impl Picture {
    /// The plot as an SVG file.
    #[must_use]
    pub fn svg(&self) -> String {
        socam_plot::standalone(&self.plot.plot())
    }
}

/// The axis of frequencies.
pub(super) fn frequency() -> Axis {
    Axis::logarithmic("Frequency", "Hz")
}

/// Magnitudes, dB.
pub(super) fn decibels(values: &[Complex<f64>]) -> Vec<f64> {
    values.iter().map(|value| decibel(value.norm())).collect()
}

/// Unwrapped phases, degrees.
pub(super) fn unwrapped(values: &[Complex<f64>]) -> Vec<f64> {
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

/// Plots of magnitude, phase, coherence and the output's lines.
#[must_use]
pub fn pictures(answer: &Answer<'_>) -> Vec<Picture> {
    let lines = &answer.response.lines;
    let (output, input) = (&answer.pair.output.name, &answer.pair.input.name);
    let x: Vec<f64> = lines.iter().map(|line| line.frequency_hz).collect();
    let values: Vec<Complex<f64>> = lines.iter().map(|line| line.response).collect();
    let curve = |label: &str, class, mark, y, spread| Curve {
        label: label.into(),
        class,
        mark,
        x: x.clone(),
        y,
        spread,
    };
    let band = magnitude_band(lines);
    let phase_spread: Vec<f64> = lines.iter().map(Line::phase_half_width_deg).collect();
    let estimated = unwrapped(&values);
    // The model's phase, shifted by whole turns to the estimate's.
    let shift = |(model, own): (f64, &f64)| model - 360.0 * ((model - own) / 360.0).round();
    let modelled: Vec<f64> = unwrapped(&answer.model).into_iter().zip(&estimated).map(shift).collect();
    let magnitude = Drawn {
        title: format!("Magnitude of {output} per {input}"),
        x: frequency(),
        y: Axis::new("Magnitude", "dB"),
        curves: vec![
            curve("95 % interval", "after", Mark::Band, band.0, band.1),
            curve("model", "before", Mark::Line, decibels(&answer.model), Vec::new()),
            curve("estimate", "after", Mark::Line, decibels(&values), Vec::new()),
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

/// Midpoint and half-width of the magnitude's interval, dB.
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
    let of = |label: &str, class, mark, driven: Driven| {
        let own = distortion.lines.iter().filter(|line| line.driven == driven);
        let (x, y) = own.map(|line| (line.frequency_hz, line.amplitude)).unzip();
        Curve { label: label.into(), class, mark, x, y, spread: Vec::new() }
    };
    let (x, y) = distortion.lines.iter().map(|line| (line.frequency_hz, line.noise)).unzip();
    let noise = Curve { label: "noise".into(), class: "noise", mark: Mark::Line, x, y, spread: Vec::new() };
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
