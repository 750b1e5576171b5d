//! Prediction of a model whose force laws bend it: exact exponential steps of the linear part, forces linear
//! over a step and implicit at its end, with exact sensitivities of exactly these steps.
//!
//! Where every law is far from its bend a step is a whole sample and exact; near it, a sample is cut into up to
//! 2^[`HALVINGS`] parts, so that a law's argument moves by at most half its transition per part.

use nalgebra::DMatrix;
use socam_model::{Equations, effects::Response};

use crate::{
    IdentifyError, feed,
    modal::offset_channels,
    pass::{Point, Rows, Weights},
    problem::{Problem, StartState},
    start,
};

/// Samples are cut into at most two to the power of this many parts.
const HALVINGS: usize = 5;
/// Beyond this many transition widths a hyperbolic tangent is 1 to 1e-7.
const SATURATED: f64 = 8.0;

/// One-step map x+ = T xi with xi = [x, u before, u after, f before, f after], and its slopes.
struct Level {
    /// states x width, row by row.
    map: Vec<f64>,
    /// states x width x free.
    slopes: Vec<f64>,
}

/// Integrates one stretch.
pub(crate) struct Stepper<'a> {
    equations: &'a Equations,
    slopes: &'a [Equations],
    free: &'a [usize],
    weights: &'a Weights,
    sizes: Sizes,
    /// From a whole sample to its finest part.
    levels: Vec<Level>,
    laws: Vec<Law>,
}

#[derive(Clone, Copy)]
struct Sizes {
    states: usize,
    inputs: usize,
    ports: usize,
    free: usize,
    locals: usize,
}

impl Sizes {
    fn width(self) -> usize {
        self.states + 2 * self.inputs + 2 * self.ports
    }

    fn columns(self) -> usize {
        self.locals + self.free
    }
}

/// A law with its parameters filled in.
struct Law {
    evaluate: fn(f64, &[f64]) -> Response,
    parameters: Vec<f64>,
    transition: f64,
    /// Position in the law's parameters and column of each that is free.
    free: Vec<(usize, usize)>,
}

/// Where the integration stands.
#[derive(Clone)]
struct State {
    x: Vec<f64>,
    /// states x columns, row by row.
    sensitivity: Vec<f64>,
    force: Vec<f64>,
    speed: Vec<f64>,
    /// ports x columns.
    force_sensitivity: Vec<f64>,
}

impl<'a> Stepper<'a> {
    /// `None` where the exponential overflows.
    pub(crate) fn new(
        problem: &'a Problem<'_>,
        equations: &'a Equations,
        slopes: &'a [Equations],
        point: &Point,
        weights: &'a Weights,
        sample_time_s: f64,
    ) -> Option<Self> {
        let sizes = Sizes {
            states: equations.state.nrows(),
            inputs: equations.input.ncols(),
            ports: equations.ports.len(),
            free: problem.free.len(),
            locals: 0,
        };
        let laws = equations.ports.iter().map(|port| {
            let parameters: Vec<f64> = port.parameters.iter().map(|index| point.values[*index]).collect();
            let column = |parameter: &usize| problem.free.iter().position(|free| free == parameter);
            Law {
                evaluate: port.effect.law,
                transition: (port.effect.transition_speed)(&parameters),
                free: port.parameters.iter().enumerate().filter_map(|(i, p)| Some((i, column(p)?))).collect(),
                parameters,
            }
        });
        let laws = laws.collect();
        let levels = levels(equations, slopes, sample_time_s, sizes)?;
        Some(Self { equations, slopes, free: &problem.free, weights, sizes, levels, laws })
    }

