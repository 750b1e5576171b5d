//! Prediction of a linear model through its modes.
//!
//! Diagonalised, every output is a fixed combination of a few signals that do not depend on the number of
//! parameters: the response chi of each mode to each input, its derivative psi with respect to the mode's
//! pole, and the decaying start terms. So do all sensitivities. A sample costs a handful of recursions; the
//! combinations are matrix products over blocks.

use faer::{Mat, reborrow::ReborrowMut};
use nalgebra::{Complex, DMatrix, DVector};
use socam_model::Equations;

use crate::{
    IdentifyError, Intersample,
    evaluation::{Point, ResidualAccumulator, Weights},
    prediction::{
        intersample,
        modes::{Mode, diagonalise, representatives},
        phi::Hold,
        products::{Combination, Signals},
        recursion::{self, Recursion},
        start_state,
    },
    preprocessing::segments::{self, Chunk},
    problem::{Problem, StartState},
};

type C = Complex<f64>;

/// Start terms below this are over.
const DECAYED: f64 = 1e-13;

/// A model diagonalised at one parameter vector.
pub(crate) struct Modal {
    /// One mode of each conjugate pair, and each real one.
    modes: Vec<Mode>,
    /// Inputs, plus one for the constant 1 where constant forces act.
    inputs: usize,
    constant: bool,
    /// Per output, signals x [free | prediction]: the part that inputs excite.
    forced: Vec<Combination>,
    vectors: DMatrix<C>,
    inverse: DMatrix<C>,
    /// T of each free parameter: sensitivities of eigenvectors V T, of the inverse -T W.
    turns: Vec<DMatrix<C>>,
    pole_sensitivities: Vec<DVector<C>>,
    equations: Equations,
    sensitivities: Vec<Equations>,
}

impl Modal {
    /// `None` where the modes are too close to each other; then the integrator takes over.
    pub(crate) fn new(
        problem: &Problem<'_>,
        equations: &Equations,
        sensitivities: &[Equations],
        point: &Point,
        weights: &Weights,
    ) -> Option<Self> {
        let (equations, sensitivities) =
            with_constant_forces(equations, sensitivities, &point.values, &problem.free);
        let (poles, vectors, inverse) = diagonalise(&equations.state)?;
        let mut modal = Self {
            modes: representatives(&poles),
            inputs: equations.input.ncols(),
            constant: equations.input.ncols() > problem.model.inputs().count(),
            forced: Vec::new(),
            turns: Vec::new(),
            pole_sensitivities: Vec::new(),
            vectors,
            inverse,
            equations,
            sensitivities,
        };
        for sensitivity in &modal.sensitivities {
            let change = &modal.inverse * complex(&sensitivity.state) * &modal.vectors;
            modal.pole_sensitivities.push(change.diagonal());
            modal.turns.push(DMatrix::from_fn(poles.len(), poles.len(), |i, j| {
                if i == j { C::default() } else { change[(i, j)] / (poles[j] - poles[i]) }
            }));
        }
        modal.forced =
            (0..problem.outputs()).map(|output| modal.forced_combination(output, weights)).collect();
        Some(modal)
    }

    /// Signals per input: itself, then chi and psi of each mode.
    fn forced_signals(&self) -> usize {
        self.inputs * (1 + 2 * self.mode_signals())
    }

    /// Real signals that the modes have between them: one for a real mode, two for a pair.
    fn mode_signals(&self) -> usize {
        self.modes.iter().map(Mode::signals).sum()
    }

    /// Combination of the forced signals of one output.
    fn forced_combination(&self, output: usize, weights: &Weights) -> Combination {
        let free = self.sensitivities.len();
        let mut combination = Mat::zeros(self.forced_signals(), free + 1);
        let seen = complex(&self.equations.output.rows(output, 1).into_owned()) * &self.vectors;
        let driven = &self.inverse * complex(&self.equations.input);
        let mut row = 0;
        for input in 0..self.inputs {
            combination[(row, free)] = self.equations.feedthrough[(output, input)];
            for (j, sensitivity) in self.sensitivities.iter().enumerate() {
                combination[(row, j)] = sensitivity.feedthrough[(output, input)];
            }
            row += 1;
            let signals = self.mode_signals();
            for (part, offset) in [(Part::Value, 0), (Part::PoleSlope, signals)] {
                let residue =
                    |m: usize, j: Option<usize>| self.residue_part(&seen, &driven, output, input, m, j, part);
                self.place(&mut combination, row + offset, free, residue);
            }
            row += 2 * signals;
        }
        weigh(&mut combination, weights, output, 0);
        Combination::new(combination.as_ref())
    }

