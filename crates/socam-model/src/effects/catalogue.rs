//! The list of all effects, and look-up by id and parameters.

use super::{
    backlash, constant_load, coulomb_friction, coupling_slip, damping_drift, definition::Effect,
    direction_dependence, direction_gain, drive_limit, driving_side, external_disturbance, gravity_unbalance,
    hysteresis, kinematic_error, mesh_loss, mesh_presliding, missing_compliance, missing_inertia,
    mounting_compliance, presliding, quadratic_drag, sensor_delay, sensor_fold, sensor_gain, sensor_hum,
    sensor_lag, sensor_offset, sensor_ripple, sensor_saturation, stiffness_hardening, stribeck_friction,
    torque_ripple, velocity_weakening,
};

/// Every effect, in the order of the documentation.
pub const CATALOGUE: &[&Effect] = &[
    &coulomb_friction::EFFECT,
    &stribeck_friction::EFFECT,
    &quadratic_drag::EFFECT,
    &damping_drift::EFFECT,
    &direction_dependence::EFFECT,
    &velocity_weakening::EFFECT,
    &constant_load::EFFECT,
    &mesh_loss::EFFECT,
    &backlash::EFFECT,
    &kinematic_error::EFFECT,
    &stiffness_hardening::EFFECT,
    &hysteresis::EFFECT,
    &missing_compliance::EFFECT,
    &missing_inertia::EFFECT,
    &mounting_compliance::EFFECT,
    &coupling_slip::EFFECT,
    &gravity_unbalance::EFFECT,
    &external_disturbance::EFFECT,
    &torque_ripple::EFFECT,
    &sensor_gain::EFFECT,
    &sensor_offset::EFFECT,
    &sensor_lag::EFFECT,
    &sensor_delay::EFFECT,
    &sensor_saturation::EFFECT,
    &drive_limit::EFFECT,
    &sensor_fold::EFFECT,
    &direction_gain::EFFECT,
    &sensor_hum::EFFECT,
    &sensor_ripple::EFFECT,
];

/// Refined laws. A refined law has the id of an effect of [`CATALOGUE`]. It is used instead of that effect where a parameter is given that
/// only the refined law has, or at a place where only the refined law can act.
pub const REFINED: &[&Effect] = &[
    &presliding::COULOMB,
    &presliding::STRIBECK,
    &driving_side::MESH_LOSS,
    &mesh_presliding::MESH_LOSS,
    &sensor_delay::AT_INPUT,
    &sensor_saturation::AT_INPUT,
];

/// All effects that a diagnosis tests in its first score test: [`CATALOGUE`] and those of [`REFINED`] that need no simpler law first.
///
/// ```
/// use socam_model::effects;
///
/// // Coulomb friction is tested as a plain law and with presliding.
/// let frictions = effects::screened().filter(|effect| effect.id == "coulomb_friction");
/// assert_eq!(frictions.count(), 2);
/// ```
pub fn screened() -> impl Iterator<Item = &'static Effect> {
    let refined = [&presliding::COULOMB, &sensor_delay::AT_INPUT, &sensor_saturation::AT_INPUT];
    CATALOGUE.iter().copied().chain(refined)
}

/// The effect of the catalogue with this id; `None` if there is none.
///
/// ```
/// use socam_model::effects;
///
/// let friction = effects::find("coulomb_friction").expect("an effect of the catalogue");
/// let law = friction.laws()[0];
/// // 0.3 N m of friction, far above the transition speed of 0.05 rad/s.
/// let response = law.evaluate(&[2.0], &[0.3, 0.05]);
/// assert!((response.torque + 0.3).abs() < 1e-12);
/// ```
pub fn find(id: &str) -> Option<&'static Effect> {
    CATALOGUE.iter().copied().find(|effect| effect.id == id)
}

/// The effect with this id that has all the given parameters, the plain law first; the plain law if none has them, `None` for an
/// unknown id.
///
/// ```
/// use socam_model::effects;
///
/// let plain = effects::find_with("coulomb_friction", ["torque"].into_iter()).unwrap();
/// let refined = effects::find_with("coulomb_friction", ["torque", "deflection"].into_iter()).unwrap();
/// assert!(!plain.has_memory() && refined.has_memory());
/// ```
pub fn find_with<'n>(id: &str, given: impl Iterator<Item = &'n str> + Clone) -> Option<&'static Effect> {
    let knows = |effect: &&Effect| given.clone().all(|name| effect.parameters.iter().any(|p| p.name == name));
    laws_of(id).find(knows).or_else(|| find(id))
}

/// [`find_with`] among the laws for which `acts_there` holds.
pub(crate) fn find_at<'n>(
    id: &str,
    given: impl Iterator<Item = &'n str> + Clone,
    acts_there: impl Fn(&Effect) -> bool,
) -> Option<&'static Effect> {
    let knows = |effect: &&Effect| given.clone().all(|name| effect.parameters.iter().any(|p| p.name == name));
    laws_of(id).filter(knows).find(|effect| acts_there(effect)).or_else(|| find_with(id, given))
}

/// Names of all parameters that a model file may give for an effect, those of its refined law included; empty for an unknown id.
///
/// ```
/// use socam_model::effects;
///
/// assert_eq!(effects::parameters_of("coulomb_friction"), ["torque", "transition_speed", "deflection"]);
/// assert!(effects::parameters_of("witchcraft").is_empty());
/// ```
pub fn parameters_of(id: &str) -> Vec<&'static str> {
    let mut names: Vec<&str> = laws_of(id).flat_map(|effect| effect.parameters).map(|own| own.name).collect();
    let mut known = std::collections::HashSet::new();
    names.retain(|name| known.insert(*name));
    names
}

fn laws_of(id: &str) -> impl Iterator<Item = &'static Effect> {
    CATALOGUE.iter().chain(REFINED).copied().filter(move |effect| effect.id == id)
}
