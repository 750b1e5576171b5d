//! What may stand behind readings that break a tie: one effect at a time, fitted by least squares.

use nalgebra::{DMatrix, DVector};
use socam_model::{
    Model,
    effects::{Acts, ActsAt, CATALOGUE, Effect, EffectParameter, Form, LawInput, Steady},
};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

use super::ties::{Kind, Tie};

/// Readings of a tie at the points that have both.
#[derive(Debug, Clone, Default)]
pub(super) struct Readings {
    /// SI.
    pub(super) first: Vec<f64>,
    /// SI.
    pub(super) second: Vec<f64>,
    /// Speed at the second's place, rad/s; NaN where not measured.
    pub(super) speed: Vec<f64>,
}

/// Which reading an explanation multiplies: its uncertainty is multiplied too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum On {
    First,
    Second,
    Neither,
}

/// An effect at a place, and what it would do to the tie's error for each unit of its coefficient.
#[derive(Debug, Clone)]
pub(super) struct Explanation {
    pub(super) effect: &'static Effect,
    pub(super) place: String,
    pub(super) parameter: &'static str,
    /// Place in the list of explanations.
    pub(super) rank: usize,
    x: Vec<f64>,
    on: On,
    value: fn(f64) -> f64,
}

/// How well it does.
#[derive(Debug, Clone)]
pub(super) struct FittedModel {
    /// Coefficients of the base, then of the explanation.
    coefficients: Vec<f64>,
    std: Vec<f64>,
    /// Half-widths of 95 % intervals in `std`.
    quantile: f64,
    pub(super) chi2: f64,
    /// Chance of as much by the readings' own scatter.
    pub(super) p_value: f64,
    /// What is left at each point, in units of its uncertainty.
    pub(super) left: Vec<f64>,
    /// What is left at each point, in units of the error.
    pub(super) residual: Vec<f64>,
}

impl Explanation {
    /// Value of the effect's parameter and its 95 % interval, SI.
    pub(super) fn estimate(&self, fitted: &FittedModel) -> (f64, [f64; 2]) {
        let last = fitted.coefficients.len() - 1;
        let (theta, half) = (fitted.coefficients[last], fitted.quantile * fitted.std[last]);
        let mut ends = [(self.value)(theta - half), (self.value)(theta + half)];
        ends.sort_by(f64::total_cmp);
        ((self.value)(theta), ends)
    }

    /// Whether a parameter may have such a value.
    pub(super) fn is_possible(&self, fitted: &FittedModel) -> bool {
        let own = self.effect.parameters.iter().find(|own| own.name == self.parameter);
        let (low, high) = own.map_or((f64::NEG_INFINITY, f64::INFINITY), |own| own.bounds);
        (low..=high).contains(&self.estimate(fitted).0)
    }

    /// Change of the parameter that moves the sum of squares by one.
    pub(super) fn resolution(&self, fitted: &FittedModel) -> f64 {
        let last = fitted.std.len() - 1;
        ((self.value)(fitted.std[last]) - (self.value)(0.0)).abs()
    }
}

/// The error of a tie, what of the model may follow it, and how uncertain it is.
pub(super) struct Case<'a> {
    tie: &'a Tie,
    readings: &'a Readings,
    /// Relative standard uncertainty of a reading.
    repeatability: f64,
    /// Error: what the tie leaves of the readings.
    pub(super) error: Vec<f64>,
    /// Viscous dampings that the model leaves free, by parameter, and their columns.
    pub(super) base: Vec<(usize, Vec<f64>)>,
}

impl<'a> Case<'a> {
    pub(super) fn new(model: &Model, tie: &'a Tie, readings: &'a Readings, repeatability: f64) -> Self {
        let both = || readings.first.iter().zip(&readings.second);
        let mut error: Vec<f64> = match tie.kind {
            Kind::Speeds => both().map(|(first, second)| (first / (tie.ratio * second)).ln()).collect(),
            Kind::Torques => both().map(|(first, second)| tie.ratio * first - second).collect(),
            Kind::Load => readings.first.clone(),
        };
        let mut base: Vec<(usize, Vec<f64>)> = Vec::new();
        for (bearing, weight) in tie.bearings.iter().filter(|_| tie.kind != Kind::Speeds) {
            let Some(damping) = model.bearings[*bearing].damping else { continue };
            let drag: Vec<f64> = readings.speed.iter().map(|speed| weight * weight * speed).collect();
            if model.parameters[damping].fixed {
                error.iter_mut().zip(&drag).for_each(|(e, d)| *e -= model.parameters[damping].value * d);
            } else if drag.iter().all(|d| d.is_finite()) {
                match base.iter_mut().find(|(known, _)| *known == damping) {
                    Some((_, column)) => column.iter_mut().zip(&drag).for_each(|(sum, d)| *sum += d),
                    None => base.push((damping, drag)),
                }
            }
        }
        Self { tie, readings, repeatability, error, base }
    }

