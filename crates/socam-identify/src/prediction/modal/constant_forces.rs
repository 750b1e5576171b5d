//! Laws without inputs as one more input of the linear model.

use nalgebra::{DMatrix, DVector};
use socam_model::Equations;

use crate::prediction::start_state;

/// Equations and derivatives in which the constant forces of laws without inputs are the column of one more input, the constant 1. The
/// result has no ports.
pub(super) fn with_constant_forces(
    equations: &Equations,
    sensitivities: &[Equations],
    values: &[f64],
    free: &[usize],
) -> (Equations, Vec<Equations>) {
    if equations.ports.is_empty() {
        return (equations.clone(), sensitivities.to_vec());
    }
    let still = DVector::zeros(equations.ports.len());
    let (torque, _) = start_state::laws(equations, values, &still);
    let append = |matrix: &DMatrix<f64>, column: DVector<f64>| {
        let last = matrix.ncols();
        let mut wide = matrix.clone().insert_column(last, 0.0);
        wide.set_column(last, &column);
        wide
    };
    let extended = Equations {
        input: append(&equations.input, &equations.force * &torque),
        feedthrough: append(&equations.feedthrough, &equations.force_output * &torque),
        force: equations.force.columns(0, 0).into_owned(),
        port: equations.port.rows(0, 0).into_owned(),
        port_input: DMatrix::zeros(0, equations.input.ncols() + 1),
        ports: Vec::new(),
        ..equations.clone()
    };
    let extend = |sensitivity: &Equations, parameter: usize| {
        let law = start_state::law_sensitivities(equations, values, &still, parameter);
        Equations {
            input: append(&sensitivity.input, &sensitivity.force * &torque + &equations.force * &law),
            feedthrough: append(
                &sensitivity.feedthrough,
                &sensitivity.force_output * &torque + &equations.force_output * &law,
            ),
            force: sensitivity.force.columns(0, 0).into_owned(),
            port: sensitivity.port.rows(0, 0).into_owned(),
            port_input: DMatrix::zeros(0, sensitivity.input.ncols() + 1),
            ..sensitivity.clone()
        }
    };
    let sensitivities = sensitivities
        .iter()
        .zip(free)
        .map(|(sensitivity, parameter)| extend(sensitivity, *parameter))
        .collect();
    (extended, sensitivities)
}
