//! MuJoCo: a body with one joint for each coordinate, and a fixed tendon for each spring.
//!
//! Rigid gears and shafts leave one coordinate each, so that no soft equality constraint stands for them: the inertias behind a gear are
//! those seen from the joint, and the other nodes of the coordinate are tendons whose coefficient is the ratio.

mod chain;
mod elements;
mod wiring;

use crate::{
    Exported, LeftOut, Target,
    description::{CoordinateMotion, Description},
    error::ExportError,
    header,
    shape::Shape,
    xml::{Xml, attribute, numbers},
};
use chain::Chain;

/// Standard gravity, m/s2.
const GRAVITY: f64 = 9.806_65;

/// Torques that act on the joint of a coordinate.
#[derive(Clone, Default)]
pub(crate) struct Joint {
    pub(crate) damping: f64,
    pub(crate) quadratic: f64,
    pub(crate) dry: f64,
    pub(crate) constant: f64,
    /// Torque and phase of an eccentric weight.
    pub(crate) unbalance: Option<(f64, f64)>,
}

pub(crate) fn write(d: &Description<'_>) -> Result<Exported, ExportError> {
    let mut left_out = Vec::new();
    let chain = Chain::of(d, &mut left_out)?;
    let joints = elements::joints(d, &mut left_out);
    elements::say_left_out(d, &chain, &mut left_out);
    let mut xml = Xml::new()?;
    let mut lines = header::lines(d, Target::Mujoco, &left_out);
    lines.push(String::new());
    lines.push(format!(
        "A joint for each coordinate, a fixed tendon for each spring; gears are coefficients of tendons. Time step {:?} s.",
        chain.time_step_s
    ));
    xml.comment(&lines)?;
    xml.open("mujoco", &[attribute("model", &d.identifier)])?;
    xml.empty("compiler", &[attribute("angle", "radian"), attribute("inertiafromgeom", "false")])?;
    xml.empty(
        "option",
        &[
            attribute("timestep", format!("{:?}", chain.time_step_s)),
            attribute("integrator", "implicitfast"),
            attribute("gravity", numbers(&[0.0, 0.0, -GRAVITY])),
            attribute("solver", "Newton"),
            attribute("iterations", "100"),
            attribute("tolerance", "1e-12"),
        ],
    )?;
    xml.open("worldbody", &[])?;
    for (coordinate, joint) in joints.iter().enumerate() {
        if let Some(inertia) = chain.inertia[coordinate] {
            body(&mut xml, d, &chain, coordinate, inertia, joint)?;
        }
    }
    xml.close()?;
    elements::tendons(&mut xml, d, &chain)?;
    wiring::actuators(&mut xml, d, &chain, &joints)?;
    wiring::sensors(&mut xml, d, &chain)?;
    wiring::readings(&mut xml, d, &chain)?;
    Ok(Exported { text: xml.finish()?, left_out })
}

/// A body with its joint. The inertia is about the joint's axis, x.
fn body(
    xml: &mut Xml,
    d: &Description<'_>,
    chain: &Chain,
    coordinate: usize,
    inertia: f64,
    joint: &Joint,
) -> Result<(), ExportError> {
    let point = &d.points[d.coordinates[coordinate].node];
    let place = numbers(&[0.2 * coordinate as f64, 0.0, 0.0]);
    xml.open("body", &[attribute("name", &point.identifier), attribute("pos", place)])?;
    let (mass, centre, about) = match joint.unbalance {
        Some((torque, phase)) if torque > 0.0 && d.is_rotation() => {
            let radius = (0.5 * inertia * GRAVITY / torque).min(0.1);
            let mass = torque / (GRAVITY * radius);
            (mass, [0.0, radius * phase.sin(), -radius * phase.cos()], inertia - mass * radius * radius)
        }
        _ if d.is_rotation() => (1.0, [0.0; 3], inertia),
        _ => (inertia, [0.0; 3], 1e-3),
    };
    xml.empty(
        "inertial",
        &[
            attribute("pos", numbers(&centre)),
            attribute("mass", format!("{mass:?}")),
            attribute("diaginertia", numbers(&[about; 3])),
        ],
    )?;
    let kind = if d.is_rotation() { "hinge" } else { "slide" };
    let mut attributes = vec![
        attribute("name", chain.joint(d, coordinate)),
        attribute("type", kind),
        attribute("axis", "1 0 0"),
    ];
    if joint.quadratic != 0.0 {
        // The second number multiplies speed times its magnitude.
        attributes.push(attribute("damping", numbers(&[joint.damping, joint.quadratic])));
    } else if joint.damping != 0.0 {
        attributes.push(attribute("damping", format!("{:?}", joint.damping)));
    }
    if joint.dry > 0.0 {
        attributes.push(attribute("frictionloss", format!("{:?}", joint.dry)));
        // Friction is as hard as the solver allows: it stops a joint within two steps, and creeps by 1e-4 of the motion that it
        // stops.
        attributes.push(attribute("solreffriction", numbers(&[2.0 * chain.time_step_s, 1.0])));
        attributes.push(attribute("solimpfriction", numbers(&[0.9999, 0.9999, 0.001, 0.5, 2.0])));
    }
    xml.empty("joint", &attributes)?;
    xml.empty(
        "geom",
        &[
            attribute("type", if d.is_rotation() { "cylinder" } else { "box" }),
            attribute("fromto", "-0.05 0 0 0.05 0 0"),
            attribute("size", "0.05"),
            attribute("contype", "0"),
            attribute("conaffinity", "0"),
        ],
    )?;
    xml.close()
}

/// Whether a coordinate is driven by a prescribed speed.
pub(crate) fn is_prescribed(d: &Description<'_>, coordinate: usize) -> bool {
    d.coordinates[coordinate].kind == CoordinateMotion::Prescribed
}

/// Shape of each effect, `None` where MuJoCo has no element for it.
pub(crate) fn shapes(d: &Description<'_>) -> Vec<Option<Shape>> {
    d.model.effects.iter().map(Shape::of).collect()
}

pub(crate) fn leave_out(left_out: &mut Vec<LeftOut>, used: &socam_model::EffectUse, why: &str) {
    left_out.push(LeftOut::new(format!("{} at {}", used.effect.id, used.place), why));
}
