//! What a profile commands.

use socam_core::Command;

/// The quantity that a profile commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProfileCommand {
    /// Voltage of a board's output, V.
    Voltage,
    /// Speed, rad/s; a board gives it by the motor's calibration alone.
    SpeedOpenLoop,
    /// Speed, rad/s; a board or a drive controls it.
    SpeedClosedLoop,
    /// Torque of a drive's motor, N m. No board takes it.
    Torque,
}

impl ProfileCommand {
    /// Whether it is a speed.
    #[must_use]
    pub fn is_speed(self) -> bool {
        matches!(self, Self::SpeedOpenLoop | Self::SpeedClosedLoop)
    }

    /// Symbol of its unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Voltage => "V",
            Self::SpeedOpenLoop | Self::SpeedClosedLoop => "rad/s",
            Self::Torque => "N m",
        }
    }

    /// What ends the keys of its levels in a file.
    pub(super) fn suffix(self) -> &'static str {
        match self {
            Self::Voltage => "V",
            Self::SpeedOpenLoop | Self::SpeedClosedLoop => "rad_s",
            Self::Torque => "Nm",
        }
    }

    /// The key of its largest rate of change in a file.
    pub(super) fn slew_key(self) -> &'static str {
        match self {
            Self::Voltage => "slew_V_s",
            Self::SpeedOpenLoop | Self::SpeedClosedLoop => "slew_rad_s2",
            Self::Torque => "slew_Nm_s",
        }
    }

    /// The command in the core's profile, which only samples the shape of a torque: that one never reaches a board.
    pub(super) fn of_board(self) -> Command {
        match self {
            Self::SpeedOpenLoop => Command::SpeedOpenLoop,
            Self::SpeedClosedLoop => Command::SpeedClosedLoop,
            Self::Voltage | Self::Torque => Command::Voltage,
        }
    }
}
