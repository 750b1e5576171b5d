//! Reconstruction of an input between its samples: it is held, is piecewise linear, or is a quintic spline that approximates a
//! band-limited signal.
//!
//! Linear interpolation multiplies a tone at x rad per sample by (sin(x/2)/(x/2))^2 and adds images at all frequencies that differ
//! from it by multiples of the sampling rate, which excite the drivetrain too. At a seventh of the sampling rate the tone loses 6 %
//! and the largest image has 2.4 %. A quintic B-spline has the sixth power instead of the second. Its coefficients are the samples
//! after a prefilter, the inverse of the spline's own response. The remaining images have (f/(1-f))^6 of a tone at f times the sampling
//! rate: 1e-5 at a seventh, 1e-3 at a quarter (M. Unser, IEEE Signal Processing Magazine 16(6), 1999, on B-splines and their prefilters).

use std::{ops::Range, sync::LazyLock};

use crate::Intersample;

/// Contribution of one coefficient within an interval between two samples: a polynomial in the position, from 0 to 1, lowest power
/// first.
pub(crate) type BasisPolynomial = [f64; 6];

/// Linear interpolation: the sample before and the one after.
const LINEAR: [BasisPolynomial; 2] = [[1.0, -1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]];

/// 120 times the cardinal B-spline of fifth degree: from the coefficient two samples before the interval's start to the one three
/// samples after it.
const QUINTIC: [BasisPolynomial; 6] = [
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

/// Zero-order hold: the sample before.
const HELD: [BasisPolynomial; 2] = [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 6]];

/// Powers of the second difference in the prefilter's series.
const POWERS: usize = 8;

/// Samples on either side of an uneven step that a band-limited input is interpolated from.
pub(crate) const UNEVEN_SIDE: usize = 3;

/// Largest sum of the weights' magnitudes in such an interpolation.
const MOST_WEIGHT: f64 = 2.0;

/// Basis polynomials of the coefficients about an interval, the earliest first.
pub(crate) fn basis(intersample: Intersample) -> Vec<BasisPolynomial> {
    match intersample {
        Intersample::Hold => HELD.to_vec(),
        Intersample::Linear => LINEAR.to_vec(),
        Intersample::BandLimited => QUINTIC.iter().map(|piece| piece.map(|c| c / 120.0)).collect(),
    }
}

/// An input between two samples: a polynomial in the position, from 0 to 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InputPolynomial(BasisPolynomial);

impl InputPolynomial {
    /// The combination of the basis polynomials by the coefficients about the interval.
    pub(crate) fn new(basis: &[BasisPolynomial], coefficients: &[f64]) -> Self {
        let mut sum = [0.0; 6];
        for (piece, coefficient) in basis.iter().zip(coefficients) {
            sum.iter_mut().zip(piece).for_each(|(sum, c)| *sum += c * coefficient);
        }
        Self(sum)
    }