    /// Runs one stretch into `rows`; false where the prediction overflowed.
    pub(crate) fn predict(
        &mut self,
        problem: &Problem<'_>,
        index: usize,
        point: &Point,
        rows: &mut Rows,
    ) -> Result<bool, IdentifyError> {
        let stretch = &problem.stretches[index];
        let locals = &point.locals[index];
        self.sizes.locals = locals.len();
        let offsets = offset_channels(problem);
        let mut state: Option<State> = None;
        let mut last = vec![0.0; self.sizes.inputs];
        let mut finite = true;
        let mut jacobian: Vec<Vec<f64>> = vec![Vec::new(); problem.outputs()];
        feed::read(
            problem.model,
            &problem.datasets[stretch.recording],
            stretch,
            problem.intersample,
            |chunk| {
                let capacity = rows.capacity();
                for k in 0..chunk.rows() {
                    if !finite {
                        return;
                    }
                    let held: Vec<f64> = chunk.held.iter().map(|input| input[k]).collect();
                    let raw: Vec<f64> = chunk.inputs.iter().map(|input| input[k]).collect();
                    let now = match state.take() {
                        None => self.start(problem, locals, &point.values, &held),
                        Some(before) => self.sample(before, &last, &held),
                    };
                    self.observe(&now, &raw, locals, &offsets, &mut jacobian);
                    state = Some(now);
                    last = held;
                    let full = (k + 1) % capacity == 0 || k + 1 == chunk.rows();
                    if full {
                        let columns = self.sizes.columns() + 1;
                        let count = jacobian[0].len() / columns;
                        let measured: Vec<&[f64]> =
                            chunk.outputs.iter().map(|o| &o[k + 1 - count..=k]).collect();
                        finite = rows.take(
                            count,
                            true,
                            &self.weights.noise_std,
                            &measured,
                            |output, mut target| {
                                for (i, row) in jacobian[output].chunks_exact(columns).enumerate() {
                                    for (j, value) in row.iter().enumerate() {
                                        target[(i, j)] = *value;
                                    }
                                }
                            },
                        );
                        jacobian.iter_mut().for_each(Vec::clear);
                    }
                }
            },
        )?;
        Ok(finite)
    }

    fn start(&self, problem: &Problem<'_>, locals: &[f64], values: &[f64], inputs: &[f64]) -> State {
        let s = self.sizes;
        let mut sensitivity = vec![0.0; s.states * s.columns()];
        let x = if problem.options.start_state == StartState::Free {
            for i in 0..s.states {
                sensitivity[i * s.columns() + i] = 1.0;
            }
            locals[..s.states].to_vec()
        } else {
            let x = start::equilibrium(self.equations, values, inputs);
            let slopes = x.as_ref().and_then(|x| {
                start::equilibrium_slopes(self.equations, self.slopes, values, self.free, inputs, x)
            });
            for (j, slope) in slopes.iter().flatten().enumerate() {
                for i in 0..s.states {
                    sensitivity[i * s.columns() + s.locals + j] = slope[i];
                }
            }
            x.map_or_else(|| vec![0.0; s.states], |x| x.iter().copied().collect())
        };
        let mut state = State {
            x,
            sensitivity,
            force: vec![0.0; s.ports],
            speed: vec![0.0; s.ports],
            force_sensitivity: vec![0.0; s.ports * s.columns()],
        };
        self.settle(&mut state, inputs, None);
        state
    }

    /// One sample further, in as many parts as the laws need.
    fn sample(&self, before: State, from: &[f64], to: &[f64]) -> State {
        let whole = self.step(&before, from, to, &self.levels[0]);
        let parts = self.laws.iter().enumerate().map(|(i, law)| {
            let (a, b) = (before.speed[i], whole.speed[i]);
            let saturated = a.abs().min(b.abs()) > SATURATED * law.transition && a * b > 0.0;
            if law.transition == 0.0 || saturated {
                1.0
            } else {
                ((b - a).abs() / (0.5 * law.transition)).ceil()
            }
        });
        let halvings = parts.fold(1.0, f64::max).log2().ceil().clamp(0.0, HALVINGS as f64) as usize;
        if halvings == 0 {
            return whole;
        }
        let parts = 1 << halvings;
        let at = |i: usize| -> Vec<f64> {
            let share = i as f64 / parts as f64;
            from.iter().zip(to).map(|(a, b)| a + (b - a) * share).collect()
        };
        let mut left = at(0);
        (0..parts).fold(before, |state, i| {
            let right = at(i + 1);
            let next = self.step(&state, &left, &right, &self.levels[halvings]);
            left = right;
            next
        })
    }

