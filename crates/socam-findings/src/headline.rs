//! The headline of a diagnosis: what was found, where, how large, and how certain. Report, terminal and dashboard show this headline.
//!
//! ```
//! let text = include_str!("headline/example.json");
//! let diagnosis: socam_findings::Diagnosis = serde_json::from_str(text)?;
//! let headline = socam_findings::headline(&diagnosis);
//! assert_eq!(headline.title, "Physics is missing: Coulomb friction, at either bearing (motor_bearing or load_bearing)");
//! assert_eq!(headline.claims[0].size.as_deref(), Some("torque 0.3010 N m (95 % interval 0.2951 to 0.3069), if at motor_bearing"));
//! # Ok::<(), serde_json::Error>(())
//! ```

mod certainty;
mod claim;

#[cfg(test)]
mod tests;

pub use socam_model::drawing::PlaceMark;

use crate::document::{Diagnosis, Finding, UNEXPLAINED, Verdict};
use crate::proof::Proof;
use crate::words;

/// Least weight of a competing explanation that ties with the finding, as a share of the finding's own weight. The headline names both.
/// Odds below 3 to 1 are "not worth more than a bare mention" (Kass and Raftery, Bayes factors, 1995).
const TIE: f64 = 1.0 / 3.0;
/// Least weight of a competing explanation whose place is marked in a drawing.
const MARKED: f64 = 0.05;

/// The kind of a headline, for its colour and sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// Nothing is missing that is material and not ordinary.
    Adequate,
    /// Physics is missing, and it has a name.
    Missing,
    /// Something is missing that has no name, or the search was ended before anything was found.
    Unexplained,
    /// Held-out recordings contradict what was found.
    Contradicted,
}

/// The headline.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Headline {
    /// Kind, for colour and sign.
    pub tone: Tone,
    /// One line without a full stop: what is missing and where, with all explanations that tie where there is one finding.
    pub title: String,
    /// One line for each finding, in their order.
    pub claims: Vec<Claim>,
    /// Sentences about the certainty, the most important first: a search that was ended before its own end, the proof, the competing
    /// explanations, and the remaining misfit.
    pub certainty: Vec<String>,
}

/// A finding in one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// What it is and where, with all explanations that tie: "Coulomb friction or Stribeck friction at load_bearing".
    pub what: String,
    /// Its size with unit and interval; `None` where it has none.
    pub size: Option<String>,
    /// Whether competing explanations tie with it.
    pub tied: bool,
}

/// The headline of a diagnosis.
#[must_use]
pub fn headline(diagnosis: &Diagnosis) -> Headline {
    let claims: Vec<Claim> =
        diagnosis.findings.iter().map(|finding| claim::claim(diagnosis, finding)).collect();
    let failed = matches!(Proof::of(diagnosis), Proof::Failed(_));
    let tone = match diagnosis.verdict {
        Verdict::Adequate => Tone::Adequate,
        Verdict::NotJudged => Tone::Unexplained,
        _ if failed => Tone::Contradicted,
        Verdict::MissingPhysics => Tone::Missing,
        Verdict::Unexplained => Tone::Unexplained,
    };
    Headline {
        tone,
        title: title(diagnosis, tone),
        certainty: certainty::sentences(diagnosis, &claims),
        claims,
    }
}

/// Places to mark in a drawing: each finding's, then those of its competing explanations that have no finding.
#[must_use]
pub fn marks(diagnosis: &Diagnosis) -> Vec<(&str, PlaceMark)> {
    let findings = diagnosis.findings.iter().enumerate();
    let found = findings.map(|(index, finding)| (finding.location.as_str(), PlaceMark::Finding(index + 1)));
    let mut marks: Vec<_> = found.collect();
    for rival in diagnosis.findings.iter().flat_map(|finding| &finding.rivals) {
        if rival.weight >= MARKED && !marks.iter().any(|(place, _)| *place == rival.location) {
            marks.push((&rival.location, PlaceMark::Rival));
        }
    }
    marks
}

fn title(diagnosis: &Diagnosis, tone: Tone) -> String {
    let (nameless, named): (Vec<&Finding>, Vec<&Finding>) = diagnosis
        .findings
        .iter()
        .filter(|finding| finding.counts())
        .partition(|finding| finding.effect == UNEXPLAINED);
    // Each claim has all of a finding's competing models.
    let said = |all: Vec<&Finding>| -> Vec<String> {
        let one = if all.len() > 1 { claim::brief } else { claim::what };
        all.into_iter().map(|finding| one(diagnosis, finding)).collect()
    };
    let named = said(named);
    let ordinary = diagnosis.findings.iter().filter(|finding| finding.evidence.ordinary.is_some());
    let ordinary = said(ordinary.collect());
    let places: Vec<String> = nameless.into_iter().map(|finding| finding.location.clone()).collect();
    let places = words::list(&places, "and");
    let at = if places.is_empty() { String::new() } else { format!(" at {places}") };
    let what = match (named.is_empty(), at.is_empty()) {
        (false, true) => joined(&named),
        (false, false) => format!("{}, and something without a name{at}", joined(&named)),
        (true, _) => format!("something without a name{at}"),
    };
    match tone {
        Tone::Adequate if diagnosis.findings.is_empty() => {
            "Nothing is missing that these recordings could show".into()
        }
        Tone::Adequate if !ordinary.is_empty() => {
            format!("Nothing is missing but ordinary imperfections: {}", joined(&ordinary))
        }
        Tone::Adequate => {
            "Nothing material is missing: what was found moves no channel by more than the tolerance".into()
        }
        Tone::Missing => format!("Physics is missing: {what}"),
        Tone::Contradicted => format!("Contradicted by the held-out recordings: {what}"),
        Tone::Unexplained if diagnosis.verdict == Verdict::NotJudged => {
            "Not judged: the search was ended before anything was found".into()
        }
        Tone::Unexplained if !diagnosis.finished => {
            format!(
                "Something is missing{at}, and the search was ended before an effect that explains it was found"
            )
        }
        Tone::Unexplained => format!("Something is missing{at} that no effect of the catalogue explains"),
    }
}

/// Items as a list; they are numbered where they hold commas.
fn joined(items: &[String]) -> String {
    if items.len() > 1 && items.iter().any(|item| item.contains(',')) {
        let numbered = items.iter().enumerate().map(|(index, item)| format!("({}) {item}", index + 1));
        numbered.collect::<Vec<_>>().join("; ")
    } else {
        words::list(items, "and")
    }
}
