//! Families of machines, one file each. A family draws a machine; wrong start values are drawn afterwards.

mod encoder_only;
mod geared;
mod linear_axis;
mod link;
mod rigid_servo;
mod speed_loop;
mod speed_o_cam;
mod three_mass_belt;
mod two_mass;

use std::f64::consts::TAU;

use super::machine::Machine;
use super::random::Draw;

/// A family: its name, and the function that draws a machine.
pub(super) type Family = (&'static str, fn(&mut Draw) -> Machine);

/// All families.
pub(super) const FAMILIES: [Family; 9] = [
    ("speed-o-cam", speed_o_cam::draw),
    ("rigid-servo", rigid_servo::draw),
    ("two-mass", two_mass::draw),
    ("three-mass-belt", three_mass_belt::draw),
    ("encoder-only", encoder_only::draw),
    ("geared", geared::draw),
    ("link", link::draw),
    ("speed-loop", speed_loop::draw),
    ("linear-axis", linear_axis::draw),
];

/// Stiffness and damping of a spring between two inertias that oscillate against each other at a frequency.
fn spring_between(inertias: (f64, f64), hz: f64, damping_ratio: f64) -> (f64, f64) {
    let reduced = 1.0 / (1.0 / inertias.0 + 1.0 / inertias.1);
    let pace = TAU * hz;
    (reduced * pace * pace, 2.0 * damping_ratio * reduced * pace)
}

/// A torque-driven axis whose total inertia is `ratio` times the motor's: torque amplitude, N m; inertia of the motor, kg m²; total
/// viscous damping, N m s/rad.
fn servo_numbers(ratio: f64, draw: &mut Draw) -> (f64, f64, f64) {
    let torque = draw.log((0.2, 20.0));
    let acceleration = draw.log((300.0, 1500.0));
    let inertia = torque / acceleration / ratio;
    // Time constant of the axis coasting down, s.
    let damping = ratio * inertia / draw.log((0.15, 0.8));
    (torque, inertia, damping)
}
