//! The decaying response to the start state.

use faer::Mat;
use nalgebra::{Complex, DMatrix, DVector};

use super::{Modal, complex, scale_rows};
use crate::{
    evaluation::weights::{Point, Weights},
    prediction::{products::LinearMap, start_state},
    preprocessing::segments::Chunk,
    problem::{Problem, StartState},
};

type C = Complex<f64>;

/// The start state of a segment in modal coordinates.
struct ModalStart {
    /// Whether the start state is unknown.
    is_free: bool,
    /// W x0.
    state: DVector<C>,
    /// Derivatives of x0 with respect to the free parameters; `None` where x0 does not depend on them.
    sensitivities: Option<Vec<DVector<f64>>>,
}

impl Modal {
    /// Per output, the map from the start signals [decay | t decay] to [nuisance | free | prediction].
    pub(super) fn start_maps(
        &self,
        problem: &Problem<'_>,
        nuisance: &[f64],
        point: &Point,
        chunk: &Chunk,
        weights: &Weights,
    ) -> Vec<LinearMap> {
        let start = self.start(problem, nuisance, point, chunk);
        let outputs = 0..problem.outputs();
        outputs.map(|output| self.start_map(output, &start, nuisance.len(), weights)).collect()
    }

    /// The start state: that of `nuisance` where it is unknown, else the equilibrium at the first inputs.
    fn start(&self, problem: &Problem<'_>, nuisance: &[f64], point: &Point, chunk: &Chunk) -> ModalStart {
        let states = self.vectors.nrows();
        let is_free = problem.options.start_state == StartState::Free;
        let first: Vec<f64> =
            chunk.inputs.iter().map(|input| input[0]).chain(self.constant.then_some(1.0)).collect();
        let equilibrium = || start_state::equilibrium(&self.equations, &point.values, &first);
        let x0 = if is_free {
            DVector::from_column_slice(&nuisance[..states])
        } else {
            equilibrium().unwrap_or_else(|| DVector::zeros(states))
        };
        let sensitivities = || {
            start_state::equilibrium_sensitivities(
                &self.equations,
                &self.sensitivities,
                &point.values,
                &problem.free,
                &first,
                &x0,
            )
        };
        let sensitivities = if is_free { None } else { sensitivities() };
        ModalStart { is_free, state: &self.inverse * x0.map(C::from), sensitivities }
    }

    fn start_map(&self, output: usize, start: &ModalStart, nuisance: usize, weights: &Weights) -> LinearMap {
        let (states, signals, free) = (self.vectors.nrows(), self.mode_signals(), self.sensitivities.len());
        let seen = complex(&self.equations.output.rows(output, 1).into_owned()) * &self.vectors;
        let mut inner = Mat::zeros(2 * signals, free + 1);
        self.fill_rows(&mut inner, 0, free, |m, j| match j {
            None => seen[m] * start.state[m],
            Some(j) => self.start_sensitivity(output, &seen, start, m, j),
        });
        self.fill_rows(&mut inner, signals, free, |m, j| {
            j.map_or(C::default(), |j| seen[m] * start.state[m] * self.pole_sensitivities[j][m])
        });
        let mut whole = Mat::zeros(2 * signals, nuisance + free + 1);
        whole.as_mut().subcols_mut(nuisance, free + 1).copy_from(&inner);
        if start.is_free && states > 0 {
            let mut own = Mat::zeros(2 * signals, states);
            let last = states - 1;
            self.fill_rows(&mut own, 0, last, |m, i| seen[m] * self.inverse[(m, i.unwrap_or(last))]);
            whole.as_mut().subcols_mut(0, states).copy_from(&own);
        }
        scale_rows(&mut whole, weights, output, nuisance);
        LinearMap::new(whole.as_ref())
    }

    /// Derivative of (C V)_om (W x0)_m with respect to free parameter `j`.
    fn start_sensitivity(
        &self,
        output: usize,
        seen: &DMatrix<C>,
        start: &ModalStart,
        m: usize,
        j: usize,
    ) -> C {
        let seen_sensitivity = self.row_sensitivity(&self.sensitivities[j].output, seen, output, m, j);
        let x0_sensitivity = start.sensitivities.as_ref().map(|sensitivities| &sensitivities[j]);
        let z0_sensitivity = (0..self.vectors.nrows()).fold(C::default(), |sum, i| {
            let moved = x0_sensitivity.map_or(0.0, |sensitivity| sensitivity[i]);
            sum + self.inverse[(m, i)] * moved - self.eigenvector_derivatives[j][(m, i)] * start.state[i]
        });
        seen_sensitivity * start.state[m] + seen[m] * z0_sensitivity
    }
}
