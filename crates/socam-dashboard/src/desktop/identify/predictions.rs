//! Measured and predicted signals of a fitted model.

use egui::{ComboBox, ScrollArea, Ui, vec2};
use socam_identify::{
    Identification, IdentifyError, NoiseLevels, Options, Problem,
    comparison::{self, NoiseModel, Traces},
};
use socam_model::Model;
use socam_recording::{Dataset, Segment};

use socam_chart::beside::{self, measured, predicted};
use socam_chart::chart::{Chart, Curve, Seen, Style, range_of, with_room};
use socam_chart::theme;
use socam_samples::{Samples, envelope};
use socam_workbench::display_units::{DisplayUnits, ShownIn};
use socam_workbench::recording::short;
use socam_workbench::signal::Signal;

use super::residual_tests::{Place, Tests};

/// One recording: for each channel the columns measured, predicted and their difference.
#[derive(Debug)]
pub(super) struct Predicted {
    name: String,
    is_held_out: bool,
    /// Names and units of the channels.
    channels: Vec<(String, String)>,
    samples: Samples,
    /// Names of the inputs.
    inputs: Vec<String>,
    tests: Tests,
}

/// Signals of all recordings at a fit; `None` where the prediction overflows.
pub(super) fn of(
    model: &Model,
    data: &[Dataset],
    fit: &Identification,
    options: &Options,
    is_held_out: bool,
) -> Result<Vec<Predicted>, IdentifyError> {
    if data.is_empty() {
        return Ok(Vec::new());
    }
    let problem = Problem::new(model, data, options.clone())?;
    let noise = NoiseModel::new(&[&problem], &fit.point, levels(model, fit))?;
    let Some(at) = comparison::measure(&problem, &noise, &fit.point)? else { return Ok(Vec::new()) };
    let traces = comparison::traces(&problem, &at, None)?;
    let channels: Vec<(String, String)> =
        model.outputs().map(|channel| (channel.name.clone(), channel.unit.to_owned())).collect();
    let one = |(index, data): (usize, &Dataset)| {
        let own: Vec<&Traces> = traces.iter().filter(|trace| trace.recording == index).collect();
        Predicted {
            name: data.name().to_owned(),
            is_held_out,
            channels: channels.clone(),
            samples: samples(&own),
            inputs: model.inputs().map(|input| input.name.clone()).collect(),
            tests: Tests::of(&own),
        }
    };
    Ok(data.iter().enumerate().map(one).collect())
}

/// Noise levels of a fit, SI.
fn levels(model: &Model, fit: &Identification) -> NoiseLevels {
    let outputs = fit.fit.channels.iter().map(|(_, channel)| channel.noise_std.max(1e-100)).collect();
    let known =
        |name: &str| fit.input_noise_std.iter().find(|(own, _)| own == name).map_or(0.0, |(_, std)| *std);
    NoiseLevels { outputs, inputs: model.inputs().map(|input| known(&input.name)).collect() }
}

/// The segments of a recording, one after another.
fn samples(traces: &[&Traces]) -> Samples {
    let outputs = traces.first().map_or(0, |trace| trace.measured.len());
    let (mut time_s, mut columns, mut segments) = (Vec::new(), vec![Vec::new(); 3 * outputs], Vec::new());
    for trace in traces.iter().filter(|trace| !trace.time_s.is_empty()) {
        let rows = trace.time_s.len();
        let (start_s, end_s) = (trace.time_s[0], trace.time_s[rows - 1]);
        let sample_time_s = (end_s - start_s) / (rows - 1).max(1) as f64;
        let first_row = time_s.len() as u64;
        segments.push(Segment { first_row, rows: rows as u64, start_s, end_s, sample_time_s, jitter_s: 0.0 });
        time_s.extend_from_slice(&trace.time_s);
        for (output, (measured, predicted)) in trace.measured.iter().zip(&trace.predicted).enumerate() {
            columns[3 * output].extend_from_slice(measured);
            columns[3 * output + 1].extend_from_slice(predicted);
            columns[3 * output + 2].extend(measured.iter().zip(predicted).map(|(m, p)| m - p));
        }
    }
    Samples::in_memory(time_s, &columns, segments)
}

/// What is drawn of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Picture {
    #[default]
    Signals,
    Residuals,
    Whiteness,
    Dependence,
}

/// Signals that are drawn, and the part of them that is shown.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    recording: usize,
    picture: Picture,
    /// The input with which residuals are correlated.
    input: usize,
    /// The range of times, s, once it was moved.
    span_s: Option<[f64; 2]>,
}

/// Least height of a chart, points.
const LEAST_HEIGHT: f32 = 96.0;

