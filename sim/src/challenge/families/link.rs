//! A link under gravity on a reducer, in a position loop; the loop's torque is the model's input, the link's angle is measured.

use std::f64::consts::TAU;

use super::servo_numbers;
use crate::challenge::machine::{Control, Known, Machine, Measure, Sort};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let mut machine = Machine::new("link", draw.one_of(&[250.0, 500.0]), (0.2, 4.0));
    let (ratio, share) = (draw.whole(10, 50) as f64, draw.log((0.7, 3.0)));
    let (_, inertia, _) = servo_numbers(1.0 + share, draw);
    let link_inertia = share * inertia * ratio * ratio;
    let all = inertia * ratio * ratio + link_inertia;
    let motor = machine.body("motor", inertia, Known::Fixed);
    let flange = machine.body("flange", 0.1 * link_inertia, Known::Fixed);
    let link = machine.body("link", 0.9 * link_inertia, Known::Open);
    machine.gear("reducer", (motor, flange), ratio);
    machine.shaft("link_shaft", (flange, link));
    // The link's pendulum frequency is about 1 Hz.
    let swing = TAU * draw.between(0.6, 1.1);
    let torque = machine.number("link_gravity", Sort::Torque, all * swing * swing, Known::Open);
    machine.gravity = Some((link, torque));
    machine.bearing("motor_bearing", motor, 0.0);
    machine.bearing("link_bearing", link, all * swing * draw.log((0.2, 0.8)));
    // The loop's bandwidth is about four times that; its torque acts at the motor.
    let pace = 4.0 * swing;
    let velocity_gain = 2.0 * all * pace / (ratio * ratio);
    machine.control = Control::Position { position_gain: 0.5 * pace, velocity_gain };
    machine.sensor("link_angle", Measure::Angle, link);
    machine.sensors[0].step = TAU / draw.one_of(&[16_384.0, 65_536.0]);
    // Amplitude of the motor's angle, rad.
    machine.amplitude = ratio * draw.between(0.8, 1.6);
    machine.mean = 0.3;
    machine
}
