//! A straight line through pairs, with a test of its linearity.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::CalibrateError;
use crate::regression::{self, Regression};

/// Least number of rows for a test of linearity by a cubic.
const ENOUGH_FOR_A_CURVE: usize = 8;
/// Least relative range of x.
const LEAST_SPREAD: f64 = 1e-6;

/// A number with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard uncertainty.
    pub std: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

impl Estimate {
    /// Estimate from a value, its standard deviation and the degrees of freedom of that.
    #[must_use]
    pub fn new(value: f64, std: f64, degrees: f64) -> Self {
        let half = regression::quantile95(degrees) * std;
        Self { value, std, ci95: [value - half, value + half] }
    }

    /// The estimate multiplied by `factor`, such as a conversion to another unit.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let ends = self.ci95.map(|end| end * factor);
        Self {
            value: self.value * factor,
            std: self.std * factor.abs(),
            ci95: [ends[0].min(ends[1]), ends[0].max(ends[1])],
        }
    }

    /// Whether a number lies within the interval.
    #[must_use]
    pub fn holds(&self, truth: f64) -> bool {
        (self.ci95[0]..=self.ci95[1]).contains(&truth)
    }
}

/// Largest departure of a cubic through the pairs from the line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Nonlinearity {
    /// Departure in per cent of the span of what was measured.
    pub percent_of_span: Estimate,
    /// Position of the largest departure, in the unit of x.
    pub at: f64,
    /// Probability of a departure at least as large if the truth is a straight line.
    pub chance: f64,
}

/// y = offset + gain x.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Slope.
    pub gain: Estimate,
    /// Value of y at x = 0.
    pub offset: Estimate,
    /// Correlation of both errors.
    pub correlation: f64,
    /// Scatter about it, in the unit of y.
    pub residual_std: f64,
    /// Pairs, outliers included.
    pub points: usize,
    /// Indices of outlying pairs, from 0.
    pub outliers: Vec<usize>,
    /// `None` where the pairs are too few to tell.
    pub nonlinearity: Option<Nonlinearity>,
    /// Least and greatest x.
    pub range: [f64; 2],
    /// The pairs.
    #[serde(skip)]
    pub pairs: Vec<[f64; 2]>,
}

impl Line {
    /// Fits a line to pairs (x, y). `gain_accuracy` is the relative standard uncertainty common to all x, that of the reference
    /// instrument: it widens the uncertainty of the gain and does not scatter.
    ///
    /// # Assumes
    /// Errors are in y; those in x are small against its range. Errors in x of 1/100 of its standard deviation over the pairs bias the
    /// gain by -1/10 000.
    ///
    /// # Errors
    /// When there are too few pairs, or no two different x.
    pub fn through(
        what: &str,
        over: &str,
        pairs: &[[f64; 2]],
        gain_accuracy: f64,
    ) -> Result<Self, CalibrateError> {
        let too_few = || CalibrateError::TooFew { what: what.into(), rows: pairs.len() };
        if pairs.len() < 4 {
            return Err(too_few());
        }
        let (low, high) = pairs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), pair| {
            (low.min(pair[0]), high.max(pair[0]))
        });
        let largest = low.abs().max(high.abs());
        if high - low <= LEAST_SPREAD * largest {
            return Err(CalibrateError::NoSpread { what: what.into(), over: over.into() });
        }
        // x scaled to -1..1, so that the columns of the design are of similar size.
        let (middle, half) = (f64::midpoint(low, high), 0.5 * (high - low));
        let scaled = |x: f64| (x - middle) / half;
        let measured = DVector::from_iterator(pairs.len(), pairs.iter().map(|pair| pair[1]));
        let design = |columns: usize| {
            DMatrix::from_fn(pairs.len(), columns, |i, j| scaled(pairs[i][0]).powi(j as i32))
        };
        let is_many = pairs.len() >= ENOUGH_FOR_A_CURVE + 2;
        // Outliers are sought about a cubic: the ends of a curve must not count as outliers of a line.
        let sought = if is_many { 4 } else { 2 };
        let curve = regression::robust(&design(sought), &measured).ok_or_else(too_few)?;
        let outliers = curve.outliers.clone();
        let inside: Vec<usize> = (0..pairs.len()).filter(|row| !outliers.contains(row)).collect();
        let own = measured.select_rows(&inside);
        let line = regression::plain(&design(2).select_rows(&inside), &own).ok_or_else(too_few)?;
        let nonlinearity = (inside.len() >= ENOUGH_FOR_A_CURVE)
            .then(|| regression::plain(&design(4).select_rows(&inside), &own))
            .flatten()
            .map(|curve| {
                nonlinearity(&curve, &inside.iter().map(|row| scaled(pairs[*row][0])).collect::<Vec<_>>())
            })
            .map(|bent| Nonlinearity { at: middle + half * bent.at, ..bent });
        let (gain, offset, correlation) = gain_and_offset(&line, middle, half, gain_accuracy);
        Ok(Self {
            gain,
            offset,
            correlation,
            residual_std: line.residual_std,
            points: pairs.len(),
            outliers,
            nonlinearity,
            range: [low, high],
            pairs: pairs.to_vec(),
        })
    }

    /// y at x.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.offset.value + self.gain.value * x
    }
}

