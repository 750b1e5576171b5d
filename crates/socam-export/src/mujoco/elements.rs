//! Loads of joints, tendons, and parts that are left out.

use socam_model::{Quantity, Site, effects::Form};

use super::{
    Joint,
    chain::{Chain, Link},
    leave_out, shapes,
};
use crate::{
    LeftOut,
    description::Description,
    error::ExportError,
    shape::Shape,
    xml::{Xml, attribute, numbers},
};

/// Torques that bearings and laws of nodes put on each joint.
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
                    "held as limits of a tendon, from which the teeth do not rebound; impacts come at other moments",
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
            (Site::Node(_) | Site::Servo, ..) => {}
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

/// Writes a fixed tendon for each spring, and one for each node whose motion differs from its joint's.
pub(super) fn tendons(xml: &mut Xml, d: &Description<'_>, chain: &Chain) -> Result<(), ExportError> {
    xml.open("tendon", &[])?;
    for link in &chain.links {
        let attributes = spring(d, chain, link);
        xml.open("fixed", &attributes)?;
        for (coordinate, coefficient) in &link.coefficients {
            joint(xml, d, chain, *coordinate, *coefficient)?;
        }
        xml.close()?;
    }
    for point in d.points.iter().filter(|point| chain.inertia[point.coordinate].is_some()) {
        xml.open("fixed", &[attribute("name", &point.tendon)])?;
        joint(xml, d, chain, point.coordinate, point.lever.value)?;
        xml.close()?;
    }
    xml.close()
}

/// Attributes of a spring's tendon.
fn spring(d: &Description<'_>, chain: &Chain, link: &Link) -> Vec<(&'static str, String)> {
    let mut attributes = vec![attribute("name", &link.name)];
    let own = |used: &socam_model::EffectUse| match used.at {
        Site::Spring(spring) | Site::Gear { contact: spring, .. } => {
            link.springs.len() == 1 && link.springs[0].0 == spring
        }
        _ => false,
    };
    let laws = d.model.effects.iter().zip(shapes(d)).filter(|(used, _)| own(used));
    let laws: Vec<Shape> = laws.filter_map(|(_, shape)| shape).collect();
    let gap =
        laws.iter().find_map(|law| if let Shape::Play { gap } = law { Some(d.value(*gap)) } else { None });
    if let Some(gap) = gap {
        // Teeth that meet are a limit, as hard as the solver allows, from which nothing rebounds.
        attributes.push(attribute("limited", "true"));
        attributes.push(attribute("range", numbers(&[-0.5 * gap, 0.5 * gap])));
        attributes.push(attribute("solreflimit", numbers(&[2.0 * chain.time_step_s, 1.0])));
        attributes.push(attribute("solimplimit", numbers(&[0.9999, 0.9999, 0.001, 0.5, 2.0])));
        return attributes;
    }
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
    attributes.push(attribute("springlength", "0"));
    attributes
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
