//! Background of a realistic bench: the effects that a diagnosis may name, and their influence on the true values of parameters.

use socam_diagnose::document::Finding;
use socam_sim::challenge::{Background, Case, Drive, Hidden, Measure};

/// Effects that a delay between channels is named by.
const DELAYS: [&str; 3] = ["sensor_delay", "sensor_lag", "channel_delay"];

/// Whether the background has an effect. `delay_s` is the stated delay or lag; a rival has none, and either sign is accepted for it.
pub(super) fn is_there(case: &Case, (effect, place): (&str, &str), delay_s: Option<f64>) -> bool {
    if DELAYS.contains(&effect) {
        return is_delay_there(case, place, delay_s);
    }
    let has_wrong_constant = case.background.input_gain.is_some();
    (has_wrong_constant && (effect, place) == ("sensor_gain", case.machine.input.name.as_str()))
        || case.background.named().contains(&(effect, place))
}

/// Delays are relative: an early input and late outputs are indistinguishable. The background has a delay of a channel if that channel's
/// delay differs from that of another channel in the stated direction.
fn is_delay_there(case: &Case, place: &str, delay_s: Option<f64>) -> bool {
    let sensors = case.machine.sensors.iter().map(|sensor| sensor.name.as_str());
    let others = sensors.chain([case.machine.input.name.as_str()]).filter(|name| *name != place);
    let own = case.background.delay(place);
    let mut relative = others.map(|other| own - case.background.delay(other));
    relative.any(|later| delay_s.map_or(later != 0.0, |stated| later * stated > 0.0))
}

/// Stated delay or lag of a finding, s.
pub(super) fn stated_delay_s(finding: &Finding) -> Option<f64> {
    let of = |name: &str| finding.parameters.iter().find(|own| own.name == name)?.value;
    of("delay").or_else(|| of("time_constant"))
}

/// The value that a hidden effect's parameter has together with the background, in the units of the recorded torque. `None` where the
/// recording has no such value: two delays on top of one another, or torques in two different units.
pub(super) fn expected(
    case: &Case,
    hidden: &Hidden,
    (name, truth): (&str, f64),
    unit: &str,
    findings: &[Finding],
) -> Option<f64> {
    if DELAYS.contains(&hidden.effect.as_str()) && case.realistic {
        return None;
    }
    let friction = case.background.friction.iter().find(|(place, _)| *place == hidden.place);
    let friction = friction.map_or(0.0, |(_, torque)| *torque);
    let truth = match (hidden.effect.as_str(), name) {
        ("coulomb_friction" | "stribeck_friction", "torque") => truth + friction,
        ("stribeck_friction", "static_torque") => truth + Background::BREAKAWAY * friction,
        _ => truth,
    };
    let is_scaled = case.machine.input.drive == Drive::Torque && unit.starts_with(['N', 'k']);
    let Some(gain) = case.background.input_gain.filter(|_| is_scaled) else { return Some(truth) };
    let corrects =
        |finding: &Finding| finding.effect == "sensor_gain" && finding.location == case.machine.input.name;
    if findings.iter().any(corrects) {
        return Some(truth);
    }
    let is_torque_measured = case.machine.sensors.iter().any(|sensor| sensor.measure == Measure::Torque);
    (!is_torque_measured).then_some(gain * truth)
}
