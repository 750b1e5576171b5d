//! The residual test of a parity relation: whether the readings satisfy it within their uncertainty, with or without an explanation.

use socam_model::Model;

use super::{
    explain::{Explanation, ScaledReading},
    least_squares::{ResidualFit, weighted},
    parity::{ParityRelation, RelationKind},
    readings::Readings,
};

/// Rounds in which coefficients and the uncertainties that depend on them are computed in turn.
const ROUNDS: usize = 5;
/// Least size of a reading, as a share of the largest, for its uncertainty.
const LEAST_SIZE: f64 = 0.05;

/// The error of a parity relation at each point, its uncertainty, and the model's free dampings that contribute to it.
pub(super) struct ResidualTest<'a> {
    relation: &'a ParityRelation,
    readings: &'a Readings,
    /// Relative standard uncertainty of a reading.
    repeatability: f64,
    /// Error of the relation at each point: logarithm of the ratio for speeds, difference of torques in N m otherwise.
    pub(super) error: Vec<f64>,
    /// Free viscous dampings: index of the parameter, and the regression's column.
    pub(super) base: Vec<(usize, Vec<f64>)>,
}

impl<'a> ResidualTest<'a> {
    pub(super) fn new(
        model: &Model,
        relation: &'a ParityRelation,
        readings: &'a Readings,
        repeatability: f64,
    ) -> Self {
        let both = || readings.first.iter().zip(&readings.second);
        let mut error: Vec<f64> = match relation.kind {
            RelationKind::Speeds => {
                both().map(|(first, second)| (first / (relation.ratio * second)).ln()).collect()
            }
            RelationKind::Torques => both().map(|(first, second)| relation.ratio * first - second).collect(),
            RelationKind::Load => readings.first.clone(),
        };
        let mut base: Vec<(usize, Vec<f64>)> = Vec::new();
        for (bearing, weight) in relation.bearings.iter().filter(|_| relation.kind != RelationKind::Speeds) {
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
        Self { relation, readings, repeatability, error, base }
    }

    /// Standard uncertainty of each point's error. An explanation with the coefficient `theta` that scales a reading scales its uncertainty
    /// too.
    fn uncertainty(&self, on: ScaledReading, theta: f64) -> Vec<f64> {
        let [first, second] = [
            if on == ScaledReading::First { 1.0 - theta } else { 1.0 },
            if on == ScaledReading::Second { 1.0 + theta } else { 1.0 },
        ];
        let both = self.readings.first.iter().zip(&self.readings.second);
        let size = |(a, b): (&f64, &f64)| match self.relation.kind {
            RelationKind::Speeds => std::f64::consts::SQRT_2,
            RelationKind::Torques => (first * self.relation.ratio * a).hypot(second * b),
            RelationKind::Load => a.abs(),
        };
        let sizes: Vec<f64> = both.map(size).collect();
        // The uncertainty of a reading near zero does not vanish.
        let least = LEAST_SIZE * sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
        sizes.iter().map(|size| self.repeatability * size.max(least).max(f64::MIN_POSITIVE)).collect()
    }

    /// Least squares fit of the dampings, within their bounds, and of an explanation, without one of the points. `None` where the points do
    /// not determine the coefficients.
    pub(super) fn fit(
        &self,
        model: &Model,
        explanation: Option<&Explanation>,
        without: Option<usize>,
    ) -> Option<ResidualFit> {
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

    /// Least squares fit with some of the dampings held at these values.
    fn fit_held(
        &self,
        explanation: Option<&Explanation>,
        held: &[Option<f64>],
        without: Option<usize>,
    ) -> Option<ResidualFit> {
        let base = self.base.iter().map(|(_, column)| column.as_slice());
        let columns: Vec<&[f64]> = base.chain(explanation.map(Explanation::column)).collect();
        let held = |k: usize| held.get(k).copied().flatten();
        let free: Vec<usize> = (0..columns.len()).filter(|k| held(*k).is_none()).collect();
        let rows: Vec<usize> = (0..self.error.len()).filter(|row| Some(*row) != without).collect();
        if rows.len() < free.len() || rows.is_empty() {
            return None;
        }
        let free_columns: Vec<&[f64]> = free.iter().map(|k| columns[*k]).collect();
        let on = explanation.map_or(ScaledReading::Neither, Explanation::scaled_reading);
        let mut coefficients: Vec<f64> = (0..columns.len()).map(|k| held(k).unwrap_or(0.0)).collect();
        let mut std = vec![0.0; columns.len()];
        let rounds = if on == ScaledReading::Neither { 1 } else { ROUNDS };
        let mut sigma = self.uncertainty(on, 0.0);
        for _ in 0..rounds {
            if !free.is_empty() {
                let remaining = |row: usize| {
                    let fixed = (0..columns.len()).filter(|k| !free.contains(k));
                    self.error[row] - fixed.map(|k| columns[k][row] * coefficients[k]).sum::<f64>()
                };
                let (values, errors) = weighted(&free_columns, &rows, remaining, &sigma)?;
                for (k, (value, error)) in free.iter().zip(values.into_iter().zip(errors)) {
                    (coefficients[*k], std[*k]) = (value, error);
                }
            }
            sigma = self.uncertainty(on, coefficients.last().copied().unwrap_or(0.0));
        }
        Some(ResidualFit::new((&self.error, &sigma), &columns, (coefficients, std), (&rows, free.len())))
    }

    /// Index of the parameter, value and 95 % interval of each free damping.
    pub(super) fn dampings(&self, fitted: &ResidualFit) -> Vec<(usize, f64, [f64; 2])> {
        let each = self.base.iter().enumerate().map(|(k, (parameter, _))| {
            let (value, half) = (fitted.coefficients[k], fitted.quantile * fitted.std[k]);
            (*parameter, value, [value - half, value + half])
        });
        each.collect()
    }
}
