use nalgebra::{DMatrix, DVector};

use super::*;
use crate::Truth;

/// exp(A t) by scaling and squaring of a Taylor series, independent of the solver.
fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let squarings = (matrix.amax().log2().ceil() as i32 + 6).max(0);
    let scaled = matrix / 2f64.powi(squarings);
    let mut term = DMatrix::identity(matrix.nrows(), matrix.nrows());
    let mut sum = term.clone();
    for order in 1..20 {
        term = &term * &scaled / f64::from(order);
        sum += &term;
    }
    for _ in 0..squarings {
        sum = &sum * &sum;
    }
    sum
}

/// An input of steps of different sizes.
fn lively(sample: usize) -> f64 {
    100.0 + 30.0 * ((sample * sample % 17) as f64 / 8.0 - 1.0)
}

#[test]
fn linear_drivetrain_agrees_with_the_matrix_exponential() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let equations = model.equations(&model.values()).unwrap();
    let (states, period_s) = (equations.state.nrows(), 1e-3);
    // x' = A x + B u, u' = 0.
    let mut generator = DMatrix::zeros(states + 1, states + 1);
    generator.view_mut((0, 0), (states, states)).copy_from(&equations.state);
    generator.view_mut((0, states), (states, 1)).copy_from(&equations.input);
    let step = exponential(&(generator * period_s));

    let plant = Plant::new(&model, &model.values()).unwrap();
    let mut trajectory = plant.start().unwrap();
    let mut exact = DVector::zeros(states + 1);
    let mut outputs = vec![0.0; 3];
    let mut worst = [0.0f64; 3];
    for sample in 0..500 {
        exact[states] = lively(sample);
        trajectory.hold((sample + 1) as f64 * period_s, &[lively(sample)]).unwrap();
        exact = &step * exact;
        trajectory.outputs(&mut outputs);
        let x = exact.rows(0, states);
        let expected = &equations.output * x + &equations.feedthrough * exact[states];
        for (worst, (output, expected)) in worst.iter_mut().zip(outputs.iter().zip(expected.iter())) {
            *worst = worst.max((output - expected).abs());
        }
    }
    // One count is 1.5e-2 rad/s, 1.5e-4 N m and 1.2e-3 N m on the default bench.
    assert!(worst[0] < 2e-6 && worst[1] < 2e-5 && worst[2] < 1e-5, "{worst:?}");
    let effort = trajectory.effort();
    assert!(effort.steps < 20_000 && effort.iterations < 90_000, "{effort:?}");
}

#[test]
fn dry_friction_agrees_with_tiny_steps() {
    let hidden = ["coulomb_friction@load_bearing:torque=0.4".parse().unwrap()];
    let truth = Truth::new(&Model::builtin("two-mass").unwrap(), &[], &hidden).unwrap();
    let plant = Plant::new(&truth.model, &truth.values).unwrap();
    let mut trajectory = plant.start().unwrap();
    let equations = truth.equations().unwrap();
    let reference = Reference::new(&equations, &truth.values);
    let (period_s, parts) = (1e-3, 2000);
    let mut x = DVector::zeros(equations.state.nrows());
    let mut worst = 0.0f64;
    for sample in 0..400 {
        // The motion reverses and stands still in between.
        let torque = 1.2 * (sample as f64 * 0.05).sin();
        trajectory.hold((sample + 1) as f64 * period_s, &[torque]).unwrap();
        for _ in 0..parts {
            x = reference.step(&x, torque, period_s / f64::from(parts));
        }
        let difference = DVector::from_column_slice(trajectory.states()) - &x;
        worst = worst.max(difference.amax());
    }
    assert!(worst < 2e-5, "{worst}");
}

/// Classical Runge-Kutta with steps much shorter than every time constant.
struct Reference<'a> {
    equations: &'a Equations,
    parameters: Vec<f64>,
}

impl<'a> Reference<'a> {
    fn new(equations: &'a Equations, values: &[f64]) -> Self {
        let parameters = equations.ports[0].parameters.iter().map(|index| values[*index]).collect();
        Self { equations, parameters }
    }

    fn rate(&self, x: &DVector<f64>, torque: f64) -> DVector<f64> {
        let e = self.equations;
        let speed = (&e.port * x)[0];
        let friction = -self.parameters[0] * (speed / self.parameters[1]).tanh();
        &e.state * x
            + &e.input * DVector::from_element(1, torque)
            + &e.force * DVector::from_element(1, friction)
    }

    fn step(&self, x: &DVector<f64>, torque: f64, step_s: f64) -> DVector<f64> {
        let a = self.rate(x, torque);
        let b = self.rate(&(x + &a * (step_s / 2.0)), torque);
        let c = self.rate(&(x + &b * (step_s / 2.0)), torque);
        let d = self.rate(&(x + &c * step_s), torque);
        x + (a + b * 2.0 + c * 2.0 + d) * (step_s / 6.0)
    }
}

#[test]
fn a_ramped_input_is_followed_without_lag() {
    // A single mass: x'' = F/m with F linear in time has an exact solution.
    let truth = Truth::new(&Model::builtin("emps").unwrap(), &[], &[]).unwrap();
    let zero = ["viscous=0", "coulomb=0", "offset=0"].map(|text| text.parse().unwrap());
    let truth = Truth::new(&truth.model, &zero, &[]).unwrap();
    let plant = Plant::new(&truth.model, &truth.values).unwrap();
    let mut trajectory = plant.start().unwrap();
    for part in 1..=10 {
        trajectory.ramp(0.1 * f64::from(part), &[5.0 * f64::from(part)]).unwrap();
    }
    let mut position = [0.0];
    trajectory.outputs(&mut position);
    assert!((position[0] - 50.0 / 6.0 / 95.1089).abs() < 1e-9, "{position:?}");
    let effort = trajectory.effort();
    assert!(effort.steps < 150, "{effort:?}");
}