impl Pictures {
    /// Draws one chart for each channel of a recording.
    pub(super) fn ui(&mut self, ui: &mut Ui, all: &[Predicted], units: &DisplayUnits, seen: &mut Vec<Seen>) {
        let shown = &all[self.recording.min(all.len() - 1)];
        ui.horizontal_wrapped(|ui| {
            for (picture, name) in [
                (Picture::Signals, "signals"),
                (Picture::Residuals, "residuals"),
                (Picture::Whiteness, "whiteness"),
                (Picture::Dependence, "by input"),
            ] {
                ui.selectable_value(&mut self.picture, picture, name);
            }
            let title = |one: &Predicted| {
                format!("{}{}", short(&one.name), if one.is_held_out { ", held out" } else { "" })
            };
            let choice = ComboBox::from_id_salt("predicted").width(220.0).selected_text(title(shown));
            let choice = choice.show_ui(ui, |ui| {
                for (index, one) in all.iter().enumerate() {
                    if ui.selectable_value(&mut self.recording, index, title(one)).clicked() {
                        self.span_s = None;
                    }
                }
            });
            choice
                .response
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "predicted recording"));
            if self.picture == Picture::Signals {
                beside::legend(ui, "measured", beside::ink(ui), Style::Thin);
                beside::legend(ui, "predicted", theme::good(ui), Style::Broad);
            }
            if self.picture == Picture::Dependence {
                self.inputs(ui, &shown.inputs);
            }
        });
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let count = shown.channels.len().max(1) as f32;
            let height = (ui.available_height() / count - 6.0).max(LEAST_HEIGHT);
            for (index, (name, unit)) in shown.channels.iter().enumerate() {
                let place = Place { height, is_lowest: index + 1 == shown.channels.len() };
                let output = (index, name.as_str());
                match self.picture {
                    Picture::Whiteness => shown.tests.whiteness(ui, output, place, seen),
                    Picture::Dependence => {
                        let input = shown.inputs.get(self.input).map_or("", String::as_str);
                        shown.tests.dependence(ui, output, (self.input, input), place, seen);
                    }
                    Picture::Signals | Picture::Residuals => {
                        let in_unit = units.of(&Signal { name: name.clone(), unit: unit.clone() });
                        self.chart(ui, (shown, index, &in_unit), height, seen);
                    }
                }
            }
        });
    }

    /// The choice of the input with which residuals are correlated.
    fn inputs(&mut self, ui: &mut Ui, inputs: &[String]) {
        self.input = self.input.min(inputs.len().saturating_sub(1));
        if inputs.len() < 2 {
            return;
        }
        let choice = ComboBox::from_id_salt("input").width(160.0).selected_text(&inputs[self.input]);
        let choice = choice.show_ui(ui, |ui| {
            for (index, name) in inputs.iter().enumerate() {
                ui.selectable_value(&mut self.input, index, name);
            }
        });
        let said = || egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "correlated input");
        choice.response.widget_info(said);
    }

    fn chart(
        &mut self,
        ui: &mut Ui,
        (shown, index, in_unit): (&Predicted, usize, &ShownIn),
        height: f32,
        seen: &mut Vec<Seen>,
    ) {
        let (name, unit) = (&shown.channels[index].0, &in_unit.unit);
        let are_residuals = self.picture == Picture::Residuals;
        let what = if are_residuals { "measured minus predicted" } else { "measured and predicted" };
        let width = ui.available_width();
        let mut chart =
            Chart::new(("predicted", index), format!("{name}: {what}, {unit}"), vec2(width, height));
        if index + 1 == shown.channels.len() {
            chart.x_label = "time, s".into();
        }
        let whole = shown.samples.span_s().map_or([0.0, 1.0], with_room);
        chart.x = self.span_s.unwrap_or(whole);
        let [from, to] = chart.x;
        let line = |column| {
            let mut line = envelope(&shown.samples, 3 * index + column, from, to, width as usize);
            line.parts.iter_mut().flatten().for_each(|point| point[1] *= in_unit.per_si);
            line.parts
        };
        chart.curves = if are_residuals {
            let (name, colour) = ("residual".into(), theme::alarm(ui));
            vec![Curve { name, colour, parts: line(2), style: Style::Solid }]
        } else {
            vec![predicted("predicted", theme::good(ui), line(1)), measured(ui, line(0))]
        };
        let values = chart.curves.iter().flat_map(|curve| curve.parts.iter().flatten().map(|point| point[1]));
        chart.y = chart.fitted(range_of(values));
        let drawn = chart.show(ui, seen);
        if drawn.x_moved {
            self.span_s = Some(drawn.x);
        }
        if drawn.response.double_clicked() {
            self.span_s = None;
        }
    }
}
