//! Laws of model files whose sign is probably wrong.

use crate::{
    Model, Motion,
    effects::{ActsAt, Effect, LawInput, QuantityKind},
};

/// Speeds at which such laws are judged, SI.
const SPEEDS: [f64; 6] = [1.0, -1.0, 1e-3, -1e-3, 1e3, -1e3];

impl Model {
    /// A sentence about each law of the file, candidates too, that pushes its bearing along at every speed in both directions: friction and
    /// drag do the opposite. Judged are laws of a speed, and of torques that may be zero.
    pub(super) fn laws_that_drive(&self) -> Vec<String> {
        let used = self.effects.iter().map(|used| (used.effect, &used.parameters));
        let tried = self.candidates.iter().map(|own| (own.effect, &own.parameters));
        let sentence = |(effect, parameters): (&'static Effect, &Vec<usize>)| {
            let values: Vec<f64> = parameters.iter().map(|index| self.parameters[*index].value).collect();
            let torque = torque_that_drives(self, effect, &values)?;
            let unit = |kind: QuantityKind| kind.unit(self.motion == Motion::Rotation);
            Some(format!(
                "the law {} pushes its bearing along at every speed, with {torque:.3} {} at {} {}; a torque is positive where it drives \
                 forward, so friction and drag need a minus",
                effect.id,
                unit(QuantityKind::Torque),
                SPEEDS[0],
                unit(QuantityKind::Speed)
            ))
        };
        used.chain(tried).filter_map(sentence).collect()
    }
}

/// The torque of a law at the first of the speeds, SI, if it has the sign of each of them while its other inputs are zero. `None` for a law of
/// anything but a bearing's speed and torques.
fn torque_that_drives(model: &Model, effect: &'static Effect, values: &[f64]) -> Option<f64> {
    let [law] = effect.laws() else { return None };
    let is_torque = |input: &LawInput| match input {
        LawInput::Channel { channel, .. } => {
            let unit = QuantityKind::Torque.unit(model.motion == Motion::Rotation);
            model.channels.iter().any(|own| own.name == *channel && own.unit == unit)
        }
        _ => false,
    };
    let (first, others) = law.law_inputs.split_first()?;
    let is_judged = effect.is_own() && effect.acts_at == ActsAt::Bearing && *first == LawInput::Speed;
    let torque = |speed: f64| {
        let mut inputs = vec![0.0; law.law_inputs.len()];
        inputs[0] = speed;
        law.evaluate(&inputs, values).torque
    };
    let drives = |speed: &f64| torque(*speed) * speed > 0.0;
    (is_judged && others.iter().all(is_torque) && SPEEDS.iter().all(drives)).then(|| torque(SPEEDS[0]))
}
