//! URDF: a rigid drivetrain. Each node is a link with a joint to the base, and all joints mimic one.
//!
//! URDF has no springs between links. Springs are taken as rigid, so that the motion is right below the first resonance.

use socam_model::Quantity;

use crate::{
    Exported, LeftOut, Target,
    description::Description,
    error::ExportError,
    header,
    multibody::{self, Load},
    xml::{Xml, attribute, numbers},
};

pub(crate) fn write(d: &Description<'_>) -> Result<Exported, ExportError> {
    let mut left_out = Vec::new();
    let Some(least) = multibody::least_inertia(d) else {
        return Err(ExportError::NoMotion { target: "URDF", why: "no part of it has inertia".into() });
    };
    let loads = multibody::loads(d, "URDF", &mut left_out);
    let shown: Vec<usize> = (0..d.points.len())
        .filter(|node| multibody::inertia(d, *node) > 0.0 || multibody::is_wired(d, *node))
        .collect();
    let leader = leader(d, &shown);
    say_left_out(d, &shown, leader, least, &mut left_out);
    let mut xml = Xml::new()?;
    let mut lines = header::lines(d, Target::Urdf, &left_out);
    lines.push(String::new());
    lines.push("Springs are taken as rigid: all joints mimic one, and the motion is right below the first resonance.".into());
    xml.comment(&lines)?;
    xml.open("robot", &[attribute("name", &d.identifier)])?;
    xml.empty("link", &[attribute("name", "base")])?;
    for (place, node) in shown.iter().enumerate() {
        link(&mut xml, d, *node, place, least)?;
        joint(&mut xml, d, *node, leader, loads[*node])?;
    }
    transmissions(&mut xml, d)?;
    Ok(Exported { text: xml.finish()?, left_out })
}

/// The node that the others follow: that of an input, or the first.
fn leader(d: &Description<'_>, shown: &[usize]) -> usize {
    let servo = d.model.servo.as_ref().map(|servo| servo.node);
    let driven = d.inputs.iter().find_map(|signal| d.node(&signal.channel.at));
    driven.or(servo).filter(|node| shown.contains(node)).unwrap_or(shown[0])
}

/// Motion of a node divided by that of the leader, where springs are rigid.
fn ratio(d: &Description<'_>, node: usize, leader: usize) -> Option<f64> {
    let (own, lead) = (&d.points[node], &d.points[leader]);
    if own.coordinate == lead.coordinate {
        return Some(own.lever.value / lead.lever.value);
    }
    d.model.rigid_ratio(&own.name, &lead.name)
}

fn say_left_out(
    d: &Description<'_>,
    shown: &[usize],
    leader: usize,
    least: f64,
    left_out: &mut Vec<LeftOut>,
) {
    for spring in &d.model.springs {
        let why = match spring.to {
            Some(_) => "taken as rigid: URDF has no springs between links, so its resonance is missing",
            None => "URDF has no springs to the ground; nothing pulls back",
        };
        left_out.push(LeftOut::new(format!("spring {}", spring.name), why));
    }
    for node in 0..d.points.len() {
        let name = format!("node {}", d.points[node].name);
        if !shown.contains(&node) {
            left_out.push(LeftOut::new(name, "it has neither inertia nor channels and is no link"));
        } else if ratio(d, node, leader).is_none() {
            left_out.push(LeftOut::new(name, "its joint is free: no rigid ratio ties it to the others"));
        } else if multibody::inertia(d, node) == 0.0 {
            left_out.push(LeftOut::new(name, format!("it is massless and gets an inertia of {least:.3e}")));
        }
    }
}

