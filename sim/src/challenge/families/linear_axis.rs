//! A linear axis with a belt, in the position loop of a servo that is part of the model. The input is the reference; position and force are
//! measured.

use socam_recording::Unit;

use super::spring_between;
use crate::challenge::machine::{Control, Drive, Known, Machine, Measure};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let hz = draw.log((12.0, 30.0));
    let mut machine = Machine::new("linear-axis", draw.one_of(&[500.0, 1000.0]), (0.2, 12.0));
    machine.translates = true;
    let (mass, share) = (draw.log((1.0, 50.0)), draw.log((0.4, 2.0)));
    let motor = machine.body("motor", mass, Known::Open);
    let clamp = machine.body("clamp", 0.05 * share * mass, Known::Fixed);
    let carriage = machine.body("carriage", 0.95 * share * mass, Known::Open);
    let (stiffness, damping) = spring_between((mass, share * mass), hz, draw.log((0.02, 0.06)));
    machine.spring("belt", (motor, clamp), stiffness, damping);
    machine.shaft("clamping", (clamp, carriage));
    let all = mass * (1.0 + share);
    let drag = all / draw.log((0.2, 0.8));
    machine.bearing("motor_bearing", motor, drag * draw.between(0.3, 0.7));
    machine.bearing("guide", carriage, drag * draw.between(0.3, 0.7));
    let pace = draw.between(15.0, 30.0);
    machine.control = Control::Position { position_gain: 0.4 * pace, velocity_gain: all * pace };
    machine.input.name = "position_ref".into();
    machine.input.unit = Unit::M;
    machine.input.drive = Drive::Servo;
    machine.sensor("motor_position", Measure::Angle, motor);
    machine.sensor("force", Measure::Effort, motor);
    if draw.chance(0.5) {
        machine.sensor("carriage_position", Measure::Angle, carriage);
    }
    let encoder = draw.log((5e-7, 5e-6));
    for sensor in machine.sensors.iter_mut().filter(|sensor| sensor.measure == Measure::Angle) {
        sensor.step = encoder;
    }
    machine.amplitude = draw.log((0.02, 0.1));
    machine.mean = 0.3;
    machine
}
