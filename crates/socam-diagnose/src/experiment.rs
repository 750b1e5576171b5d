//! What to record next, so that rivals part.

use socam_recording::ProfileFile;

use crate::document::{Finding, Over, SuggestedExperiment};

/// The profile of a suggestion as a file that `record --profile` takes, its purpose being the suggestion's sentence.
pub(crate) fn profile_text(suggestion: &SuggestedExperiment) -> Option<String> {
    let text = ProfileFile::built_in_text(&suggestion.profile).unwrap_or(&suggestion.profile);
    let profile = ProfileFile::parse(text).ok()?;
    let purpose = suggestion.sentence.replace('`', "");
    Some(ProfileFile { purpose: Some(purpose), ..profile }.to_toml())
}

/// What would show the shape of what has no name more sharply.
pub(crate) fn shape(finding: &Finding) -> Option<SuggestedExperiment> {
    let curve = finding.curve.as_ref()?;
    let (profile, why) = match curve.over {
        Over::Speed => (
            "triangle",
            "slowly through all speeds and back, several times: what depends on speed has the same shape each time",
        ),
        Over::Angle => {
            ("triangle", "slowly over many turns: what depends on the angle comes back with each of them")
        }
        Over::Torque => (
            "prbs",
            "with as much torque as the bench allows: what depends on torque shows over its whole range",
        ),
        Over::Time => ("steps", "twice, cold and warm: what changes with time differs between the two"),
        Over::Frequency => ("chirp", "up to the highest frequency that the drive can follow"),
    };
    Some(SuggestedExperiment {
        profile: profile.into(),
        tells_apart: vec![format!("{}@{}", finding.effect, finding.location)],
        sentence: format!("Record `{profile}` {why}."),
    })
}

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
