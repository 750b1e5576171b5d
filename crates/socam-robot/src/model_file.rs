//! The model file of a joint.

use socam_model::effects::{CONSTANT_LOAD, COULOMB_FRICTION, GRAVITY_UNBALANCE, TRANSITION_SPEED};

use crate::joint::{JointModel, Sourced};
use crate::written::{ModelText, Parameter, plain};

/// A value may be this many times larger or smaller than the description says.
const RANGE: f64 = 100.0;

/// Share of the catalogue's speed within which the sign of a speed is smoothed: joints move at some 1 rad/s, where that speed itself would take
/// more than 1e-3 from a motion with dry friction.
const TRANSITION_SHARE: f64 = 0.04;

impl JointModel {
    /// Name of the joint's node in [`Self::model_file`].
    #[must_use]
    pub fn node(&self) -> String {
        plain(&self.name)
    }

    /// The model as a file of schema `socam.model/1`. `description` is the name of the description's file.
    #[must_use]
    pub fn model_file(&self, description: &str) -> String {
        let name = plain(&self.name);
        let about =
            format!("Joint {} of {} ({description}), the other joints at zero", self.name, self.robot);
        let mut file = ModelText::new(&name, &about, self.turns, &self.left_out);
        self.parameters(&mut file, description);
        self.elements(&mut file, &name);
        self.channels(&mut file, &name);
        file.finish()
    }

    fn parameters(&self, file: &mut ModelText, description: &str) {
        let [kg, damping, force, stiffness] =
            if self.turns { ["kg m2", "N m s/rad", "N m", "N m/rad"] } else { ["kg", "N s/m", "N", "N/m"] };
        let inertia = self.inertia();
        let mut write = |key, number: &Sourced, unit, bounds, fixed| {
            let source = format!("{description}: {}", number.source);
            file.parameter(&Parameter {
                key,
                value: number.value,
                unit,
                bounds: Some(bounds),
                fixed,
                source: &source,
            });
        };
        let about_value = |value: f64| (value / RANGE, value * RANGE);
        let either_way = |value: f64| (-RANGE * value.abs(), RANGE * value.abs());
        // The scale of a number that the description leaves at zero: what brings the mass to rest within a second.
        let from_zero = |value: f64, scale: f64| (0.0, RANGE * value.max(scale));
        write("inertia", &inertia, kg, about_value(inertia.value), false);
        write("damping", &self.damping, damping, from_zero(self.damping.value, inertia.value), false);
        if let Some(friction) = &self.friction {
            write("friction", friction, force, from_zero(friction.value, 0.0), false);
        }
        if let Some(spring) = &self.stiffness {
            write("stiffness", spring, stiffness, about_value(spring.value), false);
        }
        if let Some(preload) = &self.preload {
            // No recording tells it from the weight of a slide.
            let is_alike = !self.turns && self.weight.is_some();
            write("preload", preload, force, either_way(preload.value), is_alike);
        }
        if let Some((weight, _)) = &self.weight {
            let bounds = if self.turns { (0.0, RANGE * weight.value) } else { either_way(weight.value) };
            write("weight", weight, force, bounds, false);
        }
        if let Some((_, phase)) = self.weight.as_ref().filter(|_| self.turns) {
            let source = "the angle of the recording counts from the joint's zero";
            file.parameter(&Parameter {
                key: "weight_phase",
                value: *phase,
                unit: "rad",
                bounds: None,
                fixed: false,
                source,
            });
        }
        if self.friction.is_some() {
            let (rotation, translation) = TRANSITION_SPEED;
            let (speed, unit) = if self.turns { (rotation, "rad/s") } else { (translation, "m/s") };
            file.parameter(&Parameter {
                key: "transition_speed",
                value: TRANSITION_SHARE * speed,
                unit,
                bounds: None,
                fixed: true,
                source: "numerical: the sign of a slower speed is smoothed",
            });
        }
    }

    /// The inertia of the bodies and of the drive.
    fn inertia(&self) -> Sourced {
        match &self.armature {
            Some(armature) => Sourced {
                value: self.behind.value + armature.value,
                source: format!(
                    "{} ({:.6}), and {} ({})",
                    self.behind.source, self.behind.value, armature.source, armature.value
                ),
            },
            None => self.behind.clone(),
        }
    }

    fn elements(&self, file: &mut ModelText, name: &str) {
        file.table("[[nodes]]", &[("name", name), ("inertia", "inertia")]);
        let bearing = format!("{name}_bearing");
        file.table("[[bearings]]", &[("name", &bearing), ("at", name), ("damping", "damping")]);
        if self.stiffness.is_some() {
            let spring = format!("{name}_spring");
            let keys =
                [("name", spring.as_str()), ("from", name), ("to", "ground"), ("stiffness", "stiffness")];
            file.table("[[springs]]", &keys);
        }
        if self.friction.is_some() {
            let parameters = [("torque", "friction"), ("transition_speed", "transition_speed")];
            file.effect(&COULOMB_FRICTION, &bearing, &parameters);
        }
        if self.preload.is_some() {
            file.effect(&CONSTANT_LOAD, name, &[("torque", "preload")]);
        }
        if self.weight.is_some() {
            if self.turns {
                file.effect(&GRAVITY_UNBALANCE, name, &[("torque", "weight"), ("phase", "weight_phase")]);
            } else {
                file.effect(&CONSTANT_LOAD, name, &[("torque", "weight")]);
            }
        }
    }

    fn channels(&self, file: &mut ModelText, name: &str) {
        let (torque, angle) = if self.turns { ("torque", "angle") } else { ("force", "position") };
        file.channel(torque, "input", torque, name);
        if let Some(gear) = self.gear.as_ref().filter(|gear| gear.value != 1.0) {
            file.line(format_args!(
                "# scale = {:?}   # {}: where the column holds the actuator's input",
                gear.value, gear.source
            ));
        }
        file.channel(angle, "output", angle, name);
    }
}
