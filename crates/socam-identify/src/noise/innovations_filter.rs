//! The stationary Kalman filter that whitens residuals coloured by the noise of an input.
//!
//! A prediction from a measured input propagates the input's error through the drivetrain: residuals of all outputs are large at the
//! resonances and correlated for as long as these ring. The residual of a correct model is
//!
//! xi(k+1) = Phi xi(k) + sum of Gamma_j e(k+j),  r(k) = C xi(k) + F e(k) + v(k)
//!
//! with e the noise of the inputs' columns and v that of the outputs, all white. j runs over the samples that the reconstruction of the
//! input within an interval depends on. The filter of Kalman (1960) predicts r from its past and leaves a white innovation; divided by
//! the root of its covariance the innovation has unit variance in every channel. Residuals and sensitivities pass through the same
//! filter. Least squares then weights them as the inverse covariance of all residuals would, at a cost linear in samples.

use nalgebra::{Cholesky, DMatrix};
use pulp::{Simd, WithSimd};
use socam_model::Equations;

use crate::{
    Intersample,
    noise::{
        matrix_equations::{spectral_radius, steady_covariance},
        residual_noise::ResidualNoise,
    },
    prediction::row_products::{self, Source},
};

/// Standard deviations of white noise, SI, in the model's order.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseLevels {
    /// One per output channel.
    pub outputs: Vec<f64>,
    /// One per input channel; zero for an input that is known exactly.
    pub inputs: Vec<f64>,
}

impl NoiseLevels {
    /// Whether some input is noisy.
    pub(crate) fn in_the_input(&self) -> bool {
        self.inputs.iter().any(|std| *std > 0.0)
    }
}

/// The stationary filter for one sample time and one set of units of the residuals.
#[derive(Debug, Clone)]
pub(crate) struct InnovationsFilter {
    pub(crate) outputs: usize,
    pub(crate) states: usize,
    /// Phi, row by row.
    pub(crate) transition: Vec<f64>,
    /// C and -C, row by row.
    pub(super) output: Vec<f64>,
    pub(crate) minus_output: Vec<f64>,
    /// K, row by row.
    pub(crate) gain: Vec<f64>,
    /// Phi and K, column by column.
    pub(super) columns: [Vec<f64>; 2],
    /// Covariance of the innovation.
    pub(crate) covariance: DMatrix<f64>,
    /// Inverse of its lower root, row by row.
    pub(crate) inverse_root: Vec<f64>,
}

impl InnovationsFilter {
    /// The filter for the linear part of `equations`; the derivatives of force laws are taken as zero. `units` has one entry per
    /// output: residuals come divided by it. `None` where no stationary filter exists, because the noise of an input drives an undamped
    /// mode that no output shows, or an entry overflows.
    pub(crate) fn new(
        equations: &Equations,
        levels: &NoiseLevels,
        units: &[f64],
        sample_time_s: f64,
        intersample: &[Intersample],
    ) -> Option<Self> {
        let noise = ResidualNoise::new(equations, &levels.inputs, units, sample_time_s, intersample)?;
        let (n, p) = (noise.transition.nrows(), noise.output.nrows());
        let spread =
            DMatrix::from_fn(p, p, |i, j| if i == j { (levels.outputs[i] / units[i]).powi(2) } else { 0.0 });
        let covariance = steady_covariance(&noise, &spread)?;
        let innovation_covariance = &noise.output * &covariance * noise.output.transpose() + &spread;
        let cholesky = Cholesky::new(innovation_covariance.clone())?;
        let gain = &noise.transition * &covariance * noise.output.transpose() * cholesky.inverse();
        let inverse_root = cholesky.l().solve_lower_triangular(&DMatrix::identity(p, p))?;
        let rows = |m: &DMatrix<f64>| m.transpose().as_slice().to_vec();
        let filter = Self {
            outputs: p,
            states: n,
            transition: rows(&noise.transition),
            output: rows(&noise.output),
            minus_output: rows(&-&noise.output),
            gain: rows(&gain),
            columns: [noise.transition.as_slice().to_vec(), gain.as_slice().to_vec()],
            inverse_root: rows(&inverse_root),
            covariance: innovation_covariance,
        };
        let finite = filter.gain.iter().chain(&filter.transition).all(|value| value.is_finite());
        finite.then_some(filter)
    }

    /// Largest modulus of the filter's poles; at least one if the filter's state does not decay.
    pub(crate) fn spectral_radius(&self) -> f64 {
        let (n, p) = (self.states, self.outputs);
        let gain = DMatrix::from_row_slice(n, p, &self.gain);
        let closed = DMatrix::from_row_slice(n, n, &self.transition)
            - gain * DMatrix::from_row_slice(p, n, &self.output);
        spectral_radius(closed)
    }

    /// The state of the filter before the first sample of one column.
    pub(crate) fn initial_state(&self) -> FilterColumn {
        let values = vec![0.0; self.states];
        FilterColumn { next: values.clone(), values }
    }

