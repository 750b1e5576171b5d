//! Force laws: their inputs, their responses, and how an effect enters the equations of motion.

use crate::formula::Tape;

/// Largest number of parameters of a law, borrowed ones included.
pub const MAX_PARAMETERS: usize = 14;
/// Largest number of inputs of a law.
pub const MAX_LAW_INPUTS: usize = 4;

/// An input of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LawInput {
    /// Speed of its node, rad/s; of a gear: of its slow side.
    Speed,
    /// Twist of its spring, rad: angle of the `from` end less that of the `to` end.
    Twist,
    /// Rate of the twist, rad/s.
    TwistRate,
    /// Torque through its spring including the damper, N m.
    Torque,
    /// Angle through which its node has turned since the recording began, rad; of a gear: its fast side.
    Angle,
    /// Time since the recording began, s.
    Time,
    /// Reading of an ideal sensor at its channel, in the channel's SI unit; for an input channel, the recorded value.
    Reading,
    /// Time derivative of an input's reading, computed from the recording, per s.
    Change,
    /// The effect's own state, see [`Acts::State`].
    State,
    /// A channel of the model, in its SI unit: the true value of an input, what the model predicts of an output.
    Channel {
        /// Name of the channel.
        channel: &'static str,
        /// Name of the input in the law's formula.
        symbol: &'static str,
    },
}

impl LawInput {
    /// Name of the input in [`Law::formula`].
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Speed => "speed",
            Self::Twist => "twist",
            Self::TwistRate => "twist_rate",
            Self::Torque => "through",
            Self::Angle => "angle",
            Self::Time => "time",
            Self::Reading => "reading",
            Self::Change => "change",
            Self::State => "state",
            Self::Channel { symbol, .. } => symbol,
        }
    }
}

/// Action of a law's response.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// A torque on its node; at a spring or in a gear's mesh, a torque through it that is added to that of the spring.
    Torque,
    /// A torque on the slow side of its gear.
    Drag,
    /// The rate of the effect's own state.
    State,
    /// An addition to a sensor's reading. For an input channel the response is subtracted from the reading to give the true value.
    Reading,
}

/// The response of a law, and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Torque, N m (N). For [`Acts::State`] the rate of the state, for [`Acts::Reading`] a reading.
    pub torque: f64,
    /// Derivative with respect to each input.
    pub derivatives: [f64; MAX_LAW_INPUTS],
    /// Derivative with respect to each parameter, in the order of [`super::Effect::parameters`], borrowed ones last.
    pub by_parameter: [f64; MAX_PARAMETERS],
}

/// The response of a law as a function of its inputs and parameters.
#[derive(Debug, Clone, Copy)]
pub enum Rule {
    /// A function of this program: a law of the catalogue.
    Code(fn(law_inputs: &[f64], parameters: &[f64]) -> Response),
    /// A formula of a model file.
    Formula(&'static Tape),
}

/// A force law.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    /// Inputs of the law.
    pub law_inputs: &'static [LawInput],
    /// Action of its response.
    pub acts: Acts,
    /// The response to inputs and parameters.
    pub rule: Rule,
    /// The response as a [`Formula`](crate::formula::Formula), for simulators of others: parameters by their names, borrowed ones as
    /// `stiffness` and `damping`, inputs by [`LawInput::symbol`]. Empty where a law has none. Corners are rounded as in `rule`; the tests of
    /// `socam-export` compare both.
    pub formula: &'static str,
    /// Width of the range of the first input in which the law is sharply curved, in that input's unit; 0 if there is none. Predictors
    /// limit their Newton steps to it.
    pub transition: fn(parameters: &[f64]) -> f64,
    /// Whether the response is zero for all inputs. Predictors then propagate only the sensitivities with respect to its parameters.
    pub inactive: fn(parameters: &[f64]) -> bool,
}

impl Law {
    /// The response to inputs and parameters.
    #[must_use]
    pub fn evaluate(&self, law_inputs: &[f64], parameters: &[f64]) -> Response {
        match self.rule {
            Rule::Code(evaluate) => evaluate(law_inputs, parameters),
            Rule::Formula(tape) => {
                let (mut derivatives, mut by_parameter) = ([0.0; MAX_LAW_INPUTS], [0.0; MAX_PARAMETERS]);
                let torque = tape.evaluate((law_inputs, &mut derivatives), (parameters, &mut by_parameter));
                Response { torque, derivatives, by_parameter }
            }
        }
    }

    /// [`Self::transition`] at parameters; of a formula by its `tanh` and `atan`.
    #[must_use]
    pub fn transition_at(&self, parameters: &[f64]) -> f64 {
        match self.rule {
            Rule::Code(_) => (self.transition)(parameters),
            Rule::Formula(tape) => tape.transition(&[0.0; MAX_LAW_INPUTS], parameters),
        }
    }

    /// Whether a formula has a finite value where all inputs are 1.
    pub(crate) fn is_finite_at(&self, parameters: &[f64]) -> bool {
        match self.rule {
            Rule::Code(_) => true,
            Rule::Formula(tape) => tape.is_finite_at(&[1.0; MAX_LAW_INPUTS], parameters),
        }
    }

    /// [`Self::inactive`] at parameters; of a formula by its factors that are zero.
    #[must_use]
    pub fn is_inactive(&self, parameters: &[f64]) -> bool {
        match self.rule {
            Rule::Code(_) => (self.inactive)(parameters),
            Rule::Formula(tape) => tape.vanishes(|parameter| parameters[parameter] == 0.0),
        }
    }
}

/// Form in which an effect enters the equations of motion.
#[derive(Debug, Clone, Copy)]
pub enum Form {
    /// The effect adds the forces of these laws.
    Laws(&'static [Law]),
    /// Adds its first parameter to the inertia of its node.
    Inertia,
    /// Replaces a rigid shaft by a spring and a damper, its two parameters.
    Compliance,
    /// The machine stands on a frame of one coordinate. Parameters: its stiffness to the ground, natural frequency (Hz) and damping ratio.
    Mounting,
    /// The reading of its channel is its first parameter times the true value.
    Gain,
    /// The reading of its channel follows the true value with a first-order lag, whose time constant is its first parameter.
    Lag,
    /// The reading of its channel is the true value delayed by its first parameter.
    Delay,
}

impl Borrowed {
    /// Their names in [`Law::formula`].
    #[must_use]
    pub const fn symbols(self) -> &'static [&'static str] {
        match self {
            Self::Stiffness => &["stiffness"],
            Self::Contact => &["stiffness", "damping"],
            Self::Damping => &["damping"],
        }
    }
}

/// Parameters of the place that a law receives after its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Borrowed {
    /// Stiffness of its spring.
    Stiffness,
    /// Stiffness, then damping, of the spring that models the contact of its teeth.
    Contact,
    /// Viscous damping of its bearing.
    Damping,
}
