//! Transfer functions fitted to data over frequency.
//!
//! B(s)/A(s) starts from the iteration of Sanathanan and Koerner and ends at the maximum of the likelihood (Levenberg and
//! Marquardt), so that coefficients, modes and the final value have standard deviations.

mod denominator;
mod descent;
mod start;

use nalgebra::{Complex, DMatrix, DVector};

use crate::{
    FrequencyError, least_squares,
    polynomial::{self, Mode},
    response::Line,
};
use denominator::Denominator;

type C = Complex<f64>;

/// Highest order of a denominator.
pub const MOST: usize = 12;

/// Directions of the coefficients that move the response by less than this part of the most are not spoken of by the data.
const SPOKEN_OF: f64 = 1e-7;
/// Transfer functions whose description is so much longer than the shortest are no rivals of it (their weight is the exponential of
/// half of that).
const NO_RIVAL: f64 = 20.0;

/// One piece of data: A output = B input, within `std` of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Hz.
    pub frequency_hz: f64,
    /// What is put in; 1 where `output` is a response.
    pub input: Complex<f64>,
    /// What comes out.
    pub output: Complex<f64>,
    /// Root mean square of its complex error.
    pub std: f64,
    /// Complex degrees of freedom that `std` was estimated with, [`Line::freedom`]; infinite where it is known.
    pub freedom: f64,
}

impl Point {
    /// By how much more the coefficients' covariance has of this point than if `std` were known: a point whose noise is taken too small
    /// weighs too much (J. Schoukens et al., Automatica 33(6), 1997: (M - 2)/(M - 3) of M repetitions, which leave M - 1 degrees).
    fn over_weighed(&self) -> f64 {
        1.0 + 1.0 / (self.freedom.max(3.0) - 2.0)
    }
}

impl From<&Line> for Point {
    fn from(line: &Line) -> Self {
        Self {
            frequency_hz: line.frequency_hz,
            input: C::new(1.0, 0.0),
            output: line.response,
            // The variance was itself estimated, with so many complex degrees of freedom: errors over its root scatter like Student's t.
            std: (line.variance / (1.0 - 1.0 / line.freedom.max(2.0))).sqrt(),
            freedom: line.freedom,
        }
    }
}

/// Orders of a transfer function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Orders {
    /// Highest power of the numerator.
    pub numerator: usize,
    /// Highest power of the denominator.
    pub denominator: usize,
}

impl std::fmt::Display for Orders {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.numerator, self.denominator)
    }
}

/// B(s)/A(s), coefficients ascending.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    /// B.
    pub numerator: Vec<f64>,
    /// A.
    pub denominator: Vec<f64>,
}

impl TransferFunction {
    /// Value at a complex frequency, 1/s.
    #[must_use]
    pub fn at(&self, s: Complex<f64>) -> Complex<f64> {
        polynomial::value(&self.numerator, s) / polynomial::value(&self.denominator, s)
    }

    /// Response at a frequency.
    #[must_use]
    pub fn response(&self, frequency_hz: f64) -> Complex<f64> {
        self.at(C::new(0.0, std::f64::consts::TAU * frequency_hz))
    }

    /// Its response as a measurement: `count` lines from the lowest to the highest frequency, in equal ratios, each known to so large a
    /// part of itself.
    #[must_use]
    pub fn measured(&self, [low_hz, high_hz]: [f64; 2], count: u32, relative_std: f64) -> Vec<Point> {
        let line = |i: u32| {
            let part = f64::from(i) / f64::from(count.max(2) - 1);
            let frequency_hz = low_hz * (high_hz / low_hz).powf(part);
            let output = self.response(frequency_hz);
            let (input, std) = (C::new(1.0, 0.0), relative_std * output.norm());
            Point { frequency_hz, input, output, std, freedom: f64::INFINITY }
        };
        (0..count).map(line).collect()
    }

    /// Roots of A, 1/s.
    #[must_use]
    pub fn poles(&self) -> Vec<Complex<f64>> {
        polynomial::roots(&self.denominator)
    }

    /// Roots of B, 1/s.
    #[must_use]
    pub fn zeros(&self) -> Vec<Complex<f64>> {
        polynomial::roots(&self.numerator)
    }

