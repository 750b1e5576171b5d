//! The state of a model along its recording: exact steps where its laws are straight, short ones where they bend.
//!
//! Forces over a step are found together with the motion that they cause (an implicit method: laws may be as steep as they
//! like). A quarter and three quarters into the step the laws are asked again: what they say there beside the parabola is the
//! error made. Where that moves a port by more than the tolerance, the step is halved. A step within which teeth meet or part is
//! halved down to the shortest, and what that goes too far is taken back.

use crate::prediction::{
    exponential::{Sizes, StepLevel},
    hybrid_modes::{HybridModes, Motion, Play},
    inactive_laws::InactiveLaws,
    intersample::InputCourse,
    laws::{self, INACTIVE, Law, Response, Workspace},
    products::{self, row_times},
};

/// Error of a step that is allowed in the speed that a law sees, relative to the largest such speed so far: outputs then stay
/// within a millionth of their range. Each factor of 32 costs twice the steps, and only where a law bends.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;
/// Steps are lengthened when the error of one twice as long would still be within the tolerance: it grows with the fifth power.
const RELIEF: f64 = 1.0 / 64.0;

/// Where the motion stands, and how it goes on.
pub(crate) struct Integrator<'a> {
    hybrid_modes: &'a HybridModes,
    /// Which of them it is in.
    side: usize,
    sizes: Sizes,
    /// Error of a step in a port's speed that is allowed, relative to the largest speed that it has had.
    tolerance: f64,
    largest: Vec<f64>,
    /// StepLevel of the last step.
    level: usize,
    /// State; inputs at a step's start, middle and end; forces there.
    xi: Vec<f64>,
    /// What the map makes of xi.
    ends: Vec<f64>,
    speeds: Vec<f64>,
    /// Of all laws in the middle of a step, then at its end.
    responses: Vec<Response>,
    workspace: Workspace,
    /// Steps taken although their error was too large and they could not be shortened.
    pub(crate) unresolved: usize,
    /// Steps tried, whether they were taken or not.
    pub(crate) attempts: usize,
    /// Whether the prediction has overflowed, as far as anybody who looks at a bench is concerned; it then stands still.
    ran_away: bool,
}

/// What happens on the way.
pub(crate) enum Event<'w> {
    /// A step, before the state moves.
    Step(&'w AcceptedStep<'w>),
    /// Teeth met or parted within the step before; all has followed.
    SwitchingEvent(&'w SwitchingEvent),
    /// A held input jumped, and with it what a law sees.
    Jump(&'w Instant),
}

/// A step.
pub(crate) struct AcceptedStep<'w> {
    pub(crate) level: &'w StepLevel,
    pub(crate) xi: &'w [f64],
    pub(crate) responses: &'w [Response],
    pub(crate) laws: &'w [Law],
    pub(crate) inactive_laws: &'w InactiveLaws,
}

/// All there is at a time.
pub(crate) struct Instant {
    pub(crate) side: usize,
    pub(crate) state: Vec<f64>,
    pub(crate) inputs: Vec<f64>,
    pub(crate) forces: Vec<f64>,
    pub(crate) responses: Vec<Response>,
}

/// From one side of a boundary to the other, a little late: the state goes back along the motion before, and forth along the one after.
pub(crate) struct SwitchingEvent {
    pub(crate) before: Instant,
    /// On the other side at the same state.
    pub(crate) beyond: Instant,
    /// With the state as it would be, had the boundary been seen in time.
    pub(crate) after: Instant,
    /// Since the boundary was met, s.
    pub(crate) late_s: f64,
    /// Of the twist in the mesh, rad/s.
    pub(crate) rate: f64,
    /// Rates of the state before, less those beyond.
    pub(crate) jump: Vec<f64>,
}

