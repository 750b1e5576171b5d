//! The kinds of boards.

use core::fmt;

/// What a board measures and drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BoardKind {
    /// Voltages of +-10 V in and out: the bench of the thesis.
    Analog,
    /// Encoders, currents and an H-bridge, see [`GearmotorChannel`].
    Gearmotor,
}

/// Order of a gearmotor board's channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum GearmotorChannel {
    MotorAngle,
    MotorSpeed,
    OutputAngle,
    OutputSpeed,
    MotorCurrent,
    /// Or a torque transducer, where the configuration says so ([`crate::ChannelKind::Transducer`]).
    SupplyCurrent,
    SupplyVoltage,
    MotorVoltage,
}

impl GearmotorChannel {
    /// Number of its channel.
    pub fn index(self) -> usize {
        self as usize
    }
}

impl fmt::Display for BoardKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Analog => "analog",
            Self::Gearmotor => "gearmotor",
        })
    }
}
