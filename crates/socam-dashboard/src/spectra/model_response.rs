//! The frequency response of the model.

use nalgebra::Complex;
use socam_model::Model;

use super::response::unjoined;

/// Magnitude and phase (degrees) of the model's response at the values of its file.
pub(super) fn model_response(
    model: &Model,
    output: &str,
    input: Option<&str>,
    [from, to]: [f64; 2],
) -> [Vec<Vec<[f64; 2]>>; 2] {
    let position = |mut channels: Box<dyn Iterator<Item = &socam_model::Channel> + '_>, column: &str| {
        channels.position(|channel| channel.column == column)
    };
    let row = position(Box::new(model.outputs()), output);
    let column = input.and_then(|input| position(Box::new(model.inputs()), input));
    let (Some(row), Some(column), Ok(equations)) = (row, column, model.equations(&model.values())) else {
        return [Vec::new(), Vec::new()];
    };
    let points = 400;
    let at = |n: i32| from * (to / from).powf(f64::from(n) / f64::from(points));
    let values: Vec<(f64, Complex<f64>)> = (0..=points)
        .filter_map(|n| {
            let s = Complex::new(0.0, std::f64::consts::TAU * at(n));
            equations.transfer(row, column, s).map(|value| (at(n), value))
        })
        .collect();
    let magnitude = values.iter().map(|(f, value)| [*f, value.norm()]).collect();
    let phase: Vec<[f64; 2]> = values.iter().map(|(f, value)| [*f, value.arg().to_degrees()]).collect();
    [vec![magnitude], unjoined(&phase)]
}
