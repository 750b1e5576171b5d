//! Hidden effects as laws of the truth and flaws of its sensors.

use super::effect::Hidden;
use crate::SimError;
use crate::challenge::flaw::Flaw;
use crate::challenge::laws::{Acting, LawKind};
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
fn law(machine: &Machine, hidden: &Hidden, p: &[f64]) -> Result<(LawKind, Vec<f64>), SimError> {
    let own = &hidden.own;
    let all = || p.iter().chain(own).copied().collect::<Vec<_>>();
    Ok(match hidden.effect.as_str() {
        "coulomb_friction" => (LawKind::Bristles, vec![p[0], p[0], own[0], own[1]]),
        "stribeck_friction" => (LawKind::Bristles, all()),
        "quadratic_drag" => (LawKind::Drag, all()),
        "damping_drift" => (LawKind::WarmingUp, vec![own[0], p[0]]),
        "direction_dependence" => (LawKind::Direction, all()),
        // The law of the catalogue is T = -torque.
        "constant_load" => (LawKind::Constant, vec![-p[0]]),
        // In proportion to the torque of the fast side, unless a share of what enters from the slow side is given.
        "mesh_loss" => {
            let back = p.get(1).map_or(p[0], |back| back / (1.0 - back));
            (LawKind::Loss, vec![p[0], back, own[0], own[1]])
        }
        "backlash" => (LawKind::Play, all()),
        "kinematic_error" => (LawKind::Eccentric, all()),
        "stiffness_hardening" => (LawKind::Hardening, all()),
        "hysteresis" => (LawKind::Sliders, all()),
        "coupling_slip" => (LawKind::Slip, all()),
        // The law of the catalogue is T = -torque sin(angle + phase).
        "gravity_unbalance" => (LawKind::AngleTorque, vec![-p[0], 1.0, p[1]]),
        "torque_ripple" => (LawKind::AngleTorque, vec![p[1], p[0], p[2]]),
        "external_disturbance" => (LawKind::Shake, all()),
        "eddy_current_brake" => (LawKind::EddyBrake, all()),
        "late_pad" => (LawKind::LatePad, all()),
        "angle_play" => (LawKind::AnglePlay, vec![p[0], own[0], p[1]]),
        "angle_drag" => (LawKind::AngleDrag, all()),
        "loosening" => (LawKind::Loosening, all()),
        "wearing_in" => (LawKind::WearingIn, all()),
        other => {
            let problem = format!("the truth has no law for it; family {}", machine.family);
            return Err(SimError::argument(other, problem));
        }
    })
}