impl<'a> Integrator<'a> {
    /// At `state`, with `inputs`. `tolerance` is relative to the largest speed that a port has had.
    pub(crate) fn new(hybrid_modes: &'a HybridModes, tolerance: f64, state: &[f64], inputs: &[f64]) -> Self {
        let side = hybrid_modes.side_at(state, inputs);
        let Motion { equations, levels, .. } = hybrid_modes.motion(side);
        let sizes = Sizes::new(equations, 0);
        let mut xi = vec![0.0; sizes.width()];
        xi[..sizes.states].copy_from_slice(state);
        xi[sizes.states + 2 * sizes.inputs..][..sizes.inputs].copy_from_slice(inputs);
        let mut integrator = Self {
            hybrid_modes,
            side,
            sizes,
            tolerance,
            largest: hybrid_modes.sides[side].laws.iter().map(Law::least).collect(),
            level: 0,
            xi,
            ends: vec![0.0; levels[0].stride],
            speeds: vec![0.0; 2 * sizes.ports],
            responses: vec![INACTIVE; 2 * sizes.ports],
            workspace: Workspace::default(),
            unresolved: 0,
            attempts: 0,
            ran_away: false,
        };
        integrator.settle(inputs);
        integrator
    }

    fn motion(&self) -> &'a Motion {
        self.hybrid_modes.motion(self.side)
    }

    fn laws(&self) -> &'a [Law] {
        &self.hybrid_modes.sides[self.side].laws
    }

    /// Now, `inputs` as held.
    pub(crate) fn instant(&self, inputs: &[f64]) -> Instant {
        Instant {
            side: self.side,
            state: self.state().to_vec(),
            inputs: inputs.to_vec(),
            forces: self.forces().to_vec(),
            responses: self.responses[self.sizes.ports..].to_vec(),
        }
    }

    pub(crate) fn state(&self) -> &[f64] {
        &self.xi[..self.sizes.states]
    }

    pub(crate) fn forces(&self) -> &[f64] {
        &self.xi[self.sizes.forces()..][..self.sizes.ports]
    }

    /// Which way of moving it is.
    pub(crate) fn side(&self) -> usize {
        self.side
    }

    /// Forces at this state: the speeds depend on them only where a law acts on a massless node.
    fn settle(&mut self, inputs: &[f64]) {
        let (Motion { equations: e, coupling, .. }, ports) = (self.motion(), self.sizes.ports);
        if ports == 0 {
            return;
        }
        let seen = |p| row_times(&e.port, p, self.state()) + row_times(&e.port_input, p, inputs);
        let base: Vec<f64> = (0..ports).map(seen).collect();
        let laws = self.laws();
        let now = &mut self.speeds[ports..];
        now.copy_from_slice(&base);
        laws::balance(laws, &base, coupling, now, &mut self.responses[ports..], &mut self.workspace);
        self.keep_forces();
    }

    /// The forces and speeds at the end of a step are those at the start of the next.
    fn keep_forces(&mut self) {
        let (ports, forces) = (self.sizes.ports, self.sizes.forces());
        for p in 0..ports {
            self.xi[forces + p] = self.responses[ports + p].torque;
            let seen = self.speeds[ports + p].abs();
            self.largest[p] = self.largest[p].max(seen);
            self.ran_away |= self.laws()[p].is_beyond(seen);
        }
    }

    /// One sample further, each input along its `course`. `follow` learns of all that happens.
    pub(crate) fn sample(&mut self, course: &[InputCourse], mut follow: impl FnMut(&Event<'_>)) {
        let n = self.sizes.states;
        let finest = self.motion().levels.len() - 1;
        let whole = 1_usize << finest;
        if self.jumps(course) && !self.ran_away {
            let inputs: Vec<f64> = course.iter().map(|course| course.at(0.0)).collect();
            self.settle(&inputs);
            follow(&Event::Jump(&self.instant(&inputs)));
        }
        // Nothing is lost by trying a step twice as long as the last.
        let mut level = self.level.saturating_sub(1).min(finest);
        let mut done = 0;
        while done < whole && !self.ran_away {
            while !done.is_multiple_of(whole >> level) {
                level += 1;
            }
            let (bent, taken, error) = self.find_step(course, (done, whole), level);
            (self.level, level) = (bent, bent);
            let length = whole >> taken;
            self.unresolved += usize::from(error > self.tolerance || error.is_nan());
            follow(&Event::Step(&AcceptedStep {
                level: &self.motion().levels[taken],
                xi: &self.xi,
                responses: &self.responses,
                laws: self.laws(),
                inactive_laws: &self.motion().inactive_laws,
            }));
            self.xi[..n].copy_from_slice(&self.ends[..n]);
            self.keep_forces();
            if let Some(turn) = self.turn() {
                follow(&Event::SwitchingEvent(&turn));
            }
            if self.ran_away {
                self.xi.fill(f64::NAN);
            }
            done += length;
            if error <= self.tolerance * RELIEF && level > 0 && done.is_multiple_of(whole >> (level - 1)) {
                level -= 1;
            }
        }
    }

    /// Whether an input that a law sees at once goes on from another value than it had.
    fn jumps(&self, course: &[InputCourse]) -> bool {
        let seen = &self.motion().equations.port_input;
        let last = &self.xi[self.sizes.states + 2 * self.sizes.inputs..];
        course.iter().zip(last).enumerate().any(|(input, (course, last))| {
            let next = course.at(0.0);
            (next - last).abs() > 1e-9 * next.abs().max(last.abs())
                && seen.column(input).iter().any(|factor| *factor != 0.0)
        })
    }

    /// The longest step from here, where `done` parts of the `whole` of a sample are over, of `level` or further, in which the laws do
    /// not bend too much and the teeth stay as they are, or the shortest there is. Answers the level that the laws allow, that of the
    /// step, and its error.
    fn find_step(
        &mut self,
        course: &[InputCourse],
        (done, whole): (usize, usize),
        level: usize,
    ) -> (usize, usize, f64) {
        let (n, inputs) = (self.sizes.states, self.sizes.inputs);
        let finest = self.motion().levels.len() - 1;
        let (mut bent, mut level) = (level, level);
        loop {
            let part = [done, done + (whole >> level)].map(|position| position as f64 / whole as f64);
            for (i, course) in course.iter().enumerate() {
                for (node, value) in course.parabola(part).into_iter().enumerate() {
                    self.xi[n + node * inputs + i] = value;
                }
            }
            let error = self.attempt(level);
            self.attempts += 1;
            let passed = error <= self.tolerance;
            if level == finest || (passed && !self.leaves()) {
                return (bent, level, error);
            }
            if passed {
                level += 1;
                continue;
            }
            // The error falls with the fifth power: as many halvings as it takes.
            let excess = (error / self.tolerance).log2() / 5.0;
            level = finest.min(level + if excess.is_finite() { excess.ceil().max(1.0) as usize } else { 2 });
            bent = level;
        }
    }

    /// Whether teeth meet or part within the step that was found.
    fn leaves(&self) -> bool {
        let (n, ports) = (self.sizes.states, self.sizes.ports);
        let Some(Play { port, .. }) = self.hybrid_modes.play else { return false };
        let [low, high] = self.hybrid_modes.sides[self.side].range;
        (0..4).any(|node| !(low..=high).contains(&self.ends[n + node * ports + port]))
    }

    /// Goes over to the side on which the twist in the mesh is at the end of a step, if it is another one.
    fn turn(&mut self) -> Option<SwitchingEvent> {
        let (n, ports, inputs) = (self.sizes.states, self.sizes.ports, self.sizes.inputs);
        let Play { port, .. } = self.hybrid_modes.play?;
        let [low, high] = self.hybrid_modes.sides[self.side].range;
        let (twist, rate) = (self.speeds[ports + port], self.speeds[ports + port + 1]);
        let (next, boundary) = match twist {
            _ if twist < low => (self.side - 1, low),
            _ if twist > high => (self.side + 1, high),
            _ => return None,
        };
        let held = self.xi[n + 2 * inputs..][..inputs].to_vec();
        let before = self.instant(&held);
        let late_s = (twist - boundary) / rate;
        // Grazing, or there and back within the shortest step: nothing to be mended.
        let late_s = if (0.0..=2.0 * self.hybrid_modes.finest_s).contains(&late_s) { late_s } else { 0.0 };
        self.side = next;
        self.settle(&held);
        let beyond = self.instant(&held);
        let rates = |instant: &Instant| self.hybrid_modes.motion(instant.side).rates(instant);
        let jump: Vec<f64> =
            rates(&before).iter().zip(rates(&beyond)).map(|(before, beyond)| before - beyond).collect();
        self.xi.iter_mut().zip(&jump).for_each(|(x, jump)| *x -= late_s * jump);
        self.settle(&held);
        Some(SwitchingEvent { before, beyond, after: self.instant(&held), late_s, rate, jump })
    }

    /// Finds the forces of a step of this level and says its error, relative to what the ports' speeds have been.
    fn attempt(&mut self, index: usize) -> f64 {
        let (level, laws) = (&self.motion().levels[index], self.laws());
        let (n, ports, sought) = (self.sizes.states, self.sizes.ports, self.sizes.sought());
        self.ends.fill(0.0);
        products::add_rows(&self.xi[..sought], &level.columns, level.stride, &mut self.ends);
        if ports == 0 {
            return 0.0;
        }
        // As if the forces stayed.
        for i in 0..2 * ports {
            let forces = self.xi[self.sizes.forces()..sought].iter().cycle();
            let stay: f64 =
                level.coupling[i * 2 * ports..].iter().take(2 * ports).zip(forces).map(|(c, f)| c * f).sum();
            self.speeds[i] = self.ends[n + i] + stay;
        }
        let base = &self.ends[n..n + 2 * ports];
        let found = laws::balance(
            laws,
            base,
            &level.coupling,
            &mut self.speeds,
            &mut self.responses,
            &mut self.workspace,
        );
        for (force, response) in self.xi[sought..].iter_mut().zip(&self.responses) {
            *force = response.torque;
        }
        products::add_rows(
            &self.xi[sought..],
            &level.columns[sought * level.stride..],
            level.stride,
            &mut self.ends,
        );
        if !found {
            return f64::INFINITY;
        }
        self.error(level)
    }

    /// Boole's rule less Simpson's: the mean of what the parabolas miss, by what they miss at the quarters. The part that cancels
    /// there is weighted lightly: it counts where a step is long against what the port's motion takes to settle.
    fn error(&self, level: &StepLevel) -> f64 {
        let (n, ports, forces) = (self.sizes.states, self.sizes.ports, self.sizes.forces());
        let mut worst = 0.0_f64;
        let laws = self.laws();
        for q in (0..ports).filter(|q| laws[*q].leads()) {
            let [start, middle, end] = [0, 1, 2].map(|node| self.xi[forces + node * ports + q]);
            let law = &laws[q];
            let miss =
                |speed: usize, parabola: f64| law.at(&self.ends[n + speed * ports + q..]).torque - parabola;
            let first = miss(2, 0.375 * start + 0.75 * middle - 0.125 * end);
            let last = miss(3, -0.125 * start + 0.75 * middle + 0.375 * end);
            let mean = (32.0 / 90.0) * (first + last).abs() + 0.05 * (first - last).abs();
            for (p, seen) in laws.iter().enumerate() {
                // A NaN must not be lost in a maximum.
                let size = self.largest[p].max(f64::MIN_POSITIVE) * seen.error_weight();
                let share = level.gain[p * ports + q] * mean / size;
                worst = if share > worst || share.is_nan() { share } else { worst };
            }
        }
        worst
    }

    /// The outputs now, `inputs` as measured.
    pub(crate) fn outputs(&self, inputs: &[f64], outputs: &mut [f64]) {
        let e = &self.motion().equations;
        for (o, output) in outputs.iter_mut().enumerate() {
            let through = row_times(&e.feedthrough, o, inputs);
            *output = row_times(&e.output, o, self.state())
                + through
                + row_times(&e.force_output, o, self.forces());
        }
    }
}
