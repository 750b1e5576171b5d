//! Actuators, sensors, and the numbers by which their values become columns of a recording.

use socam_model::Quantity;

use super::{Joint, chain::Chain, is_prescribed};
use crate::{
    description::{Description, Signal},
    error::ExportError,
    xml::{Xml, attribute, numbers},
};

/// An actuator for each input, in their order, and one for each constant torque.
pub(super) fn actuators(
    xml: &mut Xml,
    d: &Description<'_>,
    chain: &Chain,
    joints: &[Joint],
) -> Result<(), ExportError> {
    xml.open("actuator", &[])?;
    for signal in &d.inputs {
        actuator(xml, d, chain, signal)?;
    }
    for (coordinate, own) in joints.iter().enumerate().filter(|(_, own)| own.constant != 0.0) {
        let name = chain.joint(d, coordinate);
        xml.empty(
            "general",
            &[
                attribute("name", format!("constant_{name}")),
                attribute("joint", name),
                attribute("gainprm", "0"),
                attribute("biastype", "affine"),
                attribute("biasprm", numbers(&[own.constant, 0.0, 0.0])),
            ],
        )?;
    }
    xml.close()
}

fn actuator(
    xml: &mut Xml,
    d: &Description<'_>,
    chain: &Chain,
    signal: &Signal<'_>,
) -> Result<(), ExportError> {
    let (name, gain) = (attribute("name", &signal.identifier), d.gain_value(signal));
    if let (Quantity::Reference, Some(servo)) = (signal.channel.quantity, &d.model.servo) {
        let rate = d.value(servo.drive_gain) * d.value(servo.velocity_gain);
        let stiffness = rate * d.value(servo.position_gain);
        let node = d.points[servo.node].tendon.clone();
        return xml.empty(
            "general",
            &[
                name,
                attribute("tendon", node),
                attribute("gainprm", format!("{:?}", stiffness * gain)),
                attribute("biastype", "affine"),
                attribute("biasprm", numbers(&[0.0, -stiffness, -rate])),
            ],
        );
    }
    let Some(node) = d.node(&signal.channel.at) else { return Ok(()) };
    let point = &d.points[node];
    let joint = attribute("joint", chain.joint(d, point.coordinate));
    if signal.channel.quantity == Quantity::Speed && is_prescribed(d, point.coordinate) {
        // Stiffer than everything it moves, so that the joint has the wanted speed after one step.
        let held = chain.links.iter().flat_map(|link| {
            let own = link.coefficients.iter().filter(|(own, _)| *own == point.coordinate);
            own.map(|(_, coefficient)| {
                coefficient.powi(2) * (link.stiffness * chain.time_step_s + link.damping)
            })
        });
        let own = chain.inertia[point.coordinate].unwrap_or(0.0) / chain.time_step_s;
        let stiff = 1e4 * (held.sum::<f64>() + own);
        let lever = point.lever.value;
        return xml.empty(
            "general",
            &[
                name,
                joint,
                attribute("gainprm", format!("{:?}", stiff * gain / lever)),
                attribute("biastype", "affine"),
                attribute("biasprm", numbers(&[0.0, 0.0, -stiff])),
            ],
        );
    }
    if signal.channel.quantity == Quantity::Torque {
        let gear = attribute("gear", format!("{:?}", gain * point.lever.value));
        return xml.empty("motor", &[name, joint, gear]);
    }
    Ok(())
}

/// A sensor for each output, in their order; for a torque through a spring two: the twist and its rate.
pub(super) fn sensors(xml: &mut Xml, d: &Description<'_>, chain: &Chain) -> Result<(), ExportError> {
    xml.open("sensor", &[])?;
    for signal in &d.outputs {
        let name = &signal.identifier;
        let node =
            d.node(&signal.channel.at).filter(|node| chain.inertia[d.points[*node].coordinate].is_some());
        let node = node.map(|node| d.points[node].tendon.clone());
        match (signal.channel.quantity, node, link(d, chain, signal)) {
            (Quantity::Speed, Some(node), _) => {
                xml.empty("tendonvel", &[attribute("name", name), attribute("tendon", node)])?;
            }
            (Quantity::Angle, Some(node), _) => {
                xml.empty("tendonpos", &[attribute("name", name), attribute("tendon", node)])?;
            }
            (Quantity::Torque, _, Some((link, _))) => {
                let tendon = || attribute("tendon", &chain.links[link].name);
                xml.empty("tendonpos", &[attribute("name", format!("{name}_twist")), tendon()])?;
                xml.empty("tendonvel", &[attribute("name", format!("{name}_rate")), tendon()])?;
            }
            (Quantity::Torque, _, None) => {
                let reference = d.inputs.iter().find(|signal| signal.channel.quantity == Quantity::Reference);
                if let Some(reference) = reference {
                    xml.empty(
                        "actuatorfrc",
                        &[attribute("name", name), attribute("actuator", &reference.identifier)],
                    )?;
                }
            }
            _ => {}
        }
    }
    xml.close()
}

/// For each output its gain, or for a torque through a spring the numbers by which twist, rate and cube of the twist are multiplied.
pub(super) fn readings(xml: &mut Xml, d: &Description<'_>, chain: &Chain) -> Result<(), ExportError> {
    xml.open("custom", &[])?;
    for signal in &d.inputs {
        let (scale, offset) = (signal.channel.scale, signal.channel.offset);
        let name = || attribute("name", &signal.identifier);
        xml.empty("numeric", &[name(), attribute("data", numbers(&[scale, offset]))])?;
        let words =
            "the control of this name is the numbers of this name, a and b, as a times the column plus b";
        let words = format!("{}: {words}", signal.channel.column);
        xml.empty("text", &[name(), attribute("data", words)])?;
    }
    for signal in &d.outputs {
        let gain = d.gain_value(signal);
        let data = match link(d, chain, signal) {
            Some((link, share)) if signal.channel.quantity == Quantity::Torque => {
                let link = &chain.links[link];
                vec![gain * share * link.stiffness, gain * share * link.damping]
            }
            _ => vec![gain],
        };
        let name = attribute("name", &signal.identifier);
        xml.empty("numeric", &[name, attribute("data", numbers(&data))])?;
        let words = if data.len() == 2 {
            "stiffness times the twist plus damping times its rate, both in the numeric of this name"
        } else {
            "the sensor of this name times the numeric of this name"
        };
        let words = format!("{}: {words}", signal.channel.column);
        xml.empty("text", &[attribute("name", &signal.identifier), attribute("data", words)])?;
    }
    xml.close()
}

/// The link that carries the torque of a channel, and the channel's torque per torque of the link.
fn link(d: &Description<'_>, chain: &Chain, signal: &Signal<'_>) -> Option<(usize, f64)> {
    let spring = d.spring(&signal.channel.at)?;
    chain.links.iter().enumerate().find_map(|(index, link)| {
        let own = link.springs.iter().find(|(own, _)| *own == spring)?;
        Some((index, own.1))
    })
}
