//! Combinations of parameters that are determined where the parameters themselves are not.
//!
//! * Two springs with a massless node between them act nearly as one: their joint stiffness and damping.
//! * What the data do not scale, such as all inertias, dampings and torques of a free swing, or an inertia and a winding's resistance: ratios and
//!   products of two parameters.
//! * Bearings of nodes that springs and gears tie together turn nearly as one at low frequencies: their total damping.

use std::collections::VecDeque;

use socam_model::{Bearing, Model, Site, Spring};

/// A combination of parameters at given values.
pub(crate) struct Combination {
    pub(crate) name: String,
    pub(crate) expression: String,
    pub(crate) unit: String,
    /// SI.
    pub(crate) value: f64,
    /// Parameter index and derivative.
    pub(crate) sensitivities: Vec<(usize, f64)>,
}

/// Names and SI values of a model's combinations at parameter values in its order.
///
/// ```
/// use socam_identify::combination_values;
///
/// let model = socam_model::Model::builtin("speed-o-cam").expect("an embedded model");
/// let found = combination_values(&model, &model.values());
/// assert!(!found.is_empty() && found.iter().all(|(_, value)| *value > 0.0));
/// ```
pub fn combination_values(model: &Model, values: &[f64]) -> Vec<(String, f64)> {
    all(model, values).into_iter().map(|combination| (combination.name, combination.value)).collect()
}

pub(crate) fn all(model: &Model, values: &[f64]) -> Vec<Combination> {
    let each = |(a, b)| std::iter::once(stiffness(model, values, a, b)).chain(damping(model, values, a, b));
    pairs(model).flat_map(each).chain(total_dampings(model, values)).collect()
}

/// How two parameters are combined that the data do not scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scaled {
    Ratio,
    Product,
}

/// The ratio or product of two parameters.
pub(crate) fn scaled(model: &Model, values: &[f64], [a, b]: [usize; 2], how: Scaled) -> Combination {
    let [first, second] = [a, b].map(|index| &model.parameters[index]);
    let (va, vb) = (values[a], values[b]);
    let (sign, value, sensitivities) = match how {
        Scaled::Ratio => ('/', va / vb, vec![(a, 1.0 / vb), (b, -va / (vb * vb))]),
        Scaled::Product => ('*', va * vb, vec![(a, vb), (b, va)]),
    };
    let expression = format!("{}{sign}{}", first.name, second.name);
    let unit = format!("({}){sign}({})", first.unit, second.unit);
    Combination { name: expression.clone(), expression, unit, value, sensitivities }
}

/// The ratio or product of this name; `None` for any other name.
pub(crate) fn scaled_by_name(model: &Model, values: &[f64], name: &str) -> Option<Combination> {
    let pair = |sign: char, how: Scaled| {
        let (a, b) = name.split_once(sign)?;
        Some(scaled(model, values, [model.parameter(a)?, model.parameter(b)?], how))
    };
    pair('/', Scaled::Ratio).or_else(|| pair('*', Scaled::Product))
}

/// Pairs of springs that act as one: a massless node between them, and no force law in either.
///
/// ```
/// use socam_identify::springs_in_series;
///
/// let model = socam_model::Model::builtin("speed-o-cam").expect("an embedded model");
/// let (first, second) = springs_in_series(&model).next().expect("two couplings beside a torque sensor");
/// assert_eq!((first.name.as_str(), second.name.as_str()), ("coupling_1", "coupling_2"));
/// ```
pub fn pairs(model: &Model) -> impl Iterator<Item = (&Spring, &Spring)> {
    (0..model.nodes.len()).filter_map(|node| pair(model, node))
}

/// The two springs at a massless node that nothing else touches or drives.
fn pair(model: &Model, node: usize) -> Option<(&Spring, &Spring)> {
    let tied = model.nodes[node].inertia.is_some()
        || model.gears.iter().any(|gear| gear.from == node || gear.to == node)
        || model.shafts.iter().any(|shaft| shaft.nodes.0 == node || shaft.nodes.1 == node)
        || model.differentials.iter().any(|d| d.to == node || d.from.contains(&node))
        || model.motors.iter().any(|motor| motor.node == node)
        || model.bearings.iter().any(|bearing| bearing.node == node)
        || model.effects.iter().any(|used| used.at == Site::Node(node))
        || model.servo.as_ref().is_some_and(|servo| servo.node == node)
        || model.inputs().any(|channel| channel.at == model.nodes[node].name);
    let bent = |index: usize| model.effects.iter().any(|used| used.at == Site::Spring(index));
    let mut springs = model.springs.iter().enumerate().filter(|(_, s)| s.from == node || s.to == Some(node));
    if springs.clone().any(|(index, _)| bent(index)) {
        return None;
    }
    let springs: Vec<_> = springs.by_ref().map(|(_, spring)| spring).collect();
    match springs[..] {
        [a, b] if !tied => Some((a, b)),
        _ => None,
    }
}

