//! Basis functions of nonparametric terms, as laws of a model: raised cosines over an interval, harmonics over a turn.

use socam_model::{
    Motion,
    effects::{
        Acts, ActsAt, Effect, EffectParameter, Form, Law, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS,
        QuantityKind, Response, Rule, TRANSITION_SPEED,
    },
};

/// Parameter name of the speed within which friction changes its sign; the same as in the catalogue's friction laws.
const TRANSITION: &str = "transition_speed";
/// Bounds of a parameter without bounds.
pub(super) const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Parameters of a raised cosine: its height, its centre, and the distances below and above the centre beyond which it is zero. Where each
/// reaches from the centre before it to the one behind it, raised cosines add up to any smooth curve.
const BASIS: &[EffectParameter] = &[
    EffectParameter { name: "height", kind: QuantityKind::Gain, default: None, bounds: ANY },
    EffectParameter { name: "centre", kind: QuantityKind::Gain, default: None, bounds: ANY },
    EffectParameter { name: "below", kind: QuantityKind::Gain, default: None, bounds: ANY },
    EffectParameter { name: "above", kind: QuantityKind::Gain, default: None, bounds: ANY },
];

/// Parameters of a friction term: those of its basis function, and the speed within which it changes its sign.
const FRICTION: &[EffectParameter] =
    &[BASIS[0], BASIS[1], BASIS[2], BASIS[3], EffectParameter { name: TRANSITION, ..BASIS[2] }];

/// A raised cosine of the first law input.
fn raised_cosine(law_inputs: &[f64], p: &[f64]) -> Response {
    let from_centre = law_inputs[0] - p[1];
    let width = if from_centre < 0.0 { p[2] } else { p[3] };
    let distance = from_centre / width;
    let (mut derivatives, mut by_parameter) = ([0.0; MAX_LAW_INPUTS], [0.0; MAX_PARAMETERS]);
    if distance.abs() >= 1.0 {
        return Response { torque: 0.0, derivatives, by_parameter };
    }
    let (sin, cos) = (std::f64::consts::PI * distance).sin_cos();
    let value = 0.5 * (1.0 + cos);
    derivatives[0] = -0.5 * std::f64::consts::PI * sin / width * p[0];
    by_parameter[0] = value;
    Response { torque: p[0] * value, derivatives, by_parameter }
}

/// A sine of the first law input. Parameters: amplitude, order (a whole number), phase (0 or a quarter of a turn).
fn harmonic(law_inputs: &[f64], p: &[f64]) -> Response {
    let (sin, cos) = (p[1] * law_inputs[0] + p[2]).sin_cos();
    let (mut derivatives, mut by_parameter) = ([0.0; MAX_LAW_INPUTS], [0.0; MAX_PARAMETERS]);
    derivatives[0] = p[0] * p[1] * cos;
    by_parameter[0] = sin;
    Response { torque: p[0] * sin, derivatives, by_parameter }
}

/// The first law input (a reading or a twist) times a raised cosine of the second one (the time).
fn time_varying_gain(law_inputs: &[f64], p: &[f64]) -> Response {
    let Response { torque, derivatives: by_time, by_parameter } = raised_cosine(&law_inputs[1..], p);
    let mut derivatives = [0.0; MAX_LAW_INPUTS];
    derivatives[..2].copy_from_slice(&[torque, law_inputs[0] * by_time[0]]);
    Response {
        torque: law_inputs[0] * torque,
        derivatives,
        by_parameter: by_parameter.map(|derivative| law_inputs[0] * derivative),
    }
}

/// A raised cosine with the opposite sign: the curve of a bearing shows its resisting torque.
fn resisting_raised_cosine(law_inputs: &[f64], p: &[f64]) -> Response {
    negated(raised_cosine(law_inputs, p))
}

/// A harmonic with the opposite sign, for the same reason.
fn resisting_harmonic(law_inputs: &[f64], p: &[f64]) -> Response {
    negated(harmonic(law_inputs, p))
}

