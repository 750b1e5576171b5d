//! What a noisy input makes of the residuals, and the filter that undoes it.
//!
//! A prediction from a measured input carries that input's error through the drivetrain: residuals swell at the
//! resonances and stay alike for as long as those ring, in all outputs at once. The residual of a right model is
//!
//! xi(k+1) = Phi xi(k) + sum of Gamma_j e(k+j),  r(k) = C xi(k) + F e(k) + v(k)
//!
//! with e the noise of the inputs' columns and v that of the outputs, all white, and j running over the samples about an interval
//! that the input's course within it depends on, a rate's on more of them. The filter of Kalman (1960) that predicts
//! r from its past leaves a white remainder; divided by its covariance's root it has unit variance in every
//! channel. Residuals and sensitivities pass through the same filter, so that least squares weighs them as the inverse
//! covariance of all residuals would, at a cost linear in samples.

use nalgebra::{Cholesky, DMatrix, DVector};
use pulp::{Simd, WithSimd};
use socam_model::Equations;

use crate::{
    Intersample,
    prediction::{
        intersample,
        products::{self, Source},
    },
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

/// The steady filter for one sample time. Residuals come in the units that it was made for.
#[derive(Debug, Clone)]
pub(crate) struct InnovationsFilter {
    pub(crate) outputs: usize,
    pub(crate) states: usize,
    /// Phi, row by row.
    pub(crate) transition: Vec<f64>,
    /// C, row by row, and less than nothing by as much.
    output: Vec<f64>,
    pub(crate) minus_output: Vec<f64>,
    /// K, row by row.
    pub(crate) gain: Vec<f64>,
    /// Phi and K, column by column.
    columns: [Vec<f64>; 2],
    /// Covariance of the remainder.
    pub(crate) covariance: DMatrix<f64>,
    /// Inverse of its lower root, row by row.
    pub(crate) inverse_root: Vec<f64>,
}

/// How noise enters the residual: x(k+1) = transition x(k) + drive w(k), r(k) = output x(k), w of unit variance.
struct NoiseModel {
    transition: DMatrix<f64>,
    drive: DMatrix<f64>,
    output: DMatrix<f64>,
}

/// Samples before and after an interval whose noise is taken to matter within it; a band-limited course depends on more of
/// them, by less than a hundredth.
const REACH: usize = 3;

/// What leaving out states may change in white remainders, of unit variance.
const NEXT_TO_NOTHING: f64 = 0.01;

impl InnovationsFilter {
    /// For the linear part of `equations`; force laws are taken where they no longer bend. `None` where no steady filter
    /// exists: an input's noise that no sensor sees and no damping ends.
    ///
    /// `units`, one per output, are what residuals will have been divided by.
    pub(crate) fn new(
        equations: &Equations,
        levels: &NoiseLevels,
        units: &[f64],
        sample_time_s: f64,
        intersample: &[Intersample],
    ) -> Option<Self> {
        let noise = NoiseModel::new(equations, levels, units, sample_time_s, intersample)?;
        let (n, p) = (noise.transition.nrows(), noise.output.nrows());
        let spread =
            DMatrix::from_fn(p, p, |i, j| if i == j { (levels.outputs[i] / units[i]).powi(2) } else { 0.0 });
        let covariance = steady_covariance(&noise, &spread)?;
        let innovation = &noise.output * &covariance * noise.output.transpose() + &spread;
        let cholesky = Cholesky::new(innovation.clone())?;
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
            covariance: innovation,
        };
        let finite = filter.gain.iter().chain(&filter.transition).all(|value| value.is_finite());
        finite.then_some(filter)
    }

    /// The same with fewer states, as far as remainders of what it foretells differ by next to nothing (balanced truncation, Moore
    /// 1981; of the filter on its own input, Enns 1984).
    pub(crate) fn reduced(&self) -> Option<Self> {
        let (n, p) = (self.states, self.outputs);
        let matrix =
            |rows: usize, columns: usize, values: &[f64]| DMatrix::from_row_slice(rows, columns, values);
        let (transition, gain) = (matrix(n, n, &self.transition), matrix(n, p, &self.gain));
        let (output, root) = (matrix(p, n, &self.output), self.inverse_root());
        let closed = &transition - &gain * &output;
        // How far the state moves, and what a state leaves in white remainders.
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
        while kept > 1 && 2.0 * hankel[kept - 1..].iter().sum::<f64>() < NEXT_TO_NOTHING {
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
        (filter.memory() < 1.0).then_some(filter)
    }

    /// Largest modulus of the filter's poles; one or more where it never forgets.
    pub(crate) fn memory(&self) -> f64 {
        let (n, p) = (self.states, self.outputs);
        let gain = DMatrix::from_row_slice(n, p, &self.gain);
        let closed = DMatrix::from_row_slice(n, n, &self.transition)
            - gain * DMatrix::from_row_slice(p, n, &self.output);
        spectral_radius(closed)
    }

    /// Nothing remembered yet of one column.
    pub(crate) fn rest(&self) -> Filtered {
        let values = vec![0.0; self.states];
        Filtered { next: values.clone(), values }
    }

    /// Turns `remainder` (one per output) from residuals into what their past did not foretell. A missing output foretells nothing.
    pub(crate) fn subtract_foretold(&self, state: &Filtered, remainder: &mut [f64], present: &[bool]) {
        let n = self.states;
        for (o, value) in remainder.iter_mut().enumerate() {
            let foretold = dot(&self.output[o * n..(o + 1) * n], &state.values);
            *value = if present[o] { *value - foretold } else { 0.0 };
        }
    }

    /// Moves `state` on.
    pub(crate) fn follow(&self, state: &mut Filtered, remainder: &[f64]) {
        state.next.fill(0.0);
        for (columns, factors) in self.columns.iter().zip([&*state.values, remainder]) {
            let each = columns.chunks_exact(self.states.max(1)).zip(factors);
            each.for_each(|(column, factor)| add(&mut state.next, *factor, column));
        }
        std::mem::swap(&mut state.values, &mut state.next);
    }

    /// Nothing remembered yet of rows that are `stride` long.
    pub(crate) fn rest_of_rows(&self, stride: usize) -> FilteredRows {
        FilteredRows {
            stride,
            values: vec![0.0; self.states * stride],
            next: vec![0.0; self.states * stride],
            remainder: vec![0.0; self.outputs * stride],
        }
    }

    /// One sample of many columns: turns `rows`, one per output, of which the first `width` entries count (a number of whole
    /// vectors), into what their past did not foretell, divided by its covariance's root, and moves `state` on. A missing output
    /// stays nothing.
    pub(crate) fn whiten(&self, state: &mut FilteredRows, rows: &mut [f64], width: usize, present: &[bool]) {
        pulp::Arch::new().dispatch(Whiten { filter: self, state, rows, width, present });
    }

    /// Inverse of the root of the remainder's covariance.
    pub(crate) fn inverse_root(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.outputs, self.outputs, &self.inverse_root)
    }
}

