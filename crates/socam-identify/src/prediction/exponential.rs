//! Exact steps of a model's linear part, with their sensitivities.
//!
//! Over a step, inputs and forces follow parabolas through their values at its start, middle and end. The state at the end is then
//! linear in xi (see [`step_level`](crate::prediction::step_level)), by maps made of the functions phi_1 to phi_3 of the exponential.
//! This is exponential collocation at Lobatto nodes, of fourth order (Hochbruck and Ostermann 2005,
//! doi:10.1016/j.apnum.2004.08.005). Only the forces are approximated, however stiff the drivetrain.

use nalgebra::DMatrix;
use socam_model::Equations;

use crate::prediction::{
    modes::balance,
    step_level::{Dimensions, StepLevel},
};

/// The shortest step is a sample halved this many times.
pub(crate) const HALVINGS: usize = 10;

/// Terms of the series of phi_3. At norms up to one half the next term is below rounding.
const TERMS: usize = 13;

/// Lengths of the steps from sample to sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SampleSteps {
    /// All of this length, s.
    Even(f64),
    /// Of different lengths, the longest of this one, s.
    Uneven(f64),
}

impl SampleSteps {
    /// Length of the longest step whose map is stored, s; a little more than that of the longest step, which is rounded to parts.
    pub(crate) fn longest_s(self) -> f64 {
        match self {
            Self::Even(step_s) => step_s,
            Self::Uneven(longest_s) => 1.002 * longest_s,
        }
    }
}

/// The maps of steps of a sample, half a sample, and so on to the shortest step; that of a sample alone where all samples have the same step
/// and `equations` have no ports. `sensitivities` are the derivatives of `equations` with respect to the free parameters. `None` where the
/// exponential overflows.
pub(crate) fn levels(
    equations: &Equations,
    sensitivities: &[Equations],
    steps: SampleSteps,
) -> Option<Vec<StepLevel>> {
    let sample_time_s = steps.longest_s();
    let dimensions = Dimensions::new(equations, sensitivities.len());
    // The port inputs at the quarters of the shortest step need two levels more.
    let is_whole = dimensions.ports == 0 && matches!(steps, SampleSteps::Even(_));
    let stored = if is_whole { 1 } else { HALVINGS + 3 };
    let scale = balance(&equations.state);
    let balanced = |e: &Equations| {
        DMatrix::from_fn(dimensions.states, dimensions.states, |i, j| e.state[(i, j)] * scale[j] / scale[i])
    };
    let size = balanced(equations).row_iter().map(|row| row.lp_norm(1)).fold(0.0, f64::max) * sample_time_s;
    if !size.is_finite() {
        return None;
    }
    let needed = (2.0 * size).max(1.0).log2().ceil() as usize;
    let halvings = needed.max(stored - 1);
    let driven = |e: &Equations| {
        let both = |i: usize, j: usize| {
            let value =
                if j < dimensions.inputs { e.input[(i, j)] } else { e.force[(i, j - dimensions.inputs)] };
            value / scale[i]
        };
        DMatrix::from_fn(dimensions.states, dimensions.inputs + dimensions.ports, both)
    };
    let step_s = sample_time_s * 0.5_f64.powi(halvings as i32);
    let linear = |e: &Equations| Linear { state: balanced(e) * step_s, drive: driven(e) * step_s };
    let mut steps = vec![Step::finest(
        &linear(equations),
        &sensitivities.iter().map(linear).collect::<Vec<_>>(),
        dimensions,
    )];
    for _ in 0..halvings {
        let doubled = steps[steps.len() - 1].doubled(dimensions);
        steps.push(doubled);
    }
    let mut steps = steps.split_off(halvings + 1 - stored);
    steps.reverse();
    steps.iter_mut().for_each(|step| step.unscale(&scale));
    if !steps[0].value.iter().all(|value| value.is_finite()) {
        return None;
    }
    if is_whole {
        return Some(vec![StepLevel::new(&[(&steps[0].value, &steps[0].sensitivities)], dimensions)]);
    }
    Some(
        (0..=HALVINGS)
            .map(|level| with_port_inputs(equations, sensitivities, &steps[level..level + 3], dimensions))
            .collect(),
    )
}

/// A h and [B H] h for a step h, or their derivatives.
struct Linear {
    state: DMatrix<f64>,
    drive: DMatrix<f64>,
}

