//! Losses of a section from averaging windows: viscous, proportional to torque, and constant.

mod terms;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use socam_calibrate::Estimate;
use socam_calibrate::regression::{self, Regression};

use crate::{EfficiencyError, Section, windows::Window};
use terms::{Scaling, Term};

/// Number of neighbouring averaging windows with correlated errors: windows overlap by half, and model errors last longer than one.
const LAG: usize = 3;
/// Number of Gauss-Newton steps; only the torque share is nonlinear, and weakly.
const STEPS: usize = 6;
/// Columns whose independent part is smaller than this fraction count as linearly dependent.
const LEAST_OWN: f64 = 1e-4;
/// Correlation above which two estimates cannot be distinguished.
const ENTANGLED: f64 = 0.95;

/// Relative standard uncertainties of sensors' gains, standard uncertainties of their zeros (SI), by channel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensorStd {
    /// Relative standard uncertainty of the gain.
    pub gain: Option<f64>,
    /// Standard uncertainty of the zero, in the channel's unit.
    pub offset: Option<f64>,
}

/// Uncertainties of the section's sensors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensors {
    /// Torque in.
    pub torque_in: SensorStd,
    /// Torque out.
    pub torque_out: SensorStd,
    /// Speed in.
    pub speed_in: SensorStd,
    /// Speed out.
    pub speed_out: SensorStd,
}

/// Losses on the input side: T_in - T_out / N = torque_share |T_in| + viscous w + constant, in the direction of motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Losses {
    /// Fraction of the input torque that is lost, 1.
    pub torque_share: Option<Estimate>,
    /// N m s/rad at the input.
    pub viscous: Option<Estimate>,
    /// N m at the input.
    pub constant: Option<Estimate>,
    /// Pairs of losses that these recordings cannot distinguish.
    pub entangled: Vec<[&'static str; 2]>,
    /// Estimated inertia, kg m2 at the input, in addition to the model's prior.
    pub inertia: Option<Estimate>,
    /// Standard deviation of the residuals of averaging windows, N m.
    pub residual_std: f64,
    /// Number of averaging windows.
    #[serde(rename = "moments")]
    pub windows: usize,
    #[serde(skip)]
    fitted: Fitted,
}

/// The regression with the terms of its coefficients.
#[derive(Debug, Clone, PartialEq)]
struct Fitted {
    regression: Regression,
    /// The terms, in the order of the coefficients.
    terms: Vec<Term>,
}

impl Losses {
    /// Fits the losses to averaging windows. A sensor's gain without known uncertainty counts as exact. A zero without known uncertainty is estimated
    /// if there is motion in both directions, which distinguishes it from a constant loss; otherwise it counts as exact.
    ///
    /// Windows are those of [`crate::windows::substantial`].
    ///
    /// # Assumes
    /// The three laws, and torque sensors of equal bandwidth. Other losses increase `residual_std` and widen the intervals, whose covariance
    /// allows for correlated residuals.
    ///
    /// # Errors
    /// When there are too few windows.
    pub fn of(windows: &[Window], section: &Section, sensors: &Sensors) -> Result<Self, EfficiencyError> {
        let too_few = || EfficiencyError::TooFew { windows: windows.len() };
        if windows.len() < 12 {
            return Err(too_few());
        }
        let wanted = candidates(windows, section, sensors);
        let kept = independent(windows, &wanted);
        let terms: Vec<Term> = kept.iter().map(|(term, _)| *term).collect();
        let known: Vec<_> = kept.iter().map(|(_, known)| *known).collect();
        let regression = regress(windows, &terms, &known, section.share_before).ok_or_else(too_few)?;
        let fitted = Fitted { regression, terms };
        let estimate = |term| fitted.estimate(term);
        Ok(Self {
            torque_share: estimate(Term::Share),
            viscous: estimate(Term::Viscous),
            constant: estimate(Term::Constant),
            inertia: estimate(Term::Inertia),
            entangled: fitted.entangled(),
            residual_std: fitted.regression.residual_std,
            windows: windows.len(),
            fitted,
        })
    }

    /// Efficiency at a speed (rad/s, not negative) and a torque in (N m, positive), both at the input.
    #[must_use]
    pub fn efficiency(&self, speed: f64, torque: f64) -> Estimate {
        let slope = |term: &Term| match term {
            Term::Share => -1.0,
            Term::Viscous => -speed / torque,
            Term::Constant => -1.0 / torque,
            _ => 0.0,
        };
        let slopes: Vec<f64> = self.fitted.terms.iter().map(slope).collect();
        let lost: f64 = slopes.iter().zip(&self.fitted.regression.coefficients).map(|(s, c)| s * c).sum();
        let std = self.fitted.regression.std_of(&slopes);
        Estimate::new(1.0 + lost, std, self.fitted.regression.degrees_of(&slopes))
    }
}

