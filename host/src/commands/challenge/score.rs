//! Score of an answer, once the truth is known.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use socam_diagnose::document::{CandidateFate, Diagnosis, Finding, Stage, UNEXPLAINED};
use socam_sim::challenge::{Case, CaseKind, Drive, Hidden};

use super::{answer::Held, background, oracle::Oracle};

pub(super) const SCHEMA: &str = "socam.challenge-case/5";

/// Greatest ratio of held-out residuals to the noise floor for a prediction down to the noise, with all findings and curves.
const AT_THE_FLOOR: f64 = 1.15;
/// Greatest ratio of a finding's weight to that of a rival that ties with it.
const TIE: f64 = 2.0;

/// One case, diagnosed and scored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Score {
    pub(super) schema: String,
    pub(super) seed: u64,
    pub(super) number: u64,
    pub(super) family: String,
    pub(super) kind: CaseKind,
    /// Whether the bench has a background that no case names.
    pub(super) realistic: bool,
    pub(super) hidden: Vec<Hidden>,
    /// Findings, strongest first: effect and location.
    pub(super) named: Vec<(String, String)>,
    /// Error, if there is no answer.
    pub(super) error: Option<String>,
    /// Decrease of chi-square by each hidden effect with the oracle; `None` if it fails.
    pub(super) oracle_gain: Vec<Option<f64>>,
    /// Whitened chi-square per value of the oracle.
    pub(super) oracle_misfit: Option<f64>,
    /// Whether each hidden effect is detectable.
    pub(super) detectable: bool,
    pub(super) right: bool,
    /// Whether there is a finding that was not hidden and that no hidden effect ties with.
    pub(super) wrong_name: bool,
    /// Findings that belong to the background of the bench.
    pub(super) background_named: usize,
    /// False alarm rate that the diagnosis states.
    pub(super) stated_false_alarm_rate: Option<f64>,
    /// Stated probability of each hidden effect of the catalogue; 0 if it is not mentioned.
    pub(super) probability: Vec<f64>,
    /// Weight of each finding and rival, and whether it was hidden.
    pub(super) statements: Vec<(f64, bool)>,
    /// Whether all channels are predicted down to their noise with all findings, curves included; of right answers only.
    pub(super) at_the_floor: Option<bool>,
    /// Whether the intervals contain the truth, for effects that were named correctly.
    pub(super) intervals: Vec<(String, bool)>,
    /// How far each hidden effect of the catalogue came that is no finding of a wrong answer.
    #[serde(default)]
    pub(super) lost: Vec<CandidateFate>,
    /// Of a wrong answer: whitened chi-square that its effects leave on the held-out recordings, less what the hidden effects leave, in units
    /// of the latter per value. Both are fitted from the true parameters; a positive number says that the criterion had reason to prefer the
    /// truth. `None` where a fit fails, the answer has a curve, or what is hidden has no law.
    #[serde(default)]
    pub(super) truth_gains: Option<f64>,
    /// The answer's nodes beside the truth.
    #[serde(default)]
    pub(super) held: Held,
    /// Processor time of the diagnosis, s.
    pub(super) cpu_s: Option<f64>,
}

/// Whether a finding is observationally equivalent to a hidden effect, which is given by its number.
pub(super) type Equivalent<'a> = dyn Fn(&Finding, usize) -> bool + 'a;

impl Score {
    pub(super) fn new(
        case: &Case,
        (answer, cpu_s): (&Result<Diagnosis, String>, f64),
        oracle: Oracle,
        equivalent: &Equivalent<'_>,
    ) -> Self {
        let (answer, error) = match answer {
            Ok(diagnosis) => (Some(diagnosis), None),
            Err(error) => (None, Some(error.clone())),
        };
        let findings = answer.map_or(&[][..], |diagnosis| &diagnosis.findings);
        let judge = Judge::new(case, findings, equivalent);
        let right = answer.is_some() && judge.is_right();
        Self {
            schema: SCHEMA.into(),
            seed: case.seed,
            number: case.number,
            family: case.machine.family.clone(),
            kind: case.kind,
            realistic: case.realistic,
            hidden: case.hidden.clone(),
            named: findings.iter().map(|f| (f.effect.clone(), f.location.clone())).collect(),
            error,
            detectable: oracle.detects_all(),
            oracle_gain: oracle.gain,
            oracle_misfit: oracle.misfit,
            right,
            wrong_name: judge.has_wrong_name(right),
            background_named: findings.iter().filter(|finding| judge.is_background(finding)).count(),
            stated_false_alarm_rate: answer.map(|diagnosis| diagnosis.false_alarm_rate),
            probability: probabilities(case, findings),
            statements: findings.iter().flat_map(|finding| statements(case, finding)).collect(),
            at_the_floor: answer.filter(|_| right).and_then(at_the_floor),
            intervals: case.hidden.iter().flat_map(|hidden| intervals(case, hidden, findings)).collect(),
            lost: answer.filter(|_| !right).map_or_else(Vec::new, |answer| lost(case, answer)),
            truth_gains: None,
            held: answer.map_or_else(Held::default, |answer| Held::new(case, answer, &judge.claims())),
            cpu_s: answer.map(|_| cpu_s),
        }
    }
}