    /// Factor of chi (or psi) of mode `m` in the prediction (`None`) or in sensitivity `j`.
    #[allow(clippy::too_many_arguments)]
    fn residue_part(
        &self,
        seen: &DMatrix<C>,
        driven: &DMatrix<C>,
        output: usize,
        input: usize,
        m: usize,
        j: Option<usize>,
        part: Part,
    ) -> C {
        let residue = seen[m] * driven[(m, input)];
        match (part, j) {
            (Part::Value, None) => residue,
            (Part::PoleSlope, None) => C::default(),
            (Part::PoleSlope, Some(j)) => residue * self.pole_sensitivities[j][m],
            (Part::Value, Some(j)) => {
                let sensitivity = &self.sensitivities[j];
                let seen_sensitivity = self.row_sensitivity(&sensitivity.output, seen, output, m, j);
                let driven_sensitivity = (0..self.vectors.nrows()).fold(C::default(), |sum, i| {
                    sum + self.inverse[(m, i)] * sensitivity.input[(i, input)]
                        - self.turns[j][(m, i)] * driven[(i, input)]
                });
                seen_sensitivity * driven[(m, input)] + seen[m] * driven_sensitivity
            }
        }
    }

    /// Slope of (C V)_om: dC V + C V T.
    fn row_sensitivity(
        &self,
        output_sensitivity: &DMatrix<f64>,
        seen: &DMatrix<C>,
        output: usize,
        m: usize,
        j: usize,
    ) -> C {
        (0..self.vectors.nrows()).fold(C::default(), |sum, i| {
            sum + self.vectors[(i, m)] * output_sensitivity[(output, i)] + seen[i] * self.turns[j][(i, m)]
        })
    }

    /// Writes Re(weight * factor * signal) for all modes, rows from `row` on.
    fn place(
        &self,
        combination: &mut Mat<f64>,
        row: usize,
        free: usize,
        factor: impl Fn(usize, Option<usize>) -> C,
    ) {
        let mut row = row;
        for mode in &self.modes {
            for column in 0..=free {
                let value = factor(mode.index, (column < free).then_some(column)) * mode.weight;
                combination[(row, column)] = value.re;
                if !mode.real {
                    combination[(row + 1, column)] = -value.im;
                }
            }
            row += mode.signals();
        }
    }

    /// Runs one segment into `rows`; false where the prediction overflowed.
    pub(crate) fn predict(
        &self,
        problem: &Problem<'_>,
        index: usize,
        point: &Point,
        weights: &Weights,
        rows: &mut ResidualAccumulator<'_>,
    ) -> Result<bool, IdentifyError> {
        let segment = &problem.segments[index];
        let mut run = Run::new(self, problem, segment.sample_time_s, rows.capacity());
        let mut finite = true;
        segments::read(
            problem.model,
            &problem.datasets[segment.recording],
            segment,
            &problem.intersample,
            |chunk| {
                if run.row == 0 {
                    run.start =
                        self.start_combinations(problem, &point.nuisance[index], point, chunk, weights);
                }
                finite = finite && run.chunk(chunk, weights, &point.nuisance[index], rows);
            },
        )?;
        Ok(finite)
    }

    /// Per output, combination of the start signals: [decay | t decay] x [local | free | prediction].
    fn start_combinations(
        &self,
        problem: &Problem<'_>,
        nuisance: &[f64],
        point: &Point,
        chunk: &Chunk,
        weights: &Weights,
    ) -> Vec<Combination> {
        let states = self.vectors.nrows();
        let free_start = problem.options.start_state == StartState::Free;
        let first: Vec<f64> =
            chunk.inputs.iter().map(|input| input[0]).chain(self.constant.then_some(1.0)).collect();
        let rest = || start_state::equilibrium(&self.equations, &point.values, &first);
        let x0 = if free_start {
            DVector::from_column_slice(&nuisance[..states])
        } else {
            rest().unwrap_or_else(|| DVector::zeros(states))
        };
        let x0_sensitivities = if free_start {
            None
        } else {
            start_state::equilibrium_sensitivities(
                &self.equations,
                &self.sensitivities,
                &point.values,
                &problem.free,
                &first,
                &x0,
            )
        };
        let z0 = &self.inverse * x0.map(C::from);
        let signals = self.mode_signals();
        let (free, local) = (self.sensitivities.len(), nuisance.len());
        (0..problem.outputs())
            .map(|output| {
                let seen = complex(&self.equations.output.rows(output, 1).into_owned()) * &self.vectors;
                let mut inner = Mat::zeros(2 * signals, free + 1);
                self.place(&mut inner, 0, free, |m, j| match j {
                    None => seen[m] * z0[m],
                    Some(j) => {
                        let seen_sensitivity =
                            self.row_sensitivity(&self.sensitivities[j].output, &seen, output, m, j);
                        let x0_sensitivity = x0_sensitivities.as_ref().map(|sensitivities| &sensitivities[j]);
                        let z0_sensitivity = (0..states).fold(C::default(), |sum, i| {
                            let moved = x0_sensitivity.map_or(0.0, |sensitivity| sensitivity[i]);
                            sum + self.inverse[(m, i)] * moved - self.turns[j][(m, i)] * z0[i]
                        });
                        seen_sensitivity * z0[m] + seen[m] * z0_sensitivity
                    }
                });
                self.place(&mut inner, signals, free, |m, j| {
                    j.map_or(C::default(), |j| seen[m] * z0[m] * self.pole_sensitivities[j][m])
                });
                let mut whole = Mat::zeros(2 * signals, local + free + 1);
                whole.as_mut().subcols_mut(local, free + 1).copy_from(&inner);
                if free_start && states > 0 {
                    let mut start = Mat::zeros(2 * signals, states);
                    let last = states - 1;
                    self.place(&mut start, 0, last, |m, i| seen[m] * self.inverse[(m, i.unwrap_or(last))]);
                    whole.as_mut().subcols_mut(0, states).copy_from(&start);
                }
                weigh(&mut whole, weights, output, local);
                Combination::new(whole.as_ref())
            })
            .collect()
    }
}

