//! What may stand behind readings that break a tie: one effect at a time, fitted by least squares.

use nalgebra::{DMatrix, DVector};
use socam_model::{Model, effects};
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
    pub(super) effect: &'static str,
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
pub(super) struct Fitted {
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
    pub(super) fn estimate(&self, fitted: &Fitted) -> (f64, [f64; 2]) {
        let last = fitted.coefficients.len() - 1;
        let (theta, half) = (fitted.coefficients[last], fitted.quantile * fitted.std[last]);
        let mut ends = [(self.value)(theta - half), (self.value)(theta + half)];
        ends.sort_by(f64::total_cmp);
        ((self.value)(theta), ends)
    }

    /// Whether a parameter may have such a value.
    pub(super) fn is_possible(&self, fitted: &Fitted) -> bool {
        let own =
            effects::find(self.effect).and_then(|e| e.parameters.iter().find(|p| p.name == self.parameter));
        let (low, high) = own.map_or((f64::NEG_INFINITY, f64::INFINITY), |own| own.bounds);
        (low..=high).contains(&self.estimate(fitted).0)
    }

    /// Change of the parameter that moves the sum of squares by one.
    pub(super) fn resolution(&self, fitted: &Fitted) -> f64 {
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
    ) -> Option<Fitted> {
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
    ) -> Option<Fitted> {
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
        Some(Fitted { coefficients, std, quantile, chi2, p_value, left, residual })
    }

    /// Value and 95 % interval of the base's dampings.
    pub(super) fn dampings(&self, fitted: &Fitted) -> Vec<(usize, f64, [f64; 2])> {
        let each = self.base.iter().enumerate().map(|(k, (parameter, _))| {
            let (value, half) = (fitted.coefficients[k], fitted.quantile * fitted.std[k]);
            (*parameter, value, [value - half, value + half])
        });
        each.collect()
    }

    /// All effects of the catalogue that show in a steady state and could break the tie; plant first.
    pub(super) fn explanations(&self, model: &Model) -> Vec<Explanation> {
        let Self { tie, readings, .. } = self;
        let (first, second) = (&model.channels[tie.first].name, &model.channels[tie.second].name);
        let mut all: Vec<Explanation> = Vec::new();
        let mut add = |effect, place: &str, parameter, x: Vec<f64>, on, value| {
            if x.iter().all(|x| x.is_finite()) {
                let (place, rank) = (place.to_owned(), all.len());
                all.push(Explanation { effect, place, parameter, rank, x, on, value });
            }
        };
        let constant = |height: f64| vec![height; readings.first.len()];
        let plain: fn(f64) -> f64 = |theta| theta;
        if tie.kind == Kind::Speeds {
            let per = |values: &[f64], sign: f64| values.iter().map(|value| sign / value).collect::<Vec<_>>();
            add("sensor_gain", second, "gain", constant(-1.0), On::Neither, f64::exp);
            add("sensor_gain", first, "gain", constant(1.0), On::Neither, f64::exp);
            add("sensor_offset", second, "offset", per(&readings.second, -1.0), On::Neither, plain);
            add("sensor_offset", first, "offset", per(&readings.first, 1.0), On::Neither, plain);
            return all;
        }
        let over = |f: fn(f64) -> f64, weight: f64| {
            readings.speed.iter().map(|speed| f(*speed) * weight).collect::<Vec<_>>()
        };
        let entering: Vec<f64> = readings.first.iter().map(|torque| tie.ratio * torque).collect();
        for gear in &tie.gears {
            // A loss is taken from what enters, whichever way it turns.
            let loss =
                entering.iter().zip(&readings.speed).map(|(torque, speed)| torque.abs() * direction(*speed));
            add("mesh_loss", &model.gears[*gear].name, "fraction", loss.collect(), On::First, plain);
        }
        for (bearing, weight) in &tie.bearings {
            let place = &model.bearings[*bearing].name;
            add("coulomb_friction", place, "torque", over(direction, *weight), On::Neither, plain);
            let drag = over(|speed| speed * speed.abs(), weight.abs().powi(3));
            add("quadratic_drag", place, "coefficient", drag, On::Neither, plain);
        }
        let massive = tie.nodes.iter().rfind(|(node, _)| model.nodes[*node].inertia.is_some());
        if let Some((node, weight)) = massive.filter(|_| tie.kind == Kind::Load) {
            add("constant_load", &model.nodes[*node].name, "torque", constant(*weight), On::Neither, plain);
        }
        if tie.kind == Kind::Torques {
            add("sensor_gain", second, "gain", readings.second.clone(), On::Second, |theta| {
                1.0 / (1.0 + theta)
            });
            add("sensor_gain", first, "gain", entering, On::First, |theta| 1.0 / (1.0 - theta));
            add("sensor_offset", second, "offset", constant(-1.0), On::Neither, plain);
        }
        add("sensor_offset", first, "offset", constant(tie.ratio), On::Neither, plain);
        all
    }
}

/// Of a motion whose speed was not measured, forward.
fn direction(speed: f64) -> f64 {
    if speed < 0.0 { -1.0 } else { 1.0 }
}
