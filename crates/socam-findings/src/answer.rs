//! The answer of a diagnosis as deep as the recordings go: for each finding the laws, or the families of laws, or the places, that
//! together hold what is missing with a stated probability.
//!
//! The tree has three levels: side and place (`machine@load_bearing`, `sensor@torque_in`), family (`friction@load_bearing`), law
//! (`coulomb_friction@load_bearing`). The laws of a finding are the effect itself, its competing explanations and the laws that contain it.
//! The probability of a law is its weight times the share of such statements that are true on benches of `challenge` ([`Reliability`]); that of
//! a family, or of a place, is the sum of the weights below it times the share of such statements that are true. The answer is the deepest
//! level on which at most [`MOST`] nodes have a probability of [`LIMIT`] together; nothing is deeper than the recordings go.
//!
//! Breaks when: the machine is none that `challenge` draws (lumped drivetrains with the concealed laws of its own), or the recordings
//! were taken in another way; shares are then those of other benches.

use socam_model::effects::{self, Effect, Family};

use crate::document::{AnswerNode, Diagnosis, Finding, Level, Over, UNEXPLAINED, Verdict};

/// Probability that the nodes of an answer have together.
pub const LIMIT: f64 = 0.85;
/// Largest number of laws, or families, that an answer lists.
pub const MOST: usize = 2;

/// Reliability by family.
pub const RELIABILITY: [Reliability; 0] = [];
/// Reliability of a family of which too few were found, and of curves without one.
pub const OTHERS: Reliability = Reliability { family: Family::Own, law: 1.0, family_there: 1.0, side: 1.0 };
/// Share of benches with an adequate model on which nothing was hidden that could be detected.
const SILENCE: f64 = 1.0;
/// Least probability of a node that is listed on the last level.
const LEAST: f64 = 0.05;
/// Levels, the deepest first.
const LEVELS: [Level; 3] = [Level::Law, Level::Family, Level::Side];
/// Names of nodes: nothing is missing, and the two sides.
const NONE: &str = "none";
const MACHINE: &str = "machine";
const SENSOR: &str = "sensor";

/// Shares of the findings of one family that were true on benches of `challenge`: those that are the law that was named, those of a law of its
/// family at that place, and those on that side at that place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reliability {
    /// The family.
    pub family: Family,
    /// The law.
    pub law: f64,
    /// The family at that place.
    pub family_there: f64,
    /// Physics of the machine there, or an error of that sensor.
    pub side: f64,
}

/// One law that a finding may be.
struct Leaf<'a> {
    /// Id of the effect; `None` where a curve stands for a law.
    law: Option<&'a str>,
    family: Option<Family>,
    is_of_a_sensor: bool,
    place: &'a str,
    weight: f64,
}

impl Leaf<'_> {
    /// The deepest level that the leaf says something on.
    fn depth(&self) -> Level {
        match (self.law, self.family) {
            (Some(_), _) => Level::Law,
            (None, Some(_)) => Level::Family,
            (None, None) => Level::Side,
        }
    }

    /// Share of statements like it on a level that are true.
    fn reliability(&self, level: Level) -> f64 {
        let known = RELIABILITY.iter().find(|known| Some(known.family) == self.family);
        let of = |own: &Reliability| [own.side, own.family_there, own.law][level as usize];
        known.map_or(of(&OTHERS), of)
    }

    /// Its node on a level, or on the deepest level above that it has.
    fn node(&self, level: Level) -> String {
        let side = if self.is_of_a_sensor { SENSOR } else { MACHINE };
        let what = match level.min(self.depth()) {
            Level::Law => self.law.unwrap_or(side),
            Level::Family => self.family.map_or(side, Family::id),
            Level::Side => side,
        };
        format!("{what}@{}", self.place)
    }
}

/// The answer of a diagnosis, in the order of its findings.
#[must_use]
pub fn answer(diagnosis: &Diagnosis) -> Vec<AnswerNode> {
    within(diagnosis, LIMIT)
}

/// The answer whose nodes have a probability of at least `limit` together, where there are such nodes.
#[must_use]
pub fn within(diagnosis: &Diagnosis, limit: f64) -> Vec<AnswerNode> {
    if diagnosis.findings.is_empty() && diagnosis.verdict == Verdict::Adequate {
        return vec![AnswerNode {
            node: NONE.into(),
            level: Level::Side,
            probability: SILENCE,
            finding: None,
        }];
    }
    let each = diagnosis.findings.iter().enumerate();
    each.flat_map(|(index, finding)| of(diagnosis, finding, index + 1, limit)).collect()
}

/// The probability that a finding is the law that was fitted, at its place; 0 for a curve.
#[must_use]
pub fn of_its_law(diagnosis: &Diagnosis, finding: &Finding) -> f64 {
    let own = leaves(diagnosis, finding).into_iter().next().filter(|leaf| leaf.law.is_some());
    own.map_or(0.0, |leaf| leaf.weight * leaf.reliability(Level::Law))
}

