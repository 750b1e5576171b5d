//! What an input does between its samples: it is held, moves in straight lines, or is a spline that moves as a band-limited signal does.
//!
//! A tone at x rad per sample that is drawn in straight lines loses (sin(x/2)/(x/2))^2 of itself and gains images at
//! all frequencies that differ from it by the sampling rate, which excite the drivetrain too: at a seventh of the
//! sampling rate 6 % and 2.4 %. A spline of fifth degree has the sixth power instead of the second. Its
//! coefficients are the samples, sharpened by the inverse of what it takes from each tone; the images that stay have
//! (f/(1-f))^6 of a tone at f times the sampling rate: 1e-5 at a seventh, 1e-3 at a quarter.

use std::{ops::Range, sync::LazyLock};

use crate::Intersample;

/// Polynomials in the position between two samples, lowest power first: what one coefficient contributes.
type Piece = [f64; 6];

/// Straight lines: the sample before and the one after.
const LINEAR: [Piece; 2] = [[1.0, -1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]];

/// The cardinal B-spline of fifth degree, 120 times, from the coefficient two samples before the interval to the one three
/// samples after its start.
const QUINTIC: [Piece; 6] = [
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

/// The sample before, until the one after.
const HELD: [Piece; 2] = [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 6]];

/// Second differences that prefilter goes up to.
const POWERS: usize = 8;

/// What each coefficient about an interval contributes within it, the earliest first.
pub(crate) fn pieces(intersample: Intersample) -> Vec<Piece> {
    match intersample {
        Intersample::Hold => HELD.to_vec(),
        Intersample::Linear => LINEAR.to_vec(),
        Intersample::BandLimited => QUINTIC.iter().map(|piece| piece.map(|c| c / 120.0)).collect(),
    }
}

/// An input between two samples: a polynomial in the position between them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InputCourse(Piece);

impl InputCourse {
    /// From the coefficients about the interval.
    pub(crate) fn new(pieces: &[Piece], coefficients: &[f64]) -> Self {
        let mut sum = [0.0; 6];
        for (piece, coefficient) in pieces.iter().zip(coefficients) {
            sum.iter_mut().zip(piece).for_each(|(sum, c)| *sum += c * coefficient);
        }
        Self(sum)
    }

    pub(crate) fn at(&self, position: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * position + c)
    }

    /// Values at the start, the middle and the end of a part, of the parabola that has the same ends and the same mean over it.
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

/// Coefficients before the interval's first sample that matter within it, and as many after its last.
pub(crate) const fn margin(intersample: Intersample) -> usize {
    match intersample {
        Intersample::Hold | Intersample::Linear => 0,
        Intersample::BandLimited => QUINTIC.len() / 2 - 1,
    }
}

/// Samples to either side of some rows that their coefficients and the margin's depend on.
pub(crate) const fn reach(intersample: Intersample) -> usize {
    match intersample {
        Intersample::Hold | Intersample::Linear => 1,
        Intersample::BandLimited => POWERS + margin(intersample) + 1,
    }
}

/// Coefficients for the intervals that end at each of some rows of `values`: from [`margin`] + 1 before the first row to
/// [`margin`] after the last. Beyond its ends `values` is taken to go on point-symmetrically; a held input is what its first sample
/// says before that too.
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

/// What a sample contributes to the coefficients about it: from this many coefficients before it to as many after it.
pub(crate) fn prefilter(intersample: Intersample) -> Vec<f64> {
    match intersample {
        Intersample::Hold | Intersample::Linear => vec![1.0],
        Intersample::BandLimited => {
            let kernel = &*PREFILTER;
            (0..=2 * POWERS).map(|i| kernel[i.abs_diff(POWERS)]).collect()
        }
    }
}

/// The prefilter filter, from its middle on. In powers of d = 2 - 2 cos x = 4 sin^2(x/2) the inverse of
/// (sin(x/2)/(x/2))^2 is the square of arcsin(s)/s at s = sqrt(d)/2, that is 1 + d/12 + d^2/90 + ...; it is wanted to
/// the third power.
static PREFILTER: LazyLock<[f64; POWERS + 1]> = LazyLock::new(|| {
    let mut square = [1.0; POWERS + 1];
    for n in 1..=POWERS {
        // 2 (n!)^2 / (2n + 2)!, by the ratio of neighbours.
        let m = n as f64;
        square[n] = square[n - 1] * m * m / ((2.0 * m + 2.0) * (2.0 * m + 1.0));
    }
    let times = |a: &[f64; POWERS + 1], b: &[f64; POWERS + 1]| {
        std::array::from_fn(|n| (0..=n).map(|i| a[i] * b[n - i]).sum::<f64>())
    };
    let series = times(&times(&square, &square), &square);
    // d^n is 2 - shift - shift^-1 to the n: alternating binomials of 2n.
    let mut kernel = [0.0; POWERS + 1];
    for (n, weight) in series.iter().enumerate() {
        let mut binomial = 1.0;
        for i in 0..=n {
            // binomial(2n, i) stands n - i from the middle.
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
        let pieces = pieces(Intersample::BandLimited);
        for (x, tolerance) in [(0.3_f64, 5e-8), (0.6, 5e-6), (0.9, 1e-4)] {
            let tone = |t: f64| (x * t + 0.3).sin();
            let values: Vec<f64> = (0..60).map(|k| tone(f64::from(k))).collect();
            let all = coefficients(&values, 0..60, Intersample::BandLimited);
            for k in 20..40 {
                for s in [0.0_f64, 0.3, 0.5, 0.9] {
                    let value: f64 = (0..6)
                        .map(|m| (0..6).map(|j| pieces[m][j] * s.powi(j as i32)).sum::<f64>() * all[k + m])
                        .sum();
                    let error = value - tone(k as f64 - 1.0 + s);
                    assert!(error.abs() < tolerance, "{x} {k} {s}: {error}");
                }
            }
        }
    }

    #[test]
    fn a_parabola_keeps_ends_and_mean() {
        let course = InputCourse([1.0, 2.0, -3.0, 0.5, 1.0, -1.0]);
        let [start, middle, end] = course.parabola([0.25, 0.75]);
        assert_eq!((start, end), (course.at(0.25), course.at(0.75)));
        let parts = 1000;
        let sum: f64 = (0..parts).map(|i| course.at(0.25 + (f64::from(i) + 0.5) / 2000.0)).sum();
        assert!(((start + 4.0 * middle + end) / 6.0 - sum / 1000.0).abs() < 1e-6);
        let line = InputCourse(LINEAR[1]);
        assert!((line.parabola([0.5, 1.0])[1] - 0.75).abs() < 1e-15);
    }

    #[test]
    fn pieces_add_up_to_one_and_lines_to_the_samples() {
        for intersample in [Intersample::Linear, Intersample::BandLimited] {
            for s in [0.0_f64, 0.4, 1.0] {
                let sum: f64 = pieces(intersample)
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