    fn step(&self, before: &State, from: &[f64], to: &[f64], level: &Level) -> State {
        let s = self.sizes;
        let (width, columns) = (s.width(), s.columns());
        let xi = || before.x.iter().chain(from).chain(to).chain(&before.force);
        let mut next = State {
            x: vec![0.0; s.states],
            sensitivity: vec![0.0; s.states * columns],
            force: before.force.clone(),
            speed: before.speed.clone(),
            force_sensitivity: vec![0.0; s.ports * columns],
        };
        let forces = s.states + 2 * s.inputs;
        for i in 0..s.states {
            let map = &level.map[i * width..(i + 1) * width];
            next.x[i] = map.iter().zip(xi()).map(|(t, v)| t * v).sum();
            let row = &mut next.sensitivity[i * columns..(i + 1) * columns];
            for (t, source) in map.iter().zip(before.sensitivity.chunks_exact(columns.max(1))) {
                row.iter_mut().zip(source).for_each(|(r, v)| *r += t * v);
            }
            for (t, source) in map[forces..].iter().zip(before.force_sensitivity.chunks_exact(columns.max(1)))
            {
                row.iter_mut().zip(source).for_each(|(r, v)| *r += t * v);
            }
            let slopes = &level.slopes[i * width * s.free..(i + 1) * width * s.free];
            for (slope, v) in slopes.chunks_exact(s.free).zip(xi()) {
                row[s.locals..].iter_mut().zip(slope).for_each(|(r, d)| *r += d * v);
            }
        }
        self.settle(&mut next, to, Some(level));
        next
    }

    /// Solves for the forces at the end of a step (or, without a step, for given states) and adds them.
    fn settle(&self, state: &mut State, inputs: &[f64], level: Option<&Level>) {
        let s = self.sizes;
        if s.ports == 0 {
            return;
        }
        let width = s.width();
        let after = width - s.ports;
        let gain = |i: usize, port: usize| level.map_or(0.0, |level| level.map[i * width + after + port]);
        // Speeds without the new forces, and what a new force adds to them.
        let e = self.equations;
        let base: Vec<f64> = (0..s.ports)
            .map(|p| {
                (0..s.states).map(|i| e.port[(p, i)] * state.x[i]).sum::<f64>()
                    + inputs.iter().enumerate().map(|(i, u)| e.port_input[(p, i)] * u).sum::<f64>()
            })
            .collect();
        let coupling = DMatrix::from_fn(s.ports, s.ports, |p, q| {
            e.port_force[(p, q)] + (0..s.states).map(|i| e.port[(p, i)] * gain(i, q)).sum::<f64>()
        });
        let responses = self.balance(&base, &coupling, &mut state.speed);
        for (force, response) in state.force.iter_mut().zip(&responses) {
            *force = response.torque;
        }
        for i in 0..s.states {
            state.x[i] += (0..s.ports).map(|p| gain(i, p) * state.force[p]).sum::<f64>();
        }
        self.settle_sensitivities(state, inputs, level, &coupling, &responses);
    }

    /// v = base + coupling f(v) by damped Newton from the last speeds; one law at a time sees the others' forces.
    fn balance(&self, base: &[f64], coupling: &DMatrix<f64>, speed: &mut [f64]) -> Vec<Response> {
        let evaluate = |v: &[f64]| -> Vec<Response> {
            self.laws.iter().zip(v).map(|(law, v)| (law.evaluate)(*v, &law.parameters)).collect()
        };
        let defect = |v: &[f64], responses: &[Response], p: usize| {
            v[p] - base[p]
                - responses.iter().enumerate().map(|(q, r)| coupling[(p, q)] * r.torque).sum::<f64>()
        };
        let mut responses = evaluate(speed);
        for _ in 0..60 {
            let mut largest = 0.0_f64;
            for p in 0..speed.len() {
                let miss = defect(speed, &responses, p);
                let slope = 1.0 - coupling[(p, p)] * responses[p].slope_speed;
                // A tangent law jumps within its transition: never step over the whole of it at once.
                let limit = if self.laws[p].transition > 0.0 && speed[p].abs() < 4.0 * self.laws[p].transition
                {
                    2.0 * self.laws[p].transition
                } else {
                    f64::INFINITY
                };
                let step = (miss / slope).clamp(-limit, limit);
                let trial = speed[p] - step;
                // Landing on the far side of the bend from outside it: stop at zero, where the slope is steepest.
                let crossed = self.laws[p].transition > 0.0
                    && trial * speed[p] < 0.0
                    && speed[p].abs() > self.laws[p].transition;
                speed[p] = if crossed { 0.0 } else { trial };
                largest = largest.max(step.abs() / (1e-12 + speed[p].abs()));
                responses[p] = (self.laws[p].evaluate)(speed[p], &self.laws[p].parameters);
            }
            if largest.is_nan() || largest <= 1e-13 {
                break;
            }
        }
        responses
    }

