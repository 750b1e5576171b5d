//! The amplitude of an effect, and the validity of a linearisation in it.

/// The amplitude parameters of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Their names. The model is linear in them near the null value.
    pub parameters: &'static [&'static str],
    /// Value at which the effect has no influence (infinite for a limit), SI.
    pub null: f64,
    /// The function of the amplitude in which the model is linear.
    pub coordinate: Coordinate,
}

impl Amplitude {
    /// Amplitudes with the null value 0.
    pub(super) const fn of(parameters: &'static [&'static str]) -> Self {
        Self { parameters, null: 0.0, coordinate: Coordinate::Value }
    }
}

/// The coordinate in which a model is linear in an amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// The value itself.
    Value,
    /// The inverse of the value: compliance for a stiffness.
    Inverse,
}

/// The amplitudes for which sensitivities at a start predict the outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Linearisation {
    /// Sensitivities at the null value predict any amplitude.
    Null,
    /// Sensitivities at the null value predict small amplitudes only: the effect is fitted even where they predict no reduction.
    NearNull,
    /// Starts have an amplitude other than the null value, and sensitivities hold near it.
    NonNull,
    /// Sensitivities cannot predict the amplitude; a fit is run from several starts with all parameters free.
    Restarts,
}

/// The influence of an effect on steady states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steady {
    /// The effect has no influence, or one that a single amplitude does not describe.
    Unseen,
    /// All readings are linear in its first amplitude.
    Linear,
    /// The two ends of its place turn at different mean speeds.
    Slips,
}
