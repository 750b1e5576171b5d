//! What a channel measures, and whether the model reads it as an input or predicts it.

/// What a channel measures or commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantity {
    /// Speed of a node.
    Speed,
    /// Angle of a node. As an input, an angle that is added to the twist of a spring, which its damper does not feel: a
    /// mesh that does not roll true.
    #[serde(alias = "position")]
    Angle,
    /// Angular acceleration of a node.
    Acceleration,
    /// Torque through a spring, on a node from outside, or of a servo.
    #[serde(alias = "force")]
    Torque,
    /// Where a servo is told to go.
    Reference,
    /// Time since the recording began; beside the motion, for laws that depend on it.
    #[serde(skip)]
    Time,
    /// Angle through which a node has turned since the recording began; likewise.
    #[serde(skip)]
    Turned,
    /// Rate at which another input changes, by its column; likewise.
    #[serde(skip)]
    Change,
}

impl Quantity {
    /// Whether an input of this kind moves nothing, but is only seen by laws; known exactly.
    #[must_use]
    pub fn is_clock(self) -> bool {
        matches!(self, Self::Time | Self::Turned | Self::Change)
    }
}

/// Whether the model reads a channel to move or to be judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Drives the model.
    Input,
    /// Is predicted by it.
    Output,
}
