//! What can be hidden in a machine, where, and how large: sizes are shares of what the machine's own motion is (see [`Scales`]), from
//! just detectable to gross.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::background::loose_inertia;
use super::laws::{Acting, Kind};
use super::machine::{Drive, Machine, Measure};
use super::motion::{Beside, Motion, Released};
use super::random::Draw;
use super::scales::Scales;
use crate::SimError;
use crate::flaw::Flaw;
use crate::truth::{Concealed, Override};

/// An effect at work, with its parameters in SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// Its id in the catalogue, or the name of a kind that is not there.
    pub effect: String,
    /// Place or channel.
    pub place: String,
    /// In the catalogue's names.
    pub parameters: Vec<(String, f64)>,
    /// Further numbers of the truth's own law.
    pub own: Vec<f64>,
}

/// Effects of the catalogue that may be hidden.
pub(super) const NAMED: [&str; 24] = [
    "coulomb_friction",
    "stribeck_friction",
    "quadratic_drag",
    "damping_drift",
    "direction_dependence",
    "constant_load",
    "mesh_loss",
    "backlash",
    "kinematic_error",
    "stiffness_hardening",
    "hysteresis",
    "missing_compliance",
    "missing_inertia",
    "coupling_slip",
    "gravity_unbalance",
    "external_disturbance",
    "torque_ripple",
    "sensor_gain",
    "sensor_offset",
    "sensor_lag",
    "sensor_delay",
    "sensor_saturation",
    "sensor_hum",
    "sensor_ripple",
];

/// Physics that the catalogue does not hold.
pub(super) const OUTSIDE: [&str; 7] =
    ["eddy_current_brake", "late_pad", "angle_play", "angle_drag", "loosening", "gain_drift", "wearing_in"];

/// Places at which an effect can be hidden so that it shows.
pub(super) fn places(machine: &Machine, effect: &str) -> Vec<String> {
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
            // What is far stiffer than the rest does not show.
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

/// Nodes at which more inertia is not that of an open parameter.
fn uncounted(machine: &Machine) -> Vec<String> {
    let motion = Motion::new(machine, &Beside::default());
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

/// What is seen of the place where something is to be hidden.
struct At {
    effort: f64,
    speed: f64,
    inertia: f64,
    twist: f64,
    torque: f64,
    peak_torque: f64,
    /// Of the channel: its size and largest value.
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
        inertia: Motion::new(machine, &Beside::default()).inertia_at(node),
        twist: of_spring(&scales.twist),
        torque: of_spring(&scales.torque),
        peak_torque: of_spring(&scales.peak_torque),
        size: scales.channels[channel],
        peak: scales.peaks[channel],
    }
}

/// The effect at a place, of a size to be drawn.
pub(super) fn hide(effect: &str, place: &str, machine: &Machine, scales: &Scales, draw: &mut Draw) -> Hidden {
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
            // Never so far down that the damping would turn negative within ten seconds.
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
        // A spring that softens must not give way altogether.
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

/// What is hidden, as the machine and its sensors have it.
pub(super) fn conceal(
    machine: &Machine,
    hidden: &[Hidden],
    beside: &mut Beside,
) -> Result<Vec<(String, Flaw)>, SimError> {
    let mut flaws = Vec::new();
    for hidden in hidden {
        let p: Vec<f64> = hidden.parameters.iter().map(|(_, value)| *value).collect();
        if Flaw::is_one(&hidden.effect) || hidden.effect == "gain_drift" {
            flaws.push((hidden.place.clone(), flaw(hidden)?));
        } else if hidden.effect == "missing_inertia" {
            beside.inertia.push((hidden.place.clone(), p[0]));
        } else if hidden.effect == "missing_compliance" {
            beside.released.retain(|released| released.tie != hidden.place);
            let tie = hidden.place.clone();
            beside.released.push(Released { tie, stiffness: p[0], damping: p[1] });
        } else {
            let (kind, parameters) = law(machine, hidden, &p)?;
            beside.acting.push(Acting { kind, place: hidden.place.clone(), parameters });
        }
    }
    Ok(flaws)
}

fn flaw(hidden: &Hidden) -> Result<Flaw, SimError> {
    if hidden.effect == "gain_drift" {
        return Ok(Flaw::GainDrift { rate_per_s: hidden.parameters[0].1 });
    }
    let parameters = hidden.parameters.iter();
    Flaw::read(&Concealed {
        effect: hidden.effect.clone(),
        place: hidden.place.clone(),
        parameters: parameters.map(|(name, value)| Override { name: name.clone(), value: *value }).collect(),
    })
}

/// The truth's law for an effect, and its parameters.
fn law(machine: &Machine, hidden: &Hidden, p: &[f64]) -> Result<(Kind, Vec<f64>), SimError> {
    let own = &hidden.own;
    let all = || p.iter().chain(own).copied().collect::<Vec<_>>();
    Ok(match hidden.effect.as_str() {
        "coulomb_friction" => (Kind::Bristles, vec![p[0], p[0], own[0], own[1]]),
        "stribeck_friction" => (Kind::Bristles, all()),
        "quadratic_drag" => (Kind::Drag, all()),
        "damping_drift" => (Kind::WarmingUp, vec![own[0], p[0]]),
        "direction_dependence" => (Kind::Direction, all()),
        "constant_load" => (Kind::Constant, all()),
        "mesh_loss" => (Kind::Loss, all()),
        "backlash" => (Kind::Play, all()),
        "kinematic_error" => (Kind::Eccentric, all()),
        "stiffness_hardening" => (Kind::Hardening, all()),
        "hysteresis" => (Kind::Sliders, all()),
        "coupling_slip" => (Kind::Slip, all()),
        // The catalogue's: T = -torque sin(angle + phase).
        "gravity_unbalance" => (Kind::AngleTorque, vec![-p[0], 1.0, p[1]]),
        "torque_ripple" => (Kind::AngleTorque, vec![p[1], p[0], p[2]]),
        "external_disturbance" => (Kind::Shake, all()),
        "eddy_current_brake" => (Kind::EddyBrake, all()),
        "late_pad" => (Kind::LatePad, all()),
        "angle_play" => (Kind::AnglePlay, vec![p[0], own[0], p[1]]),
        "angle_drag" => (Kind::AngleDrag, all()),
        "loosening" => (Kind::Loosening, all()),
        "wearing_in" => (Kind::WearingIn, all()),
        other => {
            let problem = format!("the truth has no law for it; family {}", machine.family);
            return Err(SimError::argument(other, problem));
        }
    })
}
