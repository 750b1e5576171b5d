//! Force laws: what they see, what they answer, and how an effect enters the equations of motion.

/// Most parameters that a law has.
pub const MAX_PARAMETERS: usize = 6;
/// Most quantities that one sees.
pub const MAX_LAW_INPUTS: usize = 3;

/// What a law sees of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawInput {
    /// Speed of its node, rad/s; of a gear: of its slow side.
    Speed,
    /// Twist of its spring, rad: from less to.
    Twist,
    /// Rate of that, rad/s.
    TwistRate,
    /// Torque through its spring, its damper included, N m.
    Torque,
    /// Angle through which its node has turned since the recording began, rad; of a gear: its fast side.
    Angle,
    /// Time since the recording began, s.
    Time,
    /// What its channel would read were its sensor true; of an input, what it reads.
    Reading,
    /// Rate at which an input's reading changes, by the recording.
    Change,
    /// The state of its own: see [`Acts::State`].
    State,
}

/// What a law's answer does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acts {
    /// A torque on its node, or, at a spring or in a gear's mesh, one that pulls its ends together.
    Torque,
    /// A torque on the slow side of its gear.
    Drag,
    /// The rate at which a state of its own changes.
    State,
    /// Is added to what a sensor reads: of an input, the truth is so much less.
    Reading,
}

/// What a law answers, and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Torque, N m (N), or whatever else it is that the law answers.
    pub torque: f64,
    /// By each law_input.
    pub derivatives: [f64; MAX_LAW_INPUTS],
    /// By each parameter, in the order of [`super::Effect::parameters`], borrowed ones last.
    pub by_parameter: [f64; MAX_PARAMETERS],
}

/// A force law.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    /// What it sees.
    pub law_inputs: &'static [LawInput],
    /// What its answer does.
    pub acts: Acts,
    /// The answer to law_inputs and parameters.
    pub evaluate: fn(law_inputs: &[f64], parameters: &[f64]) -> Response,
    /// Range of its first law_input in which it bends (0: it bends nowhere sharply). Fast predictors take shorter steps there.
    pub transition: fn(parameters: &[f64]) -> f64,
    /// Whether it answers nothing, whatever it sees. Fast predictors then only listen to what it would answer.
    pub inactive: fn(parameters: &[f64]) -> bool,
}

/// How an effect enters the equations of motion.
#[derive(Debug, Clone, Copy)]
pub enum Form {
    /// By laws.
    Laws(&'static [Law]),
    /// Adds its first parameter to the inertia of its node.
    Inertia,
    /// Puts a spring and damper of its two parameters in the place of a rigid shaft.
    Compliance,
    /// What its channel reads is its first parameter times the truth.
    Gain,
    /// What its channel reads follows the truth with a first-order lag of its first parameter.
    Lag,
    /// What its channel reads is the truth of its first parameter ago.
    Delay,
}

/// A parameter of the place that a law sees beside its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Borrowed {
    /// Stiffness of its spring.
    Stiffness,
    /// Stiffness, then damping, of the spring that stands in for its mesh.
    Contact,
    /// Viscous damping of its bearing.
    Damping,
}
