//! The model file that a diagnosis starts from, written from the description of a machine.

use std::fmt::Write as _;

use super::machine::{Control, Drive, Machine, Measure, Parameter, Sort};

/// Bounds of a parameter: its start value divided and multiplied by this factor.
const BOUND_FACTOR: f64 = 100.0;

impl Machine {
    fn unit_of(&self, sort: Sort) -> &'static str {
        match (sort, self.translates) {
            (Sort::Inertia, false) => "kg m2",
            (Sort::Inertia, true) => "kg",
            (Sort::Stiffness, false) => "N m/rad",
            (Sort::Stiffness, true) => "N/m",
            (Sort::Damping, false) => "N m s/rad",
            (Sort::Damping, true) => "N s/m",
            (Sort::Torque, false) => "N m",
            (Sort::Torque, true) => "N",
            (Sort::Ratio, _) => "1",
        }
    }

    /// The model file that a diagnosis starts from.
    pub(super) fn model_file(&self) -> String {
        let motion = if self.translates { "translation" } else { "rotation" };
        let mut text =
            format!("schema = \"socam.model/1\"\nname = \"{}\"\nmotion = \"{motion}\"\n", self.family);
        text += "\n[parameters]\n";
        for Parameter { name, sort, start, fixed, .. } in &self.parameters {
            let unit = self.unit_of(*sort);
            let rest = if *fixed {
                "fixed = true".into()
            } else {
                format!("bounds = [{:e}, {:e}]", start / BOUND_FACTOR, start * BOUND_FACTOR)
            };
            let _ = writeln!(text, "{name} = {{ value = {start:e}, unit = \"{unit}\", {rest} }}");
        }
        text += &self.known_numbers();
        text += &self.network();
        text += &self.channel_tables();
        text
    }

    /// Fixed parameters of gravity and servo, which the machine holds outside its list of parameters.
    fn known_numbers(&self) -> String {
        let hanging = match self.gravity {
            Some(_) => "hanging = { value = 0.0, unit = \"rad\", fixed = true }\n",
            None => "",
        };
        let servo = match (self.input.drive, self.control) {
            (Drive::Servo, Control::Position { position_gain, velocity_gain }) => format!(
                "servo_position_gain = {{ value = {position_gain:e}, unit = \"1/s\", fixed = true }}\n\
                 servo_velocity_gain = {{ value = {velocity_gain:e}, unit = \"1\", fixed = true }}\n\
                 servo_drive_gain = {{ value = 1.0, unit = \"1\", fixed = true }}\n"
            ),
            _ => String::new(),
        };
        format!("{hanging}{servo}")
    }

    fn network(&self) -> String {
        let name = |index: usize| &self.parameters[index].name;
        let optional = |key: &str, index: Option<usize>| {
            index.map_or_else(String::new, |index| format!("{key} = \"{}\"\n", name(index)))
        };
        let mut text = String::new();
        for node in &self.nodes {
            let inertia = optional("inertia", node.inertia);
            let _ = write!(text, "\n[[nodes]]\nname = \"{}\"\n{inertia}", node.name);
        }
        let ends = |from: usize, to: usize| {
            format!("from = \"{}\"\nto = \"{}\"\n", self.nodes[from].name, self.nodes[to].name)
        };
        for spring in &self.springs {
            let (ends, damping) = (ends(spring.from, spring.to), optional("damping", spring.damping));
            let stiffness = name(spring.stiffness);
            let _ = write!(
                text,
                "\n[[springs]]\nname = \"{}\"\n{ends}stiffness = \"{stiffness}\"\n{damping}",
                spring.name
            );
        }
        for (table, ties) in [("gears", &self.gears), ("shafts", &self.shafts)] {
            for tie in ties {
                let (ends, ratio) = (ends(tie.from, tie.to), optional("ratio", tie.ratio));
                let _ = write!(text, "\n[[{table}]]\nname = \"{}\"\n{ends}{ratio}", tie.name);
            }
        }
        for bearing in &self.bearings {
            let (at, damping) = (&self.nodes[bearing.node].name, optional("damping", bearing.damping));
            let _ = write!(text, "\n[[bearings]]\nname = \"{}\"\nat = \"{at}\"\n{damping}", bearing.name);
        }
        if self.input.drive == Drive::Servo {
            let at = &self.nodes[self.input.node].name;
            let _ = write!(
                text,
                "\n[servo]\nname = \"servo\"\nat = \"{at}\"\nposition_gain = \"servo_position_gain\"\n\
                 velocity_gain = \"servo_velocity_gain\"\ndrive_gain = \"servo_drive_gain\"\n"
            );
        }
        if let Some((node, torque)) = self.gravity {
            let (at, torque) = (&self.nodes[node].name, name(torque));
            let _ = write!(
                text,
                "\n[[effects]]\neffect = \"gravity_unbalance\"\nat = \"{at}\"\n\
                 parameters = {{ torque = \"{torque}\", phase = \"hanging\" }}\n"
            );
        }
        text
    }

    fn channel_tables(&self) -> String {
        let channels = self.channels();
        let at = &self.nodes[self.input.node].name;
        let (quantity, at) = match self.input.drive {
            Drive::Torque => ("torque", at.as_str()),
            Drive::Speed => ("speed", at.as_str()),
            Drive::Servo => ("reference", "servo"),
        };
        let mut text = format!(
            "\n[channels.{}]\nrole = \"input\"\nquantity = \"{quantity}\"\nat = \"{at}\"\ncolumn = \"{}\"\n",
            self.input.name,
            channels[0].column_name()
        );
        if self.input.scale != 1.0 {
            let _ = writeln!(text, "scale = {:e}", self.input.scale);
        }
        if let Some(gain) = self.input.gain {
            let _ = writeln!(text, "gain = \"{}\"", self.parameters[gain].name);
        }
        for sensor in &self.sensors {
            let (quantity, at) = match sensor.measure {
                Measure::Speed => ("speed", self.nodes[sensor.at].name.as_str()),
                Measure::Angle => ("angle", self.nodes[sensor.at].name.as_str()),
                Measure::Torque => ("torque", self.springs[sensor.at].name.as_str()),
                Measure::Effort => ("torque", "servo"),
            };
            let _ = write!(
                text,
                "\n[channels.{}]\nrole = \"output\"\nquantity = \"{quantity}\"\nat = \"{at}\"\n",
                sensor.name
            );
        }
        text
    }
}
