//! Sensitivities of a model's state, forces and outputs with respect to parameters and start state, step by step.

use std::ops::Range;

use nalgebra::DVector;

use crate::prediction::{
    event::{AcceptedStep, Event, SwitchingEvent},
    force_sensitivities::{Workspace, solve_force_sensitivities},
    hybrid_modes::{HybridModes, LinearDynamics, Play},
    inactive_laws::InactiveSensitivity,
    instant::Instant,
    integrator::Integrator,
    row_products,
    step_level::{Dimensions, padded},
    step_sensitivities::StepSensitivities,
};

/// Sensitivities along an integration. The columns are the free parameters up to the last that changes the motion, then, until they
/// have decayed, the states at the start; each part is [`padded`].
pub(crate) struct Sensitivity<'s> {
    hybrid_modes: &'s HybridModes,
    dimensions: Dimensions,
    /// Number of free parameters that change the motion. The columns of parameters that only outputs depend on come behind all others,
    /// and only where outputs are observed.
    moving: usize,
    /// Number of start states; zero once they are dropped.
    start: usize,
    columns: usize,
    /// Sensitivities of the inactive laws at the present time.
    inactive: Vec<InactiveSensitivity>,
    /// Sensitivities of the inactive laws in the middle of a step and at its end.
    later: [Vec<InactiveSensitivity>; 2],
    /// Sensitivities of the output-only laws at the last observation.
    output_only: Vec<InactiveSensitivity>,
    /// Sensitivities of the states, then of the forces at a step's start, middle and end; row by row.
    rows: Vec<f64>,
    /// Sensitivities of the states at the end of a step, then of the port inputs in its middle and at its end; row by row.
    next: Vec<f64>,
    workspace: Workspace,
    /// [x, u, f] of an observation.
    entries: Vec<f64>,
}

impl<'s> Sensitivity<'s> {
    /// Sensitivities at the instant `first`, before the first step. `start` are the sensitivities of the start state with respect
    /// to the free parameters; it is `None` if the start state is itself unknown.
    pub(crate) fn new(
        hybrid_modes: &'s HybridModes,
        first: &Instant,
        start: Option<&[DVector<f64>]>,
    ) -> Self {
        let s = hybrid_modes.dynamics(first.mode).output_map.dimensions;
        let start_states = if start.is_some() { 0 } else { s.states };
        let moving = hybrid_modes.moving;
        let free = padded(moving);
        let columns = free + padded(start_states);
        let mut this = Self {
            hybrid_modes,
            dimensions: s,
            moving,
            start: start_states,
            columns,
            inactive: Vec::new(),
            later: [Vec::new(), Vec::new()],
            output_only: Vec::new(),
            rows: vec![0.0; (s.states + 3 * s.ports) * columns],
            next: vec![0.0; (s.states + 2 * s.ports) * columns],
            workspace: Workspace::default(),
            entries: Vec::new(),
        };
        for i in 0..start_states {
            this.rows[i * columns + free + i] = 1.0;
        }
        for (j, sensitivity) in start.into_iter().flatten().take(moving).enumerate() {
            for i in 0..s.states {
                this.rows[i * columns + j] = sensitivity[i];
            }
        }
        this.solve_forces(first);
        this
    }

    /// Sets the sensitivities of the forces to those that follow from the states' at this instant.
    fn solve_forces(&mut self, at: &Instant) {
        let (s, columns) = (self.dimensions, self.columns);
        let LinearDynamics { coupling, inactive_laws, .. } = self.hybrid_modes.dynamics(at.mode);
        self.inactive = inactive_laws.at(at);
        for p in 0..s.ports {
            let input = self.port_input(at, p);
            self.next[(s.states + p) * columns..][..columns].copy_from_slice(&input);
        }
        let port_inputs = &self.next[s.states * columns..][..s.ports * columns];
        let forces = &mut self.rows[s.states * columns..][..s.ports * columns];
        solve_force_sensitivities(
            &self.hybrid_modes.modes[at.mode].laws,
            &at.responses,
            coupling,
            port_inputs,
            forces,
            &mut self.workspace,
        );
    }

