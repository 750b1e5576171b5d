//! Intersample behaviour: the values of an input between its samples.

use std::str::FromStr;

use crate::{ChannelTransform, Quantity};

/// Intersample behaviour: the values of an input between its samples.
///
/// ```
/// use socam_model::{ChannelTransform, Intersample, Quantity};
///
/// assert_eq!(Intersample::of(Quantity::Torque, ChannelTransform::Value), Intersample::Linear);
/// assert_eq!("band-limited".parse(), Ok(Intersample::BandLimited));
/// assert!(Intersample::ALL.iter().all(|kind| kind.name().parse() == Ok(*kind)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Intersample {
    /// Constant from each sample to the next (zero-order hold): the output of a converter or drive that is updated at the recording's
    /// sample rate.
    Hold,
    /// Linear between samples (first-order hold). For a sampled motion it acts as a low-pass filter, which biases estimated dampings by
    /// several per cent where the motion has content up to a sixth of the sampling rate.
    Linear,
    /// A band-limited signal, by a spline through the samples. Its error is of order 8 in frequency.
    BandLimited,
}

impl Intersample {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Hold, Self::Linear, Self::BandLimited];

    /// Name of the reconstruction in model files and options.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Linear => "linear",
            Self::BandLimited => "band-limited",
        }
    }

    /// Default for an input. Measured motions are band-limited, because inertia smooths them, and so are waves that are computed from an
    /// angle. Torques, forces, voltages and references are linear: a drive ramps between commands.
    #[must_use]
    pub const fn of(quantity: Quantity, take: ChannelTransform) -> Self {
        match (quantity, take) {
            (Quantity::Torque, ChannelTransform::Cos(_) | ChannelTransform::Sin(_)) => Self::BandLimited,
            (Quantity::Torque | Quantity::Voltage | Quantity::Current | Quantity::Reference, _)
            | (Quantity::Signal | Quantity::Time | Quantity::Change, _) => Self::Linear,
            (Quantity::Speed | Quantity::Angle | Quantity::Acceleration | Quantity::Turned, _) => {
                Self::BandLimited
            }
        }
    }
}

impl FromStr for Intersample {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == text)
            .ok_or_else(|| format!("expected hold, linear or band-limited, not `{text}`"))
    }
}
