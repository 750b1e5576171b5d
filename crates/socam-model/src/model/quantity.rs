//! Quantity and role of a channel.

/// The quantity that a channel measures or commands.
///
/// ```
/// use socam_model::Quantity;
///
/// assert!(Quantity::Time.is_clock() && !Quantity::Speed.is_clock());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantity {
    /// Speed of a node.
    Speed,
    /// Angle of a node. As an input, an angle that is added to the twist of a spring and not to the rate of its damper, such as the
    /// transmission error of a mesh.
    #[serde(alias = "position")]
    Angle,
    /// Angular acceleration of a node.
    Acceleration,
    /// Torque: as an input, on a node from outside; as an output, through a spring or of a servo.
    #[serde(alias = "force")]
    Torque,
    /// Position reference of a servo.
    Reference,
    /// Voltage at the winding of a motor: an input.
    Voltage,
    /// Current through the winding of a motor: an output.
    Current,
    /// A recorded quantity that only laws read, such as a temperature: an input that exerts no torque. Its values are taken as exact, and
    /// its unit is that of its column.
    Signal,
    /// Time since the start of the recording, s: an input of laws only.
    #[serde(skip)]
    Time,
    /// Angle through which a node has turned since the start of the recording, rad: an input of laws only.
    #[serde(skip)]
    Turned,
    /// Time derivative of another input, computed from its column: an input of laws only.
    #[serde(skip)]
    Change,
}

impl Quantity {
    /// Whether an input of this quantity is added for laws and exerts no torque itself. Its values are taken as exact.
    #[must_use]
    pub fn is_clock(self) -> bool {
        matches!(self, Self::Time | Self::Turned | Self::Change)
    }

    /// Whether an input of this quantity drives the model: every one but clocks and signals, which only laws read.
    #[must_use]
    pub fn drives(self) -> bool {
        !self.is_clock() && self != Self::Signal
    }

    /// Whether the values of an input of this quantity are taken as exact: clocks, set points and signals.
    #[must_use]
    pub fn is_exact(self) -> bool {
        self.is_clock() || matches!(self, Self::Reference | Self::Signal)
    }
}

/// Role of a channel in the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The model reads it: a prescribed speed, a torque, a reference.
    Input,
    /// The model predicts it.
    Output,
}