/// Friction against the first law input (the speed), whose size is a basis function of the second one (time or angle).
fn friction(law_inputs: &[f64], p: &[f64], basis: fn(&[f64], &[f64]) -> Response) -> Response {
    let Response { torque, derivatives: by_other, by_parameter } = basis(&law_inputs[1..], p);
    let transition = p[4];
    let sign = (law_inputs[0] / transition).tanh();
    let mut derivatives = [0.0; MAX_LAW_INPUTS];
    derivatives[..2].copy_from_slice(&[-torque * (1.0 - sign * sign) / transition, -sign * by_other[0]]);
    Response {
        torque: -sign * torque,
        derivatives,
        by_parameter: by_parameter.map(|derivative| -sign * derivative),
    }
}

fn friction_raised_cosine(law_inputs: &[f64], p: &[f64]) -> Response {
    friction(law_inputs, p, raised_cosine)
}

fn friction_harmonic(law_inputs: &[f64], p: &[f64]) -> Response {
    friction(law_inputs, p, harmonic)
}

/// A law's response with the opposite sign.
fn negated(response: Response) -> Response {
    Response {
        torque: -response.torque,
        derivatives: response.derivatives.map(|derivative| -derivative),
        by_parameter: response.by_parameter.map(|derivative| -derivative),
    }
}

const fn effect(acts_at: ActsAt, laws: &'static [Law]) -> Effect {
    Effect::bare("shape", acts_at, BASIS, None, Form::Laws(laws), "")
}

const fn friction_law(law_inputs: &'static [LawInput], evaluate: fn(&[f64], &[f64]) -> Response) -> Law {
    Law { transition: |parameters| parameters[4], ..law(law_inputs, Acts::Torque, evaluate) }
}

const fn law(law_inputs: &'static [LawInput], acts: Acts, evaluate: fn(&[f64], &[f64]) -> Response) -> Law {
    Law {
        law_inputs,
        acts,
        rule: Rule::Code(evaluate),
        formula: "",
        transition: |_| 0.0,
        inactive: |parameters| parameters[0] == 0.0,
    }
}

pub(super) static BEARING_SPEED: Effect =
    effect(ActsAt::Bearing, &[law(&[LawInput::Speed], Acts::Torque, resisting_raised_cosine)]);
pub(super) static BEARING_ANGLE: Effect =
    effect(ActsAt::Bearing, &[law(&[LawInput::Angle], Acts::Torque, resisting_harmonic)]);
pub(super) static BEARING_TIME: Effect =
    effect(ActsAt::Bearing, &[law(&[LawInput::Time], Acts::Torque, resisting_raised_cosine)]);
pub(super) static BEARING_FRICTION_BY_ANGLE: Effect = Effect {
    parameters: FRICTION,
    ..effect(ActsAt::Bearing, &[friction_law(&[LawInput::Speed, LawInput::Angle], friction_harmonic)])
};
pub(super) static BEARING_FRICTION_BY_TIME: Effect = Effect {
    parameters: FRICTION,
    ..effect(ActsAt::Bearing, &[friction_law(&[LawInput::Speed, LawInput::Time], friction_raised_cosine)])
};
pub(super) static SPRING_TWIST: Effect =
    effect(ActsAt::Spring, &[law(&[LawInput::Twist], Acts::Torque, raised_cosine)]);
pub(super) static SPRING_STIFFNESS: Effect =
    effect(ActsAt::Spring, &[law(&[LawInput::Twist, LawInput::Time], Acts::Torque, time_varying_gain)]);
pub(super) static CHANNEL_READING: Effect =
    effect(ActsAt::Channel, &[law(&[LawInput::Reading], Acts::Reading, raised_cosine)]);
pub(super) static CHANNEL_TIME: Effect =
    effect(ActsAt::Channel, &[law(&[LawInput::Time], Acts::Reading, raised_cosine)]);
pub(super) static CHANNEL_GAIN: Effect =
    effect(ActsAt::Channel, &[law(&[LawInput::Reading, LawInput::Time], Acts::Reading, time_varying_gain)]);

/// Speed within which friction changes its sign, rad/s (m/s), unless a file sets it.
pub(super) fn transition(motion: Motion) -> f64 {
    let (rotation, translation) = TRANSITION_SPEED;
    if motion == Motion::Rotation { rotation } else { translation }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_changes_its_sign_within_the_catalogue_s_speed() {
        let speeds = [Motion::Rotation, Motion::Translation].map(transition);
        assert!(speeds.iter().all(|speed| *speed > 0.0), "{speeds:?}");
    }
}
