//! A belt drive: motor pulley, belt, large pulley, shaft with a torque sensor, load.

use super::{servo_numbers, spring_between};
use crate::challenge::machine::{Known, Machine, Measure};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let (belt_hz, shaft_hz) = (draw.log((10.0, 22.0)), draw.log((28.0, 50.0)));
    let mut machine = Machine::new("three-mass-belt", 1000.0, (0.4, 1.5 * shaft_hz));
    let ratio = draw.between(1.5, 4.0);
    let (pulley_share, load_share) = (draw.log((0.4, 1.2)), draw.log((0.5, 2.0)));
    let (torque, inertia, damping) = servo_numbers(1.0 + pulley_share + load_share, draw);
    let slow = ratio * ratio * inertia;
    let motor = machine.body("motor", inertia, Known::Open);
    // The small pulley sits on the motor's shaft; the belt's stiffness is referred to the slow side.
    let small = machine.body("belt_side", 0.05 * slow, Known::Fixed);
    let pulley = machine.body("pulley", pulley_share * slow, Known::Open);
    let load = machine.body("load", load_share * slow, Known::Open);
    machine.gear("pulleys", (motor, small), ratio);
    let belt = spring_between((slow, pulley_share * slow), belt_hz, draw.log((0.02, 0.08)));
    machine.spring("belt", (small, pulley), belt.0, belt.1);
    let shaft = spring_between((pulley_share * slow, load_share * slow), shaft_hz, draw.log((0.01, 0.04)));
    machine.spring("torque_shaft", (pulley, load), shaft.0, shaft.1);
    machine.bearing("motor_bearing", motor, damping * draw.between(0.3, 0.6));
    machine.bearing("pulley_bearing", pulley, 0.0);
    machine.bearing("load_bearing", load, ratio * ratio * damping * draw.between(0.3, 0.6));
    machine.sensor("motor_speed", Measure::Speed, motor);
    machine.sensor("shaft_torque", Measure::Torque, 1);
    machine.sensor("load_speed", Measure::Speed, load);
    machine.amplitude = torque;
    machine
}