/// The map from xi to the state at a step's end, and its sensitivities.
struct Step {
    value: DMatrix<f64>,
    sensitivities: Vec<DMatrix<f64>>,
}

impl Step {
    /// The shortest step, by the series of phi_3; the other functions follow from phi_k = 1/k! + A phi_(k+1).
    fn finest(linear: &Linear, sensitivities: &[Linear], dimensions: Dimensions) -> Self {
        let (n, a) = (dimensions.states, &linear.state);
        let unit = |value: f64| DMatrix::from_diagonal_element(n, n, value);
        let factorials: Vec<f64> = (0..TERMS + 4)
            .scan(1.0, |factorial, k| {
                *factorial *= f64::from(k.max(1) as u32);
                Some(*factorial)
            })
            .collect();
        let up = |phi: &DMatrix<f64>, d: &mut [DMatrix<f64>], constant: f64| {
            for (d, sensitivity) in d.iter_mut().zip(sensitivities) {
                *d = &sensitivity.state * phi + a * &*d;
            }
            a * phi + unit(constant)
        };
        let mut phi = unit(1.0 / factorials[TERMS + 3]);
        let mut d = vec![DMatrix::zeros(n, n); sensitivities.len()];
        for term in (0..TERMS).rev() {
            phi = up(&phi, &mut d, 1.0 / factorials[term + 3]);
        }
        let mut all = vec![(phi, d.clone())];
        for k in [2, 1, 0] {
            let phi = up(&all[all.len() - 1].0, &mut d, 1.0 / factorials[k]);
            all.push((phi, d.clone()));
        }
        all.reverse();
        let along = |weights: [f64; 3], pick: &dyn Fn(usize) -> DMatrix<f64>| {
            (1..=3).map(|k| pick(k) * weights[k - 1]).fold(DMatrix::zeros(n, n), |sum, term| sum + term)
        };
        // Weights of phi_1, phi_2 and phi_3 for the parabolas that are 1 at one of the nodes 0, 1/2 and 1, and 0 at the others.
        let parabolas = [[1.0, -3.0, 4.0], [0.0, 4.0, -8.0], [0.0, -1.0, 4.0]];
        let gather = |phi: &DMatrix<f64>, drive: &dyn Fn([f64; 3]) -> DMatrix<f64>| {
            let mut map = DMatrix::zeros(n, dimensions.width());
            map.columns_mut(0, n).copy_from(phi);
            for (i, weights) in parabolas.iter().enumerate() {
                let driven = drive(*weights);
                map.columns_mut(n + i * dimensions.inputs, dimensions.inputs)
                    .copy_from(&driven.columns(0, dimensions.inputs));
                map.columns_mut(dimensions.forces() + i * dimensions.ports, dimensions.ports)
                    .copy_from(&driven.columns(dimensions.inputs, dimensions.ports));
            }
            map
        };
        let value = gather(&all[0].0, &|weights| along(weights, &|k| all[k].0.clone()) * &linear.drive);
        let sensitivities = sensitivities.iter().enumerate().map(|(j, sensitivity)| {
            gather(&all[0].1[j], &|weights| {
                along(weights, &|k| all[k].1[j].clone()) * &linear.drive
                    + along(weights, &|k| all[k].0.clone()) * &sensitivity.drive
            })
        });
        Self { sensitivities: sensitivities.collect(), value }
    }

    /// The map of two such steps in sequence.
    fn doubled(&self, dimensions: Dimensions) -> Self {
        let after = |first: &DMatrix<f64>, last: &DMatrix<f64>| {
            let mut map = last.columns(0, dimensions.states) * halved(first, 0, dimensions);
            add_driven(&mut map, last, dimensions);
            map
        };
        let sensitivities = self.sensitivities.iter().map(|sensitivity| {
            let inner = halved(sensitivity, 0, dimensions);
            after(&self.value, sensitivity) + self.value.columns(0, dimensions.states) * inner
        });
        Self { sensitivities: sensitivities.collect(), value: after(&self.value, &self.value) }
    }

    fn unscale(&mut self, scale: &[f64]) {
        for map in std::iter::once(&mut self.value).chain(&mut self.sensitivities) {
            for i in 0..map.nrows() {
                for j in 0..map.ncols() {
                    map[(i, j)] *= scale[i] / scale.get(j).copied().unwrap_or(1.0);
                }
            }
        }
    }
}

