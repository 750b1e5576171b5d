//! The answer's nodes beside the truth: whether they hold it, and how many they are.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};
use socam_diagnose::document::{AnswerNode, Diagnosis, Finding, Level};
use socam_findings::answer;
use socam_model::effects::CATALOGUE;
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
    /// For each finding that claims something, its level, its number of nodes, their probability together, and whether one of them is true.
    pub(super) sets: Vec<(Level, usize, f64, bool)>,
    /// For each of [`LIMITS`], the number of hidden effects that the answer within it holds, and the number of its nodes.
    pub(super) within: Vec<(usize, usize)>,
}

impl Held {
    /// Compares an answer with the truth. `claims` are the findings that a bench must hide something for.
    pub(super) fn new(case: &Case, diagnosis: &Diagnosis, claims: &[&Finding]) -> Self {
        let held = |nodes: &[AnswerNode], hidden: &Hidden| {
            let holding = nodes.iter().filter(|node| holds(case, node, hidden));
            holding.map(|node| node.level).max()
        };
        let set = |finding: &&Finding| {
            let nodes = answer::of_finding(diagnosis, finding);
            let together = nodes.iter().map(|node| node.probability).sum();
            Some((nodes.first()?.level, nodes.len(), together, nodes.iter().any(|node| is_true(case, node))))
        };
        let count = |limit: &f64| {
            let nodes = answer::within(diagnosis, *limit);
            (case.hidden.iter().filter(|hidden| held(&nodes, hidden).is_some()).count(), nodes.len())
        };
        Self {
            hidden: case.hidden.iter().map(|hidden| held(&diagnosis.answer, hidden)).collect(),
            sets: claims.iter().filter_map(set).collect(),
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
    /// For each limit, the rate of hidden effects that the answer within it holds, and its mean number of nodes.
    within: Vec<(f64, Rate, f64)>,
}

impl Answers {
    /// Of cases whose hidden effects can be detected.
    pub(super) fn new(all: &[&Held]) -> Self {
        let sets = || all.iter().flat_map(|held| &held.sets);
        let mean =
            |values: &[f64]| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        let level = |(level, name): (Level, &'static str)| {
            let own = || sets().filter(move |(own, ..)| *own == level);
            let stated: Vec<f64> = own().map(|(_, _, stated, _)| *stated).collect();
            (name, Rate::of(own().map(|(.., is_true)| *is_true)), mean(&stated))
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
            nodes: mean(&sets().map(|(_, nodes, ..)| *nodes as f64).collect::<Vec<_>>()),
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
        for (limit, rate, nodes) in &self.within {
            let _ = writeln!(text, "  within {limit}: {}; {nodes:.2} nodes a case", rate.text());
        }
        text
    }
}