#[derive(Clone, Copy)]
enum Part {
    Value,
    PoleSlope,
}

/// State of the recursions along one segment.
struct Run<'m> {
    modal: &'m Modal,
    /// Per input, one for each mode.
    recursions: Vec<Vec<Recursion>>,
    /// Per input, coefficients beyond its samples.
    around: Vec<usize>,
    /// What is left of the start.
    decays: Vec<Recursion>,
    row: usize,
    start: Vec<Combination>,
    decaying: bool,
    /// Output of each offset.
    offsets: Vec<usize>,
    forced: Signals,
    starts: Signals,
    /// No input.
    silence: Vec<f64>,
}

impl<'m> Run<'m> {
    fn new(modal: &'m Modal, problem: &Problem<'_>, step_s: f64, capacity: usize) -> Self {
        let at_rest = |kind: Intersample| -> Vec<Recursion> {
            let one = |mode: &Mode| Recursion::new(Hold::new(mode.pole, step_s, kind), mode.real);
            modal.modes.iter().map(one).collect()
        };
        let lines = at_rest(Intersample::Linear);
        // The constant 1 comes last.
        let kinds = || (0..modal.inputs).map(|input| problem.intersample.get(input).copied());
        let recursions = kinds().map(|kind| kind.map_or_else(|| lines.clone(), at_rest)).collect();
        Self {
            modal,
            decays: lines.iter().map(Recursion::left_at_one).collect(),
            recursions,
            around: kinds().map(|kind| 2 * kind.map_or(0, intersample::margin) + 1).collect(),
            row: 0,
            start: Vec::new(),
            decaying: true,
            offsets: offset_channels(problem),
            forced: Signals::new(capacity, modal.forced_signals()),
            starts: Signals::new(capacity, 2 * modal.mode_signals()),
            silence: Vec::new(),
        }
    }

    fn chunk(
        &mut self,
        chunk: &Chunk,
        weights: &Weights,
        nuisance: &[f64],
        rows: &mut ResidualAccumulator<'_>,
    ) -> bool {
        let capacity = rows.capacity();
        let mut finite = true;
        let mut from = 0;
        while from < chunk.rows() && finite {
            let count = capacity.min(chunk.rows() - from);
            finite = self.block(chunk, from, count, weights, nuisance, rows);
            from += count;
        }
        finite
    }

    fn block(
        &mut self,
        chunk: &Chunk,
        from: usize,
        count: usize,
        weights: &Weights,
        nuisance: &[f64],
        rows: &mut ResidualAccumulator<'_>,
    ) -> bool {
        self.forced(chunk, from, count);
        self.decaying = self.decaying && self.decays.iter().any(|decay| decay.size() > DECAYED);
        if self.decaying {
            self.starts(count);
        }
        self.row += count;
        let measured: Vec<&[f64]> = chunk.outputs.iter().map(|output| &output[from..from + count]).collect();
        let (free, local) = (self.modal.sensitivities.len(), nuisance.len());
        let alive = self.decaying || !self.offsets.is_empty();
        rows.take(count, alive, &weights.noise_std, &measured, |output, mut target| {
            let forced = &self.modal.forced[output];
            if self.decaying {
                self.start[output].write(&self.starts, target.rb_mut());
                forced.add(&self.forced, target.rb_mut().subcols_mut(local, free + 1));
            } else {
                let skipped = if alive { local } else { 0 };
                target.rb_mut().subcols_mut(0, skipped).fill(0.0);
                forced.write(&self.forced, target.rb_mut().subcols_mut(skipped, free + 1));
            }
            if let Some(position) = self.offsets.iter().position(|channel| *channel == output) {
                let column = local - self.offsets.len() + position;
                let unit = 1.0 / weights.noise_std[output];
                for k in 0..count {
                    target[(k, column)] = unit;
                    target[(k, local + free)] += nuisance[column] * unit;
                }
            }
        })
    }

