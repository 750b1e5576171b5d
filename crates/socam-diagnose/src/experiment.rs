//! The next experiment: a profile that distinguishes competing models.

use socam_model::effects::{
    self, ActsAt,
    experiment::{Experiment, LARGE_TORQUE},
};

use crate::document::{Finding, Over, SuggestedExperiment};

/// An experiment that shows a finding's curve more precisely; `None` for a finding without a curve.
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

/// An experiment in which a finding and its first competing model differ: of the two effects' experiments, the one with the higher
/// precedence. `None` if the finding has no competing model.
pub(crate) fn suggestion(finding: &Finding) -> Option<SuggestedExperiment> {
    let rival = finding.rivals.first()?;
    let own = [&finding.effect, &rival.effect].into_iter().filter_map(|id| effects::find(id));
    let experiment = own.map(|effect| effect.experiment).max_by_key(|experiment| experiment.precedence);
    let Experiment { profile, how, .. } = experiment.unwrap_or(LARGE_TORQUE);
    Some(SuggestedExperiment {
        profile: profile.into(),
        tells_apart: vec![
            format!("{}@{}", finding.effect, finding.location),
            format!("{}@{}", rival.effect, rival.location),
        ],
        sentence: format!("Record `{profile}` {how}."),
    })
}

/// An experiment that distinguishes the competing models of violated parity relations; `None` if no finding has any.
pub(crate) fn steady(findings: &[Finding]) -> Option<SuggestedExperiment> {
    let open: Vec<&Finding> = findings.iter().filter(|finding| !finding.rivals.is_empty()).collect();
    let first = *open.first()?;
    let involved = open.iter().flat_map(|finding| {
        let rivals = finding.rivals.iter().map(|rival| &rival.effect);
        std::iter::once(&finding.effect).chain(rivals)
    });
    let own = involved.filter_map(|id| effects::find(id)).map(|effect| effect.experiment);
    let own =
        own.filter(|experiment| experiment.steady.is_some()).max_by_key(|experiment| experiment.precedence);
    let own = own.and_then(|experiment| experiment.steady);
    let mut steps: Vec<&str> = own.iter().map(|own| own.sentences).collect();
    let is_sensor = |finding: &&Finding| {
        effects::find(&finding.effect).is_some_and(|effect| effect.acts_at == ActsAt::Channel)
    };
    if open.iter().any(|finding| finding.region.torque_nm.is_none() && is_sensor(finding)) {
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
        profile: own.map_or("steps", |own| own.profile).into(),
        tells_apart: pair.map(|(effect, place)| format!("{effect}@{place}")).collect(),
        sentence: steps.join(" "),
    })
}