/// See [`InnovationsFilter::whiten`].
struct Whiten<'a> {
    filter: &'a InnovationsFilter,
    state: &'a mut FilteredRows,
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
        let FilteredRows { values, next, remainder, .. } = state;
        let past = |factors| Source { factors, width: n, rows: values, stride };
        remainder.copy_from_slice(&rows[..p * stride]);
        products::product::<S, true, 1>(simd, [past(&filter.minus_output)], width, remainder, stride);
        for o in (0..p).filter(|o| !present[*o]) {
            remainder[o * stride..][..width].fill(0.0);
        }
        let news = |factors| Source { factors, width: p, rows: remainder, stride };
        let sources = [past(&filter.transition), news(&filter.gain)];
        products::product::<S, false, 2>(simd, sources, width, next, stride);
        products::product::<S, false, 1>(simd, [news(&filter.inverse_root)], width, rows, stride);
        for o in (0..p).filter(|o| !present[*o]) {
            rows[o * stride..][..width].fill(0.0);
        }
        std::mem::swap(values, next);
    }
}

/// From the growth of a matrix's powers: an iteration for its eigenvalues need not end.
pub(crate) fn spectral_radius(mut matrix: DMatrix<f64>) -> f64 {
    const DOUBLINGS: i32 = 24;
    let mut log_scale = 0.0;
    for _ in 0..DOUBLINGS {
        let size = matrix.norm();
        if size == 0.0 {
            return 0.0;
        }
        matrix /= size;
        log_scale = 2.0 * (log_scale + size.ln());
        matrix = &matrix * &matrix;
    }
    ((log_scale + matrix.norm().ln()) / 2.0_f64.powi(DOUBLINGS)).exp()
}

/// What the filter remembers of one column.
#[derive(Debug, Clone)]
pub(crate) struct Filtered {
    values: Vec<f64>,
    next: Vec<f64>,
}

