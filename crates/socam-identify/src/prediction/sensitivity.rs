//! Sensitivities of a model's state, forces and outputs with respect to parameters and start state, step by step.

use std::ops::Range;

use nalgebra::DVector;
use pulp::{Simd, WithSimd};
use socam_model::Equations;

use crate::prediction::{
    exponential::{Sizes, padded},
    hybrid_modes::{HybridModes, Motion, Play},
    inactive_laws::InactiveSensitivities,
    integrator::{AcceptedStep, Event, Instant, Integrator, SwitchingEvent},
    laws::{self, Law, Response},
    products,
};

/// What does not change along a segment.
pub(crate) struct Constants {
    sizes: Sizes,
    /// Per output, its factors of [x, f].
    outputs: Vec<Vec<f64>>,
    /// Per output and entry of [x, u, f], the sensitivities of its factor, filled up to whole vectors.
    output_sensitivities: Vec<Vec<f64>>,
}

impl Constants {
    pub(crate) fn new(equations: &Equations, sensitivities: &[Equations]) -> Self {
        let sizes = Sizes::new(equations, sensitivities.len());
        let each = |o: usize| {
            let entries = |e: &Equations| -> Vec<f64> {
                let (x, u, f) = (e.output.row(o), e.feedthrough.row(o), e.force_output.row(o));
                x.iter().chain(u.iter()).chain(f.iter()).copied().collect()
            };
            let mut moved = vec![0.0; (sizes.states + sizes.inputs + sizes.ports) * padded(sizes.free)];
            for (j, sensitivity) in sensitivities.iter().enumerate() {
                let places = moved.iter_mut().skip(j).step_by(padded(sizes.free));
                places.zip(entries(sensitivity)).for_each(|(place, value)| *place = value);
            }
            let kept =
                equations.output.row(o).iter().chain(equations.force_output.row(o).iter()).copied().collect();
            (kept, moved)
        };
        let (outputs, output_sensitivities) = (0..equations.output.nrows()).map(each).unzip();
        Self { sizes, outputs, output_sensitivities }
    }
}

/// Columns are the free parameters up to the last that moves anything, then, while it shows, the start state; each part is filled up to
/// whole vectors.
pub(crate) struct Sensitivity<'s> {
    hybrid_modes: &'s HybridModes,
    sizes: Sizes,
    /// The number of those: what only output-only laws know comes behind all columns.
    moving: usize,
    start: usize,
    columns: usize,
    /// What inactive laws would answer now, and in the middle of a step and at its end.
    inactive: Vec<InactiveSensitivities>,
    later: [Vec<InactiveSensitivities>; 2],
    /// What output_only would answer at the last observation.
    read: Vec<InactiveSensitivities>,
    /// Of the states, then of the forces at a step's start, middle and end; row by row.
    rows: Vec<f64>,
    /// Of the states at the end of a step, then of the speeds in its middle and at its end.
    next: Vec<f64>,
    workspace: Workspace,
    /// [x, u, f] of an observation.
    entries: Vec<f64>,
}

impl<'s> Sensitivity<'s> {
    /// At `first`, before the first step. The state moves by `moved` with each free parameter, and, where it is unknown, with itself.
    pub(crate) fn new(
        hybrid_modes: &'s HybridModes,
        first: &Instant,
        moved: Option<&[DVector<f64>]>,
    ) -> Self {
        let s = hybrid_modes.motion(first.side).constants.sizes;
        let start = if moved.is_some() { 0 } else { s.states };
        let moving = hybrid_modes.moving;
        let free = padded(moving);
        let columns = free + padded(start);
        let mut this = Self {
            hybrid_modes,
            sizes: s,
            moving,
            start,
            columns,
            inactive: Vec::new(),
            later: [Vec::new(), Vec::new()],
            read: Vec::new(),
            rows: vec![0.0; (s.states + 3 * s.ports) * columns],
            next: vec![0.0; (s.states + 2 * s.ports) * columns],
            workspace: Workspace::default(),
            entries: Vec::new(),
        };
        for i in 0..start {
            this.rows[i * columns + free + i] = 1.0;
        }
        for (j, sensitivity) in moved.into_iter().flatten().take(moving).enumerate() {
            for i in 0..s.states {
                this.rows[i * columns + j] = sensitivity[i];
            }
        }
        this.settle(first);
        this
    }

