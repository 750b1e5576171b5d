//! The state of a model along its recording: exact steps where its laws are straight, short ones where they bend.
//!
//! Forces over a step are found together with the motion that they cause (an implicit method: laws may be as steep as they
//! like). A quarter and three quarters into the step the laws are asked again: what they say there beside the parabola is the
//! error made. Where that moves a port by more than the tolerance, the step is halved.

use socam_model::Equations;

use crate::{
    between::Course,
    combine,
    exponential::{Level, Sizes},
    laws::{self, Law, Response, Room, SILENT},
};

/// Error of a step that is allowed in the speed that a law sees, relative to the largest such speed so far: outputs then stay
/// within a millionth of their range. Each factor of 32 costs twice the steps, and only where a law bends.
pub const DEFAULT_TOLERANCE: f64 = 1e-8;
/// Steps are lengthened when the error of one twice as long would still be within the tolerance: it grows with the fifth power.
const RELIEF: f64 = 1.0 / 64.0;

/// Where the motion stands, and how it goes on.
pub(crate) struct Walker<'a> {
    equations: &'a Equations,
    levels: &'a [Level],
    laws: &'a [Law],
    sizes: Sizes,
    /// Error of a step in a port's speed that is allowed, relative to the largest speed that it has had.
    tolerance: f64,
    largest: Vec<f64>,
    /// Level of the last step.
    level: usize,
    /// State; inputs at a step's start, middle and end; forces there.
    xi: Vec<f64>,
    /// What the map makes of xi.
    ends: Vec<f64>,
    speeds: Vec<f64>,
    /// Of all laws in the middle of a step, then at its end.
    responses: Vec<Response>,
    room: Room,
    /// Steps taken although their error was too large and they could not be shortened.
    pub(crate) unresolved: usize,
    /// Whether the prediction has overflowed, as far as anybody who looks at a bench is concerned; it then stands still.
    ran_away: bool,
}

/// A step that was taken.
pub(crate) struct Taken<'w> {
    pub(crate) level: &'w Level,
    pub(crate) xi: &'w [f64],
    pub(crate) responses: &'w [Response],
}

impl<'a> Walker<'a> {
    /// At `state`, with `inputs`. `tolerance` is relative to the largest speed that a port has had.
    pub(crate) fn new(
        equations: &'a Equations,
        levels: &'a [Level],
        laws: &'a [Law],
        tolerance: f64,
        state: &[f64],
        inputs: &[f64],
    ) -> Self {
        let sizes = Sizes::new(equations, 0);
        let mut xi = vec![0.0; sizes.width()];
        xi[..sizes.states].copy_from_slice(state);
        let mut walker = Self {
            equations,
            levels,
            laws,
            sizes,
            tolerance,
            largest: laws.iter().map(Law::least).collect(),
            level: 0,
            xi,
            ends: vec![0.0; levels[0].stride],
            speeds: vec![0.0; 2 * sizes.ports],
            responses: vec![SILENT; 2 * sizes.ports],
            room: Room::default(),
            unresolved: 0,
            ran_away: false,
        };
        walker.settle(inputs);
        walker
    }

    pub(crate) fn state(&self) -> &[f64] {
        &self.xi[..self.sizes.states]
    }

    pub(crate) fn forces(&self) -> &[f64] {
        &self.xi[self.sizes.forces()..][..self.sizes.ports]
    }

    /// Of all laws now.
    pub(crate) fn responses(&self) -> &[Response] {
        &self.responses[self.sizes.ports..]
    }

    /// Forces at the start: the speeds depend on them only where a law acts on a massless node.
    fn settle(&mut self, inputs: &[f64]) {
        let (e, ports) = (self.equations, self.sizes.ports);
        if ports == 0 {
            return;
        }
        let base: Vec<f64> = (0..ports)
            .map(|p| {
                let state: f64 = self.state().iter().enumerate().map(|(i, x)| e.port[(p, i)] * x).sum();
                state + inputs.iter().enumerate().map(|(i, u)| e.port_input[(p, i)] * u).sum::<f64>()
            })
            .collect();
        let coupling: Vec<f64> = (0..ports * ports).map(|k| e.port_force[(k / ports, k % ports)]).collect();
        let now = &mut self.speeds[ports..];
        now.copy_from_slice(&base);
        laws::balance(self.laws, &base, &coupling, now, &mut self.responses[ports..], &mut self.room);
        self.keep_forces();
    }

