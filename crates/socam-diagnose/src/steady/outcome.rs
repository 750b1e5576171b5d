//! The outcome of a residual test: whether the relation is violated, and which effects explain it.

use socam_model::Model;

use super::{
    explain::{Explanation, explanations},
    least_squares::ResidualFit,
    options::SteadyOptions,
    parity::{ParityRelation, RelationKind},
    readings::Readings,
    residual_test::ResidualTest,
};

/// Difference of chi-squares up to which explanations fit equally well.
const EQUAL_CHI2: f64 = 0.05;

/// A parity relation with the outcome of its residual test.
pub(super) struct Outcome<'a> {
    pub(super) relation: &'a ParityRelation,
    pub(super) test: ResidualTest<'a>,
    pub(super) readings: &'a Readings,
    /// Fit of the model without an explanation.
    pub(super) base: ResidualFit,
    /// Explanations with their fits, the best first, also where the relation is not violated.
    pub(super) ranked: Vec<(Explanation, ResidualFit)>,
    /// Whether the readings violate the relation.
    pub(super) violated: bool,
    /// Number of `ranked` that explain the readings within their uncertainty.
    pub(super) sufficient: usize,
}

/// The outcome of a relation's residual test; `None` where the points do not suffice. `threshold` is the p-value below which the relation
/// counts as violated.
pub(super) fn outcome<'a>(
    model: &Model,
    relation: &'a ParityRelation,
    readings: &'a Readings,
    options: SteadyOptions,
    threshold: f64,
) -> Option<Outcome<'a>> {
    let test = ResidualTest::new(model, relation, readings, options.repeatability);
    let base = test.fit(model, None, None)?;
    let mut ranked: Vec<(Explanation, ResidualFit)> = explanations(model, relation, readings)
        .into_iter()
        .filter_map(|own| test.fit(model, Some(&own), None).map(|fitted| (own, fitted)))
        .filter(|(own, fitted)| own.is_possible(fitted))
        .collect();
    // Among explanations that fit equally well, the first one of the list leads: effects of the plant precede those of sensors.
    ranked.sort_by(|a, b| a.1.chi2.total_cmp(&b.1.chi2));
    let least = ranked.first().map_or(0.0, |(_, fitted)| fitted.chi2);
    let equal = ranked.iter().filter(|(_, fitted)| fitted.chi2 < least + EQUAL_CHI2).count();
    ranked[..equal].sort_by_key(|(own, _)| own.rank);
    let sufficient = ranked.iter().filter(|(_, fitted)| fitted.p_value >= options.false_alarm_rate).count();
    let violated = base.p_value < threshold;
    Some(Outcome { relation, test, readings, base, ranked, violated, sufficient })
}

impl Outcome<'_> {
    /// The explanation that fits best, if the relation is violated and an explanation suffices.
    pub(super) fn named(&self) -> Option<&(Explanation, ResidualFit)> {
        self.ranked.first().filter(|_| self.violated && self.sufficient > 0)
    }

    /// Squared residual of each point when it is left out of the fit, in units of its uncertainty.
    pub(super) fn left_out(&self, model: &Model, explanation: Option<&Explanation>) -> Option<Vec<f64>> {
        let each = (0..self.test.error.len()).map(|point| {
            let fitted = self.test.fit(model, explanation, Some(point))?;
            Some(fitted.normalised[point].powi(2))
        });
        each.collect()
    }

    /// Ratio of the first speed to the second, or the second torque in per cent of `ratio` times the first, at each point.
    pub(super) fn shares(&self) -> Vec<f64> {
        let both = self.readings.first.iter().zip(&self.readings.second);
        match self.relation.kind {
            RelationKind::Speeds => both.map(|(first, second)| first / second).collect(),
            _ => both.map(|(first, second)| 100.0 * second / (self.relation.ratio * first)).collect(),
        }
    }
}