    /// Where a unit step ends (the final-value theorem); without meaning where a pole is not stable.
    #[must_use]
    pub fn final_value(&self) -> f64 {
        self.numerator[0] / self.denominator[0]
    }
}

/// A mode with standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeEstimate {
    /// The mode.
    pub mode: Mode,
    /// Of its natural frequency, Hz.
    pub frequency_std_hz: f64,
    /// Of its damping ratio.
    pub damping_std: f64,
}

impl ModeEstimate {
    /// Whether its damping is told from none; that of a real pole needs no telling.
    fn is_damped(&self) -> bool {
        self.mode.pole.im == 0.0 || self.mode.damping_ratio.abs() > 1.96 * self.damping_std
    }
}

/// A fitted transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Its orders.
    pub orders: Orders,
    /// A is monic.
    pub transfer: TransferFunction,
    /// Standard deviations of the numerator's coefficients, ascending.
    pub numerator_std: Vec<f64>,
    /// Of the denominator's, the leading one 0.
    pub denominator_std: Vec<f64>,
    /// Modes, the slowest first.
    pub modes: Vec<ModeEstimate>,
    /// Standard deviation of the final value.
    pub final_value_std: f64,
    /// Mean square of residuals in units of their standard deviation; about 1 where orders suffice.
    pub misfit: f64,
    /// Whether the descent came to rest.
    pub converged: bool,
    /// Rissanen's description length up to a constant; the least of several orders is advised.
    pub description_length: f64,
    known: Known,
}

/// What is known of the coefficients: in powers of `unit`, denominator without its leading one, then numerator.
#[derive(Debug, Clone, PartialEq)]
struct Known {
    /// rad/s.
    unit: f64,
    denominator: Vec<f64>,
    numerator: Vec<f64>,
    covariance: DMatrix<f64>,
}

impl Fit {
    /// Standard deviations of the response's magnitude, relative to it, and of its phase, rad; as far as orders suffice.
    #[must_use]
    pub fn response_std(&self, frequency_hz: f64) -> [f64; 2] {
        let Known { unit, denominator, numerator, covariance } = &self.known;
        let s = C::new(0.0, std::f64::consts::TAU * frequency_hz / unit);
        let (below, above) = (polynomial::value(denominator, s), polynomial::value(numerator, s));
        // Slopes of ln B - ln A.
        let order = denominator.len() - 1;
        let slopes: Vec<C> = (0..order)
            .map(|i| -s.powu(i as u32) / below)
            .chain((0..numerator.len()).map(|i| s.powu(i as u32) / above))
            .collect();
        let std = |part: fn(&C) -> f64| {
            let gradient = DVector::from_iterator(slopes.len(), slopes.iter().map(part));
            gradient.dot(&(covariance * &gradient)).max(0.0).sqrt()
        };
        [std(|slope| slope.re), std(|slope| slope.im)]
    }
}

/// Fits orders to points.
///
/// With `stable`, every pole lies in the left half plane: those of a free fit that do not are mirrored, and the fit goes on from
/// there among stable ones only.
///
/// # Errors
/// [`FrequencyError::Orders`], [`FrequencyError::TooFewLines`], or [`FrequencyError::Singular`] where the data do not determine the
/// coefficients at all.
pub fn fit(points: &[Point], orders: Orders, stable: bool) -> Result<Fit, FrequencyError> {
    let Orders { numerator, denominator } = orders;
    if numerator > denominator || !(1..=MOST).contains(&denominator) {
        return Err(FrequencyError::Orders { numerator, denominator });
    }
    let unknowns = numerator + denominator + 1;
    if 2 * points.len() <= unknowns {
        return Err(FrequencyError::TooFewLines { lines: points.len(), unknowns });
    }
    let unit = unit(points);
    let scaled = Scaled { points, unit };
    let first = start::sanathanan_koerner(&scaled, orders)?;
    let free = descent::descend(&scaled, first);
    let best = if stable && !free.point.denominator.is_stable() {
        let mirrored = free.point.denominator.mirrored();
        descent::descend(&scaled, start::numerator_for(&scaled, mirrored, numerator)?)
    } else {
        free
    };
    report(&scaled, orders, &best)
}

