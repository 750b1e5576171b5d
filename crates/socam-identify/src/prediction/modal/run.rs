//! Prediction of one segment: recursions of the modes, block by block.

use std::ops::Range;

use faer::reborrow::ReborrowMut;

use super::{Modal, offset_channels, uneven::UnevenResponses};
use crate::{
    IdentifyError, Intersample,
    evaluation::{
        accumulator::ResidualAccumulator,
        weights::{Point, Weights},
    },
    prediction::{
        intersample,
        modes::Mode,
        phi::Hold,
        products::{LinearMap, Signals},
        recursion::{self, Recursion},
    },
    preprocessing::segments::{self, Chunk, Segment, UnevenSteps},
    problem::Problem,
};

/// Magnitude below which the start terms are taken to have decayed.
const DECAYED: f64 = 1e-13;

impl Modal {
    /// Predicts one segment and adds its residuals and sensitivities to `rows`; returns false where the prediction overflows.
    pub(crate) fn predict(
        &self,
        problem: &Problem<'_>,
        index: usize,
        point: &Point,
        weights: &Weights,
        rows: &mut ResidualAccumulator<'_>,
    ) -> Result<bool, IdentifyError> {
        let segment = &problem.segments[index];
        let mut run = ModalRun::new(self, problem, segment, rows.capacity());
        let mut finite = true;
        segments::read(
            problem.model,
            &problem.datasets[segment.recording],
            segment,
            &problem.intersample,
            |chunk| {
                if run.row == 0 {
                    run.start = self.start_maps(problem, &point.nuisance[index], point, chunk, weights);
                }
                finite = finite && run.chunk(chunk, weights, &point.nuisance[index], rows);
            },
        )?;
        Ok(finite)
    }
}

/// The recursions along one segment.
struct ModalRun<'m> {
    modal: &'m Modal,
    /// Per input, one recursion for each mode.
    recursions: Vec<Vec<Recursion>>,
    /// Per input, the number of coefficients beyond that of its samples.
    around: Vec<usize>,
    /// The decaying start terms, one for each mode.
    decays: Vec<Recursion>,
    row: usize,
    start: Vec<LinearMap>,
    decaying: bool,
    /// Outputs whose offset is estimated.
    offsets: Vec<usize>,
    forced: Signals,
    starts: Signals,
    /// Zeros, the input of the start terms.
    no_input: Vec<f64>,
    /// In place of `recursions` and `decays` where steps are uneven.
    uneven: Option<UnevenResponses>,
}

impl<'m> ModalRun<'m> {
    fn new(modal: &'m Modal, problem: &Problem<'_>, segment: &Segment, capacity: usize) -> Self {
        let step_s = segment.sample_time_s;
        let uneven = || UnevenResponses::new(modal.inputs, modal.modes.len());
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
            no_input: Vec::new(),
            uneven: segment.longest_step_s.map(|_| uneven()),
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
        let starts = |run: &Self| match &run.uneven {
            Some(uneven) => uneven.start_size() > DECAYED,
            None => run.decays.iter().any(|decay| decay.size() > DECAYED),
        };
        self.decaying = self.decaying && starts(self);
        if let Some(steps) = &chunk.steps {
            self.all_uneven(chunk, steps, from..from + count);
        } else {
            self.forced(chunk, from, count);
            if self.decaying {
                self.starts(count);
            }
        }
        self.row += count;
        let measured: Vec<&[f64]> = chunk.outputs.iter().map(|output| &output[from..from + count]).collect();
        let (free, local) = (self.modal.sensitivities.len(), nuisance.len());
        let any_nuisance = self.decaying || !self.offsets.is_empty();
        rows.fold(count, any_nuisance, &weights.noise_std, &measured, |output, mut target| {
            let forced = &self.modal.forced[output];
            if self.decaying {
                self.start[output].write(&self.starts, target.rb_mut());
                forced.add(&self.forced, target.rb_mut().subcols_mut(local, free + 1));
            } else {
                let skipped = if any_nuisance { local } else { 0 };
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

    /// Computes the forced signals of a block: inputs, and the modes' responses to them.
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

    /// Computes all signals of a block over uneven steps.
    fn all_uneven(&mut self, chunk: &Chunk, steps: &UnevenSteps, rows: Range<usize>) {
        let Some(responses) = &mut self.uneven else { return };
        let (modal, count) = (self.modal, rows.len());
        let per_input = 1 + 2 * modal.mode_signals();
        let mut forced: Vec<&mut [f64]> = self.forced.iter_mut(count).collect();
        let mut starts: Vec<&mut [f64]> = self.starts.iter_mut(count).collect();
        for (input, signals) in forced.chunks_mut(per_input).enumerate() {
            match chunk.inputs.get(input) {
                Some(values) => signals[0].copy_from_slice(&values[rows.clone()]),
                None => signals[0].fill(1.0),
            }
        }
        let half = modal.mode_signals();
        responses.advance(&modal.modes, steps, rows, self.row == 0, |input, k, place, (chi, psi)| {
            let signals =
                if input < modal.inputs { &mut forced[input * per_input + 1..] } else { &mut starts[..] };
            signals[place.start][k] = chi.re;
            signals[half + place.start][k] = psi.re;
            // A pair of modes has an imaginary part too.
            if place.len() == 2 {
                signals[place.start + 1][k] = chi.im;
                signals[half + place.start + 1][k] = psi.im;
            }
        });
    }

    /// Computes the start signals of a block: the decaying terms, and t times these, their derivative with respect to the pole.
    fn starts(&mut self, count: usize) {
        let mut signals: Vec<&mut [f64]> = self.starts.iter_mut(count).collect();
        self.no_input.resize(count + 1, 0.0);
        respond(&mut self.decays, self.row, &self.no_input, &mut signals);
    }
}

/// Advances the recursions over samples from `row` on. `held` are the input's coefficients from before these samples to after them. The
/// first sample of the segment is the present state of the recursions.
fn respond(recursions: &mut [Recursion], row: usize, held: &[f64], signals: &mut [&mut [f64]]) {
    if row > 0 {
        return recursion::advance(recursions, held, signals);
    }
    recursion::now(recursions, signals);
    let mut later: Vec<&mut [f64]> = signals.iter_mut().map(|signal| &mut signal[1..]).collect();
    recursion::advance(recursions, &held[1..], &mut later);
}
