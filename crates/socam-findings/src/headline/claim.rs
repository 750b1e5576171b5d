//! A finding in one line, with the explanations that tie with it.

use socam_model::effects;

use super::{Claim, TIE};
use crate::answer;
use crate::document::{AnswerNode, Diagnosis, EffectParameter, Finding, Level, Rival, UNEXPLAINED};
use crate::words;

/// Greatest number of explanations that are named one by one.
const NAMED: usize = 4;

/// One line about a finding.
pub(super) fn claim(diagnosis: &Diagnosis, finding: &Finding) -> Claim {
    let laws = explanations(diagnosis, finding);
    Claim {
        what: what(diagnosis, finding),
        size: size(finding, &laws, is_shallow(diagnosis, finding)),
        tied: laws.len() > 1,
    }
}

/// A finding with its place, as deep as the recordings go: the laws that tie, or what they have in common, where they are too many.
pub(super) fn what(diagnosis: &Diagnosis, finding: &Finding) -> String {
    if is_shallow(diagnosis, finding) {
        let nodes = answer::of_finding(diagnosis, finding);
        return format!("{}, fitted as {}", common(&nodes), fitted(finding, &nodes, ""));
    }
    let all = explanations(diagnosis, finding);
    let (shown, more) = (&all[..all.len().min(NAMED)], all.len().saturating_sub(NAMED));
    let (effects, places) = distinct(shown);
    let text = if shown.len() == effects.len() * places.len() {
        together(&effects, &places)
    } else {
        let of = |effect: &&str| {
            let places: Vec<&str> = shown.iter().filter(|own| own.0 == *effect).map(|own| own.1).collect();
            together(&[*effect], &places)
        };
        effects.iter().map(of).collect::<Vec<_>>().join(", or ")
    };
    if more > 0 { format!("{text}, or one of {more} other explanations") } else { text }
}

/// A finding with its place in few words, for a line of several: the law that was fitted, and whether another may be meant.
pub(super) fn brief(diagnosis: &Diagnosis, finding: &Finding) -> String {
    let (effect, place) = (words::effect(&finding.effect), &finding.location);
    let all = explanations(diagnosis, finding);
    let nodes = answer::of_finding(diagnosis, finding);
    let mut places = all.iter().map(|own| own.1).chain(nodes.iter().map(|node| node.parts().1));
    let is_elsewhere = places.any(|other| other != place);
    match (all.len() > 1 || is_shallow(diagnosis, finding), is_elsewhere) {
        (_, true) => format!("{effect} at {place}, or a competing model"),
        (true, false) => format!("{effect} or a competing model at {place}"),
        (false, false) => format!("{effect} at {place}"),
    }
}

/// The law that was fitted, with its place or, where the answer's nodes have no other, `there`.
pub(super) fn fitted(finding: &Finding, nodes: &[&AnswerNode], there: &str) -> String {
    let effect = words::effect(&finding.effect);
    let elsewhere = nodes.iter().any(|node| node.parts().1 != finding.location);
    if elsewhere { format!("{effect} at {}", finding.location) } else { format!("{effect}{there}") }
}

/// Whether the recordings leave open which law a named finding is.
fn is_shallow(diagnosis: &Diagnosis, finding: &Finding) -> bool {
    let nodes = answer::of_finding(diagnosis, finding);
    finding.effect != UNEXPLAINED && nodes.first().is_some_and(|node| node.level < Level::Law)
}

/// Families, or sides, with their places: "friction, drag or a loss at motor_bearing or load_bearing".
pub(super) fn common(nodes: &[&AnswerNode]) -> String {
    let mut kinds: Vec<(&str, Vec<String>)> = Vec::new();
    for (kind, place) in nodes.iter().map(|node| node.parts()) {
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, places)) => places.push(place.to_owned()),
            None => kinds.push((kind, vec![place.to_owned()])),
        }
    }
    let each = kinds
        .iter()
        .map(|(kind, places)| format!("{} at {}", answer::words(kind), words::list(places, "or")));
    each.collect::<Vec<_>>().join("; or ")
}

