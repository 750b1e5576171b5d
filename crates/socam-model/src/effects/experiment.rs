//! Recordings in which effects show.

/// What to record so that an effect shows and parts from its rivals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Experiment {
    /// A built-in profile.
    pub profile: &'static str,
    /// How to run it, and why: the rest of a sentence that begins with "Record".
    pub how: &'static str,
    /// Of two effects to be told apart, the experiment with the higher number is the more particular one.
    pub precedence: u8,
    /// What to do on a rig that is measured in steady states, where there is something particular.
    pub steady: Option<SteadyExperiment>,
}

/// What to do on a rig that is measured in steady states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SteadyExperiment {
    /// A built-in profile.
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

/// [`TWO_LOADS`] for a share of the transmitted torque that is lost.
pub(super) const DRIVEN_BY_LOAD: Experiment = Experiment {
    steady: Some(SteadyExperiment {
        profile: "reversals",
        sentences: "Record `reversals`: whenever the bench slows down its load drives it, and then a loss takes from the other side \
                    while a wrong gain stays as it is. Or hang a known weight from a lever at either torque sensor while nothing \
                    turns: a wrong gain shows there, a loss does not.",
    }),
    ..TWO_LOADS
};

/// Slowly through standstill.
pub(super) const THROUGH_STANDSTILL: Experiment = Experiment {
    profile: "triangle",
    how: "slowly through standstill and back, several times: that is where they differ",
    precedence: 2,
    steady: None,
};

/// Fast motion.
pub(super) const FAST_MOTION: Experiment = Experiment {
    profile: "chirp",
    how: "up to the highest frequency that the drive can follow: they part where motion is fast",
    precedence: 1,
    steady: None,
};

/// Large torques.
pub const LARGE_TORQUE: Experiment = Experiment {
    profile: "prbs",
    how: "with as much torque as the bench allows: they part where torque is large",
    precedence: 0,
    steady: None,
};