    /// Standard uncertainty of each point's error.
    fn uncertainty(&self, on: On, theta: f64) -> Vec<f64> {
        let [first, second] = [
            if on == On::First { 1.0 - theta } else { 1.0 },
            if on == On::Second { 1.0 + theta } else { 1.0 },
        ];
        let both = self.readings.first.iter().zip(&self.readings.second);
        let size = |(a, b): (&f64, &f64)| match self.tie.kind {
            Kind::Speeds => std::f64::consts::SQRT_2,
            Kind::Torques => (first * self.tie.ratio * a).hypot(second * b),
            Kind::Load => a.abs(),
        };
        let sizes: Vec<f64> = both.map(size).collect();
        // What reads next to nothing is not for that known next to exactly.
        let least = 0.05 * sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
        sizes.iter().map(|size| self.repeatability * size.max(least).max(f64::MIN_POSITIVE)).collect()
    }

    /// Least squares, with the base's dampings kept within their bounds; `None` where the points do not suffice.
    pub(super) fn fit(
        &self,
        model: &Model,
        explanation: Option<&Explanation>,
        without: Option<usize>,
    ) -> Option<FittedModel> {
        let mut held: Vec<Option<f64>> = vec![None; self.base.len()];
        loop {
            let fitted = self.fit_held(explanation, &held, without)?;
            let outside = (0..self.base.len()).find_map(|k| {
                let (low, high) = model.parameters[self.base[k].0].bounds;
                let own = fitted.coefficients[k];
                (held[k].is_none() && !(low..=high).contains(&own)).then(|| (k, own.clamp(low, high)))
            });
            match outside {
                Some((k, bound)) => held[k] = Some(bound),
                None => return Some(fitted),
            }
        }
    }

