//! Motor and load on a soft coupling, with only the motor's encoder, sampled slowly.

use std::f64::consts::TAU;

use super::{servo_numbers, spring_between};
use crate::challenge::machine::{Known, Machine, Measure};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let hz = draw.log((5.0, 14.0));
    let mut machine = Machine::new("encoder-only", draw.one_of(&[200.0, 250.0, 500.0]), (0.3, 1.5 * hz));
    let share = draw.log((0.8, 3.0));
    let (torque, inertia, damping) = servo_numbers(1.0 + share, draw);
    let motor = machine.body("motor", inertia, Known::Open);
    let hub = machine.body("hub", 0.1 * share * inertia, Known::Fixed);
    let load = machine.body("load", 0.9 * share * inertia, Known::Open);
    let (stiffness, spring_damping) = spring_between((inertia, share * inertia), hz, draw.log((0.02, 0.06)));
    machine.spring("coupling", (motor, hub), stiffness, spring_damping);
    machine.shaft("load_shaft", (hub, load));
    machine.bearing("motor_bearing", motor, damping * draw.between(0.3, 0.7));
    machine.bearing("load_bearing", load, damping * draw.between(0.3, 0.7));
    machine.sensor("motor_angle", Measure::Angle, motor);
    machine.sensors[0].step = TAU / draw.one_of(&[4096.0, 10_000.0, 65_536.0]);
    machine.amplitude = torque;
    machine.mean = 0.2;
    machine
}