    /// Forces follow states and parameters at once.
    fn settle(&mut self, at: &Instant) {
        let (s, columns) = (self.sizes, self.columns);
        let Motion { coupling, inactive_laws, .. } = self.hybrid_modes.motion(at.side);
        self.inactive = inactive_laws.at(at);
        // The speeds as they would be without the forces, by the states that move and by the equations that do.
        for p in 0..s.ports {
            let seen = self.seen(at, p);
            self.next[(s.states + p) * columns..][..columns].copy_from_slice(&seen);
        }
        let speeds = &self.next[s.states * columns..][..s.ports * columns];
        let forces = &mut self.rows[s.states * columns..][..s.ports * columns];
        follow(
            &self.hybrid_modes.sides[at.side].laws,
            &at.responses,
            coupling,
            speeds,
            forces,
            &mut self.workspace,
        );
    }

    /// What a port sees, while forces stay.
    fn seen(&self, at: &Instant, port: usize) -> Vec<f64> {
        let Motion { equations, sensitivities, inactive_laws, .. } = self.hybrid_modes.motion(at.side);
        let mut seen = vec![0.0; self.columns];
        for (i, row) in self.rows.chunks_exact(self.columns.max(1)).take(self.sizes.states).enumerate() {
            seen.iter_mut().zip(row).for_each(|(v, x)| *v += equations.port[(port, i)] * x);
        }
        for (v, sensitivity) in seen.iter_mut().zip(sensitivities) {
            let state = at.state.iter().enumerate().map(|(i, x)| sensitivity.port[(port, i)] * x);
            let input = at.inputs.iter().enumerate().map(|(i, u)| sensitivity.port_input[(port, i)] * u);
            let force = at.forces.iter().enumerate().map(|(q, f)| sensitivity.port_force[(port, q)] * f);
            *v += state.sum::<f64>() + input.sum::<f64>() + force.sum::<f64>();
        }
        self.inactive
            .iter()
            .for_each(|inactive| seen[inactive.column] += inactive_laws.to_port(port, inactive));
        seen
    }

    /// Rates of the states, row by row.
    fn rates(&self, at: &Instant) -> Vec<f64> {
        let (s, columns) = (self.sizes, self.columns);
        let motion = self.hybrid_modes.motion(at.side);
        let mut rates = vec![0.0; s.states * columns];
        for (i, rate) in rates.chunks_exact_mut(columns.max(1)).enumerate() {
            for (j, row) in self.rows.chunks_exact(columns).take(s.states + s.ports).enumerate() {
                let e = &motion.equations;
                let factor = if j < s.states { e.state[(i, j)] } else { e.force[(i, j - s.states)] };
                rate.iter_mut().zip(row).for_each(|(rate, value)| *rate += factor * value);
            }
        }
        for (j, moved) in motion.moved_rates(at).iter().enumerate() {
            moved.iter().enumerate().for_each(|(i, value)| rates[i * columns + j] += value);
        }
        for inactive in &self.inactive {
            (0..s.states).for_each(|i| {
                rates[i * columns + inactive.column] += motion.inactive_laws.to_rate(i, inactive)
            });
        }
        rates
    }

    /// After whatever happened.
    pub(crate) fn follow(&mut self, event: &Event<'_>) {
        match event {
            _ if self.columns == 0 => {}
            Event::Step(taken) => self.advance(taken),
            Event::SwitchingEvent(turn) => self.turn(turn),
            Event::Jump(at) => self.settle(at),
        }
    }