    /// The forces and speeds at the end of a step are those at the start of the next.
    fn keep_forces(&mut self) {
        let (ports, forces) = (self.sizes.ports, self.sizes.forces());
        for p in 0..ports {
            self.xi[forces + p] = self.responses[ports + p].torque;
            let seen = self.speeds[ports + p].abs();
            self.largest[p] = self.largest[p].max(seen);
            self.ran_away |= self.laws[p].is_beyond(seen);
        }
    }

    /// One sample further, each input along its `course`. `taken` learns of each step, before the state moves.
    pub(crate) fn sample(&mut self, course: &[Course], mut taken: impl FnMut(&Taken<'_>)) {
        let (n, inputs) = (self.sizes.states, self.sizes.inputs);
        let finest = self.levels.len() - 1;
        let whole = 1_usize << finest;
        // Nothing is lost by trying a step twice as long as the last.
        let mut level = self.level.saturating_sub(1).min(finest);
        let mut done = 0;
        while done < whole && !self.ran_away {
            while !done.is_multiple_of(whole >> level) {
                level += 1;
            }
            let length = whole >> level;
            let part = [done, done + length].map(|position| position as f64 / whole as f64);
            for (i, course) in course.iter().enumerate() {
                for (node, value) in course.parabola(part).into_iter().enumerate() {
                    self.xi[n + node * inputs + i] = value;
                }
            }
            let error = self.attempt(level);
            let passed = error <= self.tolerance;
            if !passed && level < finest {
                // The fifth root of what is too much, in halvings.
                let excess = (error / self.tolerance).log2() / 5.0;
                level =
                    finest.min(level + if excess.is_finite() { excess.ceil().max(1.0) as usize } else { 2 });
                continue;
            }
            self.unresolved += usize::from(!passed);
            taken(&Taken { level: &self.levels[level], xi: &self.xi, responses: &self.responses });
            self.xi[..n].copy_from_slice(&self.ends[..n]);
            self.keep_forces();
            self.level = level;
            if self.ran_away {
                self.xi.fill(f64::NAN);
            }
            done += length;
            if error <= self.tolerance * RELIEF && level > 0 && done.is_multiple_of(2 * length) {
                level -= 1;
            }
        }
    }

    /// Finds the forces of a step of this level and says its error, relative to what the ports' speeds have been.
    fn attempt(&mut self, index: usize) -> f64 {
        let level = &self.levels[index];
        let (n, ports, sought) = (self.sizes.states, self.sizes.ports, self.sizes.sought());
        self.ends.fill(0.0);
        combine::add_rows(&self.xi[..sought], &level.columns, level.stride, &mut self.ends);
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
            self.laws,
            base,
            &level.coupling,
            &mut self.speeds,
            &mut self.responses,
            &mut self.room,
        );
        for (force, response) in self.xi[sought..].iter_mut().zip(&self.responses) {
            *force = response.torque;
        }
        combine::add_rows(
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
    fn error(&self, level: &Level) -> f64 {
        let (n, ports, forces) = (self.sizes.states, self.sizes.ports, self.sizes.forces());
        let mut worst = 0.0_f64;
        for q in (0..ports).filter(|q| self.laws[*q].leads()) {
            let [start, middle, end] = [0, 1, 2].map(|node| self.xi[forces + node * ports + q]);
            let law = &self.laws[q];
            let miss =
                |speed: usize, parabola: f64| law.at(&self.ends[n + speed * ports + q..]).torque - parabola;
            let first = miss(2, 0.375 * start + 0.75 * middle - 0.125 * end);
            let last = miss(3, -0.125 * start + 0.75 * middle + 0.375 * end);
            let mean = (32.0 / 90.0) * (first + last).abs() + 0.05 * (first - last).abs();
            for p in 0..ports {
                // A NaN must not be lost in a maximum.
                let size = self.largest[p].max(f64::MIN_POSITIVE) * self.laws[p].leniency();
                let share = level.gain[p * ports + q] * mean / size;
                worst = if share > worst || share.is_nan() { share } else { worst };
            }
        }
        worst
    }

    /// The outputs now, `inputs` as measured.
    pub(crate) fn outputs(&self, inputs: &[f64], outputs: &mut [f64]) {
        let e = self.equations;
        for (o, output) in outputs.iter_mut().enumerate() {
            let state: f64 = self.state().iter().enumerate().map(|(i, x)| e.output[(o, i)] * x).sum();
            let through: f64 = inputs.iter().enumerate().map(|(i, u)| e.feedthrough[(o, i)] * u).sum();
            let force: f64 = self.forces().iter().enumerate().map(|(p, f)| e.force_output[(o, p)] * f).sum();
            *output = state + through + force;
        }
    }
}
