//! Effects that no recording of a bench tells from a candidate, by what they are: whether both were fitted to the end or not.

use socam_model::{
    Channel, Model, Parameter, Quantity, Role,
    effects::{self, ActsAt},
};

use crate::candidates::Candidate;

/// Of a sample time: by so short a time a signal that is late and one that is slow look alike, to a hundredth of what is fastest in it.
const SHORT: f64 = 0.05;

/// Those like one that was found in `model`, at its fitted strength.
pub(crate) fn alike(
    model: &Model,
    own: &Candidate,
    strength: Option<f64>,
    sample_time_s: f64,
) -> Vec<Candidate> {
    let other = match own.effect.id {
        "sensor_lag" => "sensor_delay",
        "sensor_delay" => "sensor_lag",
        "coupling_slip" => return in_a_row(model, own, |_, _| true),
        // The springs' own stiffness has to change places with it.
        "hysteresis" | "stiffness_hardening" => return in_a_row(model, own, |a, b| can_swap(model, a, b)),
        _ => return Vec::new(),
    };
    let is_short = strength.is_some_and(|time_s| time_s < SHORT * sample_time_s);
    let other = effects::find(other).filter(|_| is_short);
    other.map(|effect| Candidate { effect, ..own.clone() }).into_iter().collect()
}

/// The same in the other of two springs with nothing but a massless point between them: both carry one torque, and only their twists'
/// sum is seen.
fn in_a_row(model: &Model, own: &Candidate, may: impl Fn(usize, usize) -> bool) -> Vec<Candidate> {
    let ends = |index: usize| [Some(model.springs[index].from), model.springs[index].to];
    let Some(spring) = model.springs.iter().position(|spring| spring.name == own.place) else {
        return Vec::new();
    };
    let between = ends(spring).into_iter().flatten().filter(|node| is_bare(model, *node));
    let others = between.flat_map(|node| {
        let at_it = (0..model.springs.len()).filter(move |other| ends(*other).contains(&Some(node)));
        let at_it: Vec<usize> = at_it.collect();
        if at_it.len() == 2 { at_it } else { Vec::new() }
    });
    let others = others.filter(|other| *other != spring && may(*other, spring));
    others.map(|other| Candidate { place: model.springs[other].name.clone(), ..own.clone() }).collect()
}

/// Whether neither of two springs' stiffness is known, and each could have the other's.
fn can_swap(model: &Model, a: usize, b: usize) -> bool {
    let [a, b] = [a, b].map(|spring| &model.parameters[model.springs[spring].stiffness]);
    let could = |own: &Parameter, value: f64| !own.fixed && (own.bounds.0..=own.bounds.1).contains(&value);
    could(a, b.value) && could(b, a.value)
}

/// Whether nothing but springs' torque meets at a node.
fn is_bare(model: &Model, node: usize) -> bool {
    let name = &model.nodes[node].name;
    let moves = |channel: &Channel| channel.at == *name && channel.quantity != Quantity::Torque;
    let drives = |channel: &Channel| channel.at == *name && channel.role == Role::Input;
    model.nodes[node].inertia.is_none()
        && !model.gears.iter().any(|gear| gear.from == node || gear.to == node)
        && !model.shafts.iter().any(|shaft| shaft.nodes.0 == node || shaft.nodes.1 == node)
        && !model.bearings.iter().any(|bearing| bearing.node == node)
        && !model.channels.iter().any(|channel| moves(channel) || drives(channel))
        && !model.effects.iter().any(|used| used.effect.acts_at == ActsAt::Node && used.place == *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(id: &str, place: &str, strength: f64) -> Vec<(&'static str, String)> {
        let model = Model::builtin("speed-o-cam").unwrap();
        let effect = effects::find(id).unwrap();
        let own = Candidate { effect, place: place.into(), values: Vec::new(), strength: &[] };
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