    /// After teeth have met or parted: by how much each unknown moves the time at which they do, the state has moved less on one side,
    /// and more on the other (the saltation matrix of a hybrid system: Aizerman and Gantmacher 1958, Q. J. Mech. Appl. Math. 11, 385).
    fn turn(&mut self, turn: &SwitchingEvent) {
        let SwitchingEvent { before, beyond, after, late_s, rate, jump } = turn;
        let Some(Play { port, gap }) = &self.hybrid_modes.play else { return };
        let mut later = self.seen(before, *port);
        if let Some(gap) = gap {
            let outward = 0.5 * if beyond.side.max(before.side) > 1 { 1.0 } else { -1.0 };
            later[*gap] -= outward;
        }
        let by_twist = if *late_s > 0.0 { 1.0 / rate } else { 0.0 };
        later.iter_mut().for_each(|late| *late *= by_twist);
        let rates = self.rates(before);
        self.settle(beyond);
        let rates_beyond = self.rates(beyond);
        for (i, jump) in jump.iter().enumerate() {
            let row = &mut self.rows[i * self.columns..(i + 1) * self.columns];
            let [before, beyond] = [&rates, &rates_beyond].map(|rates| &rates[i * self.columns..]);
            for (((value, late), before), beyond) in row.iter_mut().zip(&later).zip(before).zip(beyond) {
                *value -= late_s * (before - beyond) + jump * late;
            }
        }
        self.settle(after);
    }

    /// Whether those with respect to the start state are kept.
    pub(crate) fn starting(&self) -> bool {
        self.start > 0
    }

    /// From now on without those with respect to the start state.
    pub(crate) fn drop_start(&mut self) {
        let (old, new) = (self.columns, padded(self.moving));
        for rows in [&mut self.rows, &mut self.next] {
            *rows = rows.chunks_exact(old.max(1)).flat_map(|row| &row[..new]).copied().collect();
        }
        (self.start, self.columns) = (0, new);
    }

    fn advance(&mut self, taken: &AcceptedStep<'_>) {
        let (s, columns) = (self.sizes, self.columns);
        let at_start = s.states + s.ports;
        let (inactive_inputs, xi) = (&taken.level.inactive_inputs, taken.xi);
        taken.inactive_laws.along(inactive_inputs, xi, self.later.each_mut());
        // Speeds without the forces that follow them.
        pulp::Arch::new().dispatch(ResidualAccumulator {
            sensitivity: self,
            taken,
            first: s.states,
            count: 2 * s.ports,
            known: at_start,
        });
        let nodes = [&*self.inactive, &*self.later[0], &*self.later[1]];
        inactive_inputs.add(nodes, s.states, &mut self.next[s.states * columns..], columns);
        let (_, speeds) = self.next.split_at_mut(s.states * self.columns);
        let (_, forces) = self.rows.split_at_mut(at_start * self.columns);
        follow(taken.laws, taken.responses, &taken.level.coupling, speeds, forces, &mut self.workspace);
        let known = at_start + 2 * s.ports;
        pulp::Arch::new().dispatch(ResidualAccumulator {
            sensitivity: self,
            taken,
            first: 0,
            count: s.states,
            known,
        });
        let nodes = [&*self.inactive, &*self.later[0], &*self.later[1]];
        inactive_inputs.add(nodes, 0, &mut self.next[..s.states * columns], columns);
        std::mem::swap(&mut self.inactive, &mut self.later[1]);
        let (states, forces) = self.rows.split_at_mut(s.states * self.columns);
        states.copy_from_slice(&self.next[..states.len()]);
        forces.copy_within(2 * s.ports * self.columns.., 0);
    }

    /// Has output_only hear the motion as it is now, `inputs` as held.
    pub(crate) fn read(&mut self, integrator: &Integrator<'_>, inputs: &[f64]) {
        let motion = integrator.state().iter().chain(inputs).chain(integrator.forces()).copied();
        self.hybrid_modes.motion(integrator.side()).output_only.evaluate(motion, &mut self.read);
    }

    /// Sensitivities of one output now, each where [`Sensitivity::place`] has it.
    pub(crate) fn observe(
        &mut self,
        output: usize,
        integrator: &Integrator<'_>,
        inputs: &[f64],
        sensitivities: &mut Vec<f64>,
    ) {
        let s = self.sizes;
        let Motion { constants, inactive_laws, output_only, .. } =
            self.hybrid_modes.motion(integrator.side());
        self.entries.clear();
        self.entries.extend(integrator.state().iter().chain(inputs).chain(integrator.forces()));
        let from = sensitivities.len();
        sensitivities.resize(from + self.observed(), 0.0);
        let target = &mut sensitivities[from..from + self.columns];
        products::add_rows(
            &constants.outputs[output],
            &self.rows[..(s.states + s.ports) * self.columns],
            self.columns,
            &mut *target,
        );
        let moved = padded(s.free);
        products::add_rows(
            &self.entries,
            &constants.output_sensitivities[output],
            moved,
            &mut target[..moved],
        );
        self.inactive
            .iter()
            .for_each(|inactive| target[inactive.column] += inactive_laws.to_output(output, inactive));
        for inactive in &self.read {
            sensitivities[from + self.place(inactive.column)] += output_only.to_output(output, inactive);
        }
    }