    /// The input over the step that ends at sample `k`, of samples at uneven times: the polynomial through `values` that the kind asks for, of
    /// fifth degree where the input is band-limited, and of lower degree where that would enlarge noise. A constant before the first sample.
    pub(crate) fn between(values: &[f64], time_s: &[f64], k: usize, kind: Intersample) -> Self {
        let constant = |value: f64| Self([value, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let Some(before) = k.checked_sub(1) else { return constant(values[0]) };
        if kind == Intersample::Hold {
            return constant(values[before]);
        }
        let most = if kind == Intersample::Linear { 1 } else { UNEVEN_SIDE };
        let through = |side: usize| {
            let rows = k.saturating_sub(side)..(k + side).min(values.len());
            Through::new(&values[rows.clone()], &time_s[rows], (time_s[before], time_s[k]))
        };
        let usable = (2..=most).rev().map(through).find(|found| found.size <= MOST_WEIGHT);
        usable.unwrap_or_else(|| through(1)).polynomial
    }

    /// Its coefficients, lowest power first.
    pub(crate) fn coefficients(&self) -> &[f64; 6] {
        &self.0
    }

    pub(crate) fn at(&self, position: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * position + c)
    }

    /// Values at the start, the middle and the end of a part of the interval, of the parabola that has the same ends and the same mean
    /// there.
    pub(crate) fn parabola(&self, [from, to]: [f64; 2]) -> [f64; 3] {
        let integral = |position: f64| {
            let powers = self.0.iter().enumerate().rev();
            position * powers.fold(0.0, |sum, (j, c)| sum * position + c / (j + 1) as f64)
        };
        let (start, end) = (self.at(from), self.at(to));
        let mean = (integral(to) - integral(from)) / (to - from);
        [start, 1.5 * mean - 0.25 * (start + end), end]
    }
}

/// The polynomial through samples, in the position within a step from 0 to 1.
struct Through {
    polynomial: InputPolynomial,
    /// Sum of the magnitudes of the samples' weights in the middle of the step: how much noise it may enlarge.
    size: f64,
}

impl Through {
    /// By the sum of the Lagrange polynomials of at most six samples.
    fn new(values: &[f64], time_s: &[f64], (from_s, to_s): (f64, f64)) -> Self {
        let position: Vec<f64> = time_s.iter().map(|t| (t - from_s) / (to_s - from_s)).collect();
        let (mut sum, mut size) = ([0.0; 6], 0.0);
        for (own, value) in values.iter().enumerate() {
            // The product of (s - other) / (own - other).
            let mut product = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            for other in (0..position.len()).filter(|other| *other != own) {
                let scale = 1.0 / (position[own] - position[other]);
                for power in (0..6).rev() {
                    let lower = if power == 0 { 0.0 } else { product[power - 1] };
                    product[power] = scale * (lower - position[other] * product[power]);
                }
            }
            size += InputPolynomial(product).at(0.5).abs();
            sum.iter_mut().zip(product).for_each(|(sum, c)| *sum += c * value);
        }
        Self { polynomial: InputPolynomial(sum), size }
    }
}

/// Number of coefficients before an interval's first sample that contribute within it; there are as many after its last sample.
pub(crate) const fn margin(intersample: Intersample) -> usize {
    match intersample {
        Intersample::Hold | Intersample::Linear => 0,
        Intersample::BandLimited => QUINTIC.len() / 2 - 1,
    }
}

/// Number of samples on either side of some rows that the rows' coefficients, and those of the margin, depend on.
pub(crate) const fn reach(intersample: Intersample) -> usize {
    match intersample {
        Intersample::Hold | Intersample::Linear => 1,
        Intersample::BandLimited => POWERS + margin(intersample) + 1,
    }
}

/// Coefficients for the intervals that end at each of the given rows of `values`: from [`margin`] + 1 before the first row to
/// [`margin`] after the last. `values` is extended by point reflection at its ends; a held input keeps its first value before its first
/// sample. `values` must not be empty.
pub(crate) fn coefficients(values: &[f64], rows: Range<usize>, intersample: Intersample) -> Vec<f64> {
    let margin = margin(intersample) as i64;
    let last = values.len() as i64 - 1;
    let at = |k: i64| {
        if k < 0 && intersample == Intersample::Hold {
            values[0]
        } else if k < 0 {
            2.0 * values[0] - values[(-k).min(last) as usize]
        } else if k > last {
            2.0 * values[last as usize] - values[(2 * last - k).max(0) as usize]
        } else {
            values[k as usize]
        }
    };
    let wanted = rows.start as i64 - margin - 1..rows.end as i64 + margin;
    match intersample {
        Intersample::Hold | Intersample::Linear => wanted.map(at).collect(),
        Intersample::BandLimited => {
            let reach = POWERS as i64;
            let around: Vec<f64> = (wanted.start - reach..wanted.end + reach).map(at).collect();
            let kernel = &*PREFILTER;
            around
                .windows(2 * POWERS + 1)
                .map(|window| {
                    let pairs = (1..=POWERS).map(|n| kernel[n] * (window[POWERS - n] + window[POWERS + n]));
                    kernel[0] * window[POWERS] + pairs.sum::<f64>()
                })
                .collect()
        }
    }
}

/// Impulse response of the prefilter: the contribution of one sample to the coefficients about it, symmetric about its middle.
pub(crate) fn prefilter(intersample: Intersample) -> Vec<f64> {
    match intersample {
        Intersample::Hold | Intersample::Linear => vec![1.0],
        Intersample::BandLimited => {
            let kernel = &*PREFILTER;
            (0..=2 * POWERS).map(|i| kernel[i.abs_diff(POWERS)]).collect()
        }
    }
}

/// Impulse response of the prefilter, from its middle on. In powers of d = 2 - 2 cos x = 4 sin^2(x/2), the inverse of
/// (sin(x/2)/(x/2))^2 is the square of arcsin(s)/s at s = sqrt(d)/2, that is 1 + d/12 + d^2/90 + ...; the prefilter is its third power.
static PREFILTER: LazyLock<[f64; POWERS + 1]> = LazyLock::new(|| {
    let mut square = [1.0; POWERS + 1];
    for n in 1..=POWERS {
        // The coefficient of d^n is 2 (n!)^2 / (2n + 2)!; here by its ratio to the previous one.
        let m = n as f64;
        square[n] = square[n - 1] * m * m / ((2.0 * m + 2.0) * (2.0 * m + 1.0));
    }
    let times = |a: &[f64; POWERS + 1], b: &[f64; POWERS + 1]| {
        std::array::from_fn(|n| (0..=n).map(|i| a[i] * b[n - i]).sum::<f64>())
    };
    let series = times(&times(&square, &square), &square);
    // d^n is (2 - shift - shift^-1)^n: the binomials of 2n with alternating signs.
    let mut kernel = [0.0; POWERS + 1];
    for (n, weight) in series.iter().enumerate() {
        let mut binomial = 1.0;
        for i in 0..=n {
            // binomial(2n, i) belongs n - i samples from the middle.
            let sign = if (n - i) % 2 == 0 { 1.0 } else { -1.0 };
            kernel[n - i] += weight * sign * binomial;
            binomial *= (2 * n - i) as f64 / (i + 1) as f64;
        }
    }
    kernel
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_follows_a_tone_between_its_samples() {
        let basis = basis(Intersample::BandLimited);
        for (x, tolerance) in [(0.3_f64, 5e-8), (0.6, 5e-6), (0.9, 1e-4)] {
            let tone = |t: f64| (x * t + 0.3).sin();
            let values: Vec<f64> = (0..60).map(|k| tone(f64::from(k))).collect();
            let all = coefficients(&values, 0..60, Intersample::BandLimited);
            for k in 20..40 {
                for s in [0.0_f64, 0.3, 0.5, 0.9] {
                    let value: f64 = (0..6)
                        .map(|m| (0..6).map(|j| basis[m][j] * s.powi(j as i32)).sum::<f64>() * all[k + m])
                        .sum();
                    let error = value - tone(k as f64 - 1.0 + s);
                    assert!(error.abs() < tolerance, "{x} {k} {s}: {error}");
                }
            }
        }
    }

    #[test]
    fn a_parabola_keeps_ends_and_mean() {
        let input = InputPolynomial([1.0, 2.0, -3.0, 0.5, 1.0, -1.0]);
        let [start, middle, end] = input.parabola([0.25, 0.75]);
        assert_eq!((start, end), (input.at(0.25), input.at(0.75)));
        let parts = 1000;
        let sum: f64 = (0..parts).map(|i| input.at(0.25 + (f64::from(i) + 0.5) / 2000.0)).sum();
        assert!(((start + 4.0 * middle + end) / 6.0 - sum / 1000.0).abs() < 1e-6);
        let line = InputPolynomial(LINEAR[1]);
        assert!((line.parabola([0.5, 1.0])[1] - 0.75).abs() < 1e-15);
    }

    #[test]
    fn bases_add_up_to_one_and_lines_pass_through_the_samples() {
        for intersample in [Intersample::Linear, Intersample::BandLimited] {
            for s in [0.0_f64, 0.4, 1.0] {
                let sum: f64 = basis(intersample)
                    .iter()
                    .map(|piece| piece.iter().enumerate().map(|(j, c)| c * s.powi(j as i32)).sum::<f64>())
                    .sum();
                assert!((sum - 1.0).abs() < 1e-14);
            }
        }
        let values = [1.0, 4.0, 9.0, 16.0];
        assert_eq!(coefficients(&values, 1..3, Intersample::Linear), [1.0, 4.0, 9.0]);
        assert_eq!(coefficients(&[3.0], 0..1, Intersample::BandLimited).len(), 6);
    }
}
