//! Start states of a simulation: the equilibrium, or a guess from the first samples.

use nalgebra::{DMatrix, DVector};
use socam_model::Equations;

/// Force of each port, and its derivative with respect to the port's own input, at the port inputs `seen`.
pub(crate) fn laws(
    equations: &Equations,
    values: &[f64],
    seen: &DVector<f64>,
) -> (DVector<f64>, DVector<f64>) {
    let mut torque = DVector::zeros(equations.ports.len());
    let mut derivative = torque.clone();
    for (index, port) in equations.ports.iter().enumerate().filter(|(_, port)| port.law_input == 0) {
        let response = port.evaluate(&seen.as_slice()[index..], &port.values(values));
        torque[index] = response.torque;
        for law_input in 0..port.law.law_inputs.len() {
            derivative[index + law_input] = response.derivatives[law_input];
        }
    }
    (torque, derivative)
}

/// Steps of Newton's method, and of the fall where it fails.
const NEWTON_STEPS: usize = 50;
const FALL_STEPS: usize = 200;
/// Growth of the time step of a fall.
const GROWTH: f64 = 1.5;

/// Equilibrium state at constant `inputs`: a state at which A x + B u + H f(V x + W u) = 0; `None` where there is none, as for a free
/// position. The direct effect of forces on port inputs (laws on massless nodes) is neglected.
///
/// Newton's method fails where nothing holds the machine near a state of zero, as within a backlash. It is then let go: implicit Euler steps
/// that grow (pseudo-transient continuation: C. T. Kelley and D. E. Keyes, SIAM J. Numer. Anal. 35, 1998), until it has settled on
/// what holds it.
pub(crate) fn equilibrium(equations: &Equations, values: &[f64], inputs: &[f64]) -> Option<DVector<f64>> {
    let start = DVector::zeros(equations.state.nrows());
    settled(equations, values, inputs, start.clone()).or_else(|| {
        let mut state = start;
        // Short beside every time constant.
        let mut step_s = 1e-3 / equations.state.amax().max(1e-3);
        for _ in 0..FALL_STEPS {
            let (rate, slope) = rate(equations, values, inputs, &state);
            let each = DMatrix::identity(state.len(), state.len()) / step_s;
            state += (each - slope).full_piv_lu().solve(&rate)?;
            step_s *= GROWTH;
            if !state.amax().is_finite() {
                return None;
            }
        }
        settled(equations, values, inputs, state)
    })
}

/// Newton's method for the equilibrium.
fn settled(
    equations: &Equations,
    values: &[f64],
    inputs: &[f64],
    mut x: DVector<f64>,
) -> Option<DVector<f64>> {
    for _ in 0..NEWTON_STEPS {
        let (rate, slope) = rate(equations, values, inputs, &x);
        let step = slope.full_piv_lu().solve(&rate)?;
        let size = step.amax();
        x -= step;
        if !size.is_finite() {
            return None;
        }
        if size <= 1e-12 * x.amax().max(1e-12) {
            break;
        }
    }
    Some(x)
}

/// Rate of the state, and its derivative with respect to the state.
fn rate(
    equations: &Equations,
    values: &[f64],
    inputs: &[f64],
    x: &DVector<f64>,
) -> (DVector<f64>, DMatrix<f64>) {
    let u = DVector::from_column_slice(inputs);
    let seen = &equations.port * x + &equations.port_input * &u;
    let (torque, derivative) = laws(equations, values, &seen);
    let rate = &equations.state * x + &equations.input * &u + &equations.force * torque;
    let bend = DMatrix::from_diagonal(&derivative) * &equations.port;
    (rate, &equations.state + &equations.force * bend)
}

/// Derivative of [`equilibrium`] with respect to each parameter whose derivatives are given.
pub(crate) fn equilibrium_sensitivities(
    equations: &Equations,
    derivatives: &[Equations],
    values: &[f64],
    free: &[usize],
    inputs: &[f64],
    x: &DVector<f64>,
) -> Option<Vec<DVector<f64>>> {
    let u = DVector::from_column_slice(inputs);
    let speeds = &equations.port * x + &equations.port_input * &u;
    let (torque, derivative) = laws(equations, values, &speeds);
    let bend = DMatrix::from_diagonal(&derivative);
    let lu = (&equations.state + &equations.force * &bend * &equations.port).full_piv_lu();
    let each = derivatives.iter().zip(free).map(|(d, parameter)| {
        let seen = &d.port * x + &d.port_input * &u;
        let law = law_sensitivities(equations, values, &speeds, *parameter);
        let force = &d.force * &torque + &equations.force * (&bend * seen + law);
        lu.solve(&-(&d.state * x + &d.input * &u + force))
    });
    each.collect()
}

/// Derivative of each law's torque with respect to one parameter of the model.
pub(crate) fn law_sensitivities(
    equations: &Equations,
    values: &[f64],
    speeds: &DVector<f64>,
    parameter: usize,
) -> DVector<f64> {
    DVector::from_fn(equations.ports.len(), |index, _| {
        let port = &equations.ports[index];
        if port.law_input > 0 {
            return 0.0;
        }
        let response = port.evaluate(&speeds.as_slice()[index..], &port.values(values));
        let own = port.parameters.iter().enumerate().filter(|(_, p)| **p == parameter);
        own.map(|(position, _)| response.by_parameter[position]).sum()
    })
}

/// A start state close to the equilibrium that also fits the first measured outputs: least squares of both, each equation scaled to a
/// largest coefficient of one. Missing outputs are NaN.
pub(crate) fn guess(equations: &Equations, values: &[f64], inputs: &[f64], outputs: &[f64]) -> Vec<f64> {
    let u = DVector::from_column_slice(inputs);
    let states = equations.state.nrows();
    let still = DVector::zeros(equations.ports.len());
    let (torque, _) = laws(equations, values, &still);
    let rest = -(&equations.input * &u) - &equations.force * torque;
    let seen = &equations.feedthrough * &u;
    let mut rows: Vec<(DVector<f64>, f64)> = Vec::new();
    for i in 0..states {
        rows.push((equations.state.row(i).transpose(), rest[i]));
    }
    for (i, measured) in outputs.iter().enumerate().filter(|(_, measured)| measured.is_finite()) {
        rows.push((equations.output.row(i).transpose(), measured - seen[i]));
    }
    rows.retain(|(row, _)| row.amax() > 0.0);
    if rows.is_empty() || states == 0 {
        return vec![0.0; states];
    }
    let matrix = DMatrix::from_fn(rows.len(), states, |i, j| rows[i].0[j] / rows[i].0.amax());
    let right = DVector::from_fn(rows.len(), |i, _| rows[i].1 / rows[i].0.amax());
    let solution = matrix.svd(true, true).solve(&right, 1e-9);
    solution.map_or_else(|_| vec![0.0; states], |x| x.iter().copied().collect())
}
