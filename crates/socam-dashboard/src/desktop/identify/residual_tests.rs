//! Tests of the residuals of a fit: their correlation with themselves and with the inputs.

use egui::{Color32, Ui, vec2};
use socam_chart::beside;
use socam_chart::chart::{Chart, Curve, Seen, Style, range_of};
use socam_chart::theme;
use socam_identify::comparison::Traces;
use socam_workbench::cross_correlation::CrossCorrelation;
use socam_workbench::residual_test::Autocorrelation;

/// Tests of one recording; `None` where there is too little to say.
#[derive(Debug)]
pub(super) struct Tests {
    /// Of each output.
    whiteness: Vec<Option<Autocorrelation>>,
    /// Of each input, and there of each output.
    dependence: Vec<Vec<Option<CrossCorrelation>>>,
}

impl Tests {
    /// Tests the residuals in the segments of a recording.
    pub(super) fn of(traces: &[&Traces]) -> Self {
        let outputs = traces.first().map_or(0, |trace| trace.measured.len());
        let inputs = traces.first().map_or(0, |trace| trace.inputs.len());
        let residuals: Vec<Vec<Vec<f64>>> =
            (0..outputs).map(|output| traces.iter().map(|trace| residual(trace, output)).collect()).collect();
        let with = |input: usize, own: &Vec<Vec<f64>>| {
            let pairs = own.iter().zip(traces).map(|(own, trace)| [&own[..], &trace.inputs[input][..]]);
            CrossCorrelation::new(&pairs.collect::<Vec<_>>())
        };
        Self {
            whiteness: residuals
                .iter()
                .map(|own| Autocorrelation::new(&own.iter().map(Vec::as_slice).collect::<Vec<_>>()))
                .collect(),
            dependence: (0..inputs)
                .map(|input| residuals.iter().map(|own| with(input, own)).collect())
                .collect(),
        }
    }

    /// Draws the autocorrelation of an output's residuals.
    pub(super) fn whiteness(
        &self,
        ui: &mut Ui,
        (output, name): (usize, &str),
        place: Place,
        seen: &mut Vec<Seen>,
    ) {
        let found = self.whiteness.get(output).and_then(Option::as_ref);
        let bars = found.map(|found| Bars {
            lags: (1..=found.values.len()).map(|lag| lag as f64).collect(),
            values: &found.values,
            bound: found.bound,
            said: found.sentence(),
        });
        draw(
            ui,
            ("whiteness", output),
            (&format!("autocorrelation of {name}"), "autocorrelation"),
            bars,
            place,
            seen,
        );
    }

    /// Draws the correlation of an output's residuals with an input.
    pub(super) fn dependence(
        &self,
        ui: &mut Ui,
        (output, name): (usize, &str),
        (input, input_name): (usize, &str),
        place: Place,
        seen: &mut Vec<Seen>,
    ) {
        let found = self.dependence.get(input).and_then(|own| own.get(output)?.as_ref());
        let bars = found.map(|found| Bars {
            lags: found.lags.iter().map(|lag| *lag as f64).collect(),
            values: &found.values,
            bound: found.bound,
            said: found.sentence(),
        });
        let title = format!("residual of {name} with {input_name}");
        draw(ui, ("dependence", output), (&title, "correlation"), bars, place, seen);
    }
}

fn residual(trace: &Traces, output: usize) -> Vec<f64> {
    trace.measured[output].iter().zip(&trace.predicted[output]).map(|(m, p)| m - p).collect()
}

/// Height of a chart, points, and whether it is the lowest one, which has the axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) height: f32,
    pub(super) is_lowest: bool,
}

/// A bar for each lag, and the bounds of chance.
struct Bars<'a> {
    lags: Vec<f64>,
    values: &'a [f64],
    bound: f64,
    said: String,
}

fn draw(
    ui: &mut Ui,
    id: (&'static str, usize),
    (title, name): (&str, &str),
    bars: Option<Bars<'_>>,
    place: Place,
    seen: &mut Vec<Seen>,
) {
    let said = bars.as_ref().map_or_else(String::new, |bars| format!(": {}", bars.said));
    let mut chart = Chart::new(id, format!("{title}{said}"), vec2(ui.available_width(), place.height));
    chart.when_empty = "too few residuals, or they do not change";
    if place.is_lowest {
        chart.x_label = "lag, samples".into();
    }
    chart.x = [0.0, 1.0];
    if let Some(bars) = &bars {
        let ends = range_of(bars.lags.iter().copied().chain([0.0])).unwrap_or([0.0, 1.0]);
        chart.x = [if ends[0] < 0.0 { ends[0] - 1.0 } else { 0.0 }, ends[1] + 1.0];
        let [first, last] = chart.x;
        let ground = theme::good(ui).gamma_multiply(0.2);
        chart.bands = vec![(vec![[first, -bars.bound, bars.bound], [last, -bars.bound, bars.bound]], ground)];
        chart.curves = curves(bars, name, beside::ink(ui), theme::alarm(ui));
        let values = bars.values.iter().copied().chain([bars.bound, -bars.bound, 0.0]);
        chart.y = chart.fitted(range_of(values));
    }
    chart.show(ui, seen);
}

/// A line from zero for each lag, so that each is seen; those beyond the bounds in another colour.
fn curves(bars: &Bars<'_>, name: &str, within: Color32, beyond: Color32) -> Vec<Curve> {
    let of = |is_beyond: bool| {
        let own = bars.lags.iter().zip(bars.values);
        let own = own.filter(move |(_, value)| (value.abs() > bars.bound) == is_beyond);
        own.map(|(lag, value)| vec![[*lag, 0.0], [*lag, *value]]).collect::<Vec<_>>()
    };
    let curve = |name: String, colour: Color32, parts| Curve { name, colour, parts, style: Style::Solid };
    vec![
        curve(format!("{name} within the bounds"), within, of(false)),
        curve(format!("{name} beyond the bounds"), beyond, of(true)),
    ]
}
