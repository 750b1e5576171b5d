//! The answer's nodes beside the truth: whether they hold it, and how many they are.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};
use socam_diagnose::document::{AnswerNode, Diagnosis, Finding, Level};
use socam_findings::answer;
use socam_model::effects::{CATALOGUE, Family};
use socam_sim::challenge::{Case, CaseKind, Hidden};

use super::{background, rates::Rate};

/// Limits at which answers are formed again.
pub(super) const LIMITS: [f64; 6] = [0.5, 0.8, 0.9, 0.95, 0.98, 0.999];
const LEVELS: [(Level, &str); 3] = [(Level::Law, "law"), (Level::Family, "family"), (Level::Side, "side")];

/// An answer and the truth.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Held {
    /// For each hidden effect, the level of the deepest node that holds it; `None` where none does.
    pub(super) hidden: Vec<Option<Level>>,
    /// The findings that claim something and have a place.
    pub(super) claims: Vec<Claim>,
    /// For each of [`LIMITS`], the number of hidden effects that the answer within it holds, and the number of its nodes.
    pub(super) within: Vec<(usize, usize)>,
}

/// A finding that claims something.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Claim {
    /// Family of its law; empty for a curve.
    family: String,
    /// Level of the answer's nodes.
    level: Level,
    /// Their number.
    nodes: usize,
    /// Their probability together.
    stated: f64,
    /// Whether one of them is true.
    is_true: bool,
    /// For each of [`LEVELS`], whether a node of all that the finding may be on that level is true; `None` where it has none there.
    among: [Option<bool>; 3],
}

impl Claim {
    fn new(case: &Case, diagnosis: &Diagnosis, finding: &Finding) -> Option<Self> {
        let nodes = answer::of_finding(diagnosis, finding);
        let among = |(level, _): (Level, &str)| {
            let (_, all) = answer::on_level(diagnosis, finding, level);
            (!all.is_empty()).then(|| all.iter().any(|node| is_true(case, node)))
        };
        Some(Self {
            family: answer::on_level(diagnosis, finding, Level::Side).0.map_or("", Family::id).into(),
            level: nodes.first()?.level,
            nodes: nodes.len(),
            stated: nodes.iter().map(|node| node.probability).sum(),
            is_true: nodes.iter().any(|node| is_true(case, node)),
            among: LEVELS.map(among),
        })
    }
}

impl Held {
    /// Compares an answer with the truth. `claims` are the findings that a bench must hide something for.
    pub(super) fn new(case: &Case, diagnosis: &Diagnosis, claims: &[&Finding]) -> Self {
        let held = |nodes: &[AnswerNode], hidden: &Hidden| {
            let holding = nodes.iter().filter(|node| holds(case, node, hidden));
            holding.map(|node| node.level).max()
        };
        let count = |limit: &f64| {
            let nodes = answer::within(diagnosis, *limit);
            (case.hidden.iter().filter(|hidden| held(&nodes, hidden).is_some()).count(), nodes.len())
        };
        Self {
            hidden: case.hidden.iter().map(|hidden| held(&diagnosis.answer, hidden)).collect(),
            claims: claims.iter().filter_map(|finding| Claim::new(case, diagnosis, finding)).collect(),
            within: LIMITS.iter().map(count).collect(),
        }
    }
}

/// Whether a node holds a hidden effect. What the catalogue lacks has no name and no family of its own: the side and the body must be right, and
/// a law is wrong.
fn holds(case: &Case, node: &AnswerNode, hidden: &Hidden) -> bool {
    let (_, place) = node.parts();
    if case.kind == CaseKind::Outside {
        let is_channel = case.machine.sensors.iter().any(|sensor| sensor.name == hidden.place);
        let mut below = below(node);
        return node.level < Level::Law
            && case.is_same_body(place, &hidden.place)
            && below.any(|effect| effect.family.is_of_a_sensor() == is_channel);
    }
    place == hidden.place && below(node).any(|effect| effect.id == hidden.effect)
}

/// Whether a node holds a hidden effect or a part of the background.
fn is_true(case: &Case, node: &AnswerNode) -> bool {
    let (_, place) = node.parts();
    case.hidden.iter().any(|hidden| holds(case, node, hidden))
        || below(node).any(|effect| background::is_there(case, (effect.id, place), None))
}

