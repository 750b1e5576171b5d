//! What a model has at one element of its drawing: parameters with what they are, effects, channels.

use socam_model::{Channel, Model, Parameter, Role};

/// A parameter of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ElementParameter {
    /// What it is there, such as `stiffness`.
    pub what: String,
    /// Its index in [`Model::parameters`].
    pub index: usize,
}

/// An element of a model.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ElementDetails {
    /// Its parameters; one that several elements share is in each of them.
    pub parameters: Vec<ElementParameter>,
    /// Indices of the channels that sit there in [`Model::channels`], or of the channel itself.
    pub channels: Vec<usize>,
    /// Names of the effects at it.
    pub effects: Vec<String>,
}

impl ElementDetails {
    /// The element, or channel, of a name; empty for a name that the model lacks.
    #[must_use]
    pub fn of(model: &Model, name: &str) -> Self {
        let mut found = Self::default();
        found.structure(model, name);
        for used in model.effects.iter().filter(|used| used.place == name) {
            found.effects.push(used.effect.id.to_owned());
            for (parameter, index) in used.effect.parameters.iter().zip(&used.parameters) {
                found.add(&format!("{} of {}", parameter.name, used.effect.id), Some(*index));
            }
        }
        for (index, channel) in model.channels.iter().enumerate() {
            if !channel.quantity.is_clock() && (channel.at == name || channel.name == name) {
                found.channels.push(index);
                if channel.name == name {
                    found.add("gain", channel.gain);
                }
            }
        }
        found
    }

    fn add(&mut self, what: &str, index: Option<usize>) {
        if let Some(index) = index
            && self.parameters.iter().all(|known| known.index != index)
        {
            self.parameters.push(ElementParameter { what: what.to_owned(), index });
        }
    }

    /// Adds the parameters of the element itself.
    fn structure(&mut self, model: &Model, name: &str) {
        for node in model.nodes.iter().filter(|node| node.name == name) {
            self.add("inertia", node.inertia);
        }
        for spring in model.springs.iter().filter(|spring| spring.name == name) {
            self.add("stiffness", Some(spring.stiffness));
            self.add("damping", spring.damping);
        }
        for gear in model.gears.iter().filter(|gear| gear.name == name) {
            self.add("ratio", Some(gear.ratio));
        }
        for mixed in model.differentials.iter().filter(|mixed| mixed.name == name) {
            mixed.factors.iter().for_each(|factor| self.add("factor", Some(*factor)));
        }
        for bearing in model.bearings.iter().filter(|bearing| bearing.name == name) {
            self.add("damping", bearing.damping);
        }
        for motor in model.motors.iter().filter(|motor| motor.name == name) {
            self.add("resistance", Some(motor.resistance));
            self.add("torque constant", Some(motor.torque_constant));
            self.add("back-EMF", Some(motor.back_emf));
            self.add("inductance", motor.inductance);
        }
        for servo in model.servo.iter().filter(|servo| servo.name == name) {
            self.add("position gain", Some(servo.position_gain));
            self.add("velocity gain", Some(servo.velocity_gain));
            self.add("drive gain", Some(servo.drive_gain));
            self.add("largest torque", servo.limit);
        }
    }
}

/// A channel in one line: `output_speed_rad_s, predicted by the model, noise 0.01 rad/s`.
#[must_use]
pub fn channel_words(channel: &Channel) -> String {
    let role = match channel.role {
        Role::Input => "drives the model",
        Role::Output => "predicted by the model",
    };
    let noise = channel.noise_std.map_or_else(String::new, |std| format!(", noise {std} {}", channel.unit));
    format!("column {}, {role}{noise}", channel.column)
}

/// A value in the unit of the model's file.
#[must_use]
pub fn in_file_unit(parameter: &Parameter, si: f64) -> f64 {
    si / parameter.file_factor
}

/// A value of the model's file in SI.
#[must_use]
pub fn in_si(parameter: &Parameter, own: f64) -> f64 {
    own * parameter.file_factor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_element_has_its_parameters_effects_and_channels() {
        let model = Model::builtin("two-mass").unwrap();
        let model = model.with_effect("coulomb_friction", "load_bearing", &[("torque", 0.1)]).unwrap();
        let words = |name: &str| {
            let found = ElementDetails::of(&model, name);
            let parameters: Vec<String> = found
                .parameters
                .iter()
                .map(|own| format!("{} {}", own.what, model.parameters[own.index].name))
                .collect();
            let channels: Vec<&str> =
                found.channels.iter().map(|own| model.channels[*own].name.as_str()).collect();
            (parameters, channels, found.effects)
        };
        assert_eq!(words("shaft").0, ["stiffness stiffness", "damping shaft_damping"]);
        assert_eq!(words("motor").1, ["motor_torque", "motor_speed"]);
        let bearing = words("load_bearing");
        assert_eq!(bearing.2, ["coulomb_friction"]);
        assert_eq!(bearing.0[1], "torque of coulomb_friction load_bearing_coulomb_friction_torque");
        assert_eq!(words("motor_speed").1, ["motor_speed"]);
        assert_eq!(words("nothing").0, Vec::<String>::new());
    }
}