/// All nodes of a finding on a level, and the family that it is filed under; empty where it has no place or lies above that level.
#[must_use]
pub fn on_level(diagnosis: &Diagnosis, finding: &Finding, level: Level) -> (Option<Family>, Vec<AnswerNode>) {
    let leaves = leaves(diagnosis, finding);
    let family = leaves.first().and_then(|leaf| leaf.family);
    let is_there = leaves.iter().all(|leaf| leaf.depth() >= level);
    (family, if is_there { merged(&leaves, level, 0) } else { Vec::new() })
}

/// The nodes of the answer that belong to a finding.
#[must_use]
pub fn of_finding<'a>(diagnosis: &'a Diagnosis, finding: &Finding) -> Vec<&'a AnswerNode> {
    let is_it = |other: &Finding| other.effect == finding.effect && other.location == finding.location;
    let number = diagnosis.findings.iter().position(is_it).map(|index| index + 1);
    diagnosis.answer.iter().filter(|node| node.finding.is_some() && node.finding == number).collect()
}

/// Whether an effect lies below a node, which is given without its place.
#[must_use]
pub fn is_below(effect: &Effect, kind: &str) -> bool {
    let side = if effect.family.is_of_a_sensor() { SENSOR } else { MACHINE };
    [effect.id, effect.family.id(), side].contains(&kind)
}

/// What a node says without its place, within a sentence: "friction, drag or a loss".
#[must_use]
pub fn words(kind: &str) -> String {
    let family = effects::CATALOGUE.iter().map(|effect| effect.family).find(|family| family.id() == kind);
    match kind {
        MACHINE => "something of the machine".into(),
        SENSOR => "an error of the sensor".into(),
        _ => family.map_or_else(|| crate::words::effect(kind), |family| family.name().into()),
    }
}

/// The nodes of one finding, the most probable first.
fn of(diagnosis: &Diagnosis, finding: &Finding, number: usize, limit: f64) -> Vec<AnswerNode> {
    let leaves = leaves(diagnosis, finding);
    let Some(deepest) = leaves.iter().map(Leaf::depth).min() else { return Vec::new() };
    let mut nodes = Vec::new();
    for level in LEVELS.into_iter().filter(|level| *level <= deepest) {
        let all = merged(&leaves, level, number);
        let mut held = 0.0;
        let enough = all.iter().position(|node| {
            held += node.probability;
            held >= limit
        });
        nodes = all;
        if let Some(last) = enough.filter(|last| *last < MOST) {
            nodes.truncate(last + 1);
            break;
        }
    }
    nodes.retain(|node| node.probability > LEAST);
    nodes
}