    /// Numbers of one output's sensitivities.
    pub(crate) fn observed(&self) -> usize {
        self.columns + self.hybrid_modes.free - self.moving
    }

    /// Where among these a free parameter's is.
    pub(crate) fn place(&self, free: usize) -> usize {
        if free < self.moving { free } else { self.columns + free - self.moving }
    }

    /// Where those with respect to the start state are.
    pub(crate) fn start_places(&self) -> Range<usize> {
        padded(self.moving)..padded(self.moving) + self.start
    }
}

/// Workspace for [`follow`].
#[derive(Default)]
struct Workspace {
    matrix: Vec<f64>,
    active: Vec<usize>,
    speeds: Vec<f64>,
}

/// Given how speeds would move without the forces, moves forces with them: v = v0 + C f and f = L v + q, where q is how the laws
/// move with their own parameters. Of the speeds, only those of ports whose force moves with them are used.
fn follow(
    laws: &[Law],
    responses: &[Response],
    coupling: &[f64],
    speeds: &[f64],
    forces: &mut [f64],
    workspace: &mut Workspace,
) {
    let count = responses.len();
    if count == 0 {
        return;
    }
    let columns = speeds.len() / count;
    if columns == 0 {
        return;
    }
    laws::moving(responses, &mut workspace.active);
    workspace.speeds.clear();
    for i in &workspace.active {
        let from = workspace.speeds.len();
        workspace.speeds.extend_from_slice(&speeds[i * columns..(i + 1) * columns]);
        for (k, response) in responses.iter().enumerate() {
            for (position, column) in &laws[k % laws.len()].free {
                workspace.speeds[from + column] += coupling[i * count + k] * response.by_parameter[*position];
            }
        }
    }
    laws::stiffness(coupling, responses, &workspace.active, &mut workspace.matrix);
    // A singular matrix is no motion at all; the overflow that made it is found in the prediction.
    if !laws::solve(&mut workspace.matrix, &mut workspace.speeds, columns) {
        workspace.speeds.fill(0.0);
    }
    forces.fill(0.0);
    for (i, speed) in workspace.active.iter().zip(workspace.speeds.chunks_exact(columns)) {
        let force = &mut forces[i * columns..(i + 1) * columns];
        force.iter_mut().zip(speed).for_each(|(f, v)| *f = responses[*i].by_input * v);
    }
    for (k, response) in responses.iter().enumerate() {
        for (position, column) in &laws[k % laws.len()].free {
            forces[k * columns + column] += response.by_parameter[*position];
        }
    }
}

/// ResidualAccumulator `first..` of a step, by the first `known` rows of sensitivities: states, then forces.
struct ResidualAccumulator<'a, 's> {
    sensitivity: &'a mut Sensitivity<'s>,
    taken: &'a AcceptedStep<'a>,
    first: usize,
    count: usize,
    known: usize,
}

impl WithSimd for ResidualAccumulator<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { sensitivity, taken, first, count, known } = self;
        let s = sensitivity.sizes;
        let (width, columns, moved) = (s.width(), sensitivity.columns, padded(s.free));
        let (states, forces) = sensitivity.rows[..known * columns].split_at(s.states * columns);
        for i in first..first + count {
            // What nothing depends on is not needed.
            if first > 0 && taken.responses[i - first].by_input == 0.0 {
                continue;
            }
            let map = &taken.level.rows[i * width..(i + 1) * width];
            let target = &mut sensitivity.next[i * columns..(i + 1) * columns];
            let sensitivities = &taken.level.sensitivities[i * width * moved..(i + 1) * width * moved];
            let own = [(&map[..s.states], states, columns), (&map[s.forces()..], forces, columns)];
            let (first, rest) = target.split_at_mut(moved);
            products::write(simd, [own[0], own[1], (taken.xi, sensitivities, moved)], 0, first);
            products::write(simd, own, moved, rest);
        }
    }
}
