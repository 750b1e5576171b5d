//! Elements in words, for whoever points at one.

use crate::{
    Motion, Quantity, Role,
    layout::{Element, ElementKind},
};

/// Name and kind of an element.
pub(super) fn hint(element: &Element, motion: Motion) -> String {
    let rotates = motion == Motion::Rotation;
    let kind = match element.kind {
        ElementKind::Motor => "driven node".to_owned(),
        ElementKind::Inertia if rotates => "inertia".to_owned(),
        ElementKind::Inertia => "mass".to_owned(),
        ElementKind::Load => "load".to_owned(),
        ElementKind::Point => "massless node".to_owned(),
        ElementKind::Spring { damped: true } => "spring with damper".to_owned(),
        ElementKind::Spring { damped: false } => "spring".to_owned(),
        ElementKind::Gear { ratio } => format!("gear, {}", crate::drawing::symbols::ratio(ratio)),
        ElementKind::Differential { .. } => "differential".to_owned(),
        ElementKind::Shaft => "rigid shaft".to_owned(),
        ElementKind::Bearing { damped: true } => "bearing with damping".to_owned(),
        ElementKind::Bearing { damped: false } => "bearing".to_owned(),
        ElementKind::GroundSpring { .. } => "spring to the ground".to_owned(),
        ElementKind::Winding => "winding of a motor".to_owned(),
        ElementKind::Servo => "drive in closed loop".to_owned(),
        ElementKind::Sensor { role, quantity } => measures(quantity, role, rotates),
    };
    format!("{}: {kind}", element.name)
}

/// Quantity and role of a channel.
fn measures(quantity: Quantity, role: Role, rotates: bool) -> String {
    let quantity = match quantity {
        Quantity::Speed => "speed",
        Quantity::Angle if rotates => "angle",
        Quantity::Angle => "position",
        Quantity::Acceleration => "acceleration",
        Quantity::Torque if rotates => "torque",
        Quantity::Torque => "force",
        Quantity::Reference => "reference",
        Quantity::Voltage => "voltage",
        Quantity::Current => "current",
        Quantity::Signal if role == Role::Input => return "signal, read by laws".to_owned(),
        Quantity::Signal => "signal",
        Quantity::Time => "time",
        Quantity::Turned => "angle turned",
        Quantity::Change => "rate of change",
    };
    match role {
        Role::Input => format!("{quantity}, drives the model"),
        Role::Output => format!("{quantity}, predicted by the model"),
    }
}
