//! The model file of a joint.

use std::fmt::Write as _;

use socam_model::effects::{CONSTANT_LOAD, COULOMB_FRICTION, GRAVITY_UNBALANCE};

use crate::joint::{JointModel, Sourced};

/// A value may be this many times larger or smaller than the description says.
const RANGE: f64 = 100.0;
/// Digits of a value.
const DIGITS: usize = 9;

impl JointModel {
    /// The model as a file of schema `socam.model/1`. `description` is the name of the description's file.
    #[must_use]
    pub fn model_file(&self, description: &str) -> String {
        let name = plain(&self.name);
        let units =
            if self.turns { ["kg m2", "N m s/rad", "N m", "N m/rad"] } else { ["kg", "N s/m", "N", "N/m"] };
        let mut text = String::from("schema = \"socam.model/1\"\n");
        let _ = writeln!(text, "name = {}", quoted(&name));
        let about =
            format!("Joint {} of {} ({description}), the other joints at zero", self.name, self.robot);
        let _ = writeln!(text, "description = {}", quoted(&about));
        let _ = writeln!(text, "motion = \"{}\"", if self.turns { "rotation" } else { "translation" });
        for left_out in &self.left_out {
            let _ = writeln!(text, "# Left out: {}", left_out.replace(['\n', '\r'], " "));
        }
        text.push_str("\n[parameters]\n");
        let inertia = match &self.armature {
            Some(armature) => Sourced {
                value: self.behind.value + armature.value,
                source: format!(
                    "{} ({:.6}), and {} ({})",
                    self.behind.source, self.behind.value, armature.source, armature.value
                ),
            },
            None => self.behind.clone(),
        };
        let mut parameter = |key: &str, number: &Sourced, unit: &str, bounds: (f64, f64)| {
            let Sourced { value, source } = number;
            let source = quoted(&format!("{description}: {source}"));
            let _ = writeln!(
                text,
                "{key} = {{ value = {}, unit = \"{unit}\", bounds = [{}, {}], source = {source} }}",
                rounded(*value, DIGITS),
                rounded(bounds.0, 2),
                rounded(bounds.1, 2)
            );
        };
        let about_value = |value: f64| (value / RANGE, value * RANGE);
        // The scale of a number that the description leaves at zero: what brings the mass to rest within a second.
        let from_zero = |value: f64, scale: f64| (0.0, RANGE * value.max(scale));
        parameter("inertia", &inertia, units[0], about_value(inertia.value));
        parameter("damping", &self.damping, units[1], from_zero(self.damping.value, inertia.value));
        if let Some(friction) = &self.friction {
            parameter("friction", friction, units[2], from_zero(friction.value, 0.0));
        }
        if let Some(stiffness) = &self.stiffness {
            parameter("stiffness", stiffness, units[3], about_value(stiffness.value));
        }
        if let Some((weight, phase)) = &self.weight {
            let bounds = if self.turns {
                (0.0, RANGE * weight.value)
            } else {
                (-RANGE * weight.value.abs(), RANGE * weight.value.abs())
            };
            parameter("weight", weight, units[2], bounds);
            if self.turns {
                let source = "the angle of the recording counts from the joint's zero".to_owned();
                let _ = writeln!(
                    text,
                    "weight_phase = {{ value = {}, unit = \"rad\", source = {} }}",
                    rounded(*phase, DIGITS),
                    quoted(&source)
                );
            }
        }
        let _ = writeln!(text, "\n[[nodes]]\nname = {}\ninertia = \"inertia\"", quoted(&name));
        let bearing = quoted(&format!("{name}_bearing"));
        let _ =
            writeln!(text, "\n[[bearings]]\nname = {bearing}\nat = {}\ndamping = \"damping\"", quoted(&name));
        if self.stiffness.is_some() {
            let spring = quoted(&format!("{name}_spring"));
            let _ = writeln!(
                text,
                "\n[[springs]]\nname = {spring}\nfrom = {}\nto = \"ground\"\nstiffness = \"stiffness\"",
                quoted(&name)
            );
        }
        if self.friction.is_some() {
            let _ = writeln!(
                text,
                "\n[[effects]]\neffect = {}\nat = {bearing}\nparameters = {{ torque = \"friction\" }}",
                quoted(COULOMB_FRICTION.id)
            );
        }
        if self.weight.is_some() {
            let (effect, own) = if self.turns {
                (GRAVITY_UNBALANCE, "torque = \"weight\", phase = \"weight_phase\"")
            } else {
                (CONSTANT_LOAD, "torque = \"weight\"")
            };
            let _ = writeln!(
                text,
                "\n[[effects]]\neffect = {}\nat = {}\nparameters = {{ {own} }}",
                quoted(effect.id),
                quoted(&name)
            );
        }
        let (torque, angle) = if self.turns { ("torque", "angle") } else { ("force", "position") };
        let _ = writeln!(
            text,
            "\n[channels.{torque}]\nrole = \"input\"\nquantity = \"{torque}\"\nat = {}",
            quoted(&name)
        );
        if let Some(gear) = self.gear.as_ref().filter(|gear| gear.value != 1.0) {
            let _ = writeln!(
                text,
                "# scale = {:?}   # {}: where the column holds the actuator's input",
                gear.value, gear.source
            );
        }
        let _ = writeln!(
            text,
            "\n[channels.{angle}]\nrole = \"output\"\nquantity = \"{angle}\"\nat = {}",
            quoted(&name)
        );
        text
    }
}

/// A number with so many digits.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// A name of letters, digits and underscores.
fn plain(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let plain = plain.trim_matches('_').to_owned();
    match plain.as_str() {
        "" | "ground" => "joint".to_owned(),
        _ => plain,
    }
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
