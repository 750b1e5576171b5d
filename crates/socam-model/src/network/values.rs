//! Conditions on parameter values for equations to exist.

use crate::{Model, ModelError, effects::QuantityKind};

impl Model {
    pub(super) fn check_values(&self, values: &[f64]) -> Result<(), ModelError> {
        let fail = |index: usize, expected| {
            Err(ModelError::Value {
                name: self.parameters[index].name.clone(),
                value: values[index],
                expected,
            })
        };
        if values.len() != self.parameters.len() {
            return Err(ModelError::Network(format!(
                "{} parameter values for {}",
                values.len(),
                self.parameters.len()
            )));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return fail(index, "finite");
        }
        let windings = self.motors.iter().flat_map(|motor| [Some(motor.resistance), motor.inductance]);
        let positive = self.nodes.iter().filter_map(|node| node.inertia);
        let positive = positive.chain(self.springs.iter().map(|s| s.stiffness)).chain(windings.flatten());
        for index in positive {
            if values[index] <= 0.0 {
                return fail(index, "positive");
            }
        }
        if let Some(gear) = self.gears.iter().find(|gear| values[gear.ratio] == 0.0) {
            return fail(gear.ratio, "anything but zero");
        }
        for used in self.effects.iter().filter(|used| used.effect.is_own()) {
            let mut divisors = used.effect.divisors().into_iter().map(|own| used.parameters[own]);
            if let Some(index) = divisors.find(|index| values[*index] == 0.0) {
                return fail(index, "anything but zero");
            }
        }
        for used in &self.effects {
            for (parameter, index) in used.effect.parameters.iter().zip(&used.parameters) {
                // Laws divide by these. A time that may be negative is the delay of an input, which is not a divisor.
                let scale = matches!(parameter.kind, QuantityKind::Speed)
                    || (parameter.kind == QuantityKind::Time && parameter.bounds.0 >= 0.0)
                    || matches!(parameter.name, "deflection" | "limit");
                if scale && values[*index] <= 0.0 {
                    return fail(*index, "positive");
                }
            }
        }
        let dampings = self
            .springs
            .iter()
            .filter_map(|s| s.damping)
            .chain(self.bearings.iter().filter_map(|b| b.damping));
        for index in dampings {
            if values[index] < 0.0 {
                return fail(index, "zero or more");
            }
        }
        Ok(())
    }
}