impl Fitted {
    fn estimate(&self, term: Term) -> Option<Estimate> {
        let index = self.terms.iter().position(|known| *known == term)?;
        let regression = &self.regression;
        let unit: Vec<f64> = (0..self.terms.len()).map(|i| f64::from(u8::from(i == index))).collect();
        let degrees = regression.degrees_of(&unit);
        Some(Estimate::new(regression.coefficients[index], regression.std(index), degrees))
    }

    fn entangled(&self) -> Vec<[&'static str; 2]> {
        let losses: Vec<usize> = (0..self.terms.len())
            .filter(|i| matches!(self.terms[*i], Term::Share | Term::Viscous | Term::Constant))
            .collect();
        let covariance = &self.regression.covariance;
        let all = (0..self.terms.len()).flat_map(|j| losses.iter().map(move |i| (*i, j)));
        all.filter(|(i, j)| if losses.contains(j) { i < j } else { true })
            .filter(|(i, j)| {
                let size = (covariance[(*i, *i)] * covariance[(*j, *j)]).sqrt();
                covariance[(*i, *j)].abs() > ENTANGLED * size
            })
            .map(|(i, j)| [self.terms[i].name(), self.terms[j].name()])
            .collect()
    }
}

/// A term, and what is known of its coefficient: value and standard deviation.
type Candidate = (Term, Option<(f64, f64)>);

/// The terms that the losses of a section may consist of.
fn candidates(windows: &[Window], section: &Section, sensors: &Sensors) -> Vec<Candidate> {
    let zero_std = sensors.torque_in.offset.zip(sensors.torque_out.offset);
    let zero_std = zero_std.map(|(a, b)| a.hypot(b / section.ratio));
    let both_ways = windows.iter().any(|m| m.direction > 0.0) && windows.iter().any(|m| m.direction < 0.0);
    let inertia = section.inertia.max(1e-9);
    let mut wanted: Vec<Candidate> = vec![
        (Term::Inertia, Some((inertia, 0.3 * inertia))),
        (Term::Twist, None),
        (Term::Viscous, None),
        (Term::Constant, None),
        (Term::Share, None),
    ];
    let known = |term, std: Option<f64>| std.filter(|std| *std > 0.0).map(|std| (term, Some((0.0, std))));
    wanted.extend(known(Term::GainIn, sensors.torque_in.gain));
    wanted.extend(known(Term::GainOut, sensors.torque_out.gain));
    match zero_std {
        Some(std) => wanted.extend(known(Term::Zero, Some(std))),
        None if both_ways => wanted.push((Term::Zero, None)),
        None => {}
    }
    wanted
}

/// Fits the terms by Gauss-Newton steps.
fn regress(
    windows: &[Window],
    terms: &[Term],
    known: &[Option<(f64, f64)>],
    share_before: f64,
) -> Option<Regression> {
    let measured = DVector::from_iterator(windows.len(), windows.iter().map(|m| m.torque_in - m.torque_out));
    let at = terms.iter().position(|term| *term == Term::Share);
    let mut regression: Option<Regression> = None;
    for _ in 0..STEPS {
        let values = regression.as_ref().map_or(vec![0.0; terms.len()], |r| r.coefficients.clone());
        let share = at.map_or(0.0, |at| values[at].clamp(0.0, 0.9));
        let mut design = DMatrix::zeros(windows.len(), terms.len());
        let mut wanted = measured.clone();
        for (row, window) in windows.iter().enumerate() {
            let scaling = Scaling::of(window, share, share_before);
            let mut slope = 0.0;
            for (column, (term, value)) in terms.iter().zip(&values).enumerate() {
                design[(row, column)] = term.column(window, scaling);
                slope += value * term.slope(window, scaling);
            }
            // The share also scales the other losses: this derivative carries its uncertainty over to theirs.
            if let Some(at) = at {
                design[(row, at)] += slope;
                wanted[row] += slope * share;
            }
        }
        regression = Some(regression::with_knowledge(&design, &wanted, known, LAG)?);
    }
    regression
}

/// Linearly independent terms; terms with prior knowledge are always kept.
fn independent(windows: &[Window], wanted: &[Candidate]) -> Vec<Candidate> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut kept = Vec::new();
    for (term, known) in wanted {
        let column = DVector::from_iterator(
            windows.len(),
            windows.iter().map(|window| term.column(window, Scaling::of(window, 0.0, 0.0))),
        );
        let size = column.norm();
        let mut own = column;
        for direction in &basis {
            let along = direction.dot(&own);
            own -= direction * along;
        }
        if known.is_some() {
            kept.push((*term, *known));
        } else if size > 0.0 && own.norm() > LEAST_OWN * size {
            basis.push(&own / own.norm());
            kept.push((*term, *known));
        }
    }
    kept
}
