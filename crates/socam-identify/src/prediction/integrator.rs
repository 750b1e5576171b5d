//! Adaptive exponential integrator: the linear part is exact in steps of any length; the step length follows the curvature of the
//! force laws.
//!
//! The forces over a step are solved together with the motion that they cause. The method is implicit, so laws may be steep. At a
//! quarter and at three quarters of the step the laws are evaluated once more: their difference from the parabola is the error
//! estimate. The step is halved where that error would move a port input by more than the tolerance. A step within which teeth meet
//! or part is halved down to the shortest one, and the state is corrected for the rest.

use crate::prediction::{
    event::{AcceptedStep, Event},
    hybrid_modes::{HybridModes, LinearDynamics},
    instant::Instant,
    intersample::InputPolynomial,
    laws::{INACTIVE, PortLaw, PortResponse},
    newton::{self, Workspace},
    row_products::row_times,
    step_level::Dimensions,
};

/// Default tolerance of a step's error in a port input, relative to the largest port input so far. Outputs then stay within a
/// millionth of their range. A tolerance 32 times smaller doubles the number of steps where a law is curved.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;
/// The step is doubled below this share of the tolerance. The error grows with the fifth power of the step, so that the doubled step
/// has at most half of the tolerated error.
const DOUBLING_SHARE: f64 = 1.0 / 64.0;

/// The state of a model, and how it continues.
pub(crate) struct Integrator<'a> {
    pub(super) hybrid_modes: &'a HybridModes,
    /// Index of the current mode.
    pub(super) mode: usize,
    pub(super) dimensions: Dimensions,
    /// Tolerated error of a step in a port input, relative to `largest`.
    tolerance: f64,
    /// Largest magnitude of each port input so far.
    pub(super) largest: Vec<f64>,
    /// Level at which the laws allowed the last step.
    level: usize,
    /// States, inputs and forces of a step, see [`step_level`](crate::prediction::step_level).
    pub(super) xi: Vec<f64>,
    /// The step's map applied to `xi`.
    pub(super) ends: Vec<f64>,
    /// Port inputs in the middle of a step, then at its end.
    pub(super) port_inputs: Vec<f64>,
    /// Responses of all ports, likewise.
    pub(super) responses: Vec<PortResponse>,
    pub(super) workspace: Workspace,
    /// Accepted steps whose error exceeds the tolerance although they are the shortest possible.
    pub(crate) unresolved: usize,
    /// Attempted steps, accepted or not.
    pub(crate) attempts: usize,
    /// Whether a port input has exceeded what any bench shows. The state is then NaN and no longer moves.
    has_diverged: bool,
}

impl<'a> Integrator<'a> {
    /// Starts an integration at `state` with `inputs`. `tolerance` is relative to the largest port input so far.
    pub(crate) fn new(hybrid_modes: &'a HybridModes, tolerance: f64, state: &[f64], inputs: &[f64]) -> Self {
        let mode = hybrid_modes.mode_at(state, inputs);
        let LinearDynamics { equations, levels, .. } = hybrid_modes.dynamics(mode);
        let dimensions = Dimensions::new(equations, 0);
        let mut xi = vec![0.0; dimensions.width()];
        xi[..dimensions.states].copy_from_slice(state);
        xi[dimensions.states + 2 * dimensions.inputs..][..dimensions.inputs].copy_from_slice(inputs);
        let mut integrator = Self {
            hybrid_modes,
            mode,
            dimensions,
            tolerance,
            largest: hybrid_modes.modes[mode].laws.iter().map(PortLaw::least_input).collect(),
            level: 0,
            xi,
            ends: vec![0.0; levels[0].stride],
            port_inputs: vec![0.0; 2 * dimensions.ports],
            responses: vec![INACTIVE; 2 * dimensions.ports],
            workspace: Workspace::default(),
            unresolved: 0,
            attempts: 0,
            has_diverged: false,
        };
        integrator.solve_forces(inputs);
        integrator
    }

