//! Combinations of two springs in series.
//!
//! Two springs with a massless node between them act nearly as one. Its stiffness and damping are determined where those of the two
//! springs are not.

use socam_model::{Model, Site, Spring};

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
    pairs(model).flat_map(each).collect()
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
    fn sensitivities_agree_with_differences() {
        let Some(model) = Model::builtin("speed-o-cam") else { panic!("the default model is there") };
        let values = model.values();
        let base = all(&model, &values);
        let names: Vec<&str> = base.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["k_series_12", "c_series_23", "k_series_34"]);
        for (index, combination) in base.iter().enumerate() {
            for (parameter, sensitivity) in &combination.sensitivities {
                let at = |factor: f64| {
                    let mut moved = values.clone();
                    moved[*parameter] *= factor;
                    all(&model, &moved)[index].value
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
