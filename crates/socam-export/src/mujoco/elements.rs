//! Joints' loads, tendons, actuators and sensors.

use socam_model::{Quantity, Site, effects::Form};

use super::{Joint, chain::Chain, is_prescribed, leave_out, shapes};
use crate::{
    LeftOut,
    description::{Description, Signal},
    error::ExportError,
    shape::Shape,
    xml::{Xml, attribute, numbers},
};

/// What bearings and laws of nodes put on each joint.
pub(super) fn joints(d: &Description<'_>, left_out: &mut Vec<LeftOut>) -> Vec<Joint> {
    let mut joints = vec![Joint::default(); d.coordinates.len()];
    for bearing in &d.model.bearings {
        if let Some(damping) = bearing.damping {
            let point = &d.points[bearing.node];
            joints[point.coordinate].damping += d.value(damping) * point.lever.value.powi(2);
        }
    }
    for (used, shape) in d.model.effects.iter().zip(shapes(d)) {
        let Site::Node(node) = used.at else { continue };
        if !matches!(used.effect.form, Form::Laws(_)) {
            continue;
        }
        let (coordinate, lever) = (d.points[node].coordinate, d.points[node].lever.value);
        let joint = &mut joints[coordinate];
        match shape {
            Some(Shape::Dry { torque }) => {
                joint.dry += d.value(torque) * lever.abs();
                leave_out(
                    left_out,
                    used,
                    "held as frictionloss, which sticks; its transition speed is not held",
                );
            }
            Some(Shape::Presliding { torque }) => {
                joint.dry += d.value(torque) * lever.abs();
                leave_out(left_out, used, "held as frictionloss; its presliding deflection is not held");
            }
            Some(Shape::Falling { torque, .. }) => {
                joint.dry += d.value(torque) * lever.abs();
                leave_out(
                    left_out,
                    used,
                    "held as frictionloss of its torque in motion; what is more at standstill is not held",
                );
            }
            Some(Shape::Quadratic { coefficient }) => {
                joint.quadratic += d.value(coefficient) * lever.abs().powi(3);
            }
            Some(Shape::Against { torque }) => joint.constant -= d.value(torque) * lever,
            Some(Shape::Unbalance { torque, phase })
                if lever == 1.0 && d.is_rotation() && joint.unbalance.is_none() && d.value(torque) > 0.0 =>
            {
                joint.unbalance = Some((d.value(torque), d.value(phase)));
            }
            _ => leave_out(left_out, used, "MuJoCo has no element for it"),
        }
    }
    for (index, signal) in d.inputs.iter().enumerate() {
        let own =
            d.model.effects.iter().zip(shapes(d)).filter(|(used, _)| used.at == Site::Channel(signal.index));
        for (used, shape) in own {
            match (shape, d.node(&signal.channel.at)) {
                (Some(Shape::Offset { offset }), Some(node))
                    if signal.channel.quantity == Quantity::Torque =>
                {
                    let torque =
                        d.gain_value(&d.inputs[index]) * d.value(offset) * d.points[node].lever.value;
                    joints[d.points[node].coordinate].constant -= torque;
                }
                _ if matches!(used.effect.form, Form::Gain) => {}
                _ => leave_out(
                    left_out,
                    used,
                    "it falsifies an input, and MuJoCo's actuators hold its gain only",
                ),
            }
        }
    }
    joints
}