fn link(
    xml: &mut Xml,
    d: &Description<'_>,
    node: usize,
    place: usize,
    least: f64,
) -> Result<(), ExportError> {
    let inertia = multibody::inertia(d, node).max(least);
    let (mass, about) = if d.is_rotation() { (1.0, inertia) } else { (inertia, 1e-3) };
    let origin = || attribute("xyz", numbers(&[0.0, 0.0, 0.0]));
    xml.open("link", &[attribute("name", &d.points[node].identifier)])?;
    xml.open("inertial", &[])?;
    xml.empty("origin", &[origin()])?;
    xml.empty("mass", &[attribute("value", format!("{mass:?}"))])?;
    let moment = |key| attribute(key, format!("{about:?}"));
    let zero = |key| attribute(key, "0");
    xml.empty(
        "inertia",
        &[moment("ixx"), zero("ixy"), zero("ixz"), moment("iyy"), zero("iyz"), moment("izz")],
    )?;
    xml.close()?;
    xml.open("visual", &[])?;
    xml.empty("origin", &[origin(), attribute("rpy", "0 1.5707963267948966 0")])?;
    xml.open("geometry", &[])?;
    let radius = 0.05 - 0.001 * place.min(40) as f64;
    xml.empty("cylinder", &[attribute("radius", format!("{radius:.3}")), attribute("length", "0.1")])?;
    xml.close()?;
    xml.close()?;
    xml.close()
}

fn joint(
    xml: &mut Xml,
    d: &Description<'_>,
    node: usize,
    leader: usize,
    load: Load,
) -> Result<(), ExportError> {
    let kind = if d.is_rotation() { "continuous" } else { "prismatic" };
    let name = |node: usize| d.points[node].joint.clone();
    xml.open("joint", &[attribute("name", name(node)), attribute("type", kind)])?;
    xml.empty("parent", &[attribute("link", "base")])?;
    xml.empty("child", &[attribute("link", &d.points[node].identifier)])?;
    xml.empty("origin", &[attribute("xyz", numbers(&[0.2 * node as f64, 0.0, 0.0]))])?;
    xml.empty("axis", &[attribute("xyz", "1 0 0")])?;
    if !d.is_rotation() {
        let far = |key, value: f64| attribute(key, format!("{value:?}"));
        xml.empty(
            "limit",
            &[far("lower", -1e3), far("upper", 1e3), far("effort", 1e6), far("velocity", 1e3)],
        )?;
    }
    let (damping, friction) = (format!("{:?}", load.damping), format!("{:?}", load.dry));
    xml.empty("dynamics", &[attribute("damping", damping), attribute("friction", friction)])?;
    if let Some(ratio) = ratio(d, node, leader).filter(|_| node != leader) {
        let multiplier = attribute("multiplier", format!("{ratio:?}"));
        xml.empty("mimic", &[attribute("joint", name(leader)), multiplier, attribute("offset", "0")])?;
    }
    xml.close()
}

/// A transmission for each input that drives a joint.
fn transmissions(xml: &mut Xml, d: &Description<'_>) -> Result<(), ExportError> {
    for signal in &d.inputs {
        let servo = d.model.servo.as_ref().map(|servo| servo.node);
        let (node, interface) = match signal.channel.quantity {
            Quantity::Speed => (d.node(&signal.channel.at), "VelocityJointInterface"),
            Quantity::Reference => (servo, "PositionJointInterface"),
            Quantity::Torque => (d.node(&signal.channel.at), "EffortJointInterface"),
            _ => continue,
        };
        let Some(node) = node else { continue };
        let interface = format!("hardware_interface/{interface}");
        xml.open("transmission", &[attribute("name", format!("transmission_{}", signal.identifier))])?;
        xml.text("type", &[], "transmission_interface/SimpleTransmission")?;
        xml.open("joint", &[attribute("name", d.points[node].joint.clone())])?;
        xml.text("hardwareInterface", &[], &interface)?;
        xml.close()?;
        xml.open("actuator", &[attribute("name", &signal.identifier)])?;
        // The value at the joint is the recorded value times this gain.
        xml.text("mechanicalReduction", &[], &format!("{:?}", d.gain_value(signal)))?;
        xml.close()?;
        xml.close()?;
    }
    Ok(())
}