    fn settle_sensitivities(
        &self,
        state: &mut State,
        inputs: &[f64],
        level: Option<&Level>,
        coupling: &DMatrix<f64>,
        responses: &[Response],
    ) {
        let s = self.sizes;
        let (width, columns) = (s.width(), s.columns());
        let after = width - s.ports;
        let e = self.equations;
        // Direct effect of moving parameters on the new forces' gains.
        if let Some(level) = level {
            for i in 0..s.states {
                for p in 0..s.ports {
                    let slopes = &level.slopes[(i * width + after + p) * s.free..][..s.free];
                    let row = &mut state.sensitivity[i * columns + s.locals..(i + 1) * columns];
                    row.iter_mut().zip(slopes).for_each(|(r, d)| *r += d * state.force[p]);
                }
            }
        }
        // (1 - L coupling) F' = L (V x' + dV x + dW u) + d law / d parameters, all columns at once.
        let mut right = DMatrix::zeros(s.ports, columns);
        for p in 0..s.ports {
            let slope = responses[p].slope_speed;
            for i in 0..s.states {
                let weight = slope * e.port[(p, i)];
                if weight != 0.0 {
                    for j in 0..columns {
                        right[(p, j)] += weight * state.sensitivity[i * columns + j];
                    }
                }
            }
            for (j, d) in self.slopes.iter().enumerate() {
                let moved = (0..s.states).map(|i| d.port[(p, i)] * state.x[i]).sum::<f64>()
                    + inputs.iter().enumerate().map(|(i, u)| d.port_input[(p, i)] * u).sum::<f64>();
                right[(p, s.locals + j)] += slope * moved;
            }
            for (position, column) in &self.laws[p].free {
                right[(p, s.locals + column)] += responses[p].slope_parameters[*position];
            }
        }
        let matrix = DMatrix::from_fn(s.ports, s.ports, |p, q| {
            f64::from(p == q) - responses[p].slope_speed * coupling[(p, q)]
        });
        if !matrix.lu().solve_mut(&mut right) {
            right.fill(0.0);
        }
        for p in 0..s.ports {
            for j in 0..columns {
                state.force_sensitivity[p * columns + j] = right[(p, j)];
            }
        }
        if let Some(level) = level {
            for i in 0..s.states {
                for p in 0..s.ports {
                    let gain = level.map[i * width + after + p];
                    let source = &state.force_sensitivity[p * columns..(p + 1) * columns];
                    let row = &mut state.sensitivity[i * columns..(i + 1) * columns];
                    row.iter_mut().zip(source).for_each(|(r, v)| *r += gain * v);
                }
            }
        }
    }

    /// Appends one weighted row per output: [local | free | prediction].
    fn observe(
        &self,
        state: &State,
        inputs: &[f64],
        locals: &[f64],
        offsets: &[usize],
        jacobian: &mut [Vec<f64>],
    ) {
        let s = self.sizes;
        let e = self.equations;
        let columns = s.columns();
        for (output, rows) in jacobian.iter_mut().enumerate() {
            let unit = 1.0 / self.weights.noise_std[output];
            let start = rows.len();
            rows.resize(start + columns + 1, 0.0);
            let row = &mut rows[start..];
            let mut value = 0.0;
            for i in 0..s.states {
                let weight = e.output[(output, i)];
                value += weight * state.x[i];
                let source = &state.sensitivity[i * columns..(i + 1) * columns];
                row.iter_mut().zip(source).for_each(|(r, v)| *r += weight * v);
            }
            for p in 0..s.ports {
                let weight = e.force_output[(output, p)];
                value += weight * state.force[p];
                let source = &state.force_sensitivity[p * columns..(p + 1) * columns];
                row.iter_mut().zip(source).for_each(|(r, v)| *r += weight * v);
            }
            value += inputs.iter().enumerate().map(|(i, u)| e.feedthrough[(output, i)] * u).sum::<f64>();
            for (j, d) in self.slopes.iter().enumerate() {
                row[s.locals + j] += (0..s.states).map(|i| d.output[(output, i)] * state.x[i]).sum::<f64>()
                    + inputs.iter().enumerate().map(|(i, u)| d.feedthrough[(output, i)] * u).sum::<f64>()
                    + (0..s.ports).map(|p| d.force_output[(output, p)] * state.force[p]).sum::<f64>();
            }
            if let Some(position) = offsets.iter().position(|channel| *channel == output) {
                let column = s.locals - offsets.len() + position;
                row[column] += 1.0;
                value += locals[column];
            }
            for (r, scale) in row[s.locals..].iter_mut().zip(&self.weights.scales) {
                *r *= scale;
            }
            row[columns] = value;
            row.iter_mut().for_each(|r| *r *= unit);
        }
    }
}

