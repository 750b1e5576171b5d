//! Kinds of places, and which of them a diagnosis looks at.

/// Where an effect can sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsAt {
    /// A bearing: friction and drag between a node and the ground.
    Bearing,
    /// A node: a torque that acts on it from outside, or its inertia.
    Node,
    /// A spring: a coupling or an elastic shaft.
    Spring,
    /// A gear.
    Gear,
    /// A rigid shaft.
    Shaft,
    /// A channel: what its sensor does to the truth.
    Channel,
}

impl ActsAt {
    /// What such a place is called.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Bearing => "a bearing",
            Self::Node => "a node",
            Self::Spring => "a spring",
            Self::Gear => "a gear",
            Self::Shaft => "a rigid shaft",
            Self::Channel => "a channel",
        }
    }
}

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