    /// Sensitivities of a port's input at constant forces.
    fn port_input(&self, at: &Instant, port: usize) -> Vec<f64> {
        let LinearDynamics { equations, sensitivities, inactive_laws, .. } =
            self.hybrid_modes.dynamics(at.mode);
        let mut all = vec![0.0; self.columns];
        for (i, row) in self.rows.chunks_exact(self.columns.max(1)).take(self.dimensions.states).enumerate() {
            all.iter_mut().zip(row).for_each(|(v, x)| *v += equations.port[(port, i)] * x);
        }
        for (v, sensitivity) in all.iter_mut().zip(sensitivities) {
            let state = at.state.iter().enumerate().map(|(i, x)| sensitivity.port[(port, i)] * x);
            let input = at.inputs.iter().enumerate().map(|(i, u)| sensitivity.port_input[(port, i)] * u);
            let force = at.forces.iter().enumerate().map(|(q, f)| sensitivity.port_force[(port, q)] * f);
            *v += state.sum::<f64>() + input.sum::<f64>() + force.sum::<f64>();
        }
        self.inactive
            .iter()
            .for_each(|inactive| all[inactive.column] += inactive_laws.to_port(port, inactive));
        all
    }

    /// Sensitivities of the states' rates, row by row.
    fn rates(&self, at: &Instant) -> Vec<f64> {
        let (s, columns) = (self.dimensions, self.columns);
        let dynamics = self.hybrid_modes.dynamics(at.mode);
        let mut rates = vec![0.0; s.states * columns];
        for (i, rate) in rates.chunks_exact_mut(columns.max(1)).enumerate() {
            for (j, row) in self.rows.chunks_exact(columns).take(s.states + s.ports).enumerate() {
                let e = &dynamics.equations;
                let factor = if j < s.states { e.state[(i, j)] } else { e.force[(i, j - s.states)] };
                rate.iter_mut().zip(row).for_each(|(rate, value)| *rate += factor * value);
            }
        }
        for (j, moved) in dynamics.rate_sensitivities(at).iter().enumerate() {
            moved.iter().enumerate().for_each(|(i, value)| rates[i * columns + j] += value);
        }
        for inactive in &self.inactive {
            (0..s.states).for_each(|i| {
                rates[i * columns + inactive.column] += dynamics.inactive_laws.to_rate(i, inactive)
            });
        }
        rates
    }

    /// Follows the integrator through an event.
    pub(crate) fn apply(&mut self, event: &Event<'_>) {
        match event {
            _ if self.columns == 0 => {}
            Event::Step(step) => self.advance(step),
            Event::Switch(event) => self.switch(event),
            Event::Jump(at) => self.solve_forces(at),
        }
    }

    /// Applies the saltation matrix of a switch (Aizerman and Gantmacher 1958, Q. J. Mech. Appl. Math. 11, 385). Each unknown moves
    /// the time of the switch; by that time the state moves longer along the mode before and shorter along the mode after.
    fn switch(&mut self, event: &SwitchingEvent) {
        let SwitchingEvent { before, beyond, after, late_s, rate, jump } = event;
        let Some(Play { port, gap }) = &self.hybrid_modes.play else { return };
        let mut later = self.port_input(before, *port);
        if let Some(gap) = gap {
            let outward = 0.5 * if beyond.mode.max(before.mode) > 1 { 1.0 } else { -1.0 };
            later[*gap] -= outward;
        }
        let by_twist = if *late_s > 0.0 { 1.0 / rate } else { 0.0 };
        later.iter_mut().for_each(|late| *late *= by_twist);
        let rates = self.rates(before);
        self.solve_forces(beyond);
        let rates_beyond = self.rates(beyond);
        for (i, jump) in jump.iter().enumerate() {
            let row = &mut self.rows[i * self.columns..(i + 1) * self.columns];
            let [before, beyond] = [&rates, &rates_beyond].map(|rates| &rates[i * self.columns..]);
            for (((value, late), before), beyond) in row.iter_mut().zip(&later).zip(before).zip(beyond) {
                *value -= late_s * (before - beyond) + jump * late;
            }
        }
        self.solve_forces(after);
    }

    /// Whether sensitivities with respect to the start state are kept.
    pub(crate) fn has_start(&self) -> bool {
        self.start > 0
    }

    /// Drops the sensitivities with respect to the start state.
    pub(crate) fn drop_start(&mut self) {
        let (old, new) = (self.columns, padded(self.moving));
        for rows in [&mut self.rows, &mut self.next] {
            *rows = rows.chunks_exact(old.max(1)).flat_map(|row| &row[..new]).copied().collect();
        }
        (self.start, self.columns) = (0, new);
    }

