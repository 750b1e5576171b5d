//! Model reduction of an innovations filter.

use nalgebra::DMatrix;

use crate::noise::{innovations_filter::InnovationsFilter, matrix_equations::gramian};

/// Bound on the change of the whitened innovations (of unit variance) by the states that are left out.
const REDUCTION_ERROR: f64 = 0.01;

impl InnovationsFilter {
    /// Approximates the filter by one with fewer states, by balanced truncation (Moore 1981; of a filter on its own input, Enns
    /// 1984). The bound on the change of the whitened innovations is [`REDUCTION_ERROR`]. `None` if a Gramian does not exist or the
    /// reduced filter is unstable.
    pub(crate) fn reduced(&self) -> Option<Self> {
        let (n, p) = (self.states, self.outputs);
        let matrix =
            |rows: usize, columns: usize, values: &[f64]| DMatrix::from_row_slice(rows, columns, values);
        let (transition, gain) = (matrix(n, n, &self.transition), matrix(n, p, &self.gain));
        let (output, root) = (matrix(p, n, &self.output), self.inverse_root());
        let closed = &transition - &gain * &output;
        // Gramians: covariance of the state, and squares of the whitened innovations by each state.
        let spread = gramian(&transition, &(&gain * &self.covariance * gain.transpose()))?;
        let seen = &root * &output;
        let seen = gramian(&closed.transpose(), &(seen.transpose() * &seen))?;
        let eigen = spread.symmetric_eigen();
        let sizes = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
        let factor = &eigen.eigenvectors * DMatrix::from_diagonal(&sizes);
        let eigen = (factor.transpose() * &seen * &factor).symmetric_eigen();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let hankel: Vec<f64> = order.iter().map(|i| eigen.eigenvalues[*i].max(0.0).sqrt()).collect();
        let mut kept = n;
        while kept > 1 && 2.0 * hankel[kept - 1..].iter().sum::<f64>() < REDUCTION_ERROR {
            kept -= 1;
        }
        let to = DMatrix::from_fn(n, kept, |i, k| {
            let along: f64 = (0..n).map(|j| factor[(i, j)] * eigen.eigenvectors[(j, order[k])]).sum();
            along / hankel[k].sqrt()
        });
        let from = DMatrix::from_fn(kept, kept, |i, j| if i == j { 1.0 / hankel[i] } else { 0.0 })
            * to.transpose()
            * &seen;
        let rows = |m: &DMatrix<f64>| m.transpose().as_slice().to_vec();
        let (transition, gain, output) = (&from * transition * &to, &from * gain, output * &to);
        let filter = Self {
            states: kept,
            transition: rows(&transition),
            output: rows(&output),
            minus_output: rows(&-&output),
            gain: rows(&gain),
            columns: [transition.as_slice().to_vec(), gain.as_slice().to_vec()],
            ..self.clone()
        };
        (filter.spectral_radius() < 1.0).then_some(filter)
    }
}