    pub(super) fn dynamics(&self) -> &'a LinearDynamics {
        self.hybrid_modes.dynamics(self.mode)
    }

    pub(super) fn laws(&self) -> &'a [PortLaw] {
        &self.hybrid_modes.modes[self.mode].laws
    }

    /// The present instant; `inputs` are the interpolated ones.
    pub(crate) fn instant(&self, inputs: &[f64]) -> Instant {
        Instant {
            mode: self.mode,
            state: self.state().to_vec(),
            inputs: inputs.to_vec(),
            forces: self.forces().to_vec(),
            responses: self.responses[self.dimensions.ports..].to_vec(),
        }
    }

    pub(crate) fn state(&self) -> &[f64] {
        &self.xi[..self.dimensions.states]
    }

    pub(crate) fn forces(&self) -> &[f64] {
        &self.xi[self.dimensions.forces()..][..self.dimensions.ports]
    }

    /// Index of the current mode.
    pub(crate) fn mode(&self) -> usize {
        self.mode
    }

    /// Solves for the forces at the present state. Port inputs depend on forces only where a law acts on a massless node.
    pub(super) fn solve_forces(&mut self, inputs: &[f64]) {
        let (LinearDynamics { equations: e, coupling, .. }, ports) = (self.dynamics(), self.dimensions.ports);
        if ports == 0 {
            return;
        }
        let seen = |p| row_times(&e.port, p, self.state()) + row_times(&e.port_input, p, inputs);
        let base: Vec<f64> = (0..ports).map(seen).collect();
        let laws = self.laws();
        let now = &mut self.port_inputs[ports..];
        now.copy_from_slice(&base);
        newton::algebraic_solve(
            laws,
            &base,
            coupling,
            now,
            &mut self.responses[ports..],
            &mut self.workspace,
        );
        self.keep_forces();
    }

    /// The forces at the end of a step become those at the start of the next one.
    fn keep_forces(&mut self) {
        let (ports, forces) = (self.dimensions.ports, self.dimensions.forces());
        for p in 0..ports {
            self.xi[forces + p] = self.responses[ports + p].torque;
            let seen = self.port_inputs[ports + p].abs();
            self.largest[p] = self.largest[p].max(seen);
            self.has_diverged |= self.laws()[p].has_diverged(seen);
        }
    }

    /// Number of parts of the longest step, each as long as the shortest one.
    fn whole(&self) -> usize {
        1 << (self.dynamics().levels.len() - 1)
    }

    /// Advances by one sample, along which each input follows its polynomial. The step from sample to sample has `length` parts of the
    /// shortest step; `None` for the longest, as of all samples at a constant rate. `report` is called with every event.
    pub(crate) fn sample(
        &mut self,
        inputs: &[InputPolynomial],
        length: Option<usize>,
        mut report: impl FnMut(&Event<'_>),
    ) {
        let n = self.dimensions.states;
        let finest = self.dynamics().levels.len() - 1;
        let whole = self.whole();
        let length = length.map_or(whole, |length| length.min(whole));
        if self.jumps(inputs) && !self.has_diverged {
            let held: Vec<f64> = inputs.iter().map(|polynomial| polynomial.at(0.0)).collect();
            self.solve_forces(&held);
            report(&Event::Jump(&self.instant(&held)));
        }
        // The first attempt is twice as long as the last step.
        let mut level = self.level.saturating_sub(1).min(finest);
        let mut done = 0;
        while done < length && !self.has_diverged {
            // After an event, and at the end of an uneven sample, a step is shorter than the laws ask for.
            let fits = |level: &usize| done.is_multiple_of(whole >> level) && whole >> level <= length - done;
            let fitting = (level..finest).find(fits).unwrap_or(finest);
            let (law_level, taken, error) = self.find_step(inputs, (done, length), fitting);
            if law_level > fitting {
                level = law_level;
            }
            self.level = level;
            self.unresolved += usize::from(error > self.tolerance || error.is_nan());
            let dynamics = self.dynamics();
            report(&Event::Step(&AcceptedStep {
                level: &dynamics.levels[taken],
                xi: &self.xi,
                responses: &self.responses,
                laws: self.laws(),
                inactive_laws: &dynamics.inactive_laws,
                inactive_inputs: dynamics.inactive_inputs(taken),
            }));
            self.xi[..n].copy_from_slice(&self.ends[..n]);
            self.keep_forces();
            if let Some(event) = self.switch() {
                report(&Event::Switch(&event));
            }
            if self.has_diverged {
                self.xi.fill(f64::NAN);
            }
            done += whole >> taken;
            let doubled = taken == level && level > 0 && done.is_multiple_of(whole >> (level - 1));
            if error <= self.tolerance * DOUBLING_SHARE && doubled {
                level -= 1;
            }
        }
    }

    /// Whether an input with a direct effect on a port input jumps at the start of a sample.
    fn jumps(&self, inputs: &[InputPolynomial]) -> bool {
        let seen = &self.dynamics().equations.port_input;
        let last = &self.xi[self.dimensions.states + 2 * self.dimensions.inputs..];
        inputs.iter().zip(last).enumerate().any(|(input, (polynomial, last))| {
            let next = polynomial.at(0.0);
            (next - last).abs() > 1e-9 * next.abs().max(last.abs())
                && seen.column(input).iter().any(|factor| *factor != 0.0)
        })
    }

    /// Finds the longest step whose error is within the tolerance and that does not leave the mode, or the shortest step if there is
    /// none. `done` of the sample's `length` parts are over; the first attempt is at `level`. Returns the level that the laws
    /// allow, the level of the step, and its error.
    fn find_step(
        &mut self,
        inputs: &[InputPolynomial],
        (done, length): (usize, usize),
        level: usize,
    ) -> (usize, usize, f64) {
        let (n, count) = (self.dimensions.states, self.dimensions.inputs);
        let (finest, whole) = (self.dynamics().levels.len() - 1, self.whole());
        let (mut law_level, mut level) = (level, level);
        loop {
            let part = [done, done + (whole >> level)].map(|position| position as f64 / length as f64);
            for (i, polynomial) in inputs.iter().enumerate() {
                for (node, value) in polynomial.parabola(part).into_iter().enumerate() {
                    self.xi[n + node * count + i] = value;
                }
            }
            let error = self.attempt(level);
            self.attempts += 1;
            let passed = error <= self.tolerance;
            if level == finest || (passed && !self.leaves_mode()) {
                return (law_level, level, error);
            }
            if passed {
                level += 1;
                continue;
            }
            // The error falls with the fifth power of the step: halve as often as that requires.
            let excess = (error / self.tolerance).log2() / 5.0;
            level = finest.min(level + if excess.is_finite() { excess.ceil().max(1.0) as usize } else { 2 });
            law_level = level;
        }
    }

    /// The present outputs; `inputs` as measured.
    pub(crate) fn outputs(&self, inputs: &[f64], outputs: &mut [f64]) {
        let e = &self.dynamics().equations;
        for (o, output) in outputs.iter_mut().enumerate() {
            let through = row_times(&e.feedthrough, o, inputs);
            *output = row_times(&e.output, o, self.state())
                + through
                + row_times(&e.force_output, o, self.forces());
        }
    }
}