/// The effects of the catalogue below a node.
fn below(node: &AnswerNode) -> impl Iterator<Item = &'static socam_model::effects::Effect> {
    let (kind, _) = node.parts();
    CATALOGUE.iter().copied().filter(move |effect| answer::is_below(effect, kind))
}

/// Rates of all answers.
#[derive(Debug, Serialize)]
pub(super) struct Answers {
    /// Rate of hidden effects that a node holds, of those that can be detected.
    holds: Rate,
    /// Mean number of nodes of a finding that claims something.
    nodes: Option<f64>,
    /// For each level, the rate of findings on that level one of whose nodes is true, and the mean probability that they state.
    levels: Vec<(&'static str, Rate, Option<f64>)>,
    /// For each family, the rates of findings that have the truth among what they may be: on the level of laws, of families, of sides.
    families: BTreeMap<String, [Rate; 3]>,
    /// For each limit, the rate of hidden effects that the answer within it holds, and its mean number of nodes.
    within: Vec<(f64, Rate, f64)>,
}

impl Answers {
    /// Of cases whose hidden effects can be detected.
    pub(super) fn new(all: &[&Held]) -> Self {
        let claims = || all.iter().flat_map(|held| &held.claims);
        let mean =
            |values: &[f64]| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        let level = |(level, name): (Level, &'static str)| {
            let own = || claims().filter(move |claim| claim.level == level);
            let stated: Vec<f64> = own().map(|claim| claim.stated).collect();
            (name, Rate::of(own().map(|claim| claim.is_true)), mean(&stated))
        };
        let mut families: BTreeMap<String, Vec<&Claim>> = BTreeMap::new();
        claims().for_each(|claim| families.entry(claim.family.clone()).or_default().push(claim));
        let among = |claims: Vec<&Claim>| {
            [0, 1, 2].map(|level: usize| Rate::of(claims.iter().filter_map(|claim| claim.among[level])))
        };
        let within = |(index, limit): (usize, &f64)| {
            let each = all.iter().filter(|held| !held.hidden.is_empty());
            let counts = each.flat_map(|held| {
                let count = held.within.get(index).map_or(0, |(count, _)| *count);
                (0..held.hidden.len()).map(move |hidden| hidden < count)
            });
            let nodes: Vec<f64> = all
                .iter()
                .filter_map(|held| held.within.get(index))
                .map(|(_, nodes)| *nodes as f64)
                .collect();
            (*limit, Rate::of(counts), mean(&nodes).unwrap_or(0.0))
        };
        Self {
            holds: Rate::of(all.iter().flat_map(|held| &held.hidden).map(Option::is_some)),
            nodes: mean(&claims().map(|claim| claim.nodes as f64).collect::<Vec<_>>()),
            families: families.into_iter().map(|(family, own)| (family, among(own))).collect(),
            levels: LEVELS.into_iter().map(level).collect(),
            within: LIMITS.iter().enumerate().map(within).collect(),
        }
    }

    /// Lines of text; empty where nothing was hidden.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        let Some(nodes) = self.nodes else { return text };
        let _ = writeln!(
            text,
            "answers that hold what is hidden: {}; {nodes:.2} nodes a finding",
            self.holds.text()
        );
        for (name, rate, stated) in &self.levels {
            if let Some(stated) = stated {
                let _ =
                    writeln!(text, "  on the level of a {name}: true {} (stated {stated:.2})", rate.text());
            }
        }
        for (family, [law, there, side]) in &self.families {
            let family = if family.is_empty() { "curves" } else { family };
            let count = |rate: &Rate| format!("{} of {}", rate.hits, rate.of);
            let [law, there, side] = [law, there, side].map(count);
            let _ = writeln!(
                text,
                "  {family}: the law is among those listed in {law}, the family in {there}, the place in {side}"
            );
        }
        for (limit, rate, nodes) in &self.within {
            let _ = writeln!(text, "  within {limit}: {}; {nodes:.2} nodes a case", rate.text());
        }
        text
    }
}
