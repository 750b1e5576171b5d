//! What a noisy input makes of the residuals, and the filter that undoes it.
//!
//! A prediction from a measured input carries that input's error through the drivetrain: residuals swell at the
//! resonances and stay alike for as long as those ring, in all outputs at once. The residual of a right model is
//!
//! xi(k+1) = Phi xi(k) + Gamma e(k),  r(k) = C xi(k) + F e(k) + v(k)
//!
//! with e the noise of the inputs and v that of the outputs, all white. The filter of Kalman (1960) that predicts
//! r from its past leaves a white remainder; divided by its covariance's root it has unit variance in every
//! channel. Residuals and slopes pass through the same filter, so that least squares weighs them as the inverse
//! covariance of all residuals would, at a cost linear in samples.

use faer::{MatMut, reborrow::ReborrowMut};
use nalgebra::{Cholesky, DMatrix};
use socam_model::Equations;

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
pub(crate) struct Whitener {
    outputs: usize,
    states: usize,
    /// Phi, row by row.
    transition: Vec<f64>,
    /// C, row by row.
    output: Vec<f64>,
    /// K, row by row.
    gain: Vec<f64>,
    /// Covariance of the remainder.
    pub(crate) covariance: DMatrix<f64>,
    /// Inverse of its lower root, row by row.
    inverse_root: Vec<f64>,
    /// Largest modulus of the filter's poles.
    pub(crate) memory: f64,
}

/// How noise enters the residual.
struct NoiseModel {
    transition: DMatrix<f64>,
    drive: DMatrix<f64>,
    output: DMatrix<f64>,
    through: DMatrix<f64>,
}

impl Whitener {
    /// For the linear part of `equations`; force laws are taken where they no longer bend. `None` where no steady filter
    /// exists: an input's noise that no sensor sees and no damping ends.
    ///
    /// `units`, one per output, are what residuals will have been divided by.
    pub(crate) fn new(
        equations: &Equations,
        levels: &NoiseLevels,
        units: &[f64],
        sample_time_s: f64,
    ) -> Option<Self> {
        let noise = NoiseModel::new(equations, levels, units, sample_time_s)?;
        let (n, p) = (noise.transition.nrows(), noise.output.nrows());
        let own =
            DMatrix::from_fn(p, p, |i, j| if i == j { (levels.outputs[i] / units[i]).powi(2) } else { 0.0 });
        let spread = &noise.through * noise.through.transpose() + own;
        let cross = &noise.drive * noise.through.transpose();
        let covariance = steady_covariance(&noise, &spread, &cross)?;
        let innovation = &noise.output * &covariance * noise.output.transpose() + &spread;
        let cholesky = Cholesky::new(innovation.clone())?;
        let gain = (&noise.transition * &covariance * noise.output.transpose() + cross) * cholesky.inverse();
        let inverse_root = cholesky.l().solve_lower_triangular(&DMatrix::identity(p, p))?;
        let closed = &noise.transition - &gain * &noise.output;
        // Nothing to remember without states.
        let poles = if n == 0 { Vec::new() } else { closed.complex_eigenvalues().as_slice().to_vec() };
        let memory = poles.iter().fold(0.0_f64, |most, pole| most.max(pole.norm()));
        let rows = |m: &DMatrix<f64>| m.transpose().as_slice().to_vec();
        let filter = Self {
            outputs: p,
            states: n,
            transition: rows(&noise.transition),
            output: rows(&noise.output),
            gain: rows(&gain),
            inverse_root: rows(&inverse_root),
            covariance: innovation,
            memory,
        };
        let finite = filter.gain.iter().chain(&filter.transition).all(|value| value.is_finite());
        (finite && memory < 1.0).then_some(filter)
    }

    /// Nothing remembered yet, for rows of this many columns.
    pub(crate) fn rest(&self, columns: usize) -> Filtered {
        let values = vec![0.0; self.states * columns];
        Filtered { columns, next: values.clone(), values }
    }

    /// One sample: turns `rows` (one per output, `width` columns) from residuals into what their past did not foretell, and
    /// moves `state` on, of whose columns these are the ones from `skipped`. A missing output foretells nothing.
    pub(crate) fn advance(&self, state: &mut Filtered, rows: &mut [f64], skipped: usize, present: &[bool]) {
        self.subtract_foretold(state, rows, skipped, present);
        self.follow(state, rows, skipped);
    }

    /// The first half of [`Whitener::advance`].
    pub(crate) fn subtract_foretold(
        &self,
        state: &Filtered,
        rows: &mut [f64],
        skipped: usize,
        present: &[bool],
    ) {
        let (n, whole) = (self.states, state.columns);
        let width = whole - skipped;
        if whole == 1 {
            for (o, value) in rows.iter_mut().enumerate() {
                let foretold = dot(&self.output[o * n..(o + 1) * n], &state.values);
                *value = if present[o] { *value - foretold } else { 0.0 };
            }
            return;
        }
        for (o, row) in rows.chunks_exact_mut(width).enumerate() {
            if !present[o] {
                row.fill(0.0);
                continue;
            }
            for i in 0..n {
                add(row, -self.output[o * n + i], &state.values[i * whole + skipped..(i + 1) * whole]);
            }
        }
    }