    /// Turns `innovation` (one number per output) from residuals into innovations. That of a missing output is zero.
    pub(crate) fn subtract_prediction(&self, state: &FilterColumn, innovation: &mut [f64], present: &[bool]) {
        let n = self.states;
        for (o, value) in innovation.iter_mut().enumerate() {
            let predicted = dot(&self.output[o * n..(o + 1) * n], &state.values);
            *value = if present[o] { *value - predicted } else { 0.0 };
        }
    }

    /// Updates `state` by one sample.
    pub(crate) fn update(&self, state: &mut FilterColumn, innovation: &[f64]) {
        state.next.fill(0.0);
        for (columns, factors) in self.columns.iter().zip([&*state.values, innovation]) {
            let each = columns.chunks_exact(self.states.max(1)).zip(factors);
            each.for_each(|(column, factor)| add(&mut state.next, *factor, column));
        }
        std::mem::swap(&mut state.values, &mut state.next);
    }

    /// The state of the filter before the first sample of `stride` columns.
    pub(crate) fn initial_rows(&self, stride: usize) -> FilterRows {
        FilterRows {
            stride,
            values: vec![0.0; self.states * stride],
            next: vec![0.0; self.states * stride],
            innovation: vec![0.0; self.outputs * stride],
        }
    }

    /// Filters one sample of many columns in place. `rows` has one row per output, of which the first `width` entries (whole SIMD
    /// vectors) are used: they become innovations divided by the root of their covariance, zero for a missing output.
    pub(crate) fn whiten(&self, state: &mut FilterRows, rows: &mut [f64], width: usize, present: &[bool]) {
        pulp::Arch::new().dispatch(Whiten { filter: self, state, rows, width, present });
    }

    /// Inverse of the lower root of the innovation's covariance.
    pub(crate) fn inverse_root(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.outputs, self.outputs, &self.inverse_root)
    }
}

/// See [`InnovationsFilter::whiten`].
struct Whiten<'a> {
    filter: &'a InnovationsFilter,
    state: &'a mut FilterRows,
    rows: &'a mut [f64],
    width: usize,
    present: &'a [bool],
}

impl WithSimd for Whiten<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { filter, state, rows, width, present } = self;
        let (n, p, stride) = (filter.states, filter.outputs, state.stride);
        let FilterRows { values, next, innovation, .. } = state;
        let past = |factors| Source { factors, width: n, rows: values, stride };
        innovation.copy_from_slice(&rows[..p * stride]);
        row_products::product::<S, true, 1>(simd, [past(&filter.minus_output)], width, innovation, stride);
        for o in (0..p).filter(|o| !present[*o]) {
            innovation[o * stride..][..width].fill(0.0);
        }
        let news = |factors| Source { factors, width: p, rows: innovation, stride };
        let sources = [past(&filter.transition), news(&filter.gain)];
        row_products::product::<S, false, 2>(simd, sources, width, next, stride);
        row_products::product::<S, false, 1>(simd, [news(&filter.inverse_root)], width, rows, stride);
        for o in (0..p).filter(|o| !present[*o]) {
            rows[o * stride..][..width].fill(0.0);
        }
        std::mem::swap(values, next);
    }
}

/// State of the filter for one column.
#[derive(Debug, Clone)]
pub(crate) struct FilterColumn {
    values: Vec<f64>,
    next: Vec<f64>,
}

/// State of the filter for many columns, row by row.
#[derive(Debug, Clone)]
pub(crate) struct FilterRows {
    stride: usize,
    values: Vec<f64>,
    next: Vec<f64>,
    innovation: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(target: &mut [f64], factor: f64, source: &[f64]) {
    target.iter_mut().zip(source).for_each(|(t, s)| *t += factor * s);
}

#[cfg(test)]
mod tests {
    use socam_model::Model;

    use super::*;

    #[test]
    fn a_spectral_radius_is_found_beside_delays_and_rotation() {
        let turning = DMatrix::from_row_slice(2, 2, &[0.6, -0.7, 0.7, 0.6]);
        assert!((spectral_radius(turning) - 0.85_f64.sqrt()).abs() < 1e-6);
        let delays = DMatrix::from_row_slice(3, 3, &[0.0, 0.0, 5.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(spectral_radius(delays), 0.0);
    }

    #[test]
    fn states_that_only_a_law_moves_are_left_out() {
        let model = Model::builtin("speed-o-cam").unwrap();
        let values = [("torque", 0.4), ("deflection", 1e-3)];
        let rubbing = model.with_effect("coulomb_friction", "load_bearing", &values).unwrap();
        let [plain, rubbing] = [model, rubbing].map(|model| {
            let levels = NoiseLevels {
                outputs: vec![0.01; model.outputs().count()],
                inputs: vec![0.05; model.inputs().count()],
            };
            let equations = model.equations(&model.values()).unwrap();
            InnovationsFilter::new(&equations, &levels, &levels.outputs, 1e-3, &[Intersample::BandLimited])
                .unwrap()
        });
        assert_eq!(rubbing.states, plain.states);
        assert!(rubbing.spectral_radius() < 1.0);
    }
}