/// Maps for a whole sample, a half, ... by doubling the finest, with the product rule for the slopes.
fn levels(
    equations: &Equations,
    slopes: &[Equations],
    sample_time_s: f64,
    sizes: Sizes,
) -> Option<Vec<Level>> {
    let halvings = if sizes.ports == 0 { 0 } else { HALVINGS };
    let finest = Hold::exponential(equations, slopes, sample_time_s / f64::from(1 << halvings))?;
    let mut holds = vec![finest];
    for _ in 0..halvings {
        let doubled = holds[holds.len() - 1].doubled();
        holds.push(doubled);
    }
    holds.reverse();
    Some(holds.iter().map(|hold| hold.level(sizes)).collect())
}

/// x+ = phi x + before w + after w', with w = [u, f], and the slopes of all three.
struct Hold {
    value: [DMatrix<f64>; 3],
    slopes: Vec<[DMatrix<f64>; 3]>,
}

impl Hold {
    fn exponential(equations: &Equations, slopes: &[Equations], step_s: f64) -> Option<Self> {
        let n = equations.state.nrows();
        let m = equations.input.ncols() + equations.force.ncols();
        let size = n + 2 * m;
        let generator = |e: &Equations, unit: f64| {
            let mut g = DMatrix::zeros(size, size);
            g.view_mut((0, 0), (n, n)).copy_from(&(&e.state * step_s));
            g.view_mut((0, n), (n, e.input.ncols())).copy_from(&(&e.input * step_s));
            g.view_mut((0, n + e.input.ncols()), (n, e.force.ncols())).copy_from(&(&e.force * step_s));
            g.view_mut((n, n + m), (m, m)).fill_diagonal(unit);
            g
        };
        let split = |e: &DMatrix<f64>| {
            let whole = e.view((0, n), (n, m)).into_owned();
            let after = e.view((0, n + m), (n, m)).into_owned();
            [e.view((0, 0), (n, n)).into_owned(), whole - &after, after]
        };
        let base = generator(equations, 1.0);
        let value = split(&base.exp());
        let slopes = slopes.iter().map(|slope| {
            let mut twin = DMatrix::zeros(2 * size, 2 * size);
            twin.view_mut((0, 0), (size, size)).copy_from(&base);
            twin.view_mut((size, size), (size, size)).copy_from(&base);
            twin.view_mut((0, size), (size, size)).copy_from(&generator(slope, 0.0));
            split(&twin.exp().view((0, size), (size, size)).into_owned())
        });
        let slopes: Vec<_> = slopes.collect();
        value.iter().all(|m| m.iter().all(|v| v.is_finite())).then_some(Self { value, slopes })
    }

    /// Two steps in one, the input linear over both.
    fn doubled(&self) -> Self {
        let [phi, before, after] = &self.value;
        let middle = (phi * after + before) * 0.5;
        let value = [phi * phi, phi * before + &middle, after + &middle];
        let slopes = self.slopes.iter().map(|[dphi, dbefore, dafter]| {
            let dmiddle = (dphi * after + phi * dafter + dbefore) * 0.5;
            [dphi * phi + phi * dphi, dphi * before + phi * dbefore + &dmiddle, dafter + &dmiddle]
        });
        Self { slopes: slopes.collect(), value }
    }

    fn level(&self, sizes: Sizes) -> Level {
        let inputs = sizes.inputs;
        let gather = |[phi, before, after]: &[DMatrix<f64>; 3], i: usize| -> Vec<f64> {
            let row = |m: &DMatrix<f64>, from: usize, count: usize| -> Vec<f64> {
                (from..from + count).map(|j| m[(i, j)]).collect()
            };
            [
                row(phi, 0, sizes.states),
                row(before, 0, inputs),
                row(after, 0, inputs),
                row(before, inputs, sizes.ports),
                row(after, inputs, sizes.ports),
            ]
            .concat()
        };
        let map = (0..sizes.states).flat_map(|i| gather(&self.value, i)).collect();
        let width = sizes.width();
        let mut slopes = vec![0.0; sizes.states * width * sizes.free];
        for (j, slope) in self.slopes.iter().enumerate() {
            for i in 0..sizes.states {
                for (l, value) in gather(slope, i).into_iter().enumerate() {
                    slopes[(i * width + l) * sizes.free + j] = value;
                }
            }
        }
        Level { map, slopes }
    }
}
