//! What laws of friction share: the steady torque against the motion of a bearing at a few speeds.

use socam_identify::Uncertainty;
use socam_model::{
    Bearing, EffectUse, Model,
    effects::{self, Acts, ActsAt, Effect, Family, LawInput, QuantityKind},
};

use crate::{
    candidate::Candidate,
    context::FittedModel,
    document::Drag,
    selection::{Path, Term},
};

/// Speeds as shares of the largest at the bearing.
const SHARES: [f64; 3] = [0.1, 0.5, 0.9];

/// Drag at each of [`SHARES`].
pub(crate) type Drags = [f64; SHARES.len()];

/// The drag of a term's bearing in forward motion, with 95 % intervals from the joint covariance of all its parameters (the delta method). None is
/// narrower than the discrepancies of the laws there, and each holds what other laws that predict as well give there.
/// Empty where the term is no friction at a bearing, or a law there depends on more than speed, or a curve is needed beside it.
pub(crate) fn of_term(path: &Path, term: &Term, joint: &Uncertainty) -> Vec<Drag> {
    let (model, place) = (&path.last.model, &term.candidate.place);
    let is_beside_a_curve = path.unexplained.as_ref().is_some_and(|curve| curve.place == *place);
    let Some((speeds, steady)) = each(path, &path.last, &term.candidate).filter(|_| !is_beside_a_curve)
    else {
        return Vec::new();
    };
    let unit = |kind: QuantityKind| model.unit_at(kind, place).to_owned();
    let one = |(k, own): (usize, Steady)| {
        let half = joint.half_width(&own.gradient).max(own.least_half_width);
        let all = || term.drags.iter().map(|drags| drags[k]).chain([own.torque]);
        let ends =
            [all().fold(f64::INFINITY, f64::min) - half, all().fold(f64::NEG_INFINITY, f64::max) + half];
        Drag {
            speed: speeds[k],
            speed_unit: unit(QuantityKind::Speed),
            torque: own.torque,
            torque_unit: unit(QuantityKind::Torque),
            ci95: ends.map(|end| Some(end).filter(|end| end.is_finite())),
        }
    };
    steady.into_iter().enumerate().map(one).collect()
}

/// The drag by a candidate's fit; `None` as in [`of_term`].
pub(crate) fn of_fit(path: &Path, fitted: &FittedModel, candidate: &Candidate) -> Option<Drags> {
    each(path, fitted, candidate).map(|(_, steady)| steady.map(|own| own.torque))
}

/// Speeds, and the steady torques at them.
fn each(path: &Path, fitted: &FittedModel, candidate: &Candidate) -> Option<(Drags, [Steady; SHARES.len()])> {
    let is_friction =
        candidate.effect.family == Family::Friction && candidate.effect.acts_at == ActsAt::Bearing;
    let largest = path.priors.rig.bearing(&candidate.place).1.speed;
    if !is_friction || !largest.is_finite() || largest <= 0.0 {
        return None;
    }
    let bearing = fitted.model.bearings.iter().find(|bearing| bearing.name == candidate.place)?;
    let laws = laws(&fitted.model, &candidate.place)?;
    let speeds = SHARES.map(|share| share * largest);
    let [low, middle, high] = speeds.map(|speed| torque((bearing, &laws), &fitted.at.values, speed));
    Some((speeds, [low?, middle?, high?]))
}

/// The laws at a bearing in steady motion; `None` where one depends on more than speed. Presliding does not show in steady motion.
fn laws<'a>(model: &'a Model, place: &str) -> Option<Vec<(&'a EffectUse, &'static Effect)>> {
    let of_speed = |law: &effects::Law| law.law_inputs == [LawInput::Speed] && law.acts == Acts::Torque;
    let steady = |used: &'a EffectUse| {
        let plain = effects::find(used.effect.id)?;
        let is_steady = !plain.laws().is_empty() && plain.laws().iter().all(of_speed);
        (is_steady && plain.borrows.is_none()).then_some((used, plain))
    };
    model.effects.iter().filter(|used| used.place == place).map(steady).collect()
}

/// A torque against the motion, and its derivatives by the model's parameters.
struct Steady {
    torque: f64,
    gradient: Vec<(usize, f64)>,
    /// By which the laws may be wrong.
    least_half_width: f64,
}

fn torque(
    (bearing, laws): (&Bearing, &[(&EffectUse, &'static Effect)]),
    values: &[f64],
    speed: f64,
) -> Option<Steady> {
    let damping = bearing.damping.map(|index| (index, speed));
    let mut found = Steady {
        torque: damping.map_or(0.0, |(index, speed)| values[index] * speed),
        gradient: damping.into_iter().collect(),
        least_half_width: 0.0,
    };
    for (used, plain) in laws {
        // A refined law has the parameters of the plain one, and more.
        let index = |name: &str| {
            let mut own = used.effect.parameters.iter().zip(&used.parameters);
            own.find(|(parameter, _)| parameter.name == name).map(|(_, index)| *index)
        };
        let indices: Option<Vec<usize>> = plain.parameters.iter().map(|own| index(own.name)).collect();
        let indices = indices?;
        let parameters: Vec<f64> = indices.iter().map(|index| values[*index]).collect();
        for law in plain.laws() {
            let response = law.evaluate(&[speed], &parameters);
            found.torque -= response.torque;
            for (k, index) in indices.iter().enumerate() {
                let derivative = -response.by_parameter[k];
                found.gradient.push((*index, derivative));
                let least = used.effect.least_half_width(plain.parameters[k].name, parameters[k]);
                found.least_half_width += (derivative * least).abs();
            }
        }
    }
    Some(found)
}
