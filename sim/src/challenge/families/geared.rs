//! Two gear stages with one compliant shaft between them and one after them, driven by a torque. The speeds of motor and load and the
//! torque after the gears are measured.

use super::{servo_numbers, spring_between};
use crate::challenge::machine::{Known, Machine, Measure};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let (first_hz, second_hz) = (draw.log((35.0, 55.0)), draw.log((8.0, 20.0)));
    let mut machine = Machine::new("geared", 1000.0, (0.4, 1.5 * first_hz));
    let (first, second) = (draw.between(2.0, 5.0), draw.between(2.0, 5.0));
    let (middle_share, load_share) = (draw.log((0.3, 1.0)), draw.log((0.5, 2.0)));
    let (torque, inertia, damping) = servo_numbers(1.0 + middle_share + load_share, draw);
    let (middle, slow) = (first * first * inertia, (first * second).powi(2) * inertia);
    let motor = machine.body("motor", inertia, Known::Open);
    let wheel_1 = machine.body("wheel_1", 0.1 * middle, Known::Fixed);
    let pinion_2 = machine.body("pinion_2", middle_share * middle, Known::Open);
    let wheel_2 = machine.body("wheel_2", 0.1 * slow, Known::Fixed);
    let load = machine.body("load", load_share * slow, Known::Open);
    machine.gear("stage_1", (motor, wheel_1), first);
    machine.gear("stage_2", (pinion_2, wheel_2), second);
    let intermediate =
        spring_between((1.1 * middle, middle_share * middle), first_hz, draw.log((0.02, 0.06)));
    machine.spring("intermediate_shaft", (wheel_1, pinion_2), intermediate.0, intermediate.1);
    let coupling =
        spring_between(((1.1 + middle_share) * slow, load_share * slow), second_hz, draw.log((0.01, 0.05)));
    machine.spring("coupling", (wheel_2, load), coupling.0, coupling.1);
    machine.bearing("motor_bearing", motor, damping * draw.between(0.3, 0.6));
    machine.bearing("pinion_bearing", pinion_2, 0.0);
    machine.bearing("load_bearing", load, (first * second).powi(2) * damping * draw.between(0.3, 0.6));
    machine.sensor("motor_speed", Measure::Speed, motor);
    machine.sensor("coupling_torque", Measure::Torque, 1);
    machine.sensor("load_speed", Measure::Speed, load);
    machine.amplitude = torque;
    machine
}
