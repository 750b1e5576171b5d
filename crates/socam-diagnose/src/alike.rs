//! Effects that no recording of a bench tells from a candidate, by what they are: whether both were fitted to the end or not.

use socam_identify::springs_in_series;
use socam_model::{
    Model, Parameter, Quantity, Site, Spring,
    effects::{self, Condition},
};

use crate::candidates::Candidate;

/// Those like one that was found in `model`, at its fitted strength.
pub(crate) fn alike(
    model: &Model,
    own: &Candidate,
    strength: Option<f64>,
    sample_time_s: f64,
) -> Vec<Candidate> {
    let each = own.effect.equivalents.iter().flat_map(|other| match other.holds {
        Condition::InSeries => in_a_row(model, own, |_, _| true),
        // The springs' own stiffness has to change places with it.
        Condition::InSeriesWithFreeStiffness => in_a_row(model, own, |a, b| can_swap(model, a, b)),
        Condition::ShorterThanSamples(share) => {
            let is_short = strength.is_some_and(|time_s| time_s < share * sample_time_s);
            let effect = effects::find(other.effect).filter(|_| is_short);
            effect.map(|effect| Candidate { effect, ..own.clone() }).into_iter().collect()
        }
        // What recordings have to tell.
        Condition::OneDirection | Condition::Stated(_) => Vec::new(),
    });
    each.collect()
}

/// The same in the other of two springs that act as one: both carry one torque, and only their twists' sum is seen.
fn in_a_row(model: &Model, own: &Candidate, may: impl Fn(&Spring, &Spring) -> bool) -> Vec<Candidate> {
    // What was found in a spring does not part it from its neighbour.
    let mut plain = model.clone();
    plain.effects.retain(|used| !matches!(used.at, Site::Spring(_)));
    let pairs = springs_in_series(&plain).filter(|(a, b)| !is_seen_between(&plain, a, b) && may(a, b));
    let others = pairs.filter_map(|(a, b)| match own.place.as_str() {
        place if place == a.name => Some(b),
        place if place == b.name => Some(a),
        _ => None,
    });
    others.map(|other| Candidate { place: other.name.clone(), ..own.clone() }).collect()
}

/// Whether neither of two springs' stiffness is known, and each could have the other's.
fn can_swap(model: &Model, a: &Spring, b: &Spring) -> bool {
    let [a, b] = [a, b].map(|spring| &model.parameters[spring.stiffness]);
    let could = |own: &Parameter, value: f64| !own.fixed && (own.bounds.0..=own.bounds.1).contains(&value);
    could(a, b.value) && could(b, a.value)
}

/// Whether a sensor shows how the point between two springs moves.
fn is_seen_between(model: &Model, a: &Spring, b: &Spring) -> bool {
    let is_end = |spring: &Spring, node: usize| spring.from == node || spring.to == Some(node);
    let mut between = (0..model.nodes.len()).filter(|node| is_end(a, *node) && is_end(b, *node));
    let moves = |node: usize| {
        let mut at_it = model.outputs().filter(move |channel| channel.at == model.nodes[node].name);
        at_it.any(|channel| channel.quantity != Quantity::Torque)
    };
    between.any(moves)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(id: &str, place: &str, strength: f64) -> Vec<(&'static str, String)> {
        let model = Model::builtin("speed-o-cam").unwrap();
        let effect = effects::find(id).unwrap();
        let own = Candidate {
            effect,
            place: place.into(),
            values: Vec::new(),
            strength: &[],
            linearised_at: 0.0,
            begins_large: false,
        };
        let all = alike(&model, &own, Some(strength), 1e-3);
        all.into_iter().map(|other| (other.effect.id, other.place)).collect()
    }

    #[test]
    fn what_carries_one_torque_is_alike() {
        assert_eq!(of("coupling_slip", "coupling_1", 1.0), [("coupling_slip", "coupling_2".to_owned())]);
        assert_eq!(of("hysteresis", "coupling_2", 1.0), [("hysteresis", "coupling_1".to_owned())]);
        // Behind the gear: pins and coupling stand in a row too, the load's inertia ends it.
        assert_eq!(of("coupling_slip", "coupling_3", 1.0), [("coupling_slip", "roller_pins".to_owned())]);
        // But no pin is as soft as a coupling.
        assert_eq!(of("hysteresis", "coupling_3", 1.0), []);
        assert_eq!(of("backlash", "mesh", 1e-3), []);
    }

    #[test]
    fn only_what_is_far_shorter_than_a_sample_may_be_lag_or_delay() {
        assert_eq!(of("sensor_lag", "torque_in", 2e-5), [("sensor_delay", "torque_in".to_owned())]);
        assert_eq!(of("sensor_delay", "torque_in", 2e-3), []);
    }
}
