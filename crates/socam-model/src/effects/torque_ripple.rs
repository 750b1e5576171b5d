//! A motor whose torque swings with its angle.

use super::{ANY, Acts, ActsAt, Effect, EffectParameter, Form, Kind, Law, POSITIVE, Response, Sight, shape};

/// T = torque sin(order angle + phase), the angle counted from where the recording began. Where the motor's speed is
/// prescribed it does nothing.
pub(super) const EFFECT: Effect = Effect {
    id: "torque_ripple",
    acts_at: ActsAt::Node,
    parameters: &[
        EffectParameter::new("order", Kind::Ratio, POSITIVE),
        EffectParameter::new("torque", Kind::Torque, POSITIVE),
        EffectParameter::new("phase", Kind::Phase, ANY),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        sights: &[Sight::Angle],
        acts: Acts::Torque,
        answer,
        bend: shape::straight,
        silent: |parameters| parameters[1] == 0.0,
    }]),
    equation: "T = T_r sin(n theta + phi)",
    sentence: "The machine's torque swings as it turns: cogging, or commutation.",
};

fn answer(sights: &[f64], p: &[f64]) -> Response {
    let wave = shape::wave(p[1], p[0], p[2], sights[0], 1.0);
    let [by_size, by_order, by_phase, ..] = wave.slope_parameters;
    shape::response(wave.torque, &wave.slopes, &[by_order, by_size, by_phase])
}