    /// The second half.
    pub(crate) fn follow(&self, state: &mut Filtered, rows: &[f64], skipped: usize) {
        let (n, p, whole) = (self.states, self.outputs, state.columns);
        let width = whole - skipped;
        if whole == 1 {
            for (i, next) in state.next.iter_mut().enumerate() {
                *next = dot(&self.transition[i * n..(i + 1) * n], &state.values)
                    + dot(&self.gain[i * p..(i + 1) * p], rows);
            }
            std::mem::swap(&mut state.values, &mut state.next);
            return;
        }
        for i in 0..n {
            let next = &mut state.next[i * whole + skipped..(i + 1) * whole];
            next.fill(0.0);
            for j in 0..n {
                add(next, self.transition[i * n + j], &state.values[j * whole + skipped..(j + 1) * whole]);
            }
            for o in 0..p {
                add(next, self.gain[i * p + o], &rows[o * width..(o + 1) * width]);
            }
        }
        std::mem::swap(&mut state.values, &mut state.next);
    }

    /// Filters consecutive samples in place. `block` holds `samples` rows of each output, one output after the other, and
    /// the columns of `state` from `skipped` on; `present` is by row of the block.
    pub(crate) fn apply(
        &self,
        state: &mut Filtered,
        mut block: MatMut<'_, f64>,
        samples: usize,
        skipped: usize,
        present: &[bool],
    ) {
        let (p, width) = (self.outputs, block.ncols());
        let mut rows = vec![0.0; p * width];
        let mut here = vec![true; p];
        for k in 0..samples {
            for (o, here) in here.iter_mut().enumerate() {
                *here = present[o * samples + k];
                let source = block.rb_mut().row_mut(o * samples + k);
                rows[o * width..(o + 1) * width].iter_mut().zip(source.iter()).for_each(|(r, v)| *r = *v);
            }
            self.advance(state, &mut rows, skipped, &here);
            for (o, here) in here.iter().enumerate() {
                let mut row = block.rb_mut().row_mut(o * samples + k);
                if !*here {
                    row.fill(0.0);
                    continue;
                }
                for (j, value) in row.iter_mut().enumerate() {
                    *value = (0..=o).map(|q| self.inverse_root[o * p + q] * rows[q * width + j]).sum();
                }
            }
        }
    }

    /// Inverse of the root of the remainder's covariance.
    pub(crate) fn inverse_root(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.outputs, self.outputs, &self.inverse_root)
    }

    /// Divides one sample's remainder by its root.
    pub(crate) fn normalise(&self, remainder: &[f64]) -> Vec<f64> {
        let p = self.outputs;
        (0..p).map(|o| (0..=o).map(|q| self.inverse_root[o * p + q] * remainder[q]).sum()).collect()
    }
}

/// What the filter remembers of each column.
#[derive(Debug, Clone)]
pub(crate) struct Filtered {
    columns: usize,
    values: Vec<f64>,
    next: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(target: &mut [f64], factor: f64, source: &[f64]) {
    if factor != 0.0 {
        target.iter_mut().zip(source).for_each(|(t, s)| *t += factor * s);
    }
}

impl NoiseModel {
    /// Outputs are divided by `units`, inputs' noise has unit variance.
    fn new(equations: &Equations, levels: &NoiseLevels, units: &[f64], sample_time_s: f64) -> Option<Self> {
        let (n, m) = equations.input.shape();
        let noisy: Vec<usize> = (0..m).filter(|i| levels.inputs[*i] > 0.0).collect();
        let size = n + 2 * m;
        let mut generator = DMatrix::zeros(size, size);
        generator.view_mut((0, 0), (n, n)).copy_from(&(&equations.state * sample_time_s));
        generator.view_mut((0, n), (n, m)).copy_from(&(&equations.input * sample_time_s));
        generator.view_mut((n, n + m), (m, m)).fill_diagonal(1.0);
        let step = generator.exp();
        let transition = step.view((0, 0), (n, n)).into_owned();
        let after = step.view((0, n + m), (n, m)).into_owned();
        let before = step.view((0, n), (n, m)) - &after;
        let weight = |output: usize| 1.0 / units[output];
        let p = equations.output.nrows();
        let output = DMatrix::from_fn(p, n, |i, j| equations.output[(i, j)] * weight(i));
        let feedthrough = DMatrix::from_fn(p, m, |i, j| equations.feedthrough[(i, j)] * weight(i));
        // With the state moved back by what the sample at its own instant adds, each sample's noise enters once.
        let drive = &transition * &after + before;
        let through = &output * &after + feedthrough;
        let pick = |matrix: &DMatrix<f64>| {
            DMatrix::from_fn(matrix.nrows(), noisy.len(), |i, j| {
                matrix[(i, noisy[j])] * levels.inputs[noisy[j]]
            })
        };
        let (drive, through) = (pick(&drive), pick(&through));
        let finite = transition.iter().chain(drive.iter()).all(|value| value.is_finite());
        finite.then_some(Self { transition, drive, output, through })
    }
}

/// Solution of the filter's Riccati equation by the structure-preserving doubling algorithm (Chu, Fan, Lin and Wang,
/// International Journal of Control 77, 2004), which converges quadratically.
fn steady_covariance(
    noise: &NoiseModel,
    spread: &DMatrix<f64>,
    cross: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let n = noise.transition.nrows();
    if n == 0 {
        return Some(DMatrix::zeros(0, 0));
    }
    let spread_inverse = spread.clone().try_inverse()?;
    let free = &noise.transition - cross * &spread_inverse * &noise.output;
    let mut a = free.transpose();
    let mut g = noise.output.transpose() * &spread_inverse * &noise.output;
    let mut h = &noise.drive * noise.drive.transpose() - cross * &spread_inverse * cross.transpose();
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