/// The hidden effects of the catalogue that are no findings.
fn lost(case: &Case, answer: &Diagnosis) -> Vec<CandidateFate> {
    let of_catalogue = case.hidden.iter().filter(|_| case.kind != CaseKind::Outside);
    let fate = |hidden: &Hidden| {
        let known = answer.candidates.iter().find(|one| is_named((&one.effect, &one.location), hidden));
        known.cloned().unwrap_or_else(|| {
            let sentence = "It was not among the candidates".to_owned();
            CandidateFate::new(&hidden.effect, &hidden.place, (Stage::NotProposed, 1), sentence)
        })
    };
    of_catalogue.map(fate).filter(|fate| fate.stage != Stage::Found).collect()
}

fn is_named((effect, place): (&str, &str), hidden: &Hidden) -> bool {
    effect == hidden.effect && place == hidden.place
}

/// Findings with the truth.
struct Judge<'a> {
    case: &'a Case,
    findings: &'a [Finding],
    /// For each finding, the index of the hidden effect that it is.
    is: Vec<Vec<bool>>,
}

impl<'a> Judge<'a> {
    fn new(case: &'a Case, findings: &'a [Finding], equivalent: &Equivalent<'_>) -> Self {
        let one = |finding: &Finding| -> Vec<bool> {
            let hidden = case.hidden.iter().enumerate();
            hidden.map(|(index, hidden)| is_it(finding, hidden, index, equivalent)).collect()
        };
        Self { case, findings, is: findings.iter().map(one).collect() }
    }

    /// Whether the hidden effects come first, in any order. Findings of the background may come before them: which of the two is stronger
    /// is not the diagnosis' choice.
    fn is_right(&self) -> bool {
        let is_hidden = |index: usize| self.is[index].iter().any(|is| *is);
        let all = 0..self.findings.len();
        let counted: Vec<usize> =
            all.filter(|index| is_hidden(*index) || self.is_claim(&self.findings[*index])).collect();
        let is =
            |place: usize, hidden: usize| counted.get(place).is_some_and(|index| self.is[*index][hidden]);
        match self.case.kind {
            CaseKind::Clean => counted.is_empty(),
            CaseKind::Single => is(0, 0),
            CaseKind::Double => is(0, 0) && is(1, 1) || is(0, 1) && is(1, 0),
            CaseKind::Outside => counted.first().is_some_and(|first| {
                let first = &self.findings[*first];
                first.effect == UNEXPLAINED
                    || self.case.is_same_body(&first.location, &self.case.hidden[0].place)
            }),
        }
    }

    /// Whether a finding is wrong. For physics outside the catalogue: a finding at another place, if there is no unexplained finding.
    /// Otherwise: any finding that was not hidden and that no hidden effect ties with.
    fn has_wrong_name(&self, right: bool) -> bool {
        let outside = self.case.kind == CaseKind::Outside;
        if outside && self.findings.iter().any(|finding| finding.effect == UNEXPLAINED) {
            return false;
        }
        let named = self.findings.iter().enumerate().filter(|(_, finding)| finding.effect != UNEXPLAINED);
        named.filter(|(_, finding)| self.is_claim(finding)).any(|(index, finding)| {
            if outside {
                return !self.case.is_same_body(&finding.location, &self.case.hidden[0].place);
            }
            let small = right && !self.case.hidden.is_empty() && is_small_mass(self.case, finding);
            !small && !self.is[index].iter().any(|is| *is) && !has_tying_truth(self.case, finding)
        })
    }

    /// Whether a finding claims something that has to be hidden: it is none of the background, and no imperfection that every bench has.
    fn is_claim(&self, finding: &Finding) -> bool {
        finding.evidence.ordinary.is_none() && !self.is_background(finding)
    }

    /// The findings that claim something.
    fn claims(&self) -> Vec<&'a Finding> {
        self.findings.iter().filter(|finding| self.is_claim(finding)).collect()
    }

    /// Whether a finding belongs to the background of the bench.
    fn is_background(&self, finding: &Finding) -> bool {
        let named = (finding.effect.as_str(), finding.location.as_str());
        background::is_there(self.case, named, background::stated_delay_s(finding))
    }
}

