//! What to record next, so that rivals part.

use crate::document::{Finding, SuggestedExperiment};

/// A profile that treats the finding and its first rival differently.
pub(crate) fn suggestion(finding: &Finding) -> SuggestedExperiment {
    let rival = &finding.rivals[0];
    let pair = [finding.effect.as_str(), rival.effect.as_str()];
    let any = |ids: &[&str]| pair.iter().any(|id| ids.contains(id));
    let (profile, why) = if any(&["sensor_gain", "mesh_loss"]) {
        (
            "steps",
            "at several steady speeds, with the load's torque changed between two such recordings: a gain keeps its share, a loss does not",
        )
    } else if any(&[
        "coulomb_friction",
        "stribeck_friction",
        "direction_dependence",
        "constant_load",
        "backlash",
        "hysteresis",
    ]) {
        ("triangle", "slowly through standstill and back, several times: that is where they differ")
    } else if any(&["missing_compliance", "missing_inertia", "sensor_lag", "sensor_delay", "kinematic_error"])
    {
        ("chirp", "up to the highest frequency that the drive can follow: they part where motion is fast")
    } else {
        ("prbs", "with as much torque as the bench allows: they part where torque is large")
    };
    SuggestedExperiment {
        profile: profile.into(),
        tells_apart: vec![
            format!("{}@{}", finding.effect, finding.location),
            format!("{}@{}", rival.effect, rival.location),
        ],
        sentence: format!("Record `{profile}` {why}."),
    }
}
