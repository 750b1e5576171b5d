//! The text of a model file, with comments that explain it.

use std::fmt::Write;

use socam_model::effects::{ActsAt, CATALOGUE};

use crate::{
    Description,
    machine::{Channel, LinkKind, Machine},
    sizes::{Parameter, written},
};

/// A parameter with its name.
type Named<'m> = (String, &'m Parameter);

/// The text of the model file.
pub(crate) fn write(description: &Description<'_>, machine: &Machine) -> String {
    let mut text = head(description, machine);
    let bearings = machine.bearings();
    let inertia = if machine.rotational { "inertia" } else { "mass" };
    text.push_str(
        "\n# Every number has its unit, the bounds within which `identify` searches, and its source. Check first what is \"typical\" or \"assumed\":\n# one weighed part or one catalogue value narrows all others. fixed = true is not estimated.\n[parameters]\n",
    );
    let mut parameters: Vec<Named<'_>> = Vec::new();
    let own = |name: &str, what: &str| format!("{name}_{what}");
    parameters
        .extend(machine.nodes.iter().filter_map(|n| Some((own(&n.name, inertia), n.inertia.as_ref()?))));
    for link in &machine.links {
        match &link.kind {
            LinkKind::Spring { stiffness, damping } => {
                parameters.push((own(&link.name, "stiffness"), stiffness));
                parameters.push((own(&link.name, "damping"), damping));
            }
            LinkKind::Gear { ratio } => parameters.push((own(&link.name, "ratio"), ratio)),
            LinkKind::Shaft => {}
        }
    }
    parameters.extend(bearings.iter().map(|bearing| (own(&bearing.name, "damping"), &bearing.damping)));
    let measures_current = machine.channels.iter().any(|channel| channel.quantity == "current");
    let resistance = machine.winding.as_ref().map(|winding| {
        let mut known = winding.resistance.clone();
        if !measures_current {
            known.fixed = true;
            known.source += "; fixed: without a measured current only torque_constant/resistance shows";
        }
        known
    });
    if let (Some(winding), Some(resistance)) = (&machine.winding, &resistance) {
        parameters.push((own(&winding.name, "resistance"), resistance));
        parameters.push((own(&winding.name, "torque_constant"), &winding.torque_constant));
        parameters.extend(winding.inductance.iter().map(|own_l| (own(&winding.name, "inductance"), own_l)));
    }
    let servo = servo_parameters(machine);
    parameters.extend(servo.iter().map(|(name, parameter)| ((*name).to_owned(), parameter)));
    for (name, parameter) in &parameters {
        text.push_str(&parameter_line(name, parameter));
    }
    text.push_str(&nodes(machine, inertia));
    text.push_str(&links(machine));
    text.push_str(&held(machine, &bearings));
    text.push_str(&channels(machine));
    text
}

fn head(description: &Description<'_>, machine: &Machine) -> String {
    let motion = if machine.rotational { "rotation" } else { "translation" };
    let name = quoted(description.name);
    let mut text = format!(
        "# Written by `socam-host new` from: {}\n# See it: socam-host model show FILE. Then: socam-host check RUN --model FILE, socam-host identify RUN --model FILE.\nschema = \"socam.model/1\"\nname = {name}\nmotion = \"{motion}\"\n",
        description.chain.split_whitespace().collect::<Vec<_>>().join(" ")
    );
    if machine.nodes.iter().any(|node| node.lead_m.is_some()) {
        text.push_str("# Behind the screw or rack everything is referred to its turn: masses are m (lead/2 pi)^2, travels are angles 2 pi/lead x.\n");
    }
    text
}

/// Gains of a servo: a position loop of 5 Hz around a velocity loop of 30 Hz.
fn servo_parameters(machine: &Machine) -> Vec<(&'static str, Parameter)> {
    let Some(node) = machine.servo else { return Vec::new() };
    let inertia: f64 = machine.nodes.iter().filter_map(|node| node.inertia.as_ref()).map(Parameter::si).sum();
    let inertia = machine.nodes[node].inertia.as_ref().map_or(inertia, |own| own.si().max(inertia * 0.1));
    let (gain, drive) = if machine.rotational { ("N m s/rad", "1") } else { ("N s/m", "1") };
    vec![
        ("position_gain", Parameter::usual(30.0, "1/s", 3.0, 300.0, "position loops")),
        (
            "velocity_gain",
            Parameter::computed(
                190.0 * inertia,
                gain,
                (100.0, 100.0),
                "velocity loop of 30 Hz on the inertia: 2 pi 30 J".into(),
            ),
        ),
        ("drive_gain", Parameter::fixed(1.0, drive, "velocity_gain is in torque per speed")),
    ]
}

fn parameter_line(name: &str, parameter: &Parameter) -> String {
    let bounds = parameter.bounds.filter(|_| !parameter.fixed);
    let bounds = bounds
        .map_or(String::new(), |[low, high]| format!(", bounds = [{}, {}]", written(low), written(high)));
    let fixed = if parameter.fixed { ", fixed = true" } else { "" };
    format!(
        "{name} = {{ value = {}, unit = {}{bounds}{fixed}, source = {} }}\n",
        written(parameter.value),
        quoted(&parameter.unit),
        quoted(&parameter.source)
    )
}

