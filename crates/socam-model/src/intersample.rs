//! How an input moves between its samples.

use std::str::FromStr;

use crate::{ChannelTransform, Quantity};

/// How an input moves between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Intersample {
    /// It keeps each sample's value until the next sample (zero-order hold): what a converter or a drive with the recording's
    /// own period puts out.
    Hold,
    /// In a straight line from sample to sample (first-order hold). On a sampled motion it acts as a low-pass that biases
    /// dampings, by several per cent for content up to a sixth of the sampling rate.
    Linear,
    /// As a band-limited signal: a spline through the samples whose error is of eighth order in frequency.
    BandLimited,
}

impl Intersample {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Hold, Self::Linear, Self::BandLimited];

    /// The word for it in model files and options.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Linear => "linear",
            Self::BandLimited => "band-limited",
        }
    }

    /// What an input of this kind does when nobody says: a motion has inertia, and a wave made of an angle moves as that does;
    /// a torque, a force or a reference is what a drive was told, which it ramps.
    #[must_use]
    pub const fn of(quantity: Quantity, take: ChannelTransform) -> Self {
        match (quantity, take) {
            (Quantity::Torque, ChannelTransform::Cos(_) | ChannelTransform::Sin(_)) => Self::BandLimited,
            (Quantity::Torque | Quantity::Reference | Quantity::Time | Quantity::Change, _) => Self::Linear,
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
