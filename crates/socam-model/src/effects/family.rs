//! Families of effects: laws that recordings distinguish least from one another.

/// What a law has in common with others of its kind. Where recordings do not distinguish laws of one family, the family is the answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Torque that opposes the motion: friction, drag and losses.
    Friction,
    /// Springs, play and slip between two sides that move against each other.
    Elastic,
    /// Torques and motions that return with each turn, or at a frequency.
    Periodic,
    /// Torques from outside that do not depend on the motion, inertias, and the limits of the drive.
    Load,
    /// A channel that is late or slow.
    Timing,
    /// A channel that reads another value than the true one.
    Reading,
    /// A wave on top of a channel.
    Interference,
    /// A law of a model file, whose family nobody has stated.
    Own,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Friction,
        Self::Elastic,
        Self::Periodic,
        Self::Load,
        Self::Timing,
        Self::Reading,
        Self::Interference,
        Self::Own,
    ];

    /// Id, as in reports.
    #[must_use]
    pub fn id(self) -> &'static str {
        match self {
            Self::Friction => "friction",
            Self::Elastic => "elastic",
            Self::Periodic => "periodic",
            Self::Load => "load",
            Self::Timing => "timing",
            Self::Reading => "reading",
            Self::Interference => "interference",
            Self::Own => "own",
        }
    }

    /// Name within a sentence.
    ///
    /// ```
    /// use socam_model::effects::{self, Family};
    ///
    /// let backlash = effects::find("backlash").expect("an effect of the catalogue").family;
    /// assert_eq!((backlash, backlash.name()), (Family::Elastic, "elasticity, play or slip"));
    /// ```
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Friction => "friction, drag or a loss",
            Self::Elastic => "elasticity, play or slip",
            Self::Periodic => "something periodic",
            Self::Load => "a load, an inertia or a limit of the drive",
            Self::Timing => "a delay or a lag",
            Self::Reading => "a wrong reading",
            Self::Interference => "interference",
            Self::Own => "a law of the model file",
        }
    }

    /// Whether it is an error of a channel, not physics of the machine.
    #[must_use]
    pub fn is_of_a_sensor(self) -> bool {
        matches!(self, Self::Timing | Self::Reading | Self::Interference)
    }
}
