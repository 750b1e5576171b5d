//! Sensitivities of the forces in an algebraic loop.

use crate::prediction::{
    dense_solve,
    laws::{PortLaw, PortResponse},
    newton,
};

/// Memory for [`solve_force_sensitivities`].
#[derive(Default)]
pub(crate) struct Workspace {
    matrix: Vec<f64>,
    active: Vec<usize>,
    port_inputs: Vec<f64>,
}

/// Solves v = v0 + C f and f = L v + q for the sensitivities f of the forces.
///
/// v0 (`port_inputs`) are the sensitivities of the port inputs at constant forces, C is the `coupling`, L the derivative of the laws
/// with respect to their inputs, and q that with respect to their own parameters. `port_inputs` and `forces` have one row per port and
/// instant and one column per unknown. Rows of v0 are read only for ports whose force depends on their input.
pub(crate) fn solve_force_sensitivities(
    laws: &[PortLaw],
    responses: &[PortResponse],
    coupling: &[f64],
    port_inputs: &[f64],
    forces: &mut [f64],
    workspace: &mut Workspace,
) {
    let count = responses.len();
    if count == 0 {
        return;
    }
    let columns = port_inputs.len() / count;
    if columns == 0 {
        return;
    }
    newton::active_ports(responses, &mut workspace.active);
    workspace.port_inputs.clear();
    for i in &workspace.active {
        let from = workspace.port_inputs.len();
        workspace.port_inputs.extend_from_slice(&port_inputs[i * columns..(i + 1) * columns]);
        for (k, response) in responses.iter().enumerate() {
            for (position, column) in &laws[k % laws.len()].free {
                workspace.port_inputs[from + column] +=
                    coupling[i * count + k] * response.by_parameter[*position];
            }
        }
    }
    newton::loop_matrix(coupling, responses, &workspace.active, &mut workspace.matrix);
    // The prediction reports the overflow that makes the matrix singular; sensitivities are then of no use.
    if !dense_solve::solve(&mut workspace.matrix, &mut workspace.port_inputs, columns) {
        workspace.port_inputs.fill(0.0);
    }
    forces.fill(0.0);
    for (i, input) in workspace.active.iter().zip(workspace.port_inputs.chunks_exact(columns)) {
        let force = &mut forces[i * columns..(i + 1) * columns];
        force.iter_mut().zip(input).for_each(|(f, v)| *f = responses[*i].by_input * v);
    }
    for (k, response) in responses.iter().enumerate() {
        for (position, column) in &laws[k % laws.len()].free {
            forces[k * columns + column] += response.by_parameter[*position];
        }
    }
}
