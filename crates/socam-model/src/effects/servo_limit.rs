//! The limit of a servo's torque: a key of the model file's `[servo]`, and no effect that a diagnosis looks for.

use super::{
    effect::Effect,
    kinds::{EffectParameter, POSITIVE, QuantityKind},
    law::{Acts, Form, Law, LawInput, Response, Rule},
    places::ActsAt,
    shape,
};

/// torque = command, limited to -limit .. limit. The law adds what the limit takes away.
pub(crate) static SERVO_LIMIT: Effect = Effect::bare(
    "servo limit",
    ActsAt::Node,
    &[EffectParameter::new("limit", QuantityKind::Torque, POSITIVE)],
    None,
    Form::Laws(&[Law {
        law_inputs: &[LawInput::Torque],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "0.5*(sqrt((through + limit)^2 + 1e-6*limit^2) - sqrt((through - limit)^2 + 1e-6*limit^2)) - through",
        transition: |parameters| ROUNDING * parameters[0],
        inactive: shape::never,
    }]),
    "|T| <= limit",
);

/// Width of the rounded corners as a fraction of the limit.
const ROUNDING: f64 = 1e-3;

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (kept, by_command, by_limit) = shape::limited(law_inputs[0], p[0], ROUNDING);
    shape::response(kept - law_inputs[0], &[by_command - 1.0], &[by_limit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_stays_within_the_limit_and_its_derivatives_are_differences() {
        for command in [-9.0, -2.0, -1.9, 0.0, 1.0, 1.99, 2.01, 50.0] {
            let torque = |command: f64, limit: f64| command + evaluate(&[command], &[limit]).torque;
            assert!((torque(command, 2.0) - command.clamp(-2.0, 2.0)).abs() < 2e-3, "{command}");
            let found = evaluate(&[command], &[2.0]);
            let by_command = (torque(command + 1e-6, 2.0) - torque(command - 1e-6, 2.0)) / 2e-6 - 1.0;
            let by_limit = (torque(command, 2.0 + 1e-6) - torque(command, 2.0 - 1e-6)) / 2e-6;
            assert!((found.derivatives[0] - by_command).abs() < 1e-5, "{command}");
            assert!((found.by_parameter[0] - by_limit).abs() < 2e-3, "{command}");
        }
    }
}
