//! Observationally equivalent effects: those that no recording of a bench distinguishes from a candidate, by the structure of the model.
//! Whether both were fitted does not matter.

use socam_identify::springs_in_series;
use socam_model::{
    Model, Parameter, Quantity, Site, Spring,
    effects::{self, Condition},
};

use crate::candidate::Candidate;

/// Effects that are observationally equivalent to `own`, which was found in `model` at this fitted amplitude.
pub(crate) fn equivalents(
    model: &Model,
    own: &Candidate,
    amplitude: Option<f64>,
    sample_time_s: f64,
) -> Vec<Candidate> {
    let each = own.effect.equivalents.iter().flat_map(|other| match other.holds {
        Condition::InSeries => in_series(model, own, |_, _| true),
        // Equivalent only if the two springs' stiffnesses can be exchanged along with the effect.
        Condition::InSeriesWithFreeStiffness => in_series(model, own, |a, b| can_swap(model, a, b)),
        Condition::ShorterThanSamples(share) => {
            let is_short = amplitude.is_some_and(|time_s| time_s < share * sample_time_s);
            let effect = effects::find(other.effect).filter(|_| is_short);
            effect.map(|effect| Candidate { effect, ..own.clone() }).into_iter().collect()
        }
        // Whether these conditions hold depends on the recordings.
        Condition::OneDirection | Condition::Stated(_) => Vec::new(),
    });
    each.collect()
}

/// The candidate's effect in the other of two springs in series: both carry the same torque, and only the sum of their twists is measured.
fn in_series(model: &Model, own: &Candidate, may: impl Fn(&Spring, &Spring) -> bool) -> Vec<Candidate> {
    // Effects in a spring do not separate it from its neighbour.
    let mut plain = model.clone();
    plain.effects.retain(|used| !matches!(used.at, Site::Spring(_)));
    let pairs = springs_in_series(&plain).filter(|(a, b)| !is_measured_between(&plain, a, b) && may(a, b));
    let others = pairs.filter_map(|(a, b)| match own.place.as_str() {
        place if place == a.name => Some(b),
        place if place == b.name => Some(a),
        _ => None,
    });
    others.map(|other| Candidate { place: other.name.clone(), ..own.clone() }).collect()
}

/// Whether both springs' stiffnesses are free, and each lies within the other's bounds.
fn can_swap(model: &Model, a: &Spring, b: &Spring) -> bool {
    let [a, b] = [a, b].map(|spring| &model.parameters[spring.stiffness]);
    let could = |own: &Parameter, value: f64| !own.fixed && (own.bounds.0..=own.bounds.1).contains(&value);
    could(a, b.value) && could(b, a.value)
}

/// Whether a sensor measures the motion of the point between two springs.
fn is_measured_between(model: &Model, a: &Spring, b: &Spring) -> bool {
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

    fn of(id: &str, place: &str, amplitude: f64) -> Vec<(&'static str, String)> {
        let model = Model::builtin("speed-o-cam").unwrap();
        let effect = effects::find(id).unwrap();
        let own = Candidate {
            effect,
            place: place.into(),
            values: Vec::new(),
            amplitudes: &[],
            linearised_at: 0.0,
            begins_large: false,
            speed: 0.0,
        };
        let all = equivalents(&model, &own, Some(amplitude), 1e-3);
        all.into_iter().map(|other| (other.effect.id, other.place)).collect()
    }

    #[test]
    fn effects_in_springs_of_one_torque_are_equivalent() {
        assert_eq!(of("coupling_slip", "coupling_1", 1.0), [("coupling_slip", "coupling_2".to_owned())]);
        assert_eq!(of("hysteresis", "coupling_2", 1.0), [("hysteresis", "coupling_1".to_owned())]);
        // Behind the gear, pins and coupling are in series too; the load's inertia ends the series.
        assert_eq!(of("coupling_slip", "coupling_3", 1.0), [("coupling_slip", "roller_pins".to_owned())]);
        // But the pins' stiffness cannot be as low as a coupling's.
        assert_eq!(of("hysteresis", "coupling_3", 1.0), []);
        assert_eq!(of("backlash", "mesh", 1e-3), []);
    }

    #[test]
    fn a_lag_and_a_delay_far_shorter_than_a_sample_are_equivalent() {
        assert_eq!(of("sensor_lag", "torque_in", 2e-5), [("sensor_delay", "torque_in".to_owned())]);
        assert_eq!(of("sensor_delay", "torque_in", 2e-3), []);
    }
}