fn stiffness(model: &Model, values: &[f64], a: &Spring, b: &Spring) -> Combination {
    let (ka, kb) = (values[a.stiffness], values[b.stiffness]);
    let sum = ka + kb;
    let names = [a.stiffness, b.stiffness].map(|index| model.parameters[index].name.as_str());
    Combination {
        name: series_name("k", names),
        expression: format!("1/(1/{} + 1/{})", names[0], names[1]),
        unit: model.parameters[a.stiffness].unit.clone(),
        value: ka * kb / sum,
        sensitivities: vec![(a.stiffness, (kb / sum).powi(2)), (b.stiffness, (ka / sum).powi(2))],
    }
}

/// Damping at frequencies where the twist divides between the springs by their compliances.
fn damping(model: &Model, values: &[f64], a: &Spring, b: &Spring) -> Option<Combination> {
    let (da, db) = (a.damping?, b.damping?);
    let (ka, kb, ca, cb) = (values[a.stiffness], values[b.stiffness], values[da], values[db]);
    let sum = ka + kb;
    let value = (ca * kb * kb + cb * ka * ka) / (sum * sum);
    let [ca_name, cb_name, ka_name, kb_name] =
        [da, db, a.stiffness, b.stiffness].map(|index| model.parameters[index].name.as_str());
    Some(Combination {
        name: series_name("c", [ca_name, cb_name]),
        expression: format!("({ca_name} {kb_name}^2 + {cb_name} {ka_name}^2)/({ka_name} + {kb_name})^2"),
        unit: model.parameters[da].unit.clone(),
        value,
        sensitivities: vec![
            (da, (kb / sum).powi(2)),
            (db, (ka / sum).powi(2)),
            (a.stiffness, 2.0 * (cb * ka - value * sum) / (sum * sum)),
            (b.stiffness, 2.0 * (ca * kb - value * sum) / (sum * sum)),
        ],
    })
}

/// The total damping of each group of nodes that can only turn together when nothing twists, seen at the node of its first bearing.
fn total_dampings(model: &Model, values: &[f64]) -> Vec<Combination> {
    let mut seen = vec![false; model.nodes.len()];
    let mut found = Vec::new();
    for first in model.bearings.iter().filter(|bearing| bearing.damping.is_some()) {
        if seen[first.node] {
            continue;
        }
        let speeds = speeds(model, first.node);
        speeds.iter().zip(&mut seen).for_each(|(speed, seen)| *seen |= speed.is_some());
        found.extend(total_damping(model, values, first, &speeds));
    }
    found
}

/// Ratio parameters, each with its power, whose product is a node's speed over that of the first node.
type Speed = Vec<(usize, i32)>;

/// Speeds of all nodes that move with the first one when nothing twists.
fn speeds(model: &Model, first: usize) -> Vec<Option<Speed>> {
    let springs = model.springs.iter().filter_map(|spring| Some((spring.from, spring.to?, None)));
    let shafts = model.shafts.iter().map(|shaft| (shaft.nodes.0, shaft.nodes.1, None));
    let gears = model.gears.iter().map(|gear| (gear.from, gear.to, Some(gear.ratio)));
    let ties: Vec<(usize, usize, Option<usize>)> = springs.chain(shafts).chain(gears).collect();
    let mut speeds: Vec<Option<Speed>> = vec![None; model.nodes.len()];
    speeds[first] = Some(Speed::new());
    let mut todo = VecDeque::from([first]);
    while let Some(node) = todo.pop_front() {
        for (from, to, ratio) in &ties {
            // The speed of `from` is ratio times that of `to`.
            let (other, power) = if *from == node { (*to, -1) } else { (*from, 1) };
            if (*from != node && *to != node) || speeds[other].is_some() {
                continue;
            }
            let own = speeds[node].clone().unwrap_or_default();
            speeds[other] = Some(own.into_iter().chain(ratio.map(|ratio| (ratio, power))).collect());
            todo.push_back(other);
        }
    }
    speeds
}

