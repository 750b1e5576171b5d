//! Sizes of hidden effects: a share of the machine's own motion (see [`Scales`]), from just detectable to gross.

use std::f64::consts::TAU;

use super::effect::Hidden;
use crate::challenge::machine::Machine;
use crate::challenge::motion::{Motion, loose_inertia};
use crate::challenge::random::Draw;
use crate::challenge::scales::Scales;
use crate::challenge::unmodelled::Unmodelled;

/// Typical values of the motion at a place, see [`Scales`].
struct At {
    effort: f64,
    speed: f64,
    inertia: f64,
    twist: f64,
    torque: f64,
    peak_torque: f64,
    /// Size and largest value of the channel.
    size: f64,
    peak: f64,
}

fn at(machine: &Machine, scales: &Scales, place: &str) -> At {
    let bearing = machine.bearings.iter().find(|bearing| bearing.name == place).map(|bearing| bearing.node);
    let named = machine.nodes.iter().position(|node| node.name == place);
    let gear = machine.gears.iter().chain(&machine.shafts).find(|tie| tie.name == place).map(|tie| tie.to);
    let node = bearing.or(named).or(gear).unwrap_or(0);
    let spring = machine.springs.iter().position(|spring| spring.name == place);
    let of_spring = |values: &[f64]| spring.map_or(0.0, |spring| values[spring]);
    let channel = machine.channels().iter().position(|channel| channel.name == place).unwrap_or(0);
    At {
        effort: scales.effort[node],
        speed: scales.speed[node],
        inertia: Motion::new(machine, &Unmodelled::default()).inertia_at(node),
        twist: of_spring(&scales.twist),
        torque: of_spring(&scales.torque),
        peak_torque: of_spring(&scales.peak_torque),
        size: scales.channels[channel],
        peak: scales.peaks[channel],
    }
}

/// The effect at a place, with a drawn size.
pub(crate) fn hide(effect: &str, place: &str, machine: &Machine, scales: &Scales, draw: &mut Draw) -> Hidden {
    let at = at(machine, scales, place);
    let (parameters, own) = match effect {
        "coulomb_friction"
        | "stribeck_friction"
        | "quadratic_drag"
        | "damping_drift"
        | "direction_dependence"
        | "eddy_current_brake"
        | "late_pad"
        | "angle_drag"
        | "wearing_in" => at_bearing(effect, place, &at, machine, draw),
        "mesh_loss" | "backlash" | "kinematic_error" | "angle_play" => {
            at_gear(effect, place, &at, machine, draw)
        }
        "stiffness_hardening" | "hysteresis" | "coupling_slip" | "loosening" => at_spring(effect, &at, draw),
        _ if effect.starts_with("sensor_") || effect == "gain_drift" => {
            at_channel(effect, &at, machine, draw)
        }
        _ => at_node(effect, place, &at, machine, draw),
    };
    let parameters = parameters.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    Hidden { effect: effect.into(), place: place.into(), parameters, own }
}

