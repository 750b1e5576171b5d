//! The certainty of a diagnosis, in sentences.

use super::{Claim, MARKED, claim};
use crate::answer;
use crate::document::{Diagnosis, Finding, Level, UNEXPLAINED};
use crate::proof::Proof;
use crate::words;

/// Residual on data that were not fitted, in noise floors, above which a sentence reports remaining misfit.
const LEFT: f64 = 2.0;

/// The sentences, the most important first.
pub(super) fn sentences(diagnosis: &Diagnosis, claims: &[Claim]) -> Vec<String> {
    let worst = worst(diagnosis);
    if diagnosis.findings.is_empty() {
        let fit = worst.map(|(name, before, _)| {
            format!(
                "On data that were not fitted, the worst channel, {name}, is missed by {} times its noise floor.",
                words::rough(before)
            )
        });
        let alarms = format!(
            "A complete model is called incomplete in {} % of diagnoses.",
            words::number(Some(100.0 * diagnosis.false_alarm_rate))
        );
        let alarms = diagnosis.finished.then_some(alarms);
        return diagnosis.unfinished.iter().cloned().chain(fit).chain(alarms).collect();
    }
    let mut all: Vec<String> = diagnosis.unfinished.iter().cloned().collect();
    all.push(Proof::of(diagnosis).sentence().to_owned());
    let several = diagnosis.findings.len() > 1;
    for (index, (finding, claim)) in diagnosis.findings.iter().zip(claims).enumerate() {
        let number = several.then_some(index + 1);
        let probable = probable(diagnosis, finding, number);
        all.extend(probable.or_else(|| rivals(finding, claim, number)));
        all.extend(ordinary(finding, claim));
    }
    let named = diagnosis.findings.iter().any(|finding| finding.effect != UNEXPLAINED);
    let is_weighed = !diagnosis.answer.is_empty();
    if is_weighed {
        all.push("Probabilities are how often such statements were true on simulated benches with a hidden effect; on other machines they may differ.".into());
    } else if named && diagnosis.findings.iter().all(|finding| finding.rivals.is_empty()) {
        all.push("No other explanation that was fitted comes close.".into());
    }
    all.extend(worst.and_then(left));
    all
}

/// What a finding is as deep as the recordings go, and the law that was fitted, with their probabilities.
fn probable(diagnosis: &Diagnosis, finding: &Finding, number: Option<usize>) -> Option<String> {
    let nodes = answer::of_finding(diagnosis, finding);
    let together: f64 = nodes.iter().map(|node| node.probability).sum();
    let level = nodes.first()?.level;
    let head = number.map_or_else(String::new, |number| format!("Finding {number}: "));
    let each: Vec<String> = nodes.iter().map(|node| words::percent(node.probability)).collect();
    let each = if each.len() > 1 { format!(" ({})", words::list(&each, "and")) } else { String::new() };
    let own = answer::of_its_law(diagnosis, finding);
    let own = if level < Level::Law && own > 0.0 {
        format!(", with {} {}", words::percent(own), claim::fitted(finding, &nodes, " there"))
    } else {
        String::new()
    };
    let text = format!(
        "with a probability of {} it is {}{each}{own}",
        words::percent(together),
        claim::common(&nodes)
    );
    Some(sentence(&head, &text))
}

/// The weights of a finding and of its competing explanations; `number` is the finding's, where there are several.
fn rivals(finding: &Finding, claim: &Claim, number: Option<usize>) -> Option<String> {
    let own = finding.own_weight();
    let head = number.map_or_else(String::new, |number| format!("Finding {number}: "));
    if claim.tied {
        let weights = std::iter::once(own).chain(claim::ties(finding).map(|rival| rival.weight));
        let weights: Vec<String> = weights.map(words::percent).collect();
        let text = format!(
            "these recordings do not tell its explanations apart (weights {})",
            words::list(&weights, "and")
        );
        return Some(sentence(&head, &text));
    }
    let next = finding.rivals.iter().max_by(|a, b| a.weight.total_cmp(&b.weight))?;
    if next.weight < MARKED {
        return Some(sentence(&head, "no other explanation that was fitted comes close"));
    }
    let text = format!(
        "its weight among the explanations that were fitted is {}; next is {} at {} with {}",
        words::percent(own),
        words::effect(&next.effect),
        next.location,
        words::percent(next.weight)
    );
    Some(sentence(&head, &text))
}

/// Why a finding is no fault.
fn ordinary(finding: &Finding, claim: &Claim) -> Option<String> {
    let why = finding.evidence.ordinary.as_ref()?;
    Some(sentence("", &format!("{} is ordinary at this size and no fault: {why}", claim.what)))
}

fn sentence(head: &str, text: &str) -> String {
    format!("{}.", words::capital(&format!("{head}{text}")))
}

/// The channel with the largest residual on data that were not fitted, in noise floors: its name, the residual before and after.
fn worst(diagnosis: &Diagnosis) -> Option<(&str, f64, f64)> {
    let each = diagnosis.fit.channels.iter().filter_map(|(name, fit)| {
        let noise = fit.noise_std.filter(|noise| *noise > 0.0)?;
        let (before, after) = (fit.holdout_rms_before?, fit.holdout_rms_after.or(fit.holdout_rms_before)?);
        Some((name.as_str(), before / noise, after / noise))
    });
    each.filter(|(_, before, after)| before.is_finite() && after.is_finite())
        .max_by(|a, b| a.2.total_cmp(&b.2))
}

/// A sentence about the remaining misfit of the corrected model.
fn left((name, before, after): (&str, f64, f64)) -> Option<String> {
    (after > LEFT).then(|| {
        format!(
            "Something is left: on data that were not fitted, {name} is still missed by {} times its noise floor ({} before).",
            words::rough(after),
            words::rough(before)
        )
    })
}
