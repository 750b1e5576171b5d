//! Common parts of URDF and SDF: loads of nodes, and parts of the model that neither format holds.

use socam_model::{Quantity, Site, effects::Form};

use crate::{LeftOut, description::Description, shape::Shape};

/// Load that bearings and laws put on a node.
#[derive(Clone, Copy, Default)]
pub(crate) struct Load {
    pub(crate) damping: f64,
    pub(crate) dry: f64,
}

/// Loads of the nodes; effects that are not held are listed.
pub(crate) fn loads(d: &Description<'_>, target: &str, left_out: &mut Vec<LeftOut>) -> Vec<Load> {
    let mut loads = vec![Load::default(); d.points.len()];
    for bearing in &d.model.bearings {
        loads[bearing.node].damping += bearing.damping.map_or(0.0, |damping| d.value(damping));
    }
    for used in &d.model.effects {
        let mut leave_out = |why: String| {
            left_out.push(LeftOut::new(format!("{} at {}", used.effect.id, used.place), why));
        };
        match (used.at, used.effect.form, Shape::of(used)) {
            (_, Form::Inertia | Form::Compliance, _) => {}
            (Site::Node(node), _, Some(Shape::Dry { torque })) => loads[node].dry += d.value(torque),
            (Site::Node(node), _, Some(Shape::Presliding { torque })) => {
                loads[node].dry += d.value(torque);
                leave_out("held as dry friction; its presliding deflection is not held".into());
            }
            (Site::Node(node), _, Some(Shape::Falling { torque, .. })) => {
                loads[node].dry += d.value(torque);
                leave_out(
                    "held as dry friction of its torque in motion; what is more at standstill is not held"
                        .into(),
                );
            }
            (Site::Channel(_), ..) => leave_out(format!("{target} has no sensors or inputs with errors")),
            _ => leave_out(format!("{target} has no element for it")),
        }
    }
    if let Some(servo) = &d.model.servo {
        let why = "its gains belong to the controller that drives the joint".to_owned();
        left_out.push(LeftOut::new(format!("servo {}", servo.name), why));
    }
    for signal in &d.inputs {
        if signal.channel.quantity == Quantity::Angle {
            let why = format!("{target} has no input that twists a spring");
            left_out.push(LeftOut::new(format!("input {}", signal.channel.name), why));
        }
    }
    loads
}

/// Inertia of a node, SI.
pub(crate) fn inertia(d: &Description<'_>, node: usize) -> f64 {
    d.points[node].inertias.iter().map(|own| d.value(*own)).sum()
}

/// Whether an input acts on a node or an output measures it.
pub(crate) fn is_wired(d: &Description<'_>, node: usize) -> bool {
    let servo = d.model.servo.as_ref().is_some_and(|servo| servo.node == node);
    servo || d.inputs.iter().chain(&d.outputs).any(|signal| d.node(&signal.channel.at) == Some(node))
}

/// Inertia of a node that has none: far below all others.
pub(crate) fn least_inertia(d: &Description<'_>) -> Option<f64> {
    let all = (0..d.points.len()).map(|node| inertia(d, node)).filter(|own| *own > 0.0);
    all.reduce(f64::min).map(|least| 1e-3 * least)
}

/// Why nothing would drive a chain of bodies: all inputs twist springs.
pub(crate) fn no_drive(d: &Description<'_>) -> Option<String> {
    let twisting = d.inputs.iter().all(|signal| d.twisted(signal).is_some());
    let names: Vec<&str> = d.inputs.iter().map(|signal| signal.channel.name.as_str()).collect();
    twisting.then(|| format!("its only input, {}, twists a spring while it runs", names.join(", ")))
}
