//! Derivatives of every law against finite differences, and every effect in a model file.

use super::*;
use crate::Model;
use crate::equations::tests::assert_derivatives_are_differences;

mod names;
mod rigs;

/// A plausible value of a parameter at which its law has an influence.
fn plausible(parameter: &EffectParameter) -> f64 {
    match parameter.name {
        "static_torque" => 0.9,
        "stribeck_speed" => 2.0,
        "gap" => 4e-3,
        "deflection" => 0.02,
        "cubic" => -3.0,
        "gain" => 0.97,
        "limit" => 1.5,
        "stiffness" => 300.0,
        "fraction" => 0.1,
        "inertia" => 1e-3,
        "time_constant" | "delay" => 2e-3,
        "phase" => 0.4,
        "contact_damping" => 100.0,
        _ => parameter.default.map_or(0.6, |(turning, _)| turning),
    }
}

#[test]
fn derivatives_of_every_law_agree_with_differences() {
    for effect in CATALOGUE.iter().chain(REFINED) {
        let mut parameters: Vec<f64> = effect.parameters.iter().map(plausible).collect();
        match effect.borrows {
            Some(Borrowed::Contact) => parameters.extend([0.7, 0.3]),
            Some(_) => parameters.push(0.7),
            None => {}
        }
        for law in effect.laws() {
            for seen in [[0.4, 0.01, 0.003], [-0.03, 0.02, -0.011], [3.0, -0.7, 0.4], [-1.2, 0.05, 0.02]] {
                let seen = &seen[..law.law_inputs.len()];
                let at = |seen: &[f64], parameters: &[f64]| law.evaluate(seen, parameters).torque;
                let answer = law.evaluate(seen, &parameters);
                let close = |derivative: f64, up: f64, down: f64, step: f64, what: &str| {
                    let difference = (up - down) / (2.0 * step);
                    let size = 1e-6 * (derivative.abs() + answer.torque.abs() / step.max(1e-3)) + 1e-7;
                    assert!(
                        (derivative - difference).abs() < size.max(1e-4 * derivative.abs()),
                        "{} {what} at {seen:?}: {derivative}, {difference}",
                        effect.id
                    );
                };
                let moved = |values: &[f64], index: usize, step: f64| {
                    let mut values = values.to_vec();
                    values[index] += step;
                    values
                };
                for index in 0..seen.len() {
                    let step = 1e-6 * seen[index].abs().max(1e-3);
                    let [up, down] = [step, -step].map(|step| at(&moved(seen, index, step), &parameters));
                    close(answer.derivatives[index], up, down, step, "by law_input");
                }
                for index in 0..parameters.len() {
                    let step = 1e-6 * parameters[index].abs();
                    let [up, down] = [step, -step].map(|step| at(seen, &moved(&parameters, index, step)));
                    close(
                        answer.by_parameter[index],
                        up,
                        down,
                        step,
                        effect.parameters.get(index).map_or("borrowed", |p| p.name),
                    );
                }
            }
        }
    }
}

/// Derivatives of the equations by each parameter against differences, for every effect at every place; the written file is read again.
#[test]
fn every_effect_enters_a_model_wherever_it_may_act() {
    let base = Model::builtin("speed-o-cam").unwrap();
    for effect in CATALOGUE.iter().chain(REFINED) {
        let places: Vec<String> = base.places(effect).into_iter().map(str::to_owned).collect();
        assert!(!places.is_empty(), "{}", effect.id);
        for place in places {
            let given = effect.parameters.iter().filter(|p| p.default.is_none());
            let values: Vec<(&str, f64)> = given.map(|p| (p.name, plausible(p))).collect();
            let model = base.with_effect(effect.id, &place, &values);
            // A torque on a node whose speed is prescribed, or on a massless node, has no influence.
            let model = model.unwrap_or_else(|error| panic!("{} at {place}: {error}", effect.id));
            let Ok(equations) = model.equations(&model.values()) else { continue };
            assert_eq!(
                equations.ports.len(),
                effect.laws().iter().map(|law| law.law_inputs.len().max(1)).sum::<usize>(),
                "{} at {place}",
                effect.id
            );
            assert_derivatives_are_differences(&model, 1e-4);
        }
    }
}

/// Scales of a bench on which every element moves and carries torque.
fn rig(model: &Model) -> Rig {
    let mut rig = Rig { sample_time_s: 1e-3, longest_s: 10.0, ..Rig::of_model(model, &model.values()) };
    rig.lines_hz = vec![50.0];
    for node in &mut rig.nodes {
        (node.speed, node.angle_range, node.torque, node.rest_share) = (20.0, 100.0, 2.0, 0.1);
    }
    rig.springs.iter_mut().for_each(|spring| spring.torque = 2.0);
    for channel in &mut rig.channels {
        (channel.std, channel.largest, channel.range, channel.median_hz) = (5.0, 15.0, 30.0, 3.0);
        (channel.lines_hz, channel.limit) = (vec![50.0], Some(14.0));
    }
    rig
}

