//! Hidden effects as laws of the truth and flaws of its sensors.

use super::effect::Hidden;
use crate::SimError;
use crate::challenge::flaw::Flaw;
use crate::challenge::laws::{Acting, Kind};
use crate::challenge::machine::Machine;
use crate::challenge::unmodelled::{CompliantTie, Unmodelled};
use crate::concealed::{Concealed, Override};

/// Adds hidden effects to what the machine has beyond its model; returns the flaws of its sensors.
pub(crate) fn conceal(
    machine: &Machine,
    hidden: &[Hidden],
    unmodelled: &mut Unmodelled,
) -> Result<Vec<(String, Flaw)>, SimError> {
    let mut flaws = Vec::new();
    for hidden in hidden {
        let p: Vec<f64> = hidden.parameters.iter().map(|(_, value)| *value).collect();
        if Flaw::is_one(&hidden.effect) || hidden.effect == "gain_drift" {
            flaws.push((hidden.place.clone(), flaw(hidden)?));
        } else if hidden.effect == "missing_inertia" {
            unmodelled.inertia.push((hidden.place.clone(), p[0]));
        } else if hidden.effect == "missing_compliance" {
            unmodelled.compliant.retain(|compliant| compliant.tie != hidden.place);
            let tie = hidden.place.clone();
            unmodelled.compliant.push(CompliantTie { tie, stiffness: p[0], damping: p[1] });
        } else {
            let (kind, parameters) = law(machine, hidden, &p)?;
            unmodelled.acting.push(Acting { kind, place: hidden.place.clone(), parameters });
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
        // The law of the catalogue is T = -torque.
        "constant_load" => (Kind::Constant, vec![-p[0]]),
        "mesh_loss" => (Kind::Loss, all()),
        "backlash" => (Kind::Play, all()),
        "kinematic_error" => (Kind::Eccentric, all()),
        "stiffness_hardening" => (Kind::Hardening, all()),
        "hysteresis" => (Kind::Sliders, all()),
        "coupling_slip" => (Kind::Slip, all()),
        // The law of the catalogue is T = -torque sin(angle + phase).
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