/// Fits every order up to `most` for advice, numerators from none to one less than the denominator; the best first.
#[must_use]
pub fn advise(points: &[Point], most: usize, stable: bool) -> Vec<Fit> {
    let mut fits: Vec<Fit> = (1..=most.min(MOST))
        .flat_map(|denominator| (0..denominator).map(move |numerator| Orders { numerator, denominator }))
        .filter_map(|orders| fit(points, orders, stable).ok())
        .collect();
    fits.sort_by(|a, b| a.description_length.total_cmp(&b.description_length));
    // A resonance between two lines, as narrow as need be, can always be had, and fits the noise of one of them.
    let sound: Vec<Fit> =
        fits.iter().filter(|fit| fit.modes.iter().all(ModeEstimate::is_damped)).cloned().collect();
    if sound.is_empty() { fits } else { sound }
}

/// [`Fit::response_std`] of the first of [`advise`]d fits, which are weighed by their description lengths: what the others differ from
/// it counts, too (J. A. Hoeting et al., Bayesian model averaging, Statistical Science 14, 1999).
#[must_use]
pub fn response_std_among(fits: &[Fit], frequency_hz: f64) -> [f64; 2] {
    let Some(first) = fits.first() else { return [f64::INFINITY; 2] };
    let response = first.transfer.response(frequency_hz);
    let (mut total, mut squares) = (0.0, [0.0; 2]);
    for fit in fits {
        let longer = fit.description_length - first.description_length;
        if longer > NO_RIVAL {
            continue;
        }
        let weight = (-0.5 * longer).exp();
        let off = (fit.transfer.response(frequency_hz) / response).ln();
        let std = fit.response_std(frequency_hz);
        total += weight;
        squares[0] += weight * (std[0].powi(2) + off.re.powi(2));
        squares[1] += weight * (std[1].powi(2) + off.im.powi(2));
    }
    squares.map(|sum| (sum / total).sqrt())
}

/// Frequencies are taken in units of their geometric mean, so that powers are of one size.
fn unit(points: &[Point]) -> f64 {
    let logs = points.iter().map(|point| point.frequency_hz.max(1e-12).ln());
    std::f64::consts::TAU * (logs.sum::<f64>() / points.len() as f64).exp()
}

/// Points with frequencies in units.
struct Scaled<'a> {
    points: &'a [Point],
    /// rad/s.
    unit: f64,
}

impl Scaled<'_> {
    fn s(&self, index: usize) -> C {
        C::new(0.0, std::f64::consts::TAU * self.points[index].frequency_hz / self.unit)
    }
}

/// Numerator and denominator in units.
#[derive(Debug, Clone)]
struct Candidate {
    numerator: Vec<f64>,
    denominator: Denominator,
}

fn report(scaled: &Scaled<'_>, orders: Orders, best: &descent::Descent) -> Result<Fit, FrequencyError> {
    let denominator = best.point.denominator.coefficients();
    let order = orders.denominator;
    // What is known of the coefficients, however they were searched.
    let coefficients = Candidate {
        numerator: best.point.numerator.clone(),
        denominator: Denominator::Coefficients(denominator[..order].to_vec()),
    };
    let (residuals, slopes) = descent::linearised(scaled, &coefficients);
    let freedom = (2 * scaled.points.len()).saturating_sub(slopes.ncols()).max(1) as f64;
    let misfit = 2.0 * residuals.norm_squared() / freedom;
    // Each residual's real part has half of the variance; a misfit beyond noise widens all.
    let widened = 0.5 * misfit.max(1.0);
    let root = root_of_inverse(&slopes)?;
    let mut directions = &slopes * &root;
    for (row, mut direction) in directions.row_iter_mut().enumerate() {
        direction *= scaled.points[row % scaled.points.len()].over_weighed().sqrt();
    }
    let covariance = &root * (directions.transpose() * &directions) * root.transpose() * widened;
    // Powers of the unit: a_i s^i of s^n.
    let scale = |power: usize| scaled.unit.powi(order as i32 - power as i32);
    let physical = |coefficients: &[f64]| -> Vec<f64> {
        coefficients.iter().enumerate().map(|(i, c)| c * scale(i)).collect()
    };
    let stds: Vec<f64> = (0..covariance.nrows()).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect();
    let (a_std, b_std) = stds.split_at(order);
    let transfer =
        TransferFunction { numerator: physical(&best.point.numerator), denominator: physical(&denominator) };
    let (a0, b0) = (denominator[0], best.point.numerator[0]);
    let variance = covariance[(order, order)] / a0.powi(2) + covariance[(0, 0)] * (b0 / a0.powi(2)).powi(2)
        - 2.0 * covariance[(0, order)] * b0 / a0.powi(3);
    let count = (2 * scaled.points.len()) as f64;
    let unknowns = slopes.ncols() as f64;
    Ok(Fit {
        orders,
        modes: modes(&denominator, &covariance, scaled.unit),
        transfer,
        numerator_std: physical(b_std),
        denominator_std: [physical(a_std), vec![0.0]].concat(),
        final_value_std: variance.max(0.0).sqrt(),
        misfit,
        converged: best.converged,
        description_length: count * misfit.max(1e-300).ln() + unknowns * count.ln(),
        known: Known { unit: scaled.unit, denominator, numerator: best.point.numerator.clone(), covariance },
    })
}

