//! The answer of a diagnosis as deep as the recordings go: for each finding the laws, or the families of laws, or the places, that
//! together hold what is missing with a stated probability.
//!
//! The tree has three levels: side and place (`machine@load_bearing`, `sensor@torque_in`), family (`friction@load_bearing`), law
//! (`coulomb_friction@load_bearing`). The laws of a finding are the effect itself, its competing explanations and the laws that contain it.
//! The probability of a law is its weight times the share of such statements that are true on benches of `challenge`; that of
//! a family, or of a place, is the sum of the weights below it times the share of such statements that are true. The answer is the deepest
//! level on which at most [`MOST`] nodes have a probability of [`LIMIT`] together; nothing is deeper than the recordings go.
//!
//! Breaks when: the machine is none that `challenge` draws (lumped drivetrains with the concealed laws of its own), or the recordings
//! were taken in another way; shares are then those of other benches.

use socam_model::effects::{self, Effect, Family};

use crate::document::{AnswerNode, Diagnosis, Finding, Level, Over, UNEXPLAINED, Verdict};

/// Probability that the nodes of an answer have together. On the benches that were counted such answers hold 90 % of what is hidden.
pub const LIMIT: f64 = 0.8;
/// Largest number of laws, or families, that an answer lists.
pub const MOST: usize = 2;

/// What was counted by family, the deepest level last: a place, a family there, a law. Curves are counted together, the last row. `challenge`
/// prints such counts; docs/diagnosis-measured.md has the cases.
const COUNTED: [(Option<Family>, [Counted; 3]); 8] = [
    (Some(Family::Friction), [of(47, 49), of(47, 49), of(33, 45)]),
    (Some(Family::Elastic), [of(3, 4), of(3, 4), of(3, 4)]),
    (Some(Family::Periodic), [of(5, 5), of(5, 5), of(5, 5)]),
    (Some(Family::Load), [of(3, 6), of(2, 6), of(2, 6)]),
    (Some(Family::Timing), [of(0, 0), of(0, 0), of(0, 0)]),
    (Some(Family::Reading), [of(7, 7), of(6, 7), of(5, 6)]),
    (Some(Family::Interference), [of(3, 3), of(3, 3), of(3, 3)]),
    (None, [of(16, 19), of(8, 11), of(0, 0)]),
];
/// Findings of any family, for those of which few were counted: as many as this many of all count with theirs.
const BORROWED: f64 = 2.0;
/// Share of diagnoses without any finding on whose benches nothing was hidden that could be detected: 15 of 15, and one of two before any.
const SILENCE: f64 = 16.0 / 17.0;
/// Least probability of a node that is listed on the last level.
const LEAST: f64 = 0.05;
/// Levels, the deepest first.
const LEVELS: [Level; 3] = [Level::Law, Level::Family, Level::Side];
/// Names of nodes: nothing is missing, and the two sides.
const NONE: &str = "none";
const MACHINE: &str = "machine";
const SENSOR: &str = "sensor";

/// Findings with the truth among what they may be, and all of them.
#[derive(Debug, Clone, Copy)]
struct Counted {
    hits: u32,
    of: u32,
}

const fn of(hits: u32, of: u32) -> Counted {
    Counted { hits, of }
}

/// Share of a family's findings, or of curves, that hold the truth on a level. Of a family of which few were counted, it is drawn towards the share of all.
fn reliability(family: Option<Family>, level: Level) -> f64 {
    let counts = || COUNTED.iter().map(move |(family, levels)| (*family, levels[level as usize]));
    let sum = |pick: fn(Counted) -> u32| f64::from(counts().map(|(_, own)| pick(own)).sum::<u32>());
    let all = sum(|own| own.hits) / sum(|own| own.of);
    let own = counts().find(|(known, _)| *known == family).map_or(of(0, 0), |(_, own)| own);
    (f64::from(own.hits) + BORROWED * all) / (f64::from(own.of) + BORROWED)
}