/// Every effect has starts and priors at each of its places: a diagnosis never tests a candidate without a start.
#[test]
fn every_effect_says_where_to_start_and_what_is_plausible() {
    for effect in CATALOGUE.iter().chain(REFINED) {
        let models = ["speed-o-cam", "two-mass"].map(|name| Model::builtin(name).unwrap());
        let places = |model: &Model| effect.places_in(model);
        assert!(models.iter().any(|model| !places(model).is_empty()), "{} is looked for nowhere", effect.id);
        assert!(!effect.amplitude.parameters.is_empty(), "{} has no amplitude", effect.id);
        let ids = effect.equivalents.iter().map(|other| other.effect);
        ids.chain(effect.replaces.iter().map(|other| other.law))
            .for_each(|id| assert!(find(id).is_some(), "{} names {id}", effect.id));
        for (model, place) in
            models.iter().flat_map(|model| places(model).into_iter().map(move |p| (model, p)))
        {
            let rig = rig(model);
            let names: Vec<&str> = effect.given().map(|own| own.name).collect();
            let starts = (effect.starts)(&rig, &place);
            assert!(!starts.is_empty(), "{} at {place} has no start", effect.id);
            let priors = (effect.priors)(&rig, &place);
            for start in starts.iter().chain(&effect.large_starts(&rig, &place, 0.5)) {
                let given: Vec<&str> = start.iter().map(|(name, _)| *name).collect();
                assert!(names.iter().all(|name| given.contains(name)), "{}: {given:?}", effect.id);
                model.with_effect(effect.id, &place, start).unwrap_or_else(|e| panic!("{}: {e}", effect.id));
            }
            for name in names {
                let (_, prior) = priors
                    .iter()
                    .find(|(known, _)| *known == name)
                    .unwrap_or_else(|| panic!("{} {name}", effect.id));
                assert!(!prior.source.is_empty());
                let usual = prior.quantile(0.5).unwrap_or(0.5);
                assert!(prior.log_density(usual).is_finite(), "{} {name}: {prior:?}", effect.id);
            }
            let large = effect.large_starts(&rig, &place, 0.5);
            assert!(
                !large.is_empty() && effect.log_prior(&rig, &place, &large[0]).is_finite(),
                "{}",
                effect.id
            );
        }
        assert!((effect.sentence)(&FittedValues(&[])).ends_with('.') && !effect.equation.is_empty());
    }
}

#[test]
fn impossible_values_have_a_prior_density_of_zero() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let rig = rig(&model);
    let log =
        |id: &str, place: &str, values: &[(&str, f64)]| find(id).unwrap().log_prior(&rig, place, values);
    let never = f64::NEG_INFINITY;
    // A lag of 0.5 s, a wave of two periods, friction above the drive's torque, an offset beyond the readings.
    assert_eq!(log("sensor_lag", "output_speed", &[("time_constant", 0.518)]), never);
    assert_eq!(log("external_disturbance", "load", &[("torque", 0.1), ("frequency", 0.2)]), never);
    assert_eq!(log("coulomb_friction", "load_bearing", &[("torque", 3.0)]), never);
    assert_eq!(log("sensor_offset", "output_speed", &[("offset", 40.0)]), never);
    // The drag of a bearing without damping cannot be negative.
    assert_eq!(log("direction_dependence", "cam_bearing", &[("damping_difference", -70.0)]), never);
    assert_eq!(log("quadratic_drag", "cam_bearing", &[("coefficient", -1e-6)]), never);
    assert!(log("sensor_lag", "output_speed", &[("time_constant", 2e-3)]).is_finite());
}

/// The sentence of an effect depends on the signs of its fitted values.
#[test]
fn sentences_follow_the_fitted_values() {
    let says = |id: &str, values: &[(&str, f64)]| (find(id).unwrap().sentence)(&FittedValues(values));
    let low = says("stribeck_friction", &[("torque", 0.5), ("static_torque", 0.3)]);
    let high = says("stribeck_friction", &[("torque", 0.5), ("static_torque", 0.9)]);
    assert!(!low.contains("sticks harder") && high.contains("sticks harder"));
    assert!(says("stiffness_hardening", &[("cubic", -1.0)]).contains("softer"));
    assert!(says("sensor_gain", &[("gain", 0.98)]).contains("too little"));
}
