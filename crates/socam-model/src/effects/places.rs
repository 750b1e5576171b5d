//! Kinds of places, and the subset that a diagnosis tests.

/// The kind of element at which an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
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
    /// A channel: the error of its sensor, or of the recorded input.
    Channel,
}

impl ActsAt {
    /// Name of the kind of place in a sentence, with the article.
    ///
    /// ```
    /// assert_eq!(socam_model::effects::ActsAt::Bearing.noun(), "a bearing");
    /// ```
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

/// The places, among those at which an effect may act, that a diagnosis tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Places {
    /// All places of the effect's kind.
    Every,
    /// The last node that has an inertia and whose motion is not prescribed: the load, on which torques from outside act.
    Load,
    /// The driving machine: nodes on which an input acts with a torque. Where an input prescribes a node's motion, the nodes with an inertia
    /// at the other end of that node's springs.
    Driven,
    /// The first node of the driving machine, in a model in which no input prescribes a motion.
    DrivenOnAFrame,
    /// Nodes whose motion no input prescribes.
    Free,
    /// Output channels.
    Sensors,
    /// Input channels whose column is used without a transform.
    Inputs,
    /// Output and input channels.
    Channels,
    /// The place of a law of a model file.
    Only(&'static str),
}

/// Whether a place is a part of the machine. The spring that models a gear's contact (its name ends in `.contact`) is not.
///
/// ```
/// use socam_model::effects::is_part;
///
/// assert!(is_part("coupling_1") && !is_part("mesh.contact"));
/// ```
#[must_use]
pub fn is_part(place: &str) -> bool {
    !place.ends_with(".contact")
}