    /// Inputs and the modes' responses to them, one signal each.
    fn forced(&mut self, chunk: &Chunk, from: usize, count: usize) {
        let per_input = 1 + 2 * self.modal.mode_signals();
        let mut signals: Vec<&mut [f64]> = self.forced.iter_mut(count).collect();
        for (input, signals) in signals.chunks_mut(per_input).enumerate() {
            let (own, responses) = signals.split_at_mut(1);
            let around = self.around[input];
            match (chunk.inputs.get(input), chunk.held.get(input)) {
                (Some(values), Some(held)) => {
                    own[0].copy_from_slice(&values[from..from + count]);
                    let held = &held[from..from + count + around];
                    respond(&mut self.recursions[input], self.row, held, responses);
                }
                _ => {
                    // The constant 1.
                    own[0].fill(1.0);
                    let ones = vec![1.0; count + around];
                    respond(&mut self.recursions[input], self.row, &ones, responses);
                }
            }
        }
    }

    /// Decaying start terms and the same times t, which is their derivative with respect to the pole.
    fn starts(&mut self, count: usize) {
        let mut signals: Vec<&mut [f64]> = self.starts.iter_mut(count).collect();
        self.silence.resize(count + 1, 0.0);
        respond(&mut self.decays, self.row, &self.silence, &mut signals);
    }
}

/// Samples from `row` on, with the input's coefficients from before them to after; at the first of all, the recursions stand
/// where they are.
fn respond(recursions: &mut [Recursion], row: usize, held: &[f64], signals: &mut [&mut [f64]]) {
    if row > 0 {
        return recursion::advance(recursions, held, signals);
    }
    recursion::now(recursions, signals);
    let mut later: Vec<&mut [f64]> = signals.iter_mut().map(|signal| &mut signal[1..]).collect();
    recursion::advance(recursions, &held[1..], &mut later);
}

/// Outputs whose offset is estimated.
pub(crate) fn offset_channels(problem: &Problem<'_>) -> Vec<usize> {
    let outputs = problem.model.outputs().enumerate();
    outputs.filter(|(_, channel)| channel.estimate_offset).map(|(index, _)| index).collect()
}

fn complex(matrix: &DMatrix<f64>) -> DMatrix<C> {
    matrix.map(C::from)
}

/// ResidualAccumulator to noise units, sensitivities to scaled parameters.
fn weigh(combination: &mut Mat<f64>, weights: &Weights, output: usize, local: usize) {
    for j in 0..combination.ncols() {
        let scale = if j < local { 1.0 } else { weights.scales.get(j - local).copied().unwrap_or(1.0) };
        for i in 0..combination.nrows() {
            combination[(i, j)] *= scale / weights.noise_std[output];
        }
    }
}

/// Constant forces become one more input that is always 1.
fn with_constant_forces(
    equations: &Equations,
    sensitivities: &[Equations],
    values: &[f64],
    free: &[usize],
) -> (Equations, Vec<Equations>) {
    if equations.ports.is_empty() {
        return (equations.clone(), sensitivities.to_vec());
    }
    let still = DVector::zeros(equations.ports.len());
    let (torque, _) = start_state::laws(equations, values, &still);
    let append = |matrix: &DMatrix<f64>, column: DVector<f64>| {
        let last = matrix.ncols();
        let mut wide = matrix.clone().insert_column(last, 0.0);
        wide.set_column(last, &column);
        wide
    };
    let extended = Equations {
        input: append(&equations.input, &equations.force * &torque),
        feedthrough: append(&equations.feedthrough, &equations.force_output * &torque),
        force: equations.force.columns(0, 0).into_owned(),
        port: equations.port.rows(0, 0).into_owned(),
        port_input: DMatrix::zeros(0, equations.input.ncols() + 1),
        ports: Vec::new(),
        ..equations.clone()
    };
    let extend = |sensitivity: &Equations, parameter: usize| {
        let law = start_state::law_sensitivities(equations, values, &still, parameter);
        Equations {
            input: append(&sensitivity.input, &sensitivity.force * &torque + &equations.force * &law),
            feedthrough: append(
                &sensitivity.feedthrough,
                &sensitivity.force_output * &torque + &equations.force_output * &law,
            ),
            force: sensitivity.force.columns(0, 0).into_owned(),
            port: sensitivity.port.rows(0, 0).into_owned(),
            port_input: DMatrix::zeros(0, sensitivity.input.ncols() + 1),
            ..sensitivity.clone()
        }
    };
    let sensitivities = sensitivities
        .iter()
        .zip(free)
        .map(|(sensitivity, parameter)| extend(sensitivity, *parameter))
        .collect();
    (extended, sensitivities)
}