/// Parameters by name, and further parameters of the truth's own law.
type Numbers = (Vec<(&'static str, f64)>, Vec<f64>);

fn at_bearing(effect: &str, place: &str, at: &At, machine: &Machine, draw: &mut Draw) -> Numbers {
    let torque = at.effort * draw.log((0.03, 0.4));
    let bend = at.speed * draw.log((5e-5, 3e-4));
    let rounding = 2e-3 * at.speed;
    match effect {
        "stribeck_friction" => {
            let (more, speed) = (draw.between(1.3, 2.5), at.speed * draw.log((0.03, 0.3)));
            (
                vec![("torque", torque), ("static_torque", torque * more), ("stribeck_speed", speed)],
                vec![bend],
            )
        }
        "quadratic_drag" => (vec![("coefficient", torque / (at.speed * at.speed))], vec![0.03 * at.speed]),
        "damping_drift" => {
            let bearing = machine.bearings.iter().find(|bearing| bearing.name == place);
            let damping = bearing.and_then(|bearing| bearing.damping).map_or(0.0, |own| machine.value(own));
            // The damping stays positive for ten seconds.
            let rate = draw.log((0.01, 0.09));
            (vec![("rate", if draw.chance(0.5) { rate } else { -rate })], vec![damping])
        }
        "direction_dependence" => (
            vec![
                ("torque_difference", torque * draw.sign()),
                ("damping_difference", 0.5 * torque * draw.between(-1.0, 1.0) / at.speed),
            ],
            vec![rounding],
        ),
        "eddy_current_brake" => {
            (vec![("torque", torque), ("speed", at.speed * draw.between(0.4, 1.2))], vec![])
        }
        "late_pad" => (vec![("torque", torque), ("time", draw.between(2.0, 4.0))], vec![rounding]),
        "angle_drag" => (vec![("torque", torque), ("phase", draw.phase_rad())], vec![rounding]),
        "wearing_in" => {
            (vec![("torque", torque), ("angle", at.speed * draw.log((1.0, 4.0)))], vec![rounding])
        }
        _ => (vec![("torque", torque)], vec![at.speed * 0.1, bend]),
    }
}

fn at_gear(effect: &str, place: &str, at: &At, machine: &Machine, draw: &mut Draw) -> Numbers {
    let gap = at.speed * draw.log((7e-4, 1.5e-2));
    let gear = machine.gears.iter().find(|gear| gear.name == place);
    match effect {
        "mesh_loss" => (vec![("fraction", draw.log((0.02, 0.3)))], vec![2e-3 * at.speed, 0.01 * at.effort]),
        "kinematic_error" => {
            let inertia = gear.map_or(1.0, |gear| loose_inertia(machine, place, (gear.from, gear.to)));
            let order = draw.one_of(&[0.5, 1.0, 2.0]);
            let ratio = gear.and_then(|gear| gear.ratio).map_or(1.0, |ratio| machine.value(ratio));
            let pace = order * ratio * at.speed;
            let amplitude = (at.effort * draw.log((0.02, 0.3)) / (inertia * pace * pace)).min(0.02 / ratio);
            (vec![("order", order), ("amplitude", amplitude), ("phase", draw.phase_rad())], vec![])
        }
        "angle_play" => (vec![("gap", gap), ("phase", draw.phase_rad())], vec![0.02 / at.speed]),
        _ => (vec![("gap", gap)], vec![0.02 / at.speed]),
    }
}

fn at_spring(effect: &str, at: &At, draw: &mut Draw) -> Numbers {
    match effect {
        // A softening spring keeps a positive stiffness.
        "stiffness_hardening" => {
            let share = draw.log((0.03, 0.6));
            let cubic = if draw.chance(0.3) { -0.1 * share } else { share } / (at.twist * at.twist);
            (vec![("cubic", cubic)], vec![0.01 * cubic * cubic])
        }
        "hysteresis" => (
            vec![
                ("torque", at.torque * draw.log((0.05, 0.4))),
                ("deflection", at.twist * draw.log((0.1, 0.8))),
            ],
            vec![],
        ),
        "loosening" => (vec![("share", draw.between(0.1, 0.5)), ("time", draw.between(2.0, 4.0))], vec![]),
        _ => (vec![("torque", at.peak_torque * draw.between(0.45, 0.85))], vec![]),
    }
}

fn at_node(effect: &str, place: &str, at: &At, machine: &Machine, draw: &mut Draw) -> Numbers {
    let torque = at.effort * draw.log((0.03, 0.3));
    let phase = draw.phase_rad();
    match effect {
        "missing_inertia" => (vec![("inertia", at.inertia * draw.log((0.02, 0.5)))], vec![]),
        "missing_compliance" => {
            let shaft = machine.shafts.iter().find(|shaft| shaft.name == place);
            let inertia = shaft.map_or(1.0, |shaft| loose_inertia(machine, place, (shaft.from, shaft.to)));
            let pace = TAU * machine.band_hz.1 * draw.log((0.35, 1.5));
            let damping = 2.0 * draw.log((0.02, 0.15)) * inertia * pace;
            (vec![("stiffness", inertia * pace * pace), ("damping", damping)], vec![])
        }
        "gravity_unbalance" => (vec![("torque", torque), ("phase", phase)], vec![]),
        "external_disturbance" => {
            let frequency = draw.log((2.0 * machine.band_hz.0.max(0.5), machine.band_hz.1));
            (vec![("torque", torque), ("frequency", frequency), ("phase", phase)], vec![])
        }
        "torque_ripple" => {
            let order = draw.one_of(&[1.0, 2.0, 4.0, 6.0]);
            (vec![("order", order), ("torque", torque), ("phase", phase)], vec![])
        }
        _ => (vec![("torque", torque * draw.sign())], vec![]),
    }
}

fn at_channel(effect: &str, at: &At, machine: &Machine, draw: &mut Draw) -> Numbers {
    let size = at.size * draw.log((0.02, 0.2));
    let time = draw.log((0.3, 8.0)) / machine.rate_hz;
    let numbers = match effect {
        "sensor_gain" => vec![("gain", 1.0 + draw.sign() * draw.log((0.02, 0.3)))],
        "sensor_offset" => vec![("offset", size * draw.sign())],
        "sensor_lag" => vec![("time_constant", time)],
        "sensor_delay" => vec![("delay", time)],
        "sensor_saturation" => vec![("limit", at.peak * draw.between(0.5, 0.85))],
        "sensor_hum" => vec![
            ("amplitude", size),
            (
                "frequency",
                draw.one_of(if machine.rate_hz > 400.0 { &[50.0, 60.0, 100.0] } else { &[50.0, 60.0, 16.7] }),
            ),
            ("phase", draw.phase_rad()),
        ],
        "sensor_ripple" => {
            vec![("amplitude", size), ("order", draw.one_of(&[1.0, 2.0, 4.0])), ("phase", draw.phase_rad())]
        }
        _ => vec![("rate", draw.log((0.01, 0.06)) * draw.sign())],
    };
    (numbers, vec![])
}
