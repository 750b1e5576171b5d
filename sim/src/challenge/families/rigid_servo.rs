//! A rigid servo axis: motor, gear, shaft and load, driven by a voltage or a torque.

use socam_recording::Unit;

use super::servo_numbers;
use crate::challenge::machine::{Known, Machine, Measure, Sort};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let mut machine = Machine::new("rigid-servo", 1000.0, (0.3, 40.0));
    let (ratio, share) = (draw.whole(3, 12) as f64, draw.log((0.5, 3.0)));
    let (torque, inertia, damping) = servo_numbers(1.0 + share, draw);
    let by_voltage = draw.chance(0.5);
    let motor = machine.body("motor", inertia, Known::Fixed);
    let load_inertia = share * inertia * ratio * ratio;
    let wheel = machine.body("wheel", 0.1 * load_inertia, Known::Fixed);
    let load = machine.body("load", 0.9 * load_inertia, Known::Open);
    machine.gear("reducer", (motor, wheel), ratio);
    machine.shaft("load_shaft", (wheel, load));
    machine.bearing("motor_bearing", motor, damping);
    machine.bearing("load_bearing", load, 0.0);
    machine.amplitude = torque;
    if by_voltage {
        // The motor's inertia is known, which makes the torque per volt identifiable.
        machine.input.name = "motor_voltage".into();
        machine.input.unit = Unit::V;
        machine.input.scale = torque / 12.0;
        machine.input.gain =
            Some(machine.number("drive_gain", Sort::Ratio, draw.between(0.7, 1.3), Known::Open));
        machine.amplitude = 12.0;
        machine.parameters[2].fixed = true;
    }
    machine.sensor("motor_speed", Measure::Speed, motor);
    if draw.chance(0.5) {
        machine.sensor("load_speed", Measure::Speed, load);
    }
    machine
}
