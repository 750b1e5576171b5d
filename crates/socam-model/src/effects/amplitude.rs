//! How strong an effect is, and how far a linearisation predicts what it does.

/// Parameters that measure how strong an effect is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Their names. The model is linear in them near the null value.
    pub parameters: &'static [&'static str],
    /// Their value where the effect does nothing.
    pub null: f64,
    /// What of them the model is linear in.
    pub coordinate: Coordinate,
}

impl Amplitude {
    /// Parameters that are zero where there is no effect.
    pub(super) const fn of(parameters: &'static [&'static str]) -> Self {
        Self { parameters, null: 0.0, coordinate: Coordinate::Value }
    }
}

/// The coordinate in which a model is linear in an amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// The value itself.
    Value,
    /// Its inverse: a stiffness acts by its compliance.
    Inverse,
}

/// How far the sensitivities at a start predict what an effect does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Linearisation {
    /// At the null value, for any amplitude.
    Null,
    /// At the null value, for small amplitudes only: such an effect is fitted whatever the prediction says.
    NearNull,
    /// Starts are of some amplitude already, and sensitivities hold there.
    NonNull,
    /// Not at all: sensitivities cannot predict the amplitude, and a fit is begun from several starts with all parameters free.
    Restarts,
}

/// What a steady state shows of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steady {
    /// Nothing, or nothing that one number measures.
    Unseen,
    /// Its first amplitude, in which all readings are linear.
    Linear,
    /// Two ends of its place turn at different speeds.
    Slips,
}
