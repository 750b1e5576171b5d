//! Explanations of a violated parity relation: one effect of the catalogue at one place, and its contribution to the relation's error.

use socam_model::{
    Model,
    effects::{Acts, ActsAt, CATALOGUE, Effect, EffectParameter, Form, LawInput, Steady},
};

use super::{
    least_squares::ResidualFit,
    parity::{ParityRelation, RelationKind},
    readings::Readings,
};

/// Factor on the usual transition width of a law, which does not occur in a steady state.
const NARROW: f64 = 1e-6;

/// The reading that an explanation scales. It scales that reading's uncertainty too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ScaledReading {
    First,
    Second,
    Neither,
}

/// An effect at a place, and its contribution to the relation's error.
#[derive(Debug, Clone)]
pub(super) struct Explanation {
    pub(super) effect: &'static Effect,
    pub(super) place: String,
    pub(super) parameter: &'static str,
    /// Index in the list of explanations.
    pub(super) rank: usize,
    column: Column,
}

impl Explanation {
    /// Its column of the regression: contribution to the error at each point per unit of its coefficient.
    pub(super) fn column(&self) -> &[f64] {
        &self.column.x
    }

    pub(super) fn scaled_reading(&self) -> ScaledReading {
        self.column.on
    }

    /// Value of the effect's parameter and its 95 % interval, SI.
    pub(super) fn estimate(&self, fitted: &ResidualFit) -> (f64, [f64; 2]) {
        let last = fitted.coefficients.len() - 1;
        let (theta, half) = (fitted.coefficients[last], fitted.quantile * fitted.std[last]);
        let mut ends = [(self.column.value)(theta - half), (self.column.value)(theta + half)];
        ends.sort_by(f64::total_cmp);
        ((self.column.value)(theta), ends)
    }

    /// Whether the estimate lies within the parameter's bounds.
    pub(super) fn is_possible(&self, fitted: &ResidualFit) -> bool {
        let own = self.effect.parameters.iter().find(|own| own.name == self.parameter);
        let (low, high) = own.map_or((f64::NEG_INFINITY, f64::INFINITY), |own| own.bounds);
        (low..=high).contains(&self.estimate(fitted).0)
    }

    /// Change of the parameter that changes the sum of squares by one.
    pub(super) fn resolution(&self, fitted: &ResidualFit) -> f64 {
        let last = fitted.std.len() - 1;
        ((self.column.value)(fitted.std[last]) - (self.column.value)(0.0)).abs()
    }
}

/// All effects of the catalogue that act in a steady state and could violate the relation, effects of the plant before those of sensors.
pub(super) fn explanations(
    model: &Model,
    relation: &ParityRelation,
    readings: &Readings,
) -> Vec<Explanation> {
    let regression = Regression { relation, readings };
    let mut all: Vec<Explanation> = Vec::new();
    for acts_at in [ActsAt::Gear, ActsAt::Bearing, ActsAt::Node, ActsAt::Channel] {
        let shown = CATALOGUE.iter().copied().filter(|own| own.steady == Steady::Linear);
        for effect in shown.filter(|own| own.acts_at == acts_at) {
            for (place, column) in regression.columns(model, effect) {
                let Some(parameter) = effect.amplitude.parameters.first() else { continue };
                if column.x.iter().all(|x| x.is_finite()) {
                    all.push(Explanation { effect, place, parameter, rank: all.len(), column });
                }
            }
        }
    }
    all
}

/// A relation and its readings, for which columns of effects are computed.
struct Regression<'a> {
    relation: &'a ParityRelation,
    readings: &'a Readings,
}