/// The competing explanations that tie with a finding.
pub(super) fn ties(finding: &Finding) -> impl Iterator<Item = &Rival> {
    // The finding leads the list even if its rivals have all the weight.
    let least = TIE * finding.own_weight().max(0.1);
    finding.rivals.iter().filter(move |rival| rival.weight >= least && finding.effect != UNEXPLAINED)
}

/// Effect and place of a finding, then of each explanation that ties or that the answer lists, each once.
fn explanations<'a>(diagnosis: &'a Diagnosis, finding: &'a Finding) -> Vec<(&'a str, &'a str)> {
    let mut all = vec![(finding.effect.as_str(), finding.location.as_str())];
    let nodes = answer::of_finding(diagnosis, finding).into_iter().filter(|node| node.level == Level::Law);
    let ties = ties(finding).map(|rival| (rival.effect.as_str(), rival.location.as_str()));
    for own in ties.chain(nodes.map(AnswerNode::parts)) {
        if !all.contains(&own) {
            all.push(own);
        }
    }
    all
}

/// The effects and the places among explanations, in their order.
fn distinct<'a>(explanations: &[(&'a str, &'a str)]) -> (Vec<&'a str>, Vec<&'a str>) {
    let (mut effects, mut places) = (Vec::new(), Vec::new());
    for (effect, place) in explanations {
        if !effects.contains(effect) {
            effects.push(*effect);
        }
        if !places.contains(place) {
            places.push(*place);
        }
    }
    (effects, places)
}

/// Any of the effects at any of the places.
fn together(effects: &[&str], places: &[&str]) -> String {
    let names: Vec<String> = effects.iter().map(|effect| words::effect(effect)).collect();
    let places_in_words: Vec<String> = places.iter().map(|place| (*place).to_owned()).collect();
    let (what, at) = (words::list(&names, "or"), words::list(&places_in_words, "or"));
    match (places.len(), noun(effects)) {
        (2, Some(noun)) => format!("{what}, at either {noun} ({at})"),
        (3.., Some(noun)) => format!("{what}, at one of {} {noun}s ({at})", places.len()),
        _ => format!("{what} at {at}"),
    }
}

/// The kind of place at which all of these effects act, without an article.
fn noun(effects: &[&str]) -> Option<&'static str> {
    let mut kinds = effects.iter().map(|effect| effects::find(effect).map(|effect| effect.acts_at));
    let first = kinds.next()??;
    kinds.all(|kind| kind == Some(first)).then(|| first.noun().trim_start_matches("a "))
}

/// The parameters that measure the size of a finding, with units and intervals.
fn size(finding: &Finding, laws: &[(&str, &str)], is_shallow: bool) -> Option<String> {
    let amplitudes = effects::find(&finding.effect).map_or(&[][..], |effect| effect.amplitude.parameters);
    let is_amplitude = |own: &&EffectParameter| amplitudes.contains(&own.name.as_str());
    let mut shown: Vec<&EffectParameter> = finding.parameters.iter().filter(is_amplitude).collect();
    if shown.is_empty() {
        shown.extend(finding.parameters.first());
    }
    let each = shown.iter().map(|own| {
        let name = words::parameter(&own.name, &own.unit);
        format!("{name} {}", words::quantity(own.value, own.ci95, &own.unit))
    });
    let mut size = each.collect::<Vec<_>>().join(", ");
    if size.is_empty() {
        return None;
    }
    if finding.components.len() > 1 {
        size.push_str(&format!(", the largest of {} orders", finding.components.len()));
    }
    let (effects, places) = distinct(laws);
    match (effects.len() > 1, places.len() > 1) {
        // The words before the size say what it was fitted as.
        _ if is_shallow => {}
        (false, false) => {}
        (true, false) => size.push_str(&format!(", if it is {}", words::effect(&finding.effect))),
        (false, true) => size.push_str(&format!(", if at {}", finding.location)),
        (true, true) => {
            size.push_str(&format!(", if it is {} at {}", words::effect(&finding.effect), finding.location));
        }
    }
    Some(size)
}