/// R of (J^T J)^-1 = R R^T, without directions that the data say nothing of: where orders are too many, a pole runs off to infinity and moves no
/// response there, but would drown all else in rounding.
fn root_of_inverse(slopes: &DMatrix<f64>) -> Result<DMatrix<f64>, FrequencyError> {
    let singular = FrequencyError::Singular { what: "the transfer function" };
    let scales: Vec<f64> = slopes.column_iter().map(|c| c.norm()).collect();
    if scales.contains(&0.0) {
        return Err(singular);
    }
    let scaled = DMatrix::from_fn(slopes.nrows(), slopes.ncols(), |i, j| slopes[(i, j)] / scales[j]);
    let decomposed = scaled.qr().r().svd(false, true);
    let (Some(right), sizes) = (decomposed.v_t, decomposed.singular_values) else { return Err(singular) };
    let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > SPOKEN_OF * sizes.max()).collect();
    Ok(DMatrix::from_fn(right.ncols(), kept.len(), |j, k| right[(kept[k], j)] / (sizes[kept[k]] * scales[j])))
}

/// Modes and, by how the poles move with the coefficients, their standard deviations.
fn modes(denominator: &[f64], covariance: &DMatrix<f64>, unit: f64) -> Vec<ModeEstimate> {
    let order = denominator.len() - 1;
    let slopes: Vec<f64> = denominator.iter().enumerate().skip(1).map(|(i, c)| c * i as f64).collect();
    let estimate = |mode: Mode| {
        let pole = mode.pole;
        let steep = polynomial::value(&slopes, pole);
        // dp = -sum da_i p^i / A'(p).
        let moves: Vec<C> = (0..order).map(|i| -pole.powu(i as u32) / steep).collect();
        let size = pole.norm();
        let frequency = DVector::from_fn(order, |i, _| (pole.conj() * moves[i]).re / size);
        let damping =
            DVector::from_fn(order, |i, _| -moves[i].re / size + pole.re * frequency[i] / size.powi(2));
        let part = covariance.view((0, 0), (order, order));
        let std = |gradient: &DVector<f64>| (gradient.transpose() * part * gradient)[(0, 0)].max(0.0).sqrt();
        ModeEstimate {
            mode: Mode {
                pole: pole * unit,
                natural_frequency_hz: mode.natural_frequency_hz * unit,
                damping_ratio: mode.damping_ratio,
            },
            frequency_std_hz: std(&frequency) * unit / std::f64::consts::TAU,
            damping_std: if pole.im == 0.0 { 0.0 } else { std(&damping) },
        }
    };
    polynomial::modes(&polynomial::roots(denominator)).into_iter().map(estimate).collect()
}

/// Weighted linear least squares of complex rows as real ones.
fn real_rows(design: &DMatrix<C>, wanted: &DVector<C>) -> Result<DVector<f64>, FrequencyError> {
    let rows = design.nrows();
    let split = |value: C, row: usize| if row < rows { value.re } else { value.im };
    let stacked = DMatrix::from_fn(2 * rows, design.ncols(), |i, j| split(design[(i % rows, j)], i));
    let right = DVector::from_fn(2 * rows, |i, _| split(wanted[i % rows], i));
    least_squares::real(&stacked, &right, "the transfer function")
}

#[cfg(test)]
mod tests;
