//! Poles of the model and zeros from an input to an output, on the complex plane and as a table.

use egui::{ComboBox, Grid, RichText, ScrollArea, Ui, vec2};
use nalgebra::Complex;
use socam_model::{Mode, Model};

use socam_chart::chart::{Chart, Curve, Flag, MarkerShape, Seen, Style, range_of, with_room};
use socam_chart::numbers::number;
use socam_chart::table::heads;
use socam_chart::theme;

/// Output and input of the zeros, as indices of the model's outputs and inputs.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ZeroChannels {
    output: usize,
    input: usize,
}

/// Draws the view.
pub(super) fn ui(ui: &mut Ui, model: &Model, between: &mut ZeroChannels, seen: &mut Vec<Seen>) {
    let Ok(equations) = model.equations(&model.values()) else {
        ui.label(RichText::new("this model has no linear part to show").color(theme::alarm(ui)));
        return;
    };
    let outputs: Vec<&str> = model.outputs().map(|channel| channel.name.as_str()).collect();
    let inputs: Vec<&str> = model.inputs().map(|channel| channel.name.as_str()).collect();
    choose(ui, between, &outputs, &inputs);
    let there = between.output < outputs.len() && between.input < inputs.len();
    let zeros = if there { equations.zeros(between.output, between.input) } else { Vec::new() };
    ui.label(
        RichText::new(format!("{} at its file's values; force laws are left out", model.name))
            .color(theme::weak(ui)),
    );
    table(ui, &equations.modes(), &zeros);
    let poles = equations.poles().iter().map(|pole| [pole.re, pole.im]).collect();
    let zeros = zeros.iter().map(|zero| [zero.re, zero.im]).collect();
    plane(ui, poles, zeros, seen);
}

/// The channels between which zeros are shown.
fn choose(ui: &mut Ui, between: &mut ZeroChannels, outputs: &[&str], inputs: &[&str]) {
    ui.horizontal(|ui| {
        for (chosen, name, names) in
            [(&mut between.output, "zeros of", outputs), (&mut between.input, "over", inputs)]
        {
            *chosen = (*chosen).min(names.len().saturating_sub(1));
            let label = ui.label(name);
            let text = names.get(*chosen).copied().unwrap_or("none");
            let shown = ComboBox::from_id_salt(name).selected_text(text).width(160.0).show_ui(ui, |ui| {
                for (index, name) in names.iter().enumerate() {
                    ui.selectable_value(chosen, index, *name);
                }
            });
            shown.response.labelled_by(label.id);
        }
    });
}

/// Poles and zeros with their frequencies and damping ratios.
fn table(ui: &mut Ui, modes: &[Mode], zeros: &[Complex<f64>]) {
    egui::Panel::right("modes").exact_size(400.0).show(ui, |ui| {
        ScrollArea::both().show(ui, |ui| {
            Grid::new("modes").striped(true).spacing([18.0, 4.0]).show(ui, |ui| {
                heads(ui, &["pole, 1/s", "natural frequency, Hz", "damping ratio"]);
                for mode in modes {
                    let pole = mode.pole;
                    ui.label(RichText::new(complex(pole.re, pole.im)).monospace());
                    ui.label(RichText::new(number(mode.natural_frequency_hz)).monospace());
                    ui.label(RichText::new(number(mode.damping_ratio)).monospace());
                    ui.end_row();
                }
            });
            Grid::new("zeros").striped(true).spacing([18.0, 4.0]).show(ui, |ui| {
                heads(ui, &["zero, 1/s", "natural frequency, Hz"]);
                for zero in zeros.iter().filter(|zero| zero.im >= 0.0) {
                    ui.label(RichText::new(complex(zero.re, zero.im)).monospace());
                    let frequency_hz = zero.norm() / std::f64::consts::TAU;
                    ui.label(RichText::new(number(frequency_hz)).monospace());
                    ui.end_row();
                }
            });
        });
    });
}

/// Poles and zeros on the complex plane.
fn plane(ui: &mut Ui, poles: Vec<[f64; 2]>, zeros: Vec<[f64; 2]>, seen: &mut Vec<Seen>) {
    let size = vec2(ui.available_width(), ui.available_height());
    let mut chart = Chart::new("poles", String::new(), size);
    chart.x_label = "real part, 1/s".into();
    // Poles and zeros beyond twice the largest oscillating pole are left out: they would compress the scale.
    let largest =
        poles.iter().filter(|point| point[1] != 0.0).map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max);
    let is_near = |point: &&[f64; 2]| largest == 0.0 || point[0].hypot(point[1]) < 2.0 * largest;
    let omitted = poles.iter().chain(&zeros).filter(|point| !is_near(point)).count();
    // The unit is what stands behind the last comma.
    let farther = if omitted > 0 { format!(", {omitted} farther out") } else { String::new() };
    chart.title = format!("poles (crosses) and zeros (circles){farther}: imaginary part, 1/s");
    let drawn = || poles.iter().chain(&zeros).filter(is_near);
    let reals = drawn().map(|point| point[0]).chain([0.0]);
    chart.x = range_of(reals).map_or([-1.0, 1.0], with_room);
    chart.y = chart.fitted(range_of(drawn().map(|point| point[1]).chain([0.0])));
    chart.flags = vec![Flag::new(0.0, "limit of stability", theme::weak(ui))];
    chart.when_empty = "the model has no states";
    chart.curves = [("poles", 0, poles, MarkerShape::Cross), ("zeros", 1, zeros, MarkerShape::Circle)]
        .map(|(name, number, points, shape)| Curve {
            name: name.into(),
            colour: theme::line(ui, number),
            parts: vec![points],
            style: Style::Markers(shape),
        })
        .into();
    chart.show(ui, seen);
}

/// A real number, or a conjugate pair.
fn complex(re: f64, im: f64) -> String {
    if im == 0.0 { number(re) } else { format!("{} ± {} i", number(re), number(im.abs())) }
}
