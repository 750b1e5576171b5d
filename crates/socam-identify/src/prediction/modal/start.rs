//! The decaying response to the start state.

use faer::Mat;
use nalgebra::{Complex, DVector};

use super::{Modal, complex, scale_rows};
use crate::{
    evaluation::{Point, Weights},
    prediction::{products::LinearMap, start_state},
    preprocessing::segments::Chunk,
    problem::{Problem, StartState},
};

type C = Complex<f64>;

impl Modal {
    /// Per output, combination of the start signals: [decay | t decay] x [local | free | prediction].
    pub(super) fn start_maps(
        &self,
        problem: &Problem<'_>,
        nuisance: &[f64],
        point: &Point,
        chunk: &Chunk,
        weights: &Weights,
    ) -> Vec<LinearMap> {
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
                self.fill_rows(&mut inner, 0, free, |m, j| match j {
                    None => seen[m] * z0[m],
                    Some(j) => {
                        let seen_sensitivity =
                            self.row_sensitivity(&self.sensitivities[j].output, &seen, output, m, j);
                        let x0_sensitivity = x0_sensitivities.as_ref().map(|sensitivities| &sensitivities[j]);
                        let z0_sensitivity = (0..states).fold(C::default(), |sum, i| {
                            let moved = x0_sensitivity.map_or(0.0, |sensitivity| sensitivity[i]);
                            sum + self.inverse[(m, i)] * moved
                                - self.eigenvector_derivatives[j][(m, i)] * z0[i]
                        });
                        seen_sensitivity * z0[m] + seen[m] * z0_sensitivity
                    }
                });
                self.fill_rows(&mut inner, signals, free, |m, j| {
                    j.map_or(C::default(), |j| seen[m] * z0[m] * self.pole_sensitivities[j][m])
                });
                let mut whole = Mat::zeros(2 * signals, local + free + 1);
                whole.as_mut().subcols_mut(local, free + 1).copy_from(&inner);
                if free_start && states > 0 {
                    let mut start = Mat::zeros(2 * signals, states);
                    let last = states - 1;
                    self.fill_rows(&mut start, 0, last, |m, i| {
                        seen[m] * self.inverse[(m, i.unwrap_or(last))]
                    });
                    whole.as_mut().subcols_mut(0, states).copy_from(&start);
                }
                scale_rows(&mut whole, weights, output, local);
                LinearMap::new(whole.as_ref())
            })
            .collect()
    }
}
