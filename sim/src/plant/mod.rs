//! Simulates the drivetrain: integrates its equations of motion with error control.
//!
//! The integrator is a one-step method (ESDIRK of order 3, embedded error estimate of order 4): input changes at samples need no
//! restart, and massless nodes between a stiff spring and a damper need no small steps. The tolerances below keep the error an order
//! of magnitude below one count of the default bench's sensors.

mod motion;

use diffsol::{
    NalgebraLU, NalgebraMat, NonLinearOp, OdeBuilder, OdeSolverMethod, OdeSolverProblem, RkState, Sdirk,
    Tableau,
};
use socam_model::{Equations, Model, Motion as MotionKind};

use crate::SimError;
use motion::Motion;

/// Relative tolerance of every step.
const RELATIVE_TOLERANCE: f64 = 1e-8;

/// Absolute tolerances of angles and speeds: rad and rad/s, m and m/s.
const ROTATION_TOLERANCES: (f64, f64) = (1e-10, 1e-8);
const TRANSLATION_TOLERANCES: (f64, f64) = (1e-11, 1e-9);

/// First step, s; the error control adapts it at once.
const FIRST_STEP_S: f64 = 1e-6;

type Matrix = NalgebraMat<f64>;
type Solver<'p> = Sdirk<'p, Motion, NalgebraLU<f64>, Matrix>;

/// Equations of motion, prepared for the solver.
pub struct Plant {
    problem: OdeSolverProblem<Motion>,
    /// Flags of the states that are speeds; the others are angles.
    speeds: Vec<bool>,
    /// Names of the states.
    names: Vec<String>,
}

/// Effort of a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effort {
    /// Steps accepted.
    pub steps: usize,
    /// Steps rejected by the error control.
    pub refused_steps: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Factorisations of the iteration matrix.
    pub factorisations: usize,
}

impl std::ops::Add for Effort {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            steps: self.steps + other.steps,
            refused_steps: self.refused_steps + other.refused_steps,
            iterations: self.iterations + other.iterations,
            factorisations: self.factorisations + other.factorisations,
        }
    }
}

impl Plant {
    /// The drivetrain of a model, driven directly by its inputs.
    ///
    /// # Errors
    /// [`SimError::Model`] where the model refuses the values (SI, in the order of its parameters).
    pub fn new(model: &Model, values: &[f64]) -> Result<Self, SimError> {
        Self::from_equations(&model.equations(values)?, values, model.motion)
    }

    /// Any equations of motion; `values` are those of the parameters that their ports name.
    ///
    /// # Errors
    /// [`SimError::Solver`] where the solver refuses them.
    pub fn from_equations(equations: &Equations, values: &[f64], kind: MotionKind) -> Result<Self, SimError> {
        let (angle, speed) = match kind {
            MotionKind::Rotation => ROTATION_TOLERANCES,
            MotionKind::Translation => TRANSLATION_TOLERANCES,
        };
        let speeds: Vec<bool> =
            equations.state_names.iter().map(|name| name.starts_with("speed of")).collect();
        let absolute = speeds.iter().map(|is_speed| if *is_speed { speed } else { angle });
        let mut problem = OdeBuilder::<Matrix>::new()
            .rtol(RELATIVE_TOLERANCE)
            .atol(absolute.collect::<Vec<f64>>())
            .h0(FIRST_STEP_S)
            .build_from_eqn(Motion::new(equations, values))
            .map_err(|error| failed(0.0, &error))?;
        // diffsol counts failures over the whole run, not per step: thousands of friction reversals are acceptable.
        problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
        Ok(Self { problem, speeds, names: equations.state_names.clone() })
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.speeds.len()
    }

    /// Flags of the states that are speeds; the others are angles or positions.
    pub(crate) fn speeds(&self) -> &[bool] {
        &self.speeds
    }

    /// Starts from rest, at time 0, with all inputs 0.
    ///
    /// # Errors
    /// [`SimError::Solver`] where the solver refuses the problem.
    pub fn start(&self) -> Result<Trajectory<'_>, SimError> {
        self.start_at(&vec![0.0; self.states()])
    }

    /// Starts from given states, at time 0, with all inputs 0.
    ///
    /// # Errors
    /// [`SimError::Solver`] where the solver refuses the problem.
    pub fn start_at(&self, states: &[f64]) -> Result<Trajectory<'_>, SimError> {
        let motion = &self.problem.eqn;
        motion.reset();
        let mut solver = self
            .problem
            .rk_state(&Tableau::esdirk34())
            .and_then(|state: RkState<_, Matrix>| self.problem.esdirk34_solver(state))
            .map_err(|error| failed(0.0, &error))?;
        solver.state_mut().y.batch_as_mut_slice(0).copy_from_slice(states);
        Ok(Trajectory { motion, solver, step_s: FIRST_STEP_S, names: &self.names })
    }
}