impl Regression<'_> {
    /// The column of an effect at each place where it may act.
    fn columns(&self, model: &Model, effect: &'static Effect) -> Vec<(String, Column)> {
        let Self { relation, readings } = self;
        let channels = [relation.second, relation.first].map(|channel| model.channels[channel].name.clone());
        match (effect.form, relation.kind) {
            (Form::Gain, RelationKind::Load) => Vec::new(),
            (Form::Gain, kind) => channels.into_iter().zip(self.gains(kind)).collect(),
            (Form::Laws([law, ..]), kind) if law.acts == Acts::Reading => {
                // A relation of one torque and drag has one sensor.
                let [second, first] = self.offsets(kind, effect);
                let sensors = channels.into_iter().zip([second, first]);
                sensors.skip(usize::from(kind == RelationKind::Load)).collect()
            }
            (_, RelationKind::Speeds) => Vec::new(),
            (Form::Laws([law, ..]), _) => {
                let on = if law.law_inputs.contains(&LawInput::Torque) {
                    ScaledReading::First
                } else {
                    ScaledReading::Neither
                };
                let column = |weight: f64| {
                    let points = readings.first.iter().zip(&readings.speed);
                    let each = points.map(|(torque, speed)| {
                        -weight * unit_response(effect, relation.ratio * torque, weight * speed)
                    });
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

    /// Places between the readings at which an effect of the plant may act, and the speed of each over that at the second reading.
    fn weights(&self, model: &Model, effect: &Effect) -> Vec<(String, f64)> {
        let relation = self.relation;
        let bearings =
            relation.bearings.iter().map(|(own, weight)| (model.bearings[*own].name.clone(), *weight));
        match effect.acts_at {
            // A mesh's loss is a torque on its slow side.
            ActsAt::Gear => {
                relation.gears.iter().map(|gear| (model.gears[*gear].name.clone(), 1.0)).collect()
            }
            ActsAt::Bearing => bearings.collect(),
            ActsAt::Node if relation.kind == RelationKind::Load => {
                let massive = relation.nodes.iter().rfind(|(node, _)| model.nodes[*node].inertia.is_some());
                massive.map(|(node, weight)| (model.nodes[*node].name.clone(), *weight)).into_iter().collect()
            }
            _ => Vec::new(),
        }
    }

    /// Columns of the gain of the second sensor and of the first.
    fn gains(&self, kind: RelationKind) -> [Column; 2] {
        let Self { relation, readings } = self;
        let constant = |height: f64| vec![height; readings.first.len()];
        if kind == RelationKind::Speeds {
            return [-1.0, 1.0].map(|sign| Column {
                x: constant(sign),
                on: ScaledReading::Neither,
                value: f64::exp,
            });
        }
        let entering = readings.first.iter().map(|torque| relation.ratio * torque).collect();
        [
            Column {
                x: readings.second.clone(),
                on: ScaledReading::Second,
                value: |theta| 1.0 / (1.0 + theta),
            },
            Column { x: entering, on: ScaledReading::First, value: |theta| 1.0 / (1.0 - theta) },
        ]
    }

    /// Columns of the offset of the second sensor and of the first.
    fn offsets(&self, kind: RelationKind, effect: &Effect) -> [Column; 2] {
        let Self { relation, readings } = self;
        let own = unit_response(effect, 0.0, 0.0);
        let [second, first]: [Vec<f64>; 2] = match kind {
            RelationKind::Speeds => [
                readings.second.iter().map(|value| -own / value).collect(),
                readings.first.iter().map(|value| own / value).collect(),
            ],
            _ => [vec![-own; readings.first.len()], vec![own * relation.ratio; readings.first.len()]],
        };
        [second, first].map(|x| Column { x, on: ScaledReading::Neither, value: |theta| theta })
    }
}

/// A column of the regression.
#[derive(Debug, Clone)]
struct Column {
    /// Contribution to the error at each point, per unit of the coefficient.
    x: Vec<f64>,
    on: ScaledReading,
    /// The effect's amplitude, from the coefficient.
    value: fn(f64) -> f64,
}

/// Torque of an effect's law in a steady state, at an amplitude of one. A speed that was not measured is taken as positive if the torque
/// does not depend on its size; otherwise the torque is NaN.
fn unit_response(effect: &Effect, torque: f64, speed: f64) -> f64 {
    let Form::Laws([law, ..]) = effect.form else { return f64::NAN };
    let input = |law_input: &LawInput, speed: f64| match law_input {
        LawInput::Speed => speed,
        LawInput::Torque => torque,
        _ => f64::NAN,
    };
    let widths = |own: &EffectParameter| own.default.map_or(1.0, |(rotation, _)| NARROW * rotation);
    let parameters: Vec<f64> = effect.parameters.iter().map(widths).collect();
    let at = |speed: f64| {
        let law_inputs: Vec<f64> = law.law_inputs.iter().map(|law_input| input(law_input, speed)).collect();
        law.evaluate(&law_inputs, &parameters).torque
    };
    if speed.is_nan() && law.law_inputs.contains(&LawInput::Speed) {
        let [slow, fast] = [1.0, 1e3].map(at);
        return if slow == fast { slow } else { f64::NAN };
    }
    at(speed)
}