    fn fit_held(
        &self,
        explanation: Option<&Explanation>,
        held: &[Option<f64>],
        without: Option<usize>,
    ) -> Option<FittedModel> {
        let n = self.error.len();
        let columns: Vec<&[f64]> = self
            .base
            .iter()
            .map(|(_, column)| column.as_slice())
            .chain(explanation.map(|own| own.x.as_slice()))
            .collect();
        let free: Vec<usize> =
            (0..columns.len()).filter(|k| held.get(*k).copied().flatten().is_none()).collect();
        let rows: Vec<usize> = (0..n).filter(|row| Some(*row) != without).collect();
        if rows.len() < free.len() || rows.is_empty() {
            return None;
        }
        let on = explanation.map_or(On::Neither, |own| own.on);
        let mut coefficients: Vec<f64> =
            (0..columns.len()).map(|k| held.get(k).copied().flatten().unwrap_or(0.0)).collect();
        let mut std = vec![0.0; columns.len()];
        // What multiplies a reading multiplies its uncertainty: a few rounds settle that.
        let rounds = if on == On::Neither { 1 } else { 5 };
        let mut sigma = self.uncertainty(on, 0.0);
        for _ in 0..rounds {
            let known = |row: usize| {
                let fixed = (0..columns.len()).filter(|k| !free.contains(k));
                self.error[row] - fixed.map(|k| columns[k][row] * coefficients[k]).sum::<f64>()
            };
            if !free.is_empty() {
                let matrix = DMatrix::from_fn(rows.len(), free.len(), |i, j| {
                    columns[free[j]][rows[i]] / sigma[rows[i]]
                });
                let right = DVector::from_fn(rows.len(), |i, _| known(rows[i]) / sigma[rows[i]]);
                // Columns of very different size are all the same to it once they have length one.
                let lengths: Vec<f64> = (0..free.len()).map(|j| matrix.column(j).norm()).collect();
                if lengths.iter().any(|length| !length.is_normal()) {
                    return None;
                }
                let scaled = DMatrix::from_fn(rows.len(), free.len(), |i, j| matrix[(i, j)] / lengths[j]);
                let svd = scaled.svd(true, true);
                if svd.singular_values.min() < 1e-9 {
                    return None;
                }
                let solution = svd.solve(&right, 0.0).ok()?;
                let turned = svd.v_t.as_ref()?;
                for (j, k) in free.iter().enumerate() {
                    coefficients[*k] = solution[j] / lengths[j];
                    let spread = (0..free.len()).map(|s| turned[(s, j)] / svd.singular_values[s]);
                    std[*k] = spread.map(|own| own * own).sum::<f64>().sqrt() / lengths[j];
                }
            }
            sigma = self.uncertainty(on, coefficients.last().copied().unwrap_or(0.0));
        }
        let model = |row: usize| columns.iter().zip(&coefficients).map(|(x, c)| x[row] * c).sum::<f64>();
        let residual: Vec<f64> = (0..n).map(|row| self.error[row] - model(row)).collect();
        let left: Vec<f64> = residual.iter().zip(&sigma).map(|(r, s)| r / s).collect();
        let chi2: f64 = rows.iter().map(|row| left[*row] * left[*row]).sum();
        let degrees = (rows.len() - free.len()) as f64;
        let p_value = ChiSquared::new(degrees).map_or(1.0, |noise| noise.sf(chi2));
        // Where more scatters than the readings are said to, intervals follow the scatter.
        let wider = if degrees > 0.0 { chi2 / degrees } else { 0.0 };
        let quantile = if wider > 1.0 {
            StudentsT::new(0.0, 1.0, degrees).map_or(1.96, |t| t.inverse_cdf(0.975)) * wider.sqrt()
        } else {
            1.96
        };
        Some(FittedModel { coefficients, std, quantile, chi2, p_value, left, residual })
    }

    /// Value and 95 % interval of the base's dampings.
    pub(super) fn dampings(&self, fitted: &FittedModel) -> Vec<(usize, f64, [f64; 2])> {
        let each = self.base.iter().enumerate().map(|(k, (parameter, _))| {
            let (value, half) = (fitted.coefficients[k], fitted.quantile * fitted.std[k]);
            (*parameter, value, [value - half, value + half])
        });
        each.collect()
    }

    /// All effects of the catalogue that show in a steady state and could break the tie; plant first.
    pub(super) fn explanations(&self, model: &Model) -> Vec<Explanation> {
        let mut all: Vec<Explanation> = Vec::new();
        for acts_at in [ActsAt::Gear, ActsAt::Bearing, ActsAt::Node, ActsAt::Channel] {
            let shown = CATALOGUE.iter().copied().filter(|own| own.steady == Steady::Linear);
            for effect in shown.filter(|own| own.acts_at == acts_at) {
                for (place, Column { x, on, value }) in self.columns(model, effect) {
                    if x.iter().all(|x| x.is_finite()) {
                        let (parameter, rank) = (effect.amplitude.parameters[0], all.len());
                        all.push(Explanation { effect, place, parameter, rank, x, on, value });
                    }
                }
            }
        }
        all
    }

    /// What a unit of an effect's amplitude does to the error at each of its places.
    fn columns(&self, model: &Model, effect: &'static Effect) -> Vec<(String, Column)> {
        let Self { tie, readings, .. } = self;
        let channels = [tie.second, tie.first].map(|channel| model.channels[channel].name.clone());
        match (effect.form, tie.kind) {
            (Form::Gain, Kind::Load) => Vec::new(),
            (Form::Gain, kind) => channels.into_iter().zip(self.gains(kind)).collect(),
            (Form::Laws(laws), kind) if laws[0].acts == Acts::Reading => {
                // One torque beside drag only has one sensor.
                let [second, first] = self.offsets(kind, effect);
                let sensors = channels.into_iter().zip([second, first]);
                sensors.skip(usize::from(kind == Kind::Load)).collect()
            }
            (_, Kind::Speeds) => Vec::new(),
            (Form::Laws(laws), _) => {
                let on = if laws[0].law_inputs.contains(&LawInput::Torque) { On::First } else { On::Neither };
                let column = |weight: f64| {
                    let points = readings.first.iter().zip(&readings.speed);
                    let each = points
                        .map(|(torque, speed)| -weight * answer(effect, tie.ratio * torque, weight * speed));
                    Column { x: each.collect(), on, value: |theta| theta }
                };
                self.weights(model, effect)
                    .into_iter()
                    .map(|(place, weight)| (place, column(weight)))
                    .collect()
            }
            _ => Vec::new(),
        }
    }