/// One law that a finding may be.
struct Leaf<'a> {
    /// Id of the effect; `None` where a curve stands for a law.
    law: Option<&'a str>,
    family: Option<Family>,
    /// Whether the finding is a curve, and not only needs one beside it.
    is_curve: bool,
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

    /// Under which it is counted.
    fn counted_as(&self) -> Option<Family> {
        self.family.filter(|_| !self.is_curve)
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
    each.flat_map(|(index, finding)| of_one(diagnosis, finding, index + 1, limit)).collect()
}

/// The probability that a finding is the law that was fitted, at its place; 0 for a curve.
#[must_use]
pub fn of_its_law(diagnosis: &Diagnosis, finding: &Finding) -> f64 {
    let own = leaves(diagnosis, finding).into_iter().next().filter(|leaf| leaf.law.is_some());
    own.map_or(0.0, |leaf| leaf.weight * reliability(leaf.counted_as(), Level::Law))
}

/// All nodes of a finding on a level, and the family that it is counted under, `None` for a curve; empty where it has no place or lies above that level.
#[must_use]
pub fn on_level(diagnosis: &Diagnosis, finding: &Finding, level: Level) -> (Option<Family>, Vec<AnswerNode>) {
    let leaves = leaves(diagnosis, finding);
    let family = leaves.first().and_then(Leaf::counted_as);
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
    let family = Family::ALL.into_iter().find(|family| family.id() == kind);
    match kind {
        MACHINE => "something of the machine".into(),
        SENSOR => "an error of the sensor".into(),
        _ => family.map_or_else(|| crate::words::effect(kind), |family| family.name().into()),
    }
}

/// The nodes of one finding, the most probable first.
fn of_one(diagnosis: &Diagnosis, finding: &Finding, number: usize, limit: f64) -> Vec<AnswerNode> {
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
        let probability = leaf.weight * reliability(leaf.counted_as(), level);
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
        Leaf {
            law,
            family: Some(family),
            is_curve: false,
            is_of_a_sensor: family.is_of_a_sensor(),
            place,
            weight,
        }
    };
    if finding.effect == UNEXPLAINED {
        return curve(diagnosis, finding).into_iter().collect();
    }
    let own = finding.weight_of_its_law();
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
    Some(Leaf { law: None, family, is_curve: true, is_of_a_sensor, place: &finding.location, weight: 1.0 })
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
        // Laws of friction are taken for one another too often for more.
        assert_eq!(nodes(&sure, LIMIT), ["friction@motor_bearing"]);
        let stribeck = rival("stribeck_friction", "motor_bearing", 0.45);
        for tied in [diagnosis(vec![stribeck.clone()], Vec::new()), diagnosis(Vec::new(), vec![stribeck])] {
            assert_eq!(nodes(&tied, 0.3), ["coulomb_friction@motor_bearing"]);
            assert_eq!(
                nodes(&tied, 0.6),
                ["coulomb_friction@motor_bearing", "stribeck_friction@motor_bearing"]
            );
            assert_eq!(nodes(&tied, LIMIT), ["friction@motor_bearing"]);
            assert_eq!(nodes(&tied, 1.1), ["machine@motor_bearing"]);
        }
        let places = ["motor_bearing", "load_bearing", "cam_bearing"];
        let many = places.map(|place| rival("stribeck_friction", place, 0.2));
        let several = diagnosis(many.into(), Vec::new());
        let all = within(&several, 0.75);
        assert!(all.iter().all(|node| node.level < Level::Law && node.finding == Some(1)), "{all:?}");
        assert_eq!(all[0].parts().1, "motor_bearing");
    }

    /// Of families of which few were counted a statement is worth about as much as of all, and no level above is worth less.
    #[test]
    fn reliability_is_a_share() {
        let families = effects::CATALOGUE.iter().map(|effect| Some(effect.family)).chain([None]);
        for family in families {
            let [law, there, side] = LEVELS.map(|level| reliability(family, level));
            assert!(
                0.0 < law && law <= there && there <= side && side < 1.0,
                "{family:?}: {law} {there} {side}"
            );
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
        assert_eq!(words(Family::Own.id()), "a law of the model file");
        assert_eq!(words(SENSOR), "an error of the sensor");
        let backlash = effects::find("backlash").unwrap();
        assert!(["backlash", "elastic", "machine"].iter().all(|kind| is_below(backlash, kind)));
        assert!(!is_below(backlash, "sensor"));
    }
}
