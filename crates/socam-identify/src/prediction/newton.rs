//! Forces and port inputs that depend on each other, by a damped Newton method.

use crate::prediction::{
    dense_solve::solve,
    laws::{PortLaw, PortResponse, evaluate},
};

/// Most Newton steps; beyond them a shorter time step converges sooner.
const MOST_STEPS: usize = 40;

/// Memory for [`algebraic_solve`].
#[derive(Default)]
pub(crate) struct Workspace {
    matrix: Vec<f64>,
    step: Vec<f64>,
    right: Vec<f64>,
    active: Vec<usize>,
}

/// Solves the algebraic loop v = base + coupling f(v) for the port inputs v, beginning from `port_inputs`. `coupling` is square, row
/// by row; v may hold several instants one after the other, each with the inputs of all ports. `responses` are those at the solution.
/// Returns false where the iteration fails.
///
/// Only ports whose force depends on their input enter the linear systems: most laws are constant most of the time.
pub(crate) fn algebraic_solve(
    laws: &[PortLaw],
    base: &[f64],
    coupling: &[f64],
    port_inputs: &mut [f64],
    responses: &mut [PortResponse],
    workspace: &mut Workspace,
) -> bool {
    let count = port_inputs.len();
    for _ in 0..MOST_STEPS {
        evaluate(laws, port_inputs, responses);
        workspace.step.clear();
        for (row, (base, input)) in coupling.chunks_exact(count).zip(base.iter().zip(&*port_inputs)) {
            let caused: f64 = row.iter().zip(&*responses).map(|(c, response)| c * response.torque).sum();
            workspace.step.push(base + caused - input);
        }
        active_ports(responses, &mut workspace.active);
        loop_matrix(coupling, responses, &workspace.active, &mut workspace.matrix);
        workspace.right.clear();
        workspace.right.extend(workspace.active.iter().map(|i| workspace.step[*i]));
        if !solve(&mut workspace.matrix, &mut workspace.right, 1) {
            return false;
        }
        for (i, row) in coupling.chunks_exact(count).enumerate() {
            let moved = workspace.active.iter().zip(&workspace.right);
            workspace.step[i] += moved.map(|(j, step)| row[*j] * responses[*j].by_input * step).sum::<f64>();
        }
        let mut converged = true;
        for (i, (input, step)) in port_inputs.iter_mut().zip(&workspace.step).enumerate() {
            let (next, small) = laws[i % laws.len()].damped_step(*input, *step);
            converged &= small;
            *input = next;
        }
        if converged {
            for i in (0..count).filter(|i| laws[i % laws.len()].is_first_port()) {
                let own = i..i + laws[i % laws.len()].count();
                let rest: f64 = own.map(|j| responses[j].by_input * workspace.step[j]).sum();
                responses[i].torque += rest;
            }
            return true;
        }
    }
    false
}

/// Sets `active` to the ports whose force depends on their input.
pub(crate) fn active_ports(responses: &[PortResponse], active: &mut Vec<usize>) {
    active.clear();
    active.extend((0..responses.len()).filter(|i| responses[*i].by_input != 0.0));
}

/// Sets `matrix` to 1 - coupling diag(by_input) over the active ports: the Jacobian of the algebraic loop.
pub(crate) fn loop_matrix(
    coupling: &[f64],
    responses: &[PortResponse],
    active: &[usize],
    matrix: &mut Vec<f64>,
) {
    let count = responses.len();
    matrix.clear();
    for i in active {
        let row = &coupling[i * count..(i + 1) * count];
        matrix.extend(active.iter().map(|j| f64::from(i == j) - row[*j] * responses[*j].by_input));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::laws::INACTIVE;

    /// The solution is correct at any width of the law and any coupling.
    #[test]
    fn friction_and_speed_are_solved_together() {
        let effect = socam_model::effects::find("coulomb_friction").unwrap();
        for (torque, width, gain) in [(0.6, 0.05, 1e-3), (0.6, 0.05, 10.0), (5.0, 1e-4, 3.0)] {
            let law = PortLaw::of_one_input(&effect.laws()[0], vec![torque, width], width);
            for base in [-20.0, -0.3, -1e-5, 0.0, 1e-3, 2.0] {
                for start in [-5.0, 0.0, 1e-4, 3.0] {
                    let (mut speeds, mut responses) = ([start], [INACTIVE]);
                    let found = algebraic_solve(
                        std::slice::from_ref(&law),
                        &[base],
                        &[gain],
                        &mut speeds,
                        &mut responses,
                        &mut Workspace::default(),
                    );
                    let miss = speeds[0] - base - gain * law.at(&speeds).torque;
                    assert!(
                        found && miss.abs() < 1e-9 * (1.0 + gain * torque),
                        "{torque} {width} {gain} {base} {start}"
                    );
                }
            }
        }
    }
}
