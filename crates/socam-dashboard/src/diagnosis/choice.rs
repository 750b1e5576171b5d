//! The residuals of a diagnosis that are drawn, and their horizontal axis.

/// Residuals that are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// Residuals of the model without the findings.
    Before,
    /// Residuals of the model with the findings added.
    After,
    /// Both.
    #[default]
    Both,
}

/// The horizontal axis of the residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(missing_docs, reason = "each is named by its tab")]
pub enum Over {
    Signals,
    Shape,
    #[default]
    Speed,
    Angle,
    Torque,
    Frequency,
    Time,
    Fit,
}

impl Over {
    pub(super) const ALL: [Self; 8] = [
        Self::Signals,
        Self::Speed,
        Self::Angle,
        Self::Torque,
        Self::Frequency,
        Self::Time,
        Self::Shape,
        Self::Fit,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Signals => "measured and predicted",
            Self::Shape => "measured shape",
            Self::Speed => "over speed",
            Self::Angle => "over angle",
            Self::Torque => "over torque",
            Self::Frequency => "over frequency",
            Self::Time => "over time",
            Self::Fit => "fit",
        }
    }
}

/// The choice, with the selected channel and recording.
pub(super) struct Choice<'a> {
    pub(super) sides: Sides,
    pub(super) over: Over,
    pub(super) channel: &'a mut usize,
    pub(super) recording: &'a mut usize,
}
