//! A diagnosis as text: the headline, each finding, the fit, and the parameters.

use socam_diagnose::Diagnosis;
use socam_findings::document::{CandidateFate, Finding, Stage, UNEXPLAINED};
use socam_findings::{Proof, headline, words};

use crate::table;

/// The answer as text.
pub(crate) fn text(diagnosis: &Diagnosis) -> String {
    let headline = headline(diagnosis);
    let unfinished = diagnosis.unfinished.as_ref();
    let mut text = unfinished.map_or_else(String::new, |how| format!("{how}\n"));
    text.push_str(&format!("{} ({}).\n", headline.title, diagnosis.model));
    for (index, claim) in headline.claims.iter().enumerate() {
        let size = claim.size.as_ref().map_or_else(String::new, |size| format!(": {size}"));
        text.push_str(&format!("  {}. {}{size}\n", index + 1, words::capital(&claim.what)));
    }
    for sentence in headline.certainty.iter().filter(|sentence| Some(*sentence) != unfinished) {
        text.push_str(&format!("  {sentence}\n"));
    }
    for (index, finding) in diagnosis.findings.iter().enumerate() {
        text.push_str(&one(index + 1, finding, Proof::of(diagnosis)));
    }
    text.push_str(&fit(diagnosis));
    text.push_str(&changed(diagnosis));
    diagnosis.candidates.iter().filter(|one| one.asked).for_each(|one| text.push_str(&why(one)));
    if let Some(next) = &diagnosis.suggested_experiment {
        text.push_str(&format!(
            "\nWhat to record next, {}\n  {}\n",
            match next.tells_apart.as_slice() {
                [one] => format!("to see more of {one}"),
                several => format!("to tell {} apart", several.join(" and ")),
            },
            next.sentence
        ));
    }
    text.push_str(&format!("\n{} s of processor time\n", words::rough(diagnosis.cpu_s)));
    text
}

/// Why a candidate is no finding.
fn why(fate: &CandidateFate) -> String {
    let CandidateFate { location, step, .. } = fate;
    let (effect, stage) = (words::effect(&fate.effect), fate.stage.words());
    if fate.stage == Stage::Found {
        return format!("\nWhy not {effect} at {location}: it is a finding\n");
    }
    let mut text = format!("\nWhy not {effect} at {location}: {stage} (step {step})\n  {}.\n", fate.sentence);
    for trial in &fate.trials {
        text.push_str(&format!("  {}.\n", words::capital(&trial.sentence())));
    }
    text
}

fn one(number: usize, finding: &Finding, proof: Proof<'_>) -> String {
    let law = if finding.equation.is_empty() { String::new() } else { format!(": {}", finding.equation) };
    let effect = words::capital(&words::effect(&finding.effect));
    let mut text = format!("\n{number}. {effect} at {}{law}\n", finding.location);
    let mut line = |line: String| text.push_str(&format!("   {line}\n"));
    line(finding.sentence.clone());
    for own in &finding.parameters {
        line(format!("{} = {}", own.name, words::quantity(own.value, own.ci95, &own.unit)));
    }
    for own in &finding.drag {
        let size = words::quantity(Some(own.torque), own.ci95, &own.torque_unit);
        line(format!("{} = {size}", own.name()));
    }
    let evidence = &finding.evidence;
    if !finding.region.text.is_empty() {
        line(format!("where: {}", finding.region.text));
    }
    if let Some([gain, std]) = evidence.log_score_gain {
        let (gain, std) = (words::rough(gain), words::rough(std));
        line(format!("cross-validation: log score {gain} higher, standard error {std}"));
    }
    if let (Some(data), Some(gain)) = (proof.tried_on(), proof.gain_percent(finding)) {
        line(format!("{data}: {} % of the misfit above the noise floor is removed", words::rough(gain)));
    }
    if let (Some(share), Some(channel)) = (evidence.moves_percent, &evidence.moves_channel) {
        let note =
            if evidence.material == Some(false) { ": less than the tolerance, so not material" } else { "" };
        line(format!("it moves {channel} by {} % of its standard deviation{note}", words::rough(share)));
    }
    for rival in &finding.rivals {
        let (effect, weight) = (words::effect(&rival.effect), words::percent(rival.weight));
        line(format!("or {effect} at {} ({weight})", rival.location));
    }
    for law in &finding.richer {
        let (effect, weight) = (words::effect(&law.effect), words::percent(law.weight));
        line(format!("or {effect} there, which contains it and predicts as well ({weight})"));
    }
    text
}