/// Adds the effect of inputs and forces in the second half of a step to the map of the whole step.
fn add_driven(map: &mut DMatrix<f64>, last: &DMatrix<f64>, dimensions: Dimensions) {
    let driven = halved(last, 1, dimensions);
    let n = dimensions.states;
    let mut target = map.columns_mut(n, dimensions.width() - n);
    target += driven.columns(n, dimensions.width() - n);
}

/// Turns a map from the xi of the first (0) or second (1) half of a step into one from the xi of the whole step.
fn halved(map: &DMatrix<f64>, half: usize, dimensions: Dimensions) -> DMatrix<f64> {
    let mut whole = DMatrix::zeros(map.nrows(), map.ncols());
    whole.columns_mut(0, dimensions.states).copy_from(&map.columns(0, dimensions.states));
    // Values at the start, middle and end of each half, from those of the whole step.
    let parabolas = [
        [[1.0, 0.0, 0.0], [0.375, 0.75, -0.125], [0.0, 1.0, 0.0]],
        [[0.0, 1.0, 0.0], [-0.125, 0.75, 0.375], [0.0, 0.0, 1.0]],
    ];
    let mut spread = |first: usize, count: usize, from: usize, weights: &[f64]| {
        for (to, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            for j in 0..count {
                let part = map.column(first + from * count + j) * *weight;
                let mut target = whole.column_mut(first + to * count + j);
                target += part;
            }
        }
    };
    for (from, weights) in parabolas[half].iter().enumerate() {
        spread(dimensions.states, dimensions.inputs, from, weights);
        spread(dimensions.forces(), dimensions.ports, from, weights);
    }
    whole
}

/// The map of the first of three steps, each half as long as the one before; the shorter ones give the port inputs within it.
fn with_port_inputs(
    equations: &Equations,
    sensitivities: &[Equations],
    steps: &[Step],
    dimensions: Dimensions,
) -> StepLevel {
    let n = dimensions.states;
    let (half, quarter) = (&steps[1], &steps[2]);
    let to_half = halved(&half.value, 0, dimensions);
    let to_half_sensitivities: Vec<_> =
        half.sensitivities.iter().map(|sensitivity| halved(sensitivity, 0, dimensions)).collect();
    let to_quarter = halved(&halved(&quarter.value, 0, dimensions), 0, dimensions);
    let mut to_three = quarter.value.columns(0, n) * &to_half;
    let driven = halved(&halved(&quarter.value, 0, dimensions), 1, dimensions);
    let mut target = to_three.columns_mut(n, dimensions.width() - n);
    target += driven.columns(n, dimensions.width() - n);
    // V x + W u + U f, where `share` is the position in the step at which u and f are taken.
    let seen = |e: &Equations, x: &DMatrix<f64>, share: f64| {
        let mut rows = &e.port * x;
        let parabola =
            [(1.0 - share) * (1.0 - 2.0 * share), 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)];
        for (i, weight) in parabola.into_iter().enumerate() {
            let mut target = rows.columns_mut(n + i * dimensions.inputs, dimensions.inputs);
            target += &e.port_input * weight;
            let mut target = rows.columns_mut(dimensions.forces() + i * dimensions.ports, dimensions.ports);
            target += &e.port_force * weight;
        }
        rows
    };
    let both = |x: &DMatrix<f64>, x_sensitivities: &[DMatrix<f64>], share: f64| {
        let sensitivities = sensitivities
            .iter()
            .zip(x_sensitivities)
            .map(|(d, x_sensitivity)| seen(d, x, share) + &equations.port * x_sensitivity);
        (seen(equations, x, share), sensitivities.collect::<Vec<_>>())
    };
    let middle = both(&to_half, &to_half_sensitivities, 0.5);
    let end = both(&steps[0].value, &steps[0].sensitivities, 1.0);
    let mut level = StepLevel::new(
        &[(&steps[0].value, &steps[0].sensitivities), (&middle.0, &middle.1), (&end.0, &end.1)],
        dimensions,
    );
    level.set_columns(&[seen(equations, &to_quarter, 0.25), seen(equations, &to_three, 0.75)], dimensions);
    level
}

#[cfg(test)]
mod tests;
