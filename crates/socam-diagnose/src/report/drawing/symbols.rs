//! Symbols of the drawing's elements. The origin (0, 0) is a point of the wire that runs through them.

use maud::{Markup, html};
use socam_model::{Motion, Quantity, Role, layout::ElementKind};

use crate::report::words;

/// Half the width of a symbol; the wire begins there.
pub(super) fn half_width(kind: ElementKind) -> f64 {
    match kind {
        ElementKind::Motor => 21.0,
        ElementKind::Load => 17.0,
        ElementKind::Inertia => 13.0,
        ElementKind::Point => 2.5,
        ElementKind::Spring { .. } | ElementKind::Shaft => 30.0,
        ElementKind::Gear { .. } => 27.0,
        ElementKind::Differential { .. } => 19.0,
        ElementKind::Servo | ElementKind::Winding => 26.0,
        ElementKind::Bearing { .. } | ElementKind::GroundSpring { .. } | ElementKind::Sensor { .. } => 0.0,
    }
}

/// Distance from the wire to a symbol's lower edge.
pub(super) fn reach(kind: ElementKind) -> f64 {
    match kind {
        ElementKind::Motor => 21.0,
        ElementKind::Load => 27.0,
        ElementKind::Inertia => 22.0,
        ElementKind::Point => 11.0,
        ElementKind::Spring { damped: true } | ElementKind::Servo | ElementKind::Winding => 18.0,
        ElementKind::Spring { damped: false } => 9.0,
        ElementKind::Gear { .. } => 29.0,
        ElementKind::Differential { .. } => 19.0,
        _ => 7.0,
    }
}

/// A symbol on the wire.
pub(super) fn chain(kind: ElementKind) -> Markup {
    html! {
        @match kind {
            ElementKind::Motor => {
                circle class="body" r="21" {}
                text class="letter" y="6" text-anchor="middle" { "M" }
            }
            ElementKind::Load => { rect class="body" x="-17" y="-27" width="34" height="54" rx="2" {} }
            ElementKind::Inertia => { rect class="body" x="-13" y="-22" width="26" height="44" rx="2" {} }
            ElementKind::Point => { rect class="solid" x="-2.5" y="-11" width="5" height="22" rx="1" {} }
            ElementKind::Spring { damped: true } => {
                path class="wire" d="M-30 0h6M24 0h6M-24-9v21M24-9v21" {}
                path class="shape" d="M-24-9h6l3-6 6 12 6-12 6 12 6-12 6 12 3-6h6" {}
                path class="shape" d="M-24 12h16M8 6h-16v12h16M1 8v8M1 12h23" {}
            }
            ElementKind::Spring { damped: false } => {
                path class="shape" d="M-30 0h10l3.5-8 6.5 16 6.5-16 6.5 16 6.5-16 6.5 16 3.5-8h10" {}
            }
            ElementKind::Gear { ratio } => {
                path class="wire" d="M-27 0h3M20 0h7" {}
                circle class="teeth" cx="-15" r="8" {}
                circle class="teeth" cx="8" r="15" {}
                circle class="body" cx="-15" r="6.5" {}
                circle class="body" cx="8" r="13.5" {}
                text class="name" y="29" text-anchor="middle" { (words::minus(&format!("{ratio}"))) " : 1" }
            }
            ElementKind::Shaft => { path class="shape" d="M-30-3.5h60v7h-60z" {} }
            ElementKind::Differential { factor } => {
                circle class="body" r="19" {}
                text class="name" y="4" text-anchor="middle" { "\u{d7}" (words::minus(&format!("{}", (1e4 * factor).round() / 1e4))) }
            }
            ElementKind::Winding => {
                rect class="body" x="-26" y="-18" width="52" height="36" rx="6" {}
                path class="shape" d="M-21 0a5.25 5.25 0 0 1 10.5 0a5.25 5.25 0 0 1 10.5 0a5.25 5.25 0 0 1 10.5 0a5.25 5.25 0 0 1 10.5 0" {}
            }
            ElementKind::Servo => {
                rect class="body" x="-26" y="-18" width="52" height="36" rx="6" {}
                text class="name" y="4" text-anchor="middle" { "servo" }
            }
            _ => {}
        }
    }
}

/// A symbol that hangs from (0, 0) and stands on the ground.
pub(super) fn grounded(kind: ElementKind) -> Markup {
    html! {
        @match kind {
            ElementKind::GroundSpring { .. } => {
                path class="shape" d="M0 0v4l-7 3 14 5-14 5 14 5-14 5 7 3v4" {}
            }
            ElementKind::Bearing { damped: true } => {
                path class="shape" d="M0 0v16M-6 16h12M-9 10v16h18v-16M0 26v8" {}
            }
            _ => {
                path class="shape" d="M0 0v12" {}
                circle class="body" cy="19" r="7" {}
                path class="shape" d="M-11 26h22M0 26v8" {}
            }
        }
        path class="shape" d="M-14 34h28M-11 34l-4 6M-4 34l-4 6M3 34l-4 6M10 34l-4 6" {}
    }
}

/// Quantity and role of a channel in words.
pub(super) fn measures(quantity: Quantity, role: Role, motion: Motion) -> String {
    let rotates = motion == Motion::Rotation;
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
        Quantity::Time => "time",
        Quantity::Turned => "angle turned",
        Quantity::Change => "rate of change",
    };
    match role {
        Role::Input => format!("{quantity}, drives the model"),
        Role::Output => format!("{quantity}, predicted by the model"),
    }
}