fn fit(diagnosis: &Diagnosis) -> String {
    let head = ["channel", "unit", "noise floor", "before", "after", "held out: before", "after"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (name, fit) in &diagnosis.fit.channels {
        let numbers =
            [fit.noise_std, fit.rms_before, fit.rms_after, fit.holdout_rms_before, fit.holdout_rms_after];
        rows.push([vec![name.clone(), words::unit(&fit.unit)], numbers.map(words::level).to_vec()].concat());
    }
    let right = [false, false, true, true, true, true, true];
    format!("\nResidual rms, running free\n{}", table::align(&rows, &right))
}

/// Parameters that the data determine, before and after.
fn changed(diagnosis: &Diagnosis) -> String {
    let corrected = diagnosis.findings.iter().any(|finding| finding.effect != UNEXPLAINED);
    let after = if corrected { "after" } else { "value" };
    let mut rows = vec![["parameter", "unit", "before", after, "95 % interval"].map(str::to_owned).to_vec()];
    let row = |name: &str, unit: &str, before: String, after: Option<f64>, ci95: [Option<f64>; 2]| {
        let (value, range) = (words::estimate(after, ci95), words::interval(after, ci95));
        vec![name.to_owned(), words::unit(unit), before, value, range]
    };
    let determined = diagnosis.parameters.iter().filter(|own| !own.fixed && own.identifiable);
    rows.extend(determined.map(|own| {
        row(&own.name, &own.unit, words::estimate(own.before, own.ci95_before), own.after, own.ci95)
    }));
    let combinations = diagnosis.combinations.iter();
    rows.extend(
        combinations.map(|own| row(&own.name, &own.unit, words::number(own.before), own.after, own.ci95)),
    );
    let mut right = vec![false, false, true, true, false];
    if !corrected {
        // Nothing was corrected: there is one value.
        rows.iter_mut().for_each(|row| {
            row.remove(2);
        });
        right.remove(2);
    }
    format!("\nParameters\n{}", table::align(&rows, &right))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The terminal, the page and the window use the same headline.
    #[test]
    fn the_headline_and_its_numbers_come_first() {
        let text = include_str!("../../../../crates/socam-findings/src/headline/example.json");
        let diagnosis: Diagnosis = serde_json::from_str(text).unwrap();
        let said = super::text(&diagnosis);
        let headline = headline(&diagnosis);
        let (first, rest) = said.split_once('\n').unwrap();
        assert!(first.starts_with(&headline.title), "{said}");
        assert!(rest.starts_with("  1. Coulomb friction, at either bearing"), "{said}");
        assert!(said.contains("torque = 0.3010 N m (95 % interval 0.2951 to 0.3069)"), "{said}");
        assert!(headline.certainty.iter().all(|sentence| said.contains(sentence.as_str())), "{said}");
    }

    #[test]
    fn a_search_that_was_ended_is_said_first_and_once() {
        let text = include_str!("../../../../crates/socam-findings/src/headline/example.json");
        let mut diagnosis: Diagnosis = serde_json::from_str(text).unwrap();
        let how = "The search was interrupted after 3.0 s: no further effect was looked for.";
        (diagnosis.finished, diagnosis.unfinished) = (false, Some(how.into()));
        let said = super::text(&diagnosis);
        assert!(said.starts_with(&format!("{how}\nPhysics is missing")), "{said}");
        assert_eq!(said.matches(how).count(), 1);
    }
}
