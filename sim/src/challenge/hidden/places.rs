//! Places at which an effect can be hidden in a machine.

use crate::challenge::machine::{Drive, Machine, Measure};
use crate::challenge::motion::Motion;
use crate::challenge::unmodelled::Unmodelled;

/// Places of an effect at which it changes the recordings.
pub(crate) fn places(machine: &Machine, effect: &str) -> Vec<String> {
    let free = |node: usize| machine.input.drive != Drive::Speed || node != machine.input.node;
    let bearings = machine.bearings.iter().filter(|bearing| free(bearing.node));
    let names = |list: Vec<&String>| list.into_iter().cloned().collect::<Vec<_>>();
    let end = machine.nodes.last().map(|node| node.name.clone()).into_iter().collect::<Vec<_>>();
    match effect {
        "coulomb_friction"
        | "stribeck_friction"
        | "quadratic_drag"
        | "direction_dependence"
        | "eddy_current_brake"
        | "late_pad"
        | "wearing_in" => names(bearings.map(|bearing| &bearing.name).collect()),
        "damping_drift" => {
            names(bearings.filter(|bearing| bearing.damping.is_some()).map(|bearing| &bearing.name).collect())
        }
        "constant_load" | "external_disturbance" => end,
        "gravity_unbalance" if machine.translates || machine.gravity.is_some() => Vec::new(),
        "gravity_unbalance" => end,
        "angle_drag" if machine.translates => Vec::new(),
        "angle_drag" => names(bearings.map(|bearing| &bearing.name).collect()),
        "mesh_loss" | "backlash" | "kinematic_error" | "angle_play" => {
            names(machine.gears.iter().map(|gear| &gear.name).collect())
        }
        "stiffness_hardening" | "hysteresis" | "coupling_slip" | "loosening" => {
            // Springs far stiffer than the softest do not show.
            let softest = |spring: usize| machine.value(machine.springs[spring].stiffness);
            let least = (0..machine.springs.len()).map(softest).fold(f64::INFINITY, f64::min);
            let soft = (0..machine.springs.len()).filter(|spring| softest(*spring) < 100.0 * least);
            names(soft.map(|spring| &machine.springs[spring].name).collect())
        }
        "missing_compliance" => names(machine.shafts.iter().map(|shaft| &shaft.name).collect()),
        "missing_inertia" => uncounted(machine),
        "torque_ripple" if machine.translates || machine.input.drive != Drive::Torque => Vec::new(),
        "torque_ripple" => vec![machine.nodes[machine.input.node].name.clone()],
        "sensor_gain" if machine.sensors.len() < 2 => Vec::new(),
        "sensor_ripple" if machine.translates => Vec::new(),
        "sensor_offset" | "sensor_ripple" => sensors(machine, |sensor| sensor != Measure::Angle),
        _ => sensors(machine, |_| true),
    }
}

fn sensors(machine: &Machine, fits: impl Fn(Measure) -> bool) -> Vec<String> {
    machine.sensors.iter().filter(|sensor| fits(sensor.measure)).map(|sensor| sensor.name.clone()).collect()
}

/// Nodes at which added inertia is not equivalent to a free parameter.
fn uncounted(machine: &Machine) -> Vec<String> {
    let motion = Motion::new(machine, &Unmodelled::default());
    let open = |node: usize| {
        let inertia = machine.nodes[node].inertia;
        inertia.is_some_and(|inertia| !machine.parameters[inertia].fixed)
    };
    let is_known = |node: &usize| {
        let tied = motion.tied_to(*node);
        let driven = machine.input.drive == Drive::Speed && tied[machine.input.node].is_some();
        !driven && !(0..tied.len()).any(|other| tied[other].is_some() && open(other))
    };
    (0..machine.nodes.len()).filter(is_known).map(|node| machine.nodes[node].name.clone()).collect()
}
