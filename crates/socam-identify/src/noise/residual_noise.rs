//! State-space model of the noise in the residuals.

use nalgebra::{DMatrix, DVector};
use socam_model::Equations;

use crate::{Intersample, prediction::intersample};

/// Number of samples before and after an interval whose noise is modelled within it. A band-limited reconstruction depends on more samples,
/// with weights below a hundredth.
const REACH: usize = 3;

/// State-space model of the coloured part of the residuals: x(k+1) = transition x(k) + drive w(k), r(k) = output x(k), with white w of
/// unit variance.
pub(super) struct ResidualNoise {
    pub(super) transition: DMatrix<f64>,
    pub(super) drive: DMatrix<f64>,
    pub(super) output: DMatrix<f64>,
}

impl ResidualNoise {
    /// Creates the noise model for inputs whose columns have white noise of standard deviation `input_std` (SI). Residuals are
    /// divided by `units`. `None` if an entry overflows.
    pub(super) fn new(
        equations: &Equations,
        input_std: &[f64],
        units: &[f64],
        sample_time_s: f64,
        intersample: &[Intersample],
    ) -> Option<Self> {
        let noisy: Vec<usize> = (0..input_std.len()).filter(|i| input_std[*i] > 0.0).collect();
        let seen = observed(equations);
        let drive = DMatrix::from_fn(seen.len(), noisy.len(), |i, j| {
            equations.input[(seen[i], noisy[j])] * input_std[noisy[j]]
        });
        let state = equations.state.select_rows(&seen).select_columns(&seen);
        let kinds: Vec<Intersample> = noisy.iter().map(|input| intersample[*input]).collect();
        let (step, taps) = response(&state, &drive, sample_time_s, &kinds);
        let kernels: Vec<Vec<f64>> = noisy.iter().map(|input| equations.transforms[*input].noise()).collect();
        let (n, m, p) = (step.nrows(), noisy.len(), units.len());
        // The states are those of the drivetrain, then the last noise samples of each input, the latest first. w is the noise of the
        // last sample that affects the coming interval.
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
            // Direct feedthrough of the samples about this one, the latest first.
            for (i, unit) in units.iter().enumerate() {
                let through = equations.feedthrough[(i, *input)] * input_std[*input] / unit;
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

/// States that influence the outputs, directly or through other states. A state that is driven only by a law, such as the
/// deflection of friction's bristles, is left out because it would have an undamped pole at one.
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

/// Transition matrix of an interval, and for each input the responses of the state to the samples about the interval, the earliest
/// first.
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
        let of_coefficients: Vec<_> = intersample::basis(*kind).iter().map(of_coefficient).collect();
        shortened(convolved(&of_coefficients, &intersample::prefilter(*kind)))
    };
    let taps = intersample.iter().enumerate().map(of_samples).collect();
    (step.view((0, 0), (n, n)).into_owned(), taps)
}

/// Convolution of responses with a kernel: responses to coefficients and the prefilter give those to samples; these and the kernel of
/// the channel's transform give those to the samples of its column.
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

/// Leaves out the responses to samples beyond [`REACH`] and adds them to those of the two samples beside the interval.
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