impl Plant {
    /// Refuses to continue the motion of a drivetrain that lacks one of this one's bodies: the state of that body would be unknown.
    pub(crate) fn check_change(&self, before: &Self) -> Result<(), SimError> {
        let moves =
            |name: &&String| ["angle of", "wind-up of", "speed of"].iter().any(|kind| name.starts_with(kind));
        let Some(new) = self.names.iter().filter(moves).find(|name| !before.names.contains(name)) else {
            return Ok(());
        };
        let problem = "the drivetrain moves in another way from then on, so that the change cannot happen in mid-run; leave out its time";
        Err(SimError::argument(new, problem))
    }

    /// Continues the motion of another drivetrain. States that it does not have (those of laws with memory, clocks) start at 0.
    ///
    /// # Errors
    /// [`SimError::Solver`] where the solver refuses the problem.
    pub(crate) fn start_after(&self, before: &Trajectory<'_>) -> Result<Trajectory<'_>, SimError> {
        let nth =
            |names: &[String], index: usize| names[..index].iter().filter(|n| **n == names[index]).count();
        let value = |index: usize| {
            let same = (0..before.names.len()).find(|other| {
                before.names[*other] == self.names[index]
                    && nth(before.names, *other) == nth(&self.names, index)
            });
            same.map_or(0.0, |other| before.states()[other])
        };
        let states: Vec<f64> = (0..self.states()).map(value).collect();
        let mut trajectory = self.start_at(&states)?;
        *trajectory.solver.state_mut().t = before.time_s();
        Ok(trajectory)
    }
}

/// A running simulation. See [`Plant::start`].
pub struct Trajectory<'p> {
    motion: &'p Motion,
    solver: Solver<'p>,
    /// The step that the error control proposes.
    step_s: f64,
    /// Names of the states.
    names: &'p [String],
}

impl Trajectory<'_> {
    /// Simulated time, s.
    pub fn time_s(&self) -> f64 {
        self.solver.state().t
    }

    /// Sets the inputs without advancing time.
    pub fn set_input(&mut self, input: &[f64]) {
        self.motion.hold(self.time_s(), input);
    }

    /// Advances to `to_s` with the inputs held at `input`.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the solver gives up.
    pub fn hold(&mut self, to_s: f64, input: &[f64]) -> Result<(), SimError> {
        self.motion.hold(self.time_s(), input);
        self.advance(to_s)
    }

    /// Advances to `to_s` with the inputs linear from their present values to `input`.
    ///
    /// # Errors
    /// [`SimError::Solver`] when the solver gives up.
    pub fn ramp(&mut self, to_s: f64, input: &[f64]) -> Result<(), SimError> {
        self.motion.ramp(self.time_s(), to_s, input);
        self.advance(to_s)
    }

    /// The present outputs of the model.
    pub fn outputs(&self, outputs: &mut [f64]) {
        let state = self.solver.state();
        self.motion.outputs(state.y.batch_as_slice(0), state.t, outputs);
    }

    /// The present states.
    pub fn states(&self) -> &[f64] {
        self.solver.state().y.batch_as_slice(0)
    }

    /// Effort so far.
    pub fn effort(&self) -> Effort {
        let statistics = self.solver.get_statistics();
        Effort {
            steps: statistics.number_of_steps,
            refused_steps: statistics.number_of_error_test_failures,
            iterations: statistics.number_of_nonlinear_solver_iterations,
            factorisations: statistics.number_of_linear_solver_setups,
        }
    }

    /// Advances to `to_s` in equal steps. With the solver's stop time the last step would be tiny and each change of step would need a
    /// new factorisation; equal steps reuse one over many intervals.
    fn advance(&mut self, to_s: f64) -> Result<(), SimError> {
        let from_s = self.time_s();
        let interval_s = to_s - from_s;
        if interval_s <= 0.0 {
            return Ok(());
        }
        self.renew_slope();
        let rounding_s = 1e-9 * interval_s;
        loop {
            let left_s = to_s - self.time_s();
            if left_s <= rounding_s {
                break;
            }
            // The tolerance for rounding keeps an interval of exactly one step undivided.
            let steps = (left_s / self.step_s - 1e-6).ceil().max(1.0);
            let step_s = left_s / steps;
            *self.solver.state_mut().h = step_s;
            self.solver.config_mut().maximum_timestep_growth = (interval_s / step_s).clamp(1.0, 2.0);
            self.solver.step().map_err(|error| failed(self.time_s(), &error))?;
            self.step_s = self.solver.state().h;
        }
        *self.solver.state_mut().t = to_s;
        Ok(())
    }

    /// The first stage reuses the rate at the end of the last step, which a changed input invalidates.
    fn renew_slope(&mut self) {
        let time_s = self.time_s();
        let motion = self.motion;
        let state = self.solver.state_mut();
        NonLinearOp::call_inplace(motion, state.y, time_s, state.dy);
    }
}

fn failed(time_s: f64, error: &diffsol::DiffsolError) -> SimError {
    // The time is already in the error.
    let words = error.to_string();
    let reason = words.trim_start_matches("ODE solver error: ").split(" at time").next().unwrap_or_default();
    SimError::Solver { time_s, reason: reason.to_lowercase() }
}

#[cfg(test)]
mod tests;