    /// Places between the readings at which an effect of the plant may act, and their speed over that at the second reading.
    fn weights(&self, model: &Model, effect: &Effect) -> Vec<(String, f64)> {
        let tie = self.tie;
        let bearings = tie.bearings.iter().map(|(own, weight)| (model.bearings[*own].name.clone(), *weight));
        match effect.acts_at {
            // Taken from what enters, on the slow side.
            ActsAt::Gear => tie.gears.iter().map(|gear| (model.gears[*gear].name.clone(), 1.0)).collect(),
            ActsAt::Bearing => bearings.collect(),
            ActsAt::Node if tie.kind == Kind::Load => {
                let massive = tie.nodes.iter().rfind(|(node, _)| model.nodes[*node].inertia.is_some());
                massive.map(|(node, weight)| (model.nodes[*node].name.clone(), *weight)).into_iter().collect()
            }
            _ => Vec::new(),
        }
    }

    /// Gains of the second and the first sensor.
    fn gains(&self, kind: Kind) -> [Column; 2] {
        let Self { tie, readings, .. } = self;
        let constant = |height: f64| vec![height; readings.first.len()];
        if kind == Kind::Speeds {
            return [-1.0, 1.0].map(|sign| Column { x: constant(sign), on: On::Neither, value: f64::exp });
        }
        let entering = readings.first.iter().map(|torque| tie.ratio * torque).collect();
        [
            Column { x: readings.second.clone(), on: On::Second, value: |theta| 1.0 / (1.0 + theta) },
            Column { x: entering, on: On::First, value: |theta| 1.0 / (1.0 - theta) },
        ]
    }

    /// What is added to the readings of the second and the first sensor.
    fn offsets(&self, kind: Kind, effect: &Effect) -> [Column; 2] {
        let Self { tie, readings, .. } = self;
        let own = answer(effect, 0.0, 0.0);
        let [second, first]: [Vec<f64>; 2] = match kind {
            Kind::Speeds => [
                readings.second.iter().map(|value| -own / value).collect(),
                readings.first.iter().map(|value| own / value).collect(),
            ],
            _ => [vec![-own; readings.first.len()], vec![own * tie.ratio; readings.first.len()]],
        };
        [second, first].map(|x| Column { x, on: On::Neither, value: |theta| theta })
    }
}

/// What a unit of an amplitude does to a tie's error at each point, which reading's uncertainty it multiplies, and the amplitude of a
/// coefficient.
struct Column {
    x: Vec<f64>,
    on: On,
    value: fn(f64) -> f64,
}

/// What an effect of one law answers to a steady state with its amplitude at one. Of a motion whose speed was not measured it is taken to
/// be forward, if the answer does not depend on how fast.
fn answer(effect: &Effect, torque: f64, speed: f64) -> f64 {
    let Form::Laws([law, ..]) = effect.form else { return f64::NAN };
    let seen = |law_input: &LawInput, speed: f64| match law_input {
        LawInput::Speed => speed,
        LawInput::Torque => torque,
        _ => f64::NAN,
    };
    // Numerical widths of corners are no part of a steady state.
    let widths = |own: &EffectParameter| own.default.map_or(1.0, |(rotation, _)| NARROW * rotation);
    let parameters: Vec<f64> = effect.parameters.iter().map(widths).collect();
    let at = |speed: f64| {
        let law_inputs: Vec<f64> = law.law_inputs.iter().map(|law_input| seen(law_input, speed)).collect();
        (law.evaluate)(&law_inputs, &parameters).torque
    };
    if speed.is_nan() && law.law_inputs.contains(&LawInput::Speed) {
        let [slow, fast] = [1.0, 1e3].map(at);
        return if slow == fast { slow } else { f64::NAN };
    }
    at(speed)
}

/// Share of the usual width of a law's corner.
const NARROW: f64 = 1e-6;
