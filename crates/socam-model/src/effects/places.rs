//! Where a diagnosis looks for an effect.

use super::{ActsAt, Effect};
use crate::{Model, Quantity, Role};

/// Which of the places at which an effect may act are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Places {
    /// All of that kind.
    Every,
    /// The last node with an inertia whose motion is not prescribed: what acts from outside acts on the load.
    Load,
    /// The machine that drives: nodes that an input acts on with a torque, or, where an input prescribes the motion of a node, those with
    /// an inertia at the other end of its springs.
    Driven,
    /// Nodes whose motion no input prescribes.
    Free,
    /// Channels that are predicted.
    Sensors,
    /// Channels that drive the model.
    Inputs,
    /// Channels that are predicted, and inputs.
    Channels,
}

/// What stands in for a mesh's teeth is no part that could be worn.
#[must_use]
pub fn is_part(place: &str) -> bool {
    !place.ends_with(".contact")
}

impl Effect {
    /// Places of a model at which a diagnosis looks for it.
    #[must_use]
    pub fn places_in(&self, model: &Model) -> Vec<String> {
        let moves = |input: &crate::Channel| !input.quantity.is_clock();
        let driven = |name: &str| model.inputs().any(|input| moves(input) && input.at == name);
        let prescribed =
            |name: &str| model.inputs().any(|input| input.quantity == Quantity::Speed && input.at == name);
        let massive = |name: &str| model.nodes.iter().any(|node| node.name == name && node.inertia.is_some());
        let name = |node: usize| model.nodes[node].name.as_str();
        let behind_drive = |place: &str| {
            let mut joined =
                model.springs.iter().filter_map(|spring| Some((name(spring.from), name(spring.to?))));
            massive(place)
                && joined.any(|(a, b)| (a == place && prescribed(b)) || (b == place && prescribed(a)))
        };
        let channel = |name: &str| model.channels.iter().find(|channel| channel.name == name);
        let all = model.places(self).into_iter().filter(|place| is_part(place));
        let is_sensor = |place: &str| channel(place).is_some_and(|c| !c.quantity.is_clock());
        let mut all = all.filter(|place| self.acts_at != ActsAt::Channel || is_sensor(place));
        let kept: Vec<&str> = match self.places {
            Places::Every | Places::Channels | Places::Inputs => all.collect(),
            Places::Load => all.rfind(|place| massive(place) && !prescribed(place)).into_iter().collect(),
            Places::Driven => {
                all.filter(|place| !prescribed(place) && (driven(place) || behind_drive(place))).collect()
            }
            Places::Free => all.filter(|place| !prescribed(place)).collect(),
            Places::Sensors => {
                all.filter(|place| channel(place).is_some_and(|c| c.role == Role::Output)).collect()
            }
        };
        kept.into_iter().map(str::to_owned).collect()
    }
}