/// Whether a finding is a hidden effect, or has it among its rivals if it is observationally equivalent.
fn is_it(finding: &Finding, hidden: &Hidden, index: usize, equivalent: &Equivalent<'_>) -> bool {
    let owns_up = || finding.rivals.iter().any(|rival| is_named((&rival.effect, &rival.location), hidden));
    is_named((&finding.effect, &finding.location), hidden) || (owns_up() && equivalent(finding, index))
}

fn has_tying_truth(case: &Case, finding: &Finding) -> bool {
    let own = finding.own_weight();
    let is_tied = |weight: f64| own <= TIE * weight;
    finding
        .rivals
        .iter()
        .any(|rival| is_true(case, (&rival.effect, &rival.location), None) && is_tied(rival.weight))
}

/// Whether an effect is hidden, or part of the background.
fn is_true(case: &Case, named: (&str, &str), delay_s: Option<f64>) -> bool {
    case.hidden.iter().any(|hidden| is_named(named, hidden)) || background::is_there(case, named, delay_s)
}

/// Whether a finding is a small inertia at a massless point of the model: the bench has some there, so the finding is not wrong
/// once the hidden effects are found.
fn is_small_mass(case: &Case, finding: &Finding) -> bool {
    let nodes = &case.machine.nodes;
    finding.effect == "missing_inertia"
        && case.machine.input.drive == Drive::Speed
        && nodes.iter().any(|node| node.name == finding.location && node.inertia.is_none())
}

/// Stated probability of each hidden effect of the catalogue, as a finding or as a rival.
fn probabilities(case: &Case, findings: &[Finding]) -> Vec<f64> {
    if case.kind == CaseKind::Outside {
        return Vec::new();
    }
    let given = |hidden: &Hidden| {
        let all = findings.iter().flat_map(weights);
        let own = all.filter(|(effect, place, _)| is_named((effect, place), hidden));
        own.map(|(.., weight)| weight).fold(0.0, f64::max)
    };
    case.hidden.iter().map(given).collect()
}

/// Effect, place and weight of a finding and of each of its rivals.
fn weights(finding: &Finding) -> impl Iterator<Item = (&str, &str, f64)> {
    let rivals =
        finding.rivals.iter().map(|rival| (rival.effect.as_str(), rival.location.as_str(), rival.weight));
    std::iter::once((finding.effect.as_str(), finding.location.as_str(), finding.own_weight())).chain(rivals)
}

/// Weight of each named statement, and whether it is true of the hidden effects or of the background; empty if the hidden effect
/// has no name.
fn statements(case: &Case, finding: &Finding) -> Vec<(f64, bool)> {
    if case.kind == CaseKind::Outside {
        return Vec::new();
    }
    let named = weights(finding).filter(|(effect, ..)| *effect != UNEXPLAINED);
    let stated = background::stated_delay_s(finding);
    let each = named.enumerate().map(|(rival, (effect, place, weight))| {
        let delay_s = stated.filter(|_| rival == 0);
        (weight, is_true(case, (effect, place), delay_s))
    });
    each.collect()
}

/// `None` if the answer has no residuals or noise floors.
fn at_the_floor(diagnosis: &Diagnosis) -> Option<bool> {
    let channels = diagnosis.fit.channels.iter();
    let ratios: Vec<f64> =
        channels.filter_map(|(_, fit)| Some(fit.holdout_rms_after? / fit.noise_std?)).collect();
    (!ratios.is_empty()).then(|| ratios.iter().all(|ratio| *ratio <= AT_THE_FLOOR))
}

/// Parameters with an interval, and whether it contains the truth.
fn intervals(case: &Case, hidden: &Hidden, findings: &[Finding]) -> Vec<(String, bool)> {
    let Some(finding) =
        findings.iter().find(|finding| is_named((&finding.effect, &finding.location), hidden))
    else {
        return Vec::new();
    };
    let each = hidden.parameters.iter().filter_map(|(name, truth)| {
        let known = finding.parameters.iter().find(|parameter| parameter.name == *name)?;
        if known.ci95 == [None, None] {
            return None;
        }
        let [low, high] =
            [known.ci95[0].unwrap_or(f64::NEG_INFINITY), known.ci95[1].unwrap_or(f64::INFINITY)];
        let truth = background::expected(case, hidden, (name, *truth), &known.unit, findings)?;
        let truth = if name == "phase" { nearest_turn(truth, low, high) } else { truth };
        Some((name.clone(), (low..=high).contains(&truth)))
    });
    each.collect()
}

/// The phase, shifted by whole turns to the interval.
fn nearest_turn(phase: f64, low: f64, high: f64) -> f64 {
    let middle = 0.5 * (low + high);
    if middle.is_finite() { phase + TAU * ((middle - phase) / TAU).round() } else { phase }
}

#[cfg(test)]
mod tests;