/// Of many.
#[derive(Debug, Clone)]
pub(crate) struct FilteredRows {
    stride: usize,
    values: Vec<f64>,
    next: Vec<f64>,
    remainder: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(target: &mut [f64], factor: f64, source: &[f64]) {
    target.iter_mut().zip(source).for_each(|(t, s)| *t += factor * s);
}

impl NoiseModel {
    /// Outputs are divided by `units`.
    fn new(
        equations: &Equations,
        levels: &NoiseLevels,
        units: &[f64],
        sample_time_s: f64,
        intersample: &[Intersample],
    ) -> Option<Self> {
        let noisy: Vec<usize> = (0..levels.inputs.len()).filter(|i| levels.inputs[*i] > 0.0).collect();
        let seen = observed(equations);
        let drive = DMatrix::from_fn(seen.len(), noisy.len(), |i, j| {
            equations.input[(seen[i], noisy[j])] * levels.inputs[noisy[j]]
        });
        let state = equations.state.select_rows(&seen).select_columns(&seen);
        let kinds: Vec<Intersample> = noisy.iter().map(|input| intersample[*input]).collect();
        let (step, taps) = response(&state, &drive, sample_time_s, &kinds);
        let kernels: Vec<Vec<f64>> = noisy.iter().map(|input| equations.transforms[*input].noise()).collect();
        let (n, m, p) = (step.nrows(), noisy.len(), units.len());
        // The state, then each input's noise of the last samples, the latest first; what comes in is the noise of the
        // last sample that matters for the coming interval.
        let remembered: Vec<usize> =
            kernels.iter().zip(&taps).map(|(kernel, taps)| taps.len() + kernel.len() - 2).collect();
        let size = n + remembered.iter().sum::<usize>();
        let (mut transition, mut entering) = (DMatrix::zeros(size, size), DMatrix::zeros(size, m));
        transition.view_mut((0, 0), (n, n)).copy_from(&step);
        let mut output = DMatrix::zeros(p, size);
        for (i, unit) in units.iter().enumerate() {
            (0..n).for_each(|j| output[(i, j)] = equations.output[(i, seen[j])] / unit);
        }
        let mut first = n;
        for (j, (input, kernel)) in noisy.iter().zip(&kernels).enumerate() {
            let of_column = convolved(&taps[j], kernel);
            entering.view_mut((0, j), (n, 1)).copy_from(&of_column[remembered[j]]);
            entering[(first, j)] = 1.0;
            for age in 0..remembered[j] {
                let own = &of_column[remembered[j] - 1 - age];
                transition.view_mut((0, first + age), (n, 1)).copy_from(own);
                if age + 1 < remembered[j] {
                    transition[(first + age + 1, first + age)] = 1.0;
                }
            }
            // What passes through at once, of the samples about this one, the latest first.
            for (i, unit) in units.iter().enumerate() {
                let through = equations.feedthrough[(i, *input)] * levels.inputs[*input] / unit;
                let latest = first + remembered[j] / 2 - kernel.len() / 2;
                for (k, weight) in kernel.iter().rev().enumerate() {
                    output[(i, latest + k)] = through * weight;
                }
            }
            first += remembered[j];
        }
        let finite = transition.iter().chain(entering.iter()).all(|value| value.is_finite());
        finite.then_some(Self { transition, drive: entering, output })
    }
}

/// States that outputs show, themselves or through others. What only a law moves, such as friction's bristles, would never forget.
fn observed(equations: &Equations) -> Vec<usize> {
    let states = equations.state.ncols();
    let mut seen: Vec<usize> =
        (0..states).filter(|j| equations.output.column(*j).iter().any(|c| *c != 0.0)).collect();
    let mut next = 0;
    while let Some(&i) = seen.get(next) {
        let moves = |j: &usize| equations.state[(i, *j)] != 0.0 && !seen.contains(j);
        let more: Vec<usize> = (0..states).filter(moves).collect();
        seen.extend(more);
        next += 1;
    }
    seen.sort_unstable();
    seen
}

/// What the state becomes in an interval: of itself, and, input by input, of its samples about it, the earliest first.
fn response(
    state: &DMatrix<f64>,
    drive: &DMatrix<f64>,
    sample_time_s: f64,
    intersample: &[Intersample],
) -> (DMatrix<f64>, Vec<Vec<DVector<f64>>>) {
    let (n, m) = drive.shape();
    let degrees = if intersample.contains(&Intersample::BandLimited) { 6 } else { 2 };
    let size = n + degrees * m;
    let mut generator = DMatrix::zeros(size, size);
    generator.view_mut((0, 0), (n, n)).copy_from(&(state * sample_time_s));
    generator.view_mut((0, n), (n, m)).copy_from(&(drive * sample_time_s));
    for degree in 1..degrees {
        generator.view_mut((n + (degree - 1) * m, n + degree * m), (m, m)).fill_diagonal(1.0);
    }
    let step = generator.exp();
    let mut factorial = 1.0;
    let powers: Vec<DMatrix<f64>> = (0..degrees)
        .map(|degree| {
            factorial *= degree.max(1) as f64;
            step.view((0, n + degree * m), (n, m)) * factorial
        })
        .collect();
    let of_samples = |(input, kind): (usize, &Intersample)| {
        let of_coefficient = |piece: &[f64; 6]| {
            let powers = piece.iter().zip(&powers);
            powers.fold(DVector::zeros(n), |sum, (c, power)| sum + power.column(input) * *c)
        };
        let of_coefficients: Vec<_> = intersample::pieces(*kind).iter().map(of_coefficient).collect();
        shortened(convolved(&of_coefficients, &intersample::prefilter(*kind)))
    };
    let taps = intersample.iter().enumerate().map(of_samples).collect();
    (step.view((0, 0), (n, n)).into_owned(), taps)
}

/// Of what a coefficient does, what a sample does; or of that, what a sample of the column does.
fn convolved(taps: &[DVector<f64>], kernel: &[f64]) -> Vec<DVector<f64>> {
    let states = taps.first().map_or(0, DVector::nrows);
    let mut each = vec![DVector::zeros(states); taps.len() + kernel.len() - 1];
    for (i, tap) in taps.iter().enumerate() {
        for (k, weight) in kernel.iter().enumerate() {
            each[i + k] += tap * *weight;
        }
    }
    each
}

/// Leaves out the samples beyond [`REACH`], and gives what they would do to those beside the interval.
fn shortened(taps: Vec<DVector<f64>>) -> Vec<DVector<f64>> {
    let beyond = (taps.len() / 2).saturating_sub(REACH + 1);
    let mut kept = taps[beyond..taps.len() - beyond].to_vec();
    let middle = kept.len() / 2;
    for tap in taps[..beyond].iter().chain(&taps[taps.len() - beyond..]) {
        kept[middle - 1] += tap * 0.5;
        kept[middle] += tap * 0.5;
    }
    kept
}

/// Sum of transition^k source transition'^k over very many k.
fn gramian(transition: &DMatrix<f64>, source: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    const DOUBLINGS: usize = 24;
    let (mut sum, mut power) = (source.clone(), transition.clone());
    for _ in 0..DOUBLINGS {
        let added = &power * &sum * power.transpose();
        sum += &added;
        if added.amax() <= 1e-14 * sum.amax() {
            break;
        }
        power = &power * &power;
    }
    sum.iter().all(|value| value.is_finite()).then_some(sum)
}

/// Solution of the filter's Riccati equation by the structure-preserving doubling algorithm (Chu, Fan, Lin and Wang,
/// International Journal of Control 77, 2004), which converges quadratically.
fn steady_covariance(noise: &NoiseModel, spread: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = noise.transition.nrows();
    if n == 0 {
        return Some(DMatrix::zeros(0, 0));
    }
    let spread_inverse = spread.clone().try_inverse()?;
    let mut a = noise.transition.transpose();
    let mut g = noise.output.transpose() * &spread_inverse * &noise.output;
    let mut h = &noise.drive * noise.drive.transpose();
    for _ in 0..60 {
        let inner = (DMatrix::identity(n, n) + &g * &h).lu();
        let (wa, wg) = (inner.solve(&a)?, inner.solve(&g)?);
        let added = a.transpose() * &h * &wa;
        let next_g = &g + &a * wg * a.transpose();
        a = &a * wa;
        h += &added;
        h = (&h + h.transpose()) * 0.5;
        g = (&next_g + next_g.transpose()) * 0.5;
        if !h.iter().all(|value| value.is_finite()) {
            return None;
        }
        if added.amax() <= 1e-14 * h.amax() {
            return Some(h);
        }
    }
    None
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
    fn bristles_are_none_of_the_filters_business() {
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
        assert!(rubbing.memory() < 1.0);
    }
}
