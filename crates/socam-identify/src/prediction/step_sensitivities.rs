//! Sensitivities at the end of a step from those at its start: the inner loop of [`Sensitivity`](super::sensitivity::Sensitivity).

use pulp::{Simd, WithSimd};

use crate::prediction::{
    event::AcceptedStep,
    row_products,
    step_level::{Dimensions, padded},
};

/// One part of a step: computes the sensitivities of some rows of its map from those of states and forces.
pub(crate) struct StepSensitivities<'a> {
    pub(crate) dimensions: Dimensions,
    pub(crate) step: &'a AcceptedStep<'a>,
    /// The rows of the step's map to differentiate: the first and how many.
    pub(crate) first: usize,
    pub(crate) count: usize,
    /// Sensitivities of the states, then of the forces that are known, `columns` numbers a row.
    pub(crate) known: &'a [f64],
    pub(crate) columns: usize,
    /// Sensitivities of all rows of the map; those of the rows `first..first + count` are overwritten.
    pub(crate) target: &'a mut [f64],
}

impl WithSimd for StepSensitivities<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { dimensions, step, first, count, known, columns, target } = self;
        let (width, moved) = (dimensions.width(), padded(dimensions.free));
        let (states, forces) = known.split_at(dimensions.states * columns);
        for i in first..first + count {
            // Port inputs that no force depends on are not needed.
            if first > 0 && step.responses[i - first].by_input == 0.0 {
                continue;
            }
            let map = &step.level.rows[i * width..(i + 1) * width];
            let target = &mut target[i * columns..(i + 1) * columns];
            let sensitivities = &step.level.sensitivities[i * width * moved..(i + 1) * width * moved];
            let own = [
                (&map[..dimensions.states], states, columns),
                (&map[dimensions.forces()..], forces, columns),
            ];
            let (first, rest) = target.split_at_mut(moved);
            row_products::write(simd, [own[0], own[1], (step.xi, sensitivities, moved)], 0, first);
            row_products::write(simd, own, moved, rest);
        }
    }
}
