//! Relations between effects: laws that contain a simpler law, and observationally equivalent effects.

use super::rig::{Rig, Values};

/// Fitted values of an effect's parameters (name, SI value), for its sentence and for the starts of laws that replace it.
///
/// ```
/// use socam_model::effects::FittedValues;
///
/// let fitted = FittedValues(&[("torque", 0.3)]);
/// assert_eq!(fitted.get("torque"), 0.3);
/// assert!(fitted.get("static_torque").is_nan());
/// ```
#[derive(Debug, Clone, Copy)]
pub struct FittedValues<'v>(pub &'v [(&'v str, f64)]);

impl FittedValues<'_> {
    /// Value of a parameter, SI; NaN where it is not given, so that every comparison with it is false.
    #[must_use]
    pub fn get(&self, name: &str) -> f64 {
        self.0.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }
}

/// A simpler law that this one may replace once the simpler one is fitted.
#[derive(Debug, Clone, Copy)]
pub struct Replaces {
    /// Id of the simpler law.
    pub law: &'static str,
    /// Start values of this law from the fitted values of the simpler one; parameters of the same name that are left out keep their fitted
    /// values.
    pub starts: fn(&Rig, &FittedValues<'_>) -> Vec<Values>,
}

/// An effect that is observationally equivalent to this one under some condition.
#[derive(Debug, Clone, Copy)]
pub struct Equivalent {
    /// Id of the other effect.
    pub effect: &'static str,
    /// Condition of the equivalence.
    pub holds: Condition,
}

/// A condition for [`Equivalent`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// The other effect acts at the other of two springs in series, with no measurement between them.
    InSeries,
    /// The condition of [`Self::InSeries`] holds, one of the two stiffnesses is free, and its bounds include the value of the
    /// other.
    InSeriesWithFreeStiffness,
    /// The other effect acts at the same channel, and the amplitude is below this fraction of the sample time.
    ShorterThanSamples(f64),
    /// The place turns in one direction only.
    OneDirection,
    /// Any other condition, as a clause of a sentence.
    Stated(&'static str),
}