/// `None` where fewer than two dampings are free, or where a spring to the ground or a sum of two motions hinders the common motion.
fn total_damping(
    model: &Model,
    values: &[f64],
    first: &Bearing,
    speeds: &[Option<Speed>],
) -> Option<Combination> {
    let moves = |node: usize| speeds[node].is_some();
    let is_held = model.springs.iter().any(|spring| spring.to.is_none() && moves(spring.from))
        || model.differentials.iter().any(|d| moves(d.to) || d.from.into_iter().any(moves));
    let name = |index: usize| model.parameters[index].name.as_str();
    let (mut value, mut terms, mut sensitivities) = (0.0, Vec::new(), Vec::new());
    for bearing in &model.bearings {
        let Some((damping, speed)) = bearing.damping.zip(speeds[bearing.node].as_ref()) else { continue };
        let factor: f64 = speed.iter().map(|(ratio, power)| values[*ratio].powi(2 * power)).product();
        let ratios = speed
            .iter()
            .map(|(ratio, power)| format!("{}{}^2", if *power > 0 { " " } else { "/" }, name(*ratio)));
        terms.push(format!("{}{}", name(damping), ratios.collect::<String>()));
        value += factor * values[damping];
        sensitivities.push((damping, factor));
        let of_ratio = |(ratio, power): &(usize, i32)| {
            (*ratio, 2.0 * f64::from(*power) * factor * values[damping] / values[*ratio])
        };
        sensitivities.extend(speed.iter().map(of_ratio));
    }
    let dampings = model.bearings.iter().filter(|bearing| moves(bearing.node)).filter_map(|own| own.damping);
    let free = dampings.filter(|index| !model.parameters[*index].fixed).count();
    (free > 1 && !is_held).then(|| Combination {
        name: format!("c_total_{}", model.nodes[first.node].name),
        expression: terms.join(" + "),
        unit: first.damping.map_or_else(String::new, |own| model.parameters[own].unit.clone()),
        value,
        sensitivities,
    })
}

/// `k_series_12` for k1 and k2; names without a common stem are spelled out.
fn series_name(kind: &str, [a, b]: [&str; 2]) -> String {
    match (a.strip_prefix(kind), b.strip_prefix(kind)) {
        (Some(a), Some(b)) if a.chars().chain(b.chars()).all(|c| c.is_ascii_digit()) => {
            format!("{kind}_series_{a}{b}")
        }
        _ => format!("{kind}_series_{a}_{b}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_total_damping_is_seen_through_gears_and_not_through_a_spring_to_the_ground() {
        let model = Model::builtin("two-mass").unwrap();
        let [total] = &all(&model, &model.values())[..] else { panic!("one combination") };
        assert_eq!(
            (total.name.as_str(), total.expression.as_str()),
            ("c_total_motor", "motor_damping + load_damping")
        );
        assert!((total.value - 0.012).abs() < 1e-12);
        let geared =
            model.text.replace("from = \"motor\"\nto = \"load\"", "from = \"motor\"\nto = \"pinion\"");
        let geared = geared
            .replace("[parameters]", "[parameters]\nratio = { value = 5, unit = \"1\", bounds = [1, 10] }")
            + "\n[[nodes]]\nname = \"pinion\"\n[[gears]]\nname = \"gear\"\nfrom = \"pinion\"\nto = \"load\"\nratio = \"ratio\"\n";
        let model = Model::parse(&geared).unwrap();
        let [total] = &all(&model, &model.values())[..] else { panic!("one combination") };
        assert_eq!(total.expression, "motor_damping + load_damping/ratio^2");
        assert!((total.value - (4e-3 + 8e-3 / 25.0)).abs() < 1e-12);
        check(&model);
        let grounded = geared
            + "\n[[springs]]\nname = \"stop\"\nfrom = \"load\"\nto = \"ground\"\nstiffness = \"stiffness\"\n";
        let model = Model::parse(&grounded).unwrap();
        assert!(all(&model, &model.values()).is_empty());
    }

    #[test]
    fn sensitivities_agree_with_differences() {
        let model = Model::builtin("speed-o-cam").unwrap();
        let base = all(&model, &model.values());
        let names: Vec<&str> = base.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["k_series_12", "c_series_23", "k_series_34"]);
        check(&model);
    }

    fn check(model: &Model) {
        let values = model.values();
        let base = all(model, &values);
        for (index, combination) in base.iter().enumerate() {
            for (parameter, sensitivity) in &combination.sensitivities {
                let at = |factor: f64| {
                    let mut moved = values.clone();
                    moved[*parameter] *= factor;
                    all(model, &moved)[index].value
                };
                let difference = (at(1.0 + 1e-6) - at(1.0 - 1e-6)) / (2e-6 * values[*parameter]);
                assert!(
                    (sensitivity - difference).abs() < 1e-6 * sensitivity.abs() + 1e-12,
                    "{}: {sensitivity} {difference}",
                    combination.name
                );
            }
        }
    }
}
