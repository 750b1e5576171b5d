//! Recordings that determine an effect and separate it from its equivalents.

/// A recording that determines an effect and separates it from competing effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Experiment {
    /// Name of a built-in profile.
    pub profile: &'static str,
    /// Instruction for the experiment and its reason; completes a sentence that begins with "Record `PROFILE`".
    pub how: &'static str,
    /// To separate two effects, the experiment with the higher number is proposed: it is the more specific one.
    pub precedence: u8,
    /// Instructions for a rig that is measured in steady states; `None` where none are specific to the effect.
    pub steady: Option<SteadyExperiment>,
}

/// Instructions for a rig that is measured in steady states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SteadyExperiment {
    /// Name of a built-in profile.
    pub profile: &'static str,
    /// Whole sentences.
    pub sentences: &'static str,
}

/// Steady speeds under two loads.
pub(super) const TWO_LOADS: Experiment = Experiment {
    profile: "steps",
    how: "at several steady speeds, with the load's torque changed between two such recordings: a gain keeps its share, a loss does not",
    precedence: 3,
    steady: None,
};

/// [`TWO_LOADS`] for a loss proportional to the transmitted torque.
pub(super) const DRIVEN_BY_LOAD: Experiment = Experiment {
    steady: Some(SteadyExperiment {
        profile: "reversals",
        sentences: "Record `reversals`: while the bench slows down its load drives it, and a loss then reduces the torque on the \
                    other side, whereas a wrong gain stays the same. Or hang a known weight from a lever at either torque sensor while nothing \
                    turns: a wrong gain shows there, a loss does not.",
    }),
    ..TWO_LOADS
};

/// Slow motion through standstill.
pub(super) const THROUGH_STANDSTILL: Experiment = Experiment {
    profile: "triangle",
    how: "slowly through standstill and back, several times: that is where they differ",
    precedence: 2,
    steady: None,
};

/// Fast motion.
pub(super) const FAST_MOTION: Experiment = Experiment {
    profile: "chirp",
    how: "up to the highest frequency that the drive can follow: they differ in fast motion",
    precedence: 1,
    steady: None,
};

/// Large torques.
pub const LARGE_TORQUE: Experiment = Experiment {
    profile: "prbs",
    how: "with as much torque as the bench allows: they differ at large torque",
    precedence: 0,
    steady: None,
};