    /// Advances by a step: port inputs at constant forces, forces, then states.
    fn advance(&mut self, step: &AcceptedStep<'_>) {
        let (s, columns) = (self.dimensions, self.columns);
        let at_start = s.states + s.ports;
        let (inactive_inputs, xi) = (step.inactive_inputs, step.xi);
        step.inactive_laws.along(inactive_inputs, xi, self.later.each_mut());
        pulp::Arch::new().dispatch(StepSensitivities {
            dimensions: s,
            step,
            first: s.states,
            count: 2 * s.ports,
            known: &self.rows[..at_start * columns],
            columns,
            target: &mut self.next,
        });
        let nodes = [&*self.inactive, &*self.later[0], &*self.later[1]];
        inactive_inputs.add(nodes, s.states, &mut self.next[s.states * columns..], columns);
        let port_inputs = &self.next[s.states * columns..];
        let forces = &mut self.rows[at_start * columns..];
        solve_force_sensitivities(
            step.laws,
            step.responses,
            &step.level.coupling,
            port_inputs,
            forces,
            &mut self.workspace,
        );
        pulp::Arch::new().dispatch(StepSensitivities {
            dimensions: s,
            step,
            first: 0,
            count: s.states,
            known: &self.rows[..(at_start + 2 * s.ports) * columns],
            columns,
            target: &mut self.next,
        });
        let nodes = [&*self.inactive, &*self.later[0], &*self.later[1]];
        inactive_inputs.add(nodes, 0, &mut self.next[..s.states * columns], columns);
        std::mem::swap(&mut self.inactive, &mut self.later[1]);
        let (states, forces) = self.rows.split_at_mut(s.states * columns);
        states.copy_from_slice(&self.next[..states.len()]);
        forces.copy_within(2 * s.ports * columns.., 0);
    }

    /// Evaluates the output-only laws at the present time; `inputs` are the interpolated ones.
    pub(crate) fn evaluate_output_only(&mut self, integrator: &Integrator<'_>, inputs: &[f64]) {
        let motion = integrator.state().iter().chain(inputs).chain(integrator.forces()).copied();
        self.hybrid_modes.dynamics(integrator.mode()).output_only.evaluate(motion, &mut self.output_only);
    }

    /// Appends the sensitivities of one output at the present time: [`Sensitivity::row_length`] numbers, at the positions that
    /// [`Sensitivity::column_of`] and [`Sensitivity::start_columns`] give.
    pub(crate) fn observe(
        &mut self,
        output: usize,
        integrator: &Integrator<'_>,
        inputs: &[f64],
        sensitivities: &mut Vec<f64>,
    ) {
        let s = self.dimensions;
        let LinearDynamics { output_map, inactive_laws, output_only, .. } =
            self.hybrid_modes.dynamics(integrator.mode());
        self.entries.clear();
        self.entries.extend(integrator.state().iter().chain(inputs).chain(integrator.forces()));
        let from = sensitivities.len();
        sensitivities.resize(from + self.row_length(), 0.0);
        let target = &mut sensitivities[from..from + self.columns];
        row_products::add_rows(
            &output_map.outputs[output],
            &self.rows[..(s.states + s.ports) * self.columns],
            self.columns,
            &mut *target,
        );
        let moved = padded(s.free);
        row_products::add_rows(
            &self.entries,
            &output_map.output_sensitivities[output],
            moved,
            &mut target[..moved],
        );
        self.inactive
            .iter()
            .for_each(|inactive| target[inactive.column] += inactive_laws.to_output(output, inactive));
        for inactive in &self.output_only {
            sensitivities[from + self.column_of(inactive.column)] += output_only.to_output(output, inactive);
        }
    }

    /// Length of a row of one output's sensitivities.
    pub(crate) fn row_length(&self) -> usize {
        self.columns + self.hybrid_modes.free - self.moving
    }

    /// Position of a free parameter in a row of sensitivities.
    pub(crate) fn column_of(&self, free: usize) -> usize {
        if free < self.moving { free } else { self.columns + free - self.moving }
    }

    /// Positions of the start states in a row of sensitivities.
    pub(crate) fn start_columns(&self) -> Range<usize> {
        padded(self.moving)..padded(self.moving) + self.start
    }
}
