//! The default bench: the motor's speed is prescribed, two torque sensors and a tachometer measure the response.

use socam_recording::Unit;

use crate::challenge::machine::{Drive, Input, Known, Machine, Measure, Sort};
use crate::challenge::random::Draw;

/// Inertia of nodes that are massless in the model, kg m²: too small to be identified, large enough for an explicit integrator.
const SMALL_FAST: f64 = 2e-7;
const SMALL_SLOW: f64 = 1e-6;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let mut machine = Machine::new("speed-o-cam", 1000.0, (0.4, 60.0));
    let near = |value: f64, draw: &mut Draw| value * draw.between(0.7, 1.3);
    let reduction = 8.0;
    let motor = machine.point("motor", SMALL_FAST);
    let sensor_in = machine.point("torque_sensor_in", SMALL_FAST);
    let cam = machine.body("cam_shaft", 1.287_502_2e-4, Known::Fixed);
    let disk = machine.body("disk", 4.778_417_2e-3, Known::Fixed);
    let sensor_out = machine.point("torque_sensor_out", SMALL_SLOW);
    let hub = machine.point("load_hub", SMALL_SLOW);
    let load = machine.body("load", 1.4752e-2, Known::Fixed);
    let (first, second, third) = (near(71.0, draw), near(54.4, draw), near(110.0, draw));
    machine.spring("coupling_1", (motor, sensor_in), first, 0.02 * draw.factor(2.0));
    machine.spring("coupling_2", (sensor_in, cam), second, 0.02 * draw.factor(2.0));
    machine.spring("roller_pins", (disk, sensor_out), near(52483.0, draw), 0.0);
    machine.spring("coupling_3", (sensor_out, hub), third, 0.08 * draw.factor(2.0));
    undamped(&mut machine, 2);
    machine.gear("mesh", (cam, disk), reduction);
    machine.shaft("load_shaft", (hub, load));
    machine.bearing("cam_bearing", cam, 0.0);
    machine.bearing("load_bearing", load, 0.05 * draw.factor(2.0));
    machine.input = Input {
        name: "motor_speed".into(),
        unit: Unit::RadPerS,
        drive: Drive::Speed,
        node: motor,
        scale: 1.0,
        gain: None,
    };
    machine.sensor("output_speed", Measure::Speed, load);
    machine.sensor("torque_in", Measure::Torque, 0);
    machine.sensor("torque_out", Measure::Torque, 2);
    machine.amplitude = draw.between(25.0, 50.0);
    machine.mean = 2.0;
    machine
}

/// A spring without a damper in the model.
fn undamped(machine: &mut Machine, spring: usize) {
    let name = format!("{}_damping", machine.springs[spring].name);
    machine.springs[spring].damping = None;
    if let Some(index) = machine.parameters.iter().position(|parameter| parameter.name == name) {
        debug_assert!(machine.parameters[index].sort == Sort::Damping);
        machine.parameters.remove(index);
        let later = |parameter: &mut usize| *parameter -= usize::from(*parameter > index);
        for spring in &mut machine.springs {
            later(&mut spring.stiffness);
            spring.damping.iter_mut().for_each(later);
        }
    }
}
