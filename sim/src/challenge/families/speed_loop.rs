//! Motor and load on a compliant coupling in a speed loop; the loop's torque is the model's input.

use super::two_mass;
use crate::challenge::machine::{Control, Machine};
use crate::challenge::random::Draw;

pub(super) fn draw(draw: &mut Draw) -> Machine {
    let mut machine = two_mass::draw(draw);
    machine.family = "speed-loop".into();
    let inertia: f64 =
        (0..3).map(|node| machine.nodes[node].inertia.map_or(0.0, |own| machine.value(own))).sum();
    let torque = machine.amplitude;
    // The loop is slower than the coupling's resonance, so that it is stable.
    let pace = draw.between(8.0, 20.0);
    machine.control = Control::Speed { proportional: inertia * pace, integral: 0.25 * inertia * pace * pace };
    // With this speed amplitude, changes of the profile require about the available torque of the drive.
    machine.amplitude = torque / (inertia * pace);
    machine
}
