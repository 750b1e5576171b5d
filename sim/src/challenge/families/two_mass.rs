//! Motor and load on a compliant coupling, driven by a torque, both speeds measured.

use super::{servo_numbers, spring_between};
use crate::challenge::machine::{Known, Machine, Measure};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let hz = draw.log((12.0, 40.0));
    let mut machine = Machine::new("two-mass", 1000.0, (0.4, 1.8 * hz));
    let share = draw.log((0.4, 3.0));
    let (torque, inertia, damping) = servo_numbers(1.0 + share, draw);
    let motor = machine.body("motor", inertia, Known::Open);
    let hub = machine.body("hub", 0.1 * share * inertia, Known::Fixed);
    let load = machine.body("load", 0.9 * share * inertia, Known::Open);
    let (stiffness, spring_damping) = spring_between((inertia, share * inertia), hz, draw.log((0.01, 0.06)));
    machine.spring("coupling", (motor, hub), stiffness, spring_damping);
    machine.shaft("load_shaft", (hub, load));
    machine.bearing("motor_bearing", motor, damping * draw.between(0.3, 0.7));
    machine.bearing("load_bearing", load, damping * draw.between(0.3, 0.7));
    machine.sensor("motor_speed", Measure::Speed, motor);
    machine.sensor("load_speed", Measure::Speed, load);
    machine.amplitude = torque;
    machine
}
