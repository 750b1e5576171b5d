//! The right-hand side of the equations of motion, for importers that integrate it themselves.

use nalgebra::{DMatrix, DVector};
use socam_model::Equations;

/// Most Newton iterations for laws that are coupled algebraically; they are monotone and converge in a few.
const ITERATIONS: usize = 30;

/// x' = A x + B u + H f with f = laws(v), v = V x + W u + U f, at `values` of all parameters. Where the laws on massless nodes do not settle,
/// the last iterate is used.
pub(crate) fn rates(e: &Equations, values: &[f64], state: &[f64], inputs: &[f64]) -> Vec<f64> {
    let (x, u) = (DVector::from_column_slice(state), DVector::from_column_slice(inputs));
    let free = &e.port * &x + &e.port_input * &u;
    let mut seen = free.clone();
    let (mut force, mut slopes) = laws(e, values, &seen);
    for _ in 0..ITERATIONS {
        let residual = &free + &e.port_force * &force - &seen;
        // Without massless nodes U is zero, and the first residual is too.
        if residual.amax() <= 1e-12 * (1.0 + free.amax()) {
            break;
        }
        let closed =
            DMatrix::identity(slopes.len(), slopes.len()) - &e.port_force * DMatrix::from_diagonal(&slopes);
        let Some(change) = closed.lu().solve(&residual) else { break };
        seen += change;
        (force, slopes) = laws(e, values, &seen);
    }
    (&e.state * x + &e.input * u + &e.force * force).iter().copied().collect()
}

/// Force of each port, and its derivative with respect to the port's own input.
fn laws(e: &Equations, values: &[f64], seen: &DVector<f64>) -> (DVector<f64>, DVector<f64>) {
    let mut force = DVector::zeros(e.ports.len());
    let mut slopes = force.clone();
    for (index, port) in e.ports.iter().enumerate().filter(|(_, port)| port.law_input == 0) {
        let response = port.evaluate(&seen.as_slice()[index..], &port.values(values));
        force[index] = response.torque;
        for law_input in 0..port.law.law_inputs.len() {
            slopes[index + law_input] = response.derivatives[law_input];
        }
    }
    (force, slopes)
}
