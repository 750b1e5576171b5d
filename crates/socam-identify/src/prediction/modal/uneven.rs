//! Responses of the modes over steps of different lengths: each step has its own factors, which are exact for the input's polynomial.

use std::ops::Range;

use nalgebra::Complex;

use crate::{
    prediction::{modes::Mode, phi::ModeStep},
    preprocessing::segments::UnevenSteps,
};

type C = Complex<f64>;

/// The constant 1, as an input.
const ONE: [f64; 6] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const ZERO: [f64; 6] = [0.0; 6];

/// Response chi of a mode, and its derivative psi with respect to the mode's pole.
type Response = (C, C);

/// The responses of all modes along a segment, to each input and to its start.
pub(super) struct UnevenResponses {
    /// Per input, one for each mode; the last of these inputs is the start, without an input.
    responses: Vec<Vec<Response>>,
}

impl UnevenResponses {
    pub(super) fn new(inputs: usize, modes: usize) -> Self {
        let rest = vec![(C::default(), C::default()); modes];
        let mut responses = vec![rest; inputs + 1];
        responses[inputs].iter_mut().for_each(|(chi, _)| *chi = C::from(1.0));
        Self { responses }
    }

    /// Magnitude of the slowest start term.
    pub(super) fn start_size(&self) -> f64 {
        self.responses.last().into_iter().flatten().map(|(chi, _)| chi.norm()).fold(0.0, f64::max)
    }

    /// Advances over the steps that end at `rows` (none before the segment's first row, `is_first`). `write` is called for each input and
    /// row with the position in the block, the places of the mode's signals among those of all modes, and its response.
    pub(super) fn advance(
        &mut self,
        modes: &[Mode],
        steps: &UnevenSteps,
        rows: Range<usize>,
        is_first: bool,
        mut write: impl FnMut(usize, usize, &Range<usize>, Response),
    ) {
        let start = self.responses.len() - 1;
        for (position, k) in rows.enumerate() {
            let mut place = 0..0;
            for (m, mode) in modes.iter().enumerate() {
                place = place.end..place.end + mode.signals();
                let step = ModeStep::new(mode.pole, steps.length_s(k));
                for (input, responses) in self.responses.iter_mut().enumerate() {
                    if position > 0 || !is_first {
                        let along = match steps.input(input, k) {
                            Some(polynomial) => polynomial.coefficients(),
                            None if input < start => &ONE,
                            None => &ZERO,
                        };
                        let (chi, psi) = responses[m];
                        let (driven, moved) = step.response(along);
                        responses[m] = (
                            step.decay * chi + driven,
                            step.decay * psi + step.decay_sensitivity * chi + moved,
                        );
                    }
                    write(input, position, &place, responses[m]);
                }
            }
        }
    }
}
