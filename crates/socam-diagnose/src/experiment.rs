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

/// What settles which of several rivals breaks the ties of steady states; `None` where no finding has rivals.
pub(crate) fn steady(findings: &[Finding]) -> Option<SuggestedExperiment> {
    let open: Vec<&Finding> = findings.iter().filter(|finding| !finding.rivals.is_empty()).collect();
    let first = *open.first()?;
    let involves = |effect: &str| {
        open.iter().any(|f| f.effect == effect || f.rivals.iter().any(|rival| rival.effect == effect))
    };
    let mut steps = Vec::new();
    if involves("mesh_loss") {
        steps.push(
            "Record `reversals`: whenever the bench slows down its load drives it, and then a loss takes from the other side while a \
             wrong gain stays as it is. Or hang a known weight from a lever at either torque sensor while nothing turns: a wrong gain \
             shows there, a loss does not.",
        );
    }
    if open.iter().any(|finding| finding.region.torque_nm.is_none() && finding.effect.starts_with("sensor")) {
        steps.push(
            "Put both tachometers on one shaft, or exchange them, and record `steps`: a wrong gain goes along with its sensor. Turns \
             counted over a minute say which is right.",
        );
    }
    if steps.is_empty() {
        steps.push(
            "Record `steps` with another load: what stands for what changes with speed or with torque.",
        );
    }
    let pair = std::iter::once((&first.effect, &first.location))
        .chain(first.rivals.iter().map(|rival| (&rival.effect, &rival.location)));
    Some(SuggestedExperiment {
        profile: if involves("mesh_loss") { "reversals" } else { "steps" }.into(),
        tells_apart: pair.map(|(effect, place)| format!("{effect}@{place}")).collect(),
        sentence: steps.join(" "),
    })
}