fn quoted(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    format!("\"{}\"", plain.replace('\\', "\\\\").replace('"', "\\\""))
}

fn nodes(machine: &Machine, inertia: &str) -> String {
    let mut text =
        "\n# A node is a point with one angle: everything that turns rigidly together. Without inertia it is massless.\n".to_owned();
    if !machine.rotational {
        text = "\n# A node is a point with one position: everything that moves rigidly together.\n".into();
    }
    for node in &machine.nodes {
        let _ = writeln!(text, "[[nodes]]\nname = \"{}\"", node.name);
        if node.inertia.is_some() {
            let _ = writeln!(text, "inertia = \"{}_{inertia}\"", node.name);
        }
    }
    text
}

/// The effects that a diagnosis can find at a kind of place.
fn can_find(place: ActsAt) -> String {
    let ids = CATALOGUE.iter().filter(|effect| effect.acts_at == place).map(|effect| effect.id);
    format!("# `diagnose` can find here: {}.\n", ids.collect::<Vec<_>>().join(", "))
}

fn links(machine: &Machine) -> String {
    let mut text = String::new();
    let name = |node: usize| machine.nodes[node].name.as_str();
    let mut explained = Vec::new();
    for link in &machine.links {
        let (table, what, place) = match link.kind {
            LinkKind::Spring { .. } => (
                "springs",
                "# A spring with a damper. Stiffness counts at its own nodes, not at the motor's side of a gear.\n",
                ActsAt::Spring,
            ),
            LinkKind::Gear { .. } => (
                "gears",
                "# A gear without compliance; `to` turns `ratio` times slower than `from`.\n",
                ActsAt::Gear,
            ),
            LinkKind::Shaft => ("shafts", "# A rigid connection.\n", ActsAt::Shaft),
        };
        if !explained.contains(&table) {
            explained.push(table);
            let _ = write!(text, "\n{what}{}", can_find(place));
        }
        let _ = writeln!(
            text,
            "[[{table}]]\nname = \"{}\"\nfrom = \"{}\"\nto = \"{}\"",
            link.name,
            name(link.from),
            name(link.to)
        );
        let _ = match link.kind {
            LinkKind::Spring { .. } => {
                writeln!(text, "stiffness = \"{0}_stiffness\"\ndamping = \"{0}_damping\"", link.name)
            }
            LinkKind::Gear { .. } => writeln!(text, "ratio = \"{}_ratio\"", link.name),
            LinkKind::Shaft => Ok(()),
        };
    }
    text
}

/// Bearings, the winding and the servo.
fn held(machine: &Machine, bearings: &[crate::machine::Bearing<'_>]) -> String {
    let mut text = String::new();
    if !bearings.is_empty() {
        let _ = write!(text, "\n# Damping between a node and the frame.\n{}", can_find(ActsAt::Bearing));
    }
    for bearing in bearings {
        let _ = writeln!(
            text,
            "[[bearings]]\nname = \"{0}\"\nat = \"{1}\"\ndamping = \"{0}_damping\"",
            bearing.name, bearing.node.name
        );
    }
    if let Some(winding) = &machine.winding {
        let _ = write!(
            text,
            "\n# torque = torque_constant current; voltage = resistance current + back-EMF. Its back-EMF is the torque constant times the speed.\n[[motors]]\nname = \"{0}\"\nat = \"{1}\"\nresistance = \"{0}_resistance\"\ntorque_constant = \"{0}_torque_constant\"\n",
            winding.name, machine.nodes[winding.node].name
        );
        if winding.inductance.is_some() {
            let _ = writeln!(text, "inductance = \"{}_inductance\"", winding.name);
        }
    }
    if let Some(node) = machine.servo {
        let _ = write!(
            text,
            "\n# torque = drive_gain velocity_gain (position_gain (reference - angle) - speed)\n[servo]\nname = \"servo\"\nat = \"{}\"\nposition_gain = \"position_gain\"\nvelocity_gain = \"velocity_gain\"\ndrive_gain = \"drive_gain\"\n",
            machine.nodes[node].name
        );
    }
    text
}

fn channels(machine: &Machine) -> String {
    let mut text = format!(
        "\n# Inputs drive the model, outputs are predicted and compared. `column` is the name in the recording; `scale` makes SI of it.\n{}",
        can_find(ActsAt::Channel)
    );
    for channel in &machine.channels {
        text.push_str(&channel_table(channel));
    }
    text
}

fn channel_table(channel: &Channel) -> String {
    let role = if channel.is_input { "input" } else { "output" };
    let mut text = format!(
        "[channels.{}]\nrole = \"{role}\"\nquantity = \"{}\"\nat = \"{}\"\n",
        channel.name, channel.quantity, channel.at
    );
    if let Some(column) = &channel.column {
        let _ = writeln!(text, "column = {}", quoted(column));
    }
    if let Some(unit) = &channel.unit {
        let _ = writeln!(text, "unit = {}", quoted(unit));
    }
    if channel.take_rate {
        text.push_str("take = \"rate\"      # the column is an angle, of which the rate is the input\n");
    }
    if let Some(scale) = channel.scale {
        let remark =
            if channel.remark.is_empty() { String::new() } else { format!("      # {}", channel.remark) };
        let _ = writeln!(text, "scale = {}{remark}", written(scale));
    }
    text
}