/// Gain, offset and the correlation of their errors, from a line over (x - `middle`) / `half`.
fn gain_and_offset(
    line: &Regression,
    middle: f64,
    half: f64,
    gain_accuracy: f64,
) -> (Estimate, Estimate, f64) {
    let gain = line.coefficients[1] / half;
    let statistical = line.std(1) / half;
    let shared = gain_accuracy * gain.abs();
    let std = statistical.hypot(shared);
    // Degrees of freedom by Welch and Satterthwaite; the common uncertainty counts as known.
    let degrees = line.degrees * (std / statistical.max(f64::MIN_POSITIVE)).powi(4);
    let to_zero = [1.0, -middle / half];
    let offset = line.coefficients[0] + to_zero[1] * line.coefficients[1];
    let offset_std = line.std_of(&to_zero);
    let covariance = (line.covariance[(0, 1)] + to_zero[1] * line.covariance[(1, 1)]) / half;
    (
        Estimate::new(gain, std, degrees),
        Estimate::new(offset, offset_std, line.degrees),
        covariance / (std * offset_std).max(f64::MIN_POSITIVE),
    )
}

/// The largest departure of a cubic over -1..1 from the line closest to it at the pairs.
fn nonlinearity(curve: &Regression, places: &[f64]) -> Nonlinearity {
    let bends = |power: i32| {
        let design = DMatrix::from_fn(places.len(), 2, |i, j| places[i].powi(j as i32));
        let column = DVector::from_iterator(places.len(), places.iter().map(|u| u.powi(power)));
        let line = regression::plain(&design, &column).map_or(vec![0.0; 2], |fit| fit.coefficients);
        move |u: f64| u.powi(power) - line[0] - line[1] * u
    };
    let (square, cube) = (bends(2), bends(3));
    let weights = |u: f64| [0.0, 0.0, square(u), cube(u)];
    let departure = |u: f64| weights(u).iter().zip(&curve.coefficients).map(|(w, c)| w * c).sum::<f64>();
    let all = (0..=100).map(|k| -1.0 + 0.02 * f64::from(k));
    let at = all.max_by(|a, b| departure(*a).abs().total_cmp(&departure(*b).abs())).unwrap_or(0.0);
    let to_percent = 100.0 / (2.0 * curve.coefficients[1].abs()).max(f64::MIN_POSITIVE);
    let estimate = Estimate::new(departure(at), curve.std_of(&weights(at)), curve.degrees);
    Nonlinearity { percent_of_span: estimate.times(to_percent), at, chance: curve.chance_of_none(&[2, 3]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A repeating scatter in place of random numbers.
    fn pairs(bend: f64) -> Vec<[f64; 2]> {
        let y = |x: f64, i: usize| 0.02 + 0.07 * x + bend * x * x + 1e-3 * [1.0, -1.0, 0.5, -0.5, 0.0][i % 5];
        (0..25).map(|i| (10.0 * i as f64, i)).map(|(x, i)| [x, y(x, i)]).collect()
    }

    #[test]
    fn a_line_has_its_gain_offset_and_the_instruments_accuracy() {
        let line = Line::through("a", "x", &pairs(0.0), 0.0).unwrap();
        assert!((line.gain.value - 0.07).abs() < 5e-6 && (line.offset.value - 0.02).abs() < 1e-3);
        assert!(line.gain.holds(0.07) && line.offset.holds(0.02) && line.outliers.is_empty());
        assert!(line.correlation < -0.8);
        assert!(line.nonlinearity.unwrap().chance > 0.05);
        let shared = Line::through("a", "x", &pairs(0.0), 0.01).unwrap();
        assert!((shared.gain.std / shared.gain.value - 0.01).abs() < 1e-5);
        assert!(Line::through("a", "x", &pairs(0.0)[..3], 0.0).is_err());
        assert!(Line::through("a", "x", &[[1.0, 2.0]; 9], 0.0).unwrap_err().to_string().contains("same x"));
    }

    #[test]
    fn a_bend_is_seen_and_measured() {
        // A parabola departs from its best line by bend * span^2 / 8 about, over a span of 0.07 * 240.
        let bent = Line::through("a", "x", &pairs(1e-5), 0.0).unwrap().nonlinearity.unwrap();
        assert!(bent.chance < 1e-6);
        let expected = 100.0 * 1e-5 * 240.0 * 240.0 / 6.0 / (0.07 * 240.0);
        assert!((bent.percent_of_span.value.abs() / expected - 1.0).abs() < 0.25, "{bent:?} {expected}");
    }
}
