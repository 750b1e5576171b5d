//! How effects stand to each other: what replaces a simpler law, and what recordings cannot tell apart.

use super::rig::{Rig, Values};

/// Fitted values of an effect's parameters, for its sentence and for laws that continue from there.
#[derive(Debug, Clone, Copy)]
pub struct FittedValues<'v>(pub &'v [(&'v str, f64)]);

impl FittedValues<'_> {
    /// A value, SI; NaN where it is not determined, so that no comparison with it holds.
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
    /// Starts from the simpler law's fitted values: those of this law's parameters that are not carried over as they are.
    pub starts: fn(&Rig, &FittedValues<'_>) -> Vec<Values>,
}

/// An effect that is observationally equivalent to this one under some condition.
#[derive(Debug, Clone, Copy)]
pub struct Equivalent {
    /// Its id.
    pub effect: &'static str,
    /// When.
    pub holds: Condition,
}

/// A condition for [`Equivalent`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// At the other of two springs in series with nothing measured between them.
    InSeries,
    /// Likewise, if the stiffness of either is free and could be the other's.
    InSeriesWithFreeStiffness,
    /// At the same channel, while the amplitude is below this share of the sample time.
    ShorterThanSamples(f64),
    /// While the place always turns the same way.
    OneDirection,
    /// Anything else, as a clause.
    Stated(&'static str),
}