/// The nodes of leaves on a level, each once, the most probable first.
fn merged(leaves: &[Leaf<'_>], level: Level, number: usize) -> Vec<AnswerNode> {
    let mut nodes: Vec<AnswerNode> = Vec::new();
    for leaf in leaves {
        let node = leaf.node(level);
        let probability = leaf.weight * leaf.reliability(level);
        match nodes.iter_mut().find(|known| known.node == node) {
            Some(known) => known.probability += probability,
            None => nodes.push(AnswerNode { node, level, probability, finding: Some(number) }),
        }
    }
    nodes.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    nodes
}

/// The laws that a finding may be, with their weights. Where a curve is needed beside a law at one place, the law is not the true one,
/// and only its family is said.
fn leaves<'a>(diagnosis: &'a Diagnosis, finding: &'a Finding) -> Vec<Leaf<'a>> {
    let is_curve_at = |place: &str| {
        let mut curves = diagnosis.findings.iter().filter(|other| other.effect == UNEXPLAINED);
        curves.any(|other| other.location == place)
    };
    let named = |effect: &'a str, place: &'a str, weight: f64| {
        let family = effects::find(effect).map_or(Family::Own, |effect| effect.family);
        let law = (!is_curve_at(place)).then_some(effect);
        Leaf { law, family: Some(family), is_of_a_sensor: family.is_of_a_sensor(), place, weight }
    };
    if finding.effect == UNEXPLAINED {
        return curve(diagnosis, finding).into_iter().collect();
    }
    let sum = |all: &[crate::document::Rival]| all.iter().map(|own| own.weight).sum::<f64>();
    let own = (1.0 - sum(&finding.rivals) - sum(&finding.richer)).max(0.0);
    let others = finding.rivals.iter().chain(&finding.richer);
    let others = others.map(|rival| named(&rival.effect, &rival.location, rival.weight));
    std::iter::once(named(&finding.effect, &finding.location, own)).chain(others).collect()
}

/// What a curve stands for; `None` where the misfit has no place.
fn curve<'a>(diagnosis: &'a Diagnosis, finding: &'a Finding) -> Option<Leaf<'a>> {
    let curve = finding.curve.as_ref()?;
    let is_of_a_sensor = diagnosis.fit.channels.iter().any(|(name, _)| *name == finding.location);
    let family = match curve.over {
        _ if is_of_a_sensor => Some(Family::Reading),
        Over::Speed => Some(Family::Friction),
        Over::Torque => Some(Family::Elastic),
        Over::Angle => Some(Family::Periodic),
        // What changes as time goes by may be any law whose parameter drifts.
        Over::Time | Over::Frequency => None,
    };
    Some(Leaf { law: None, family, is_of_a_sensor, place: &finding.location, weight: 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Curve, Rival};

    fn rival(effect: &str, location: &str, weight: f64) -> Rival {
        Rival { effect: effect.into(), location: location.into(), weight }
    }

    fn diagnosis(rivals: Vec<Rival>, richer: Vec<Rival>) -> Diagnosis {
        let mut diagnosis: Diagnosis = serde_json::from_str(include_str!("headline/example.json")).unwrap();
        (diagnosis.findings[0].rivals, diagnosis.findings[0].richer) = (rivals, richer);
        diagnosis
    }

    /// Nodes of an answer, as text.
    fn nodes(diagnosis: &Diagnosis, limit: f64) -> Vec<String> {
        within(diagnosis, limit).into_iter().map(|own| own.node).collect()
    }

    #[test]
    fn an_answer_is_as_deep_as_its_limit_allows() {
        let sure = diagnosis(Vec::new(), Vec::new());
        assert_eq!(nodes(&sure, 0.5), ["coulomb_friction@motor_bearing"]);
        let stribeck = rival("stribeck_friction", "motor_bearing", 0.45);
        for tied in [diagnosis(vec![stribeck.clone()], Vec::new()), diagnosis(Vec::new(), vec![stribeck])] {
            assert_eq!(nodes(&tied, 0.5), ["coulomb_friction@motor_bearing"]);
            assert_eq!(within(&tied, 1.1)[0].node, "machine@motor_bearing");
        }
        let places = ["motor_bearing", "load_bearing", "cam_bearing"];
        let many = places.map(|place| rival("stribeck_friction", place, 0.2));
        let several = diagnosis(many.into(), Vec::new());
        let all = within(&several, 0.75);
        assert!(all.iter().all(|node| node.level < Level::Law && node.finding == Some(1)), "{all:?}");
        assert_eq!(all[0].parts().1, "motor_bearing");
    }

    #[test]
    fn an_answer_only_grows_with_its_limit() {
        let competing = vec![
            rival("stribeck_friction", "motor_bearing", 0.3),
            rival("coulomb_friction", "load_bearing", 0.15),
            rival("sensor_offset", "torque_in", 0.1),
        ];
        let diagnosis = diagnosis(competing, Vec::new());
        let leaves = leaves(&diagnosis, &diagnosis.findings[0]);
        let covered = |limit: f64| {
            let nodes = within(&diagnosis, limit);
            let is_in = |leaf: &Leaf<'_>| {
                nodes.iter().any(|node| {
                    [Level::Law, Level::Family, Level::Side]
                        .map(|level| leaf.node(level))
                        .contains(&node.node)
                })
            };
            leaves.iter().map(|leaf| is_in(leaf)).collect::<Vec<_>>()
        };
        let limits: Vec<Vec<bool>> = (1..20).map(|step| covered(0.05 * f64::from(step))).collect();
        for pair in limits.windows(2) {
            assert!(pair[0].iter().zip(&pair[1]).all(|(before, after)| !before || *after), "{limits:?}");
        }
    }

    #[test]
    fn a_curve_is_a_family_and_a_misfit_without_a_place_is_nothing() {
        let mut curved = diagnosis(Vec::new(), Vec::new());
        let curve = Curve {
            over: Over::Speed,
            unit: "rad/s".into(),
            x: vec![0.0, 1.0],
            torque: vec![Some(0.0), Some(1.0)],
            torque_std: Vec::new(),
            torque_unit: "N m".into(),
        };
        let beside = Finding {
            effect: UNEXPLAINED.into(),
            rivals: Vec::new(),
            curve: Some(curve),
            ..curved.findings[0].clone()
        };
        // Where a curve is needed beside a law, the law is not the true one.
        curved.findings.push(beside);
        assert_eq!(nodes(&curved, 0.5), ["friction@motor_bearing"; 2]);
        curved.findings[1].curve = None;
        curved.findings.remove(0);
        assert_eq!(nodes(&curved, 0.5), [""; 0]);
    }

    #[test]
    fn nodes_have_words() {
        assert_eq!(words("friction"), "friction, drag or a loss");
        assert_eq!(words("coulomb_friction"), "Coulomb friction");
        assert_eq!(words(SENSOR), "an error of the sensor");
        let backlash = effects::find("backlash").unwrap();
        assert!(["backlash", "elastic", "machine"].iter().all(|kind| is_below(backlash, kind)));
        assert!(!is_below(backlash, "sensor"));
    }
}