/// Lists effects at springs, gears and outputs that are not held, and inputs that nothing takes.
pub(super) fn say_left_out(d: &Description<'_>, chain: &Chain, left_out: &mut Vec<LeftOut>) {
    for (used, shape) in d.model.effects.iter().zip(shapes(d)) {
        match (used.at, shape, used.effect.form) {
            (Site::Spring(_), Some(Shape::Cubic { .. }), _) | (_, _, Form::Compliance | Form::Inertia) => {}
            (Site::Gear { .. }, Some(Shape::Play { .. }), _) => {
                leave_out(
                    left_out,
                    used,
                    "held as a dead band of the tendon; the damper of the contact acts in it too",
                );
            }
            (Site::Spring(_) | Site::Gear { .. }, ..) => {
                leave_out(left_out, used, "MuJoCo has no element for it")
            }
            (Site::Channel(channel), _, form) => {
                let is_output = d.outputs.iter().any(|signal| signal.index == channel);
                if is_output && !matches!(form, Form::Gain) {
                    leave_out(
                        left_out,
                        used,
                        "it changes a reading and not the motion; MuJoCo's sensors are ideal",
                    );
                }
            }
            (Site::Node(_), ..) => {}
        }
    }
    for signal in &d.inputs {
        if d.twisted(signal).is_some() {
            let why = "MuJoCo's tendons take no added twist while they run";
            left_out.push(LeftOut::new(format!("input {}", signal.channel.name), why));
        }
    }
    for signal in &d.outputs {
        let gone =
            d.node(&signal.channel.at).is_some_and(|node| chain.inertia[d.points[node].coordinate].is_none());
        if signal.channel.quantity == Quantity::Acceleration || gone {
            let why = "there is no sensor for it; an acceleration is in qacc";
            left_out.push(LeftOut::new(format!("output {}", signal.channel.name), why));
        }
    }
}

/// A fixed tendon for each spring, and one for each node whose motion differs from its joint's.
pub(super) fn tendons(xml: &mut Xml, d: &Description<'_>, chain: &Chain) -> Result<(), ExportError> {
    xml.open("tendon", &[])?;
    for link in &chain.links {
        let mut attributes = vec![attribute("name", &link.name)];
        let laws = d.model.effects.iter().zip(shapes(d));
        let own = |used: &socam_model::EffectUse| match used.at {
            Site::Spring(spring) | Site::Gear { contact: spring, .. } => {
                link.springs.len() == 1 && link.springs[0].0 == spring
            }
            _ => false,
        };
        let laws: Vec<Shape> = laws.filter(|(used, _)| own(used)).filter_map(|(_, shape)| shape).collect();
        let cubic: f64 =
            laws.iter().map(|law| if let Shape::Cubic { cubic } = law { d.value(*cubic) } else { 0.0 }).sum();
        let stiffness = if cubic == 0.0 {
            format!("{:?}", link.stiffness)
        } else {
            numbers(&[link.stiffness, 0.0, link.stiffness * cubic])
        };
        attributes.push(attribute("stiffness", stiffness));
        if link.damping > 0.0 {
            attributes.push(attribute("damping", format!("{:?}", link.damping)));
        }
        let gap = laws
            .iter()
            .find_map(|law| if let Shape::Play { gap } = law { Some(d.value(*gap)) } else { None });
        let free = gap.map_or("0".to_owned(), |gap| numbers(&[-0.5 * gap, 0.5 * gap]));
        attributes.push(attribute("springlength", free));
        xml.open("fixed", &attributes)?;
        for (coordinate, coefficient) in &link.coefficients {
            joint(xml, d, chain, *coordinate, *coefficient)?;
        }
        xml.close()?;
    }
    for point in d.points.iter().filter(|point| chain.inertia[point.coordinate].is_some()) {
        xml.open("fixed", &[attribute("name", format!("node_{}", point.identifier))])?;
        joint(xml, d, chain, point.coordinate, point.lever.value)?;
        xml.close()?;
    }
    xml.close()
}

fn joint(
    xml: &mut Xml,
    d: &Description<'_>,
    chain: &Chain,
    coordinate: usize,
    coefficient: f64,
) -> Result<(), ExportError> {
    let coefficient = attribute("coef", format!("{coefficient:?}"));
    xml.empty("joint", &[attribute("joint", chain.joint(d, coordinate)), coefficient])
}

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
        let node = format!("node_{}", d.points[servo.node].identifier);
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
        let node = node.map(|node| format!("node_{}", d.points[node].identifier));
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
