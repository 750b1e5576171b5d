//! Faults: why the output was cut, in numbers and in words.

use core::fmt;

/// The cause of a fault. Channels are indices into [`crate::Config::channels`]; [`Fault::with_names`] prints their names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Fault {
    /// The emergency stop was requested by the host.
    EmergencyStop,
    /// The emergency stop's contact at the bench is open.
    EmergencyStopInput,
    /// No request of the host for too long.
    HostSilent {
        /// The configured limit.
        timeout_us: u32,
    },
    /// A shaft turns too fast.
    OverSpeed {
        /// Channel that measured it.
        channel: u8,
        /// Measured, in urad/s.
        value_micro: i32,
        /// Allowed, in urad/s.
        limit_micro: i32,
    },
    /// A torque is too large.
    OverTorque {
        /// Channel that measured it.
        channel: u8,
        /// Measured, in uN m.
        value_micro: i32,
        /// Allowed, in uN m.
        limit_micro: i32,
    },
    /// Another quantity exceeds its limit.
    OverLimit {
        /// Channel that measured it.
        channel: u8,
        /// Measured, in millionths of the channel's unit.
        value_micro: i32,
        /// Allowed, in millionths of the channel's unit.
        limit_micro: i32,
    },
    /// A reading is at the converter's rail.
    SensorSaturated {
        /// Channel that reads it.
        channel: u8,
        /// The reading.
        count: i32,
    },
    /// A reading repeats exactly although the bench moves.
    SensorStuck {
        /// Channel that reads it.
        channel: u8,
        /// The reading.
        count: i32,
        /// For how long.
        for_us: u32,
    },
    /// A sensor gives no signal although the bench should move.
    SensorMissing {
        /// Channel that reads it.
        channel: u8,
        /// The last reading, in millionths of the channel's unit.
        value_micro: i32,
        /// The command at that moment.
        output_uv: i32,
    },
    /// The input converter did not answer.
    ConverterSilent,
    /// The output converter did not answer.
    OutputSilent,
    /// The cable to the host was pulled.
    CablePulled,
    /// The hardware watchdog restarted the board: its program hung or gave up.
    Watchdog,
    /// The board was reset from outside.
    Reset,
    /// All inputs read the same count.
    ConverterStuck {
        /// The reading.
        count: i32,
    },
    /// The drive's enable line is not where the board put it.
    EnableStuck {
        /// Whether the line reads as enabled.
        is_on: bool,
    },
    /// The configuration, the profile or the state in the board's memory is not what was written there.
    Corrupted,
    /// The board lost its supply in a run.
    PowerLost,
    /// A run lasted longer, by the clock, than its profile or the board allows.
    RunTooLong {
        /// Longest time that the profile and the board allow, µs.
        limit_us: u64,
    },
    /// The board's program is not the one that was flashed.
    ImageDamaged,
    /// The processor's clock and the timer disagree.
    ClockOff,
    /// A current is too large.
    OverCurrent {
        /// Channel that measured it.
        channel: u8,
        /// Measured, in uA.
        value_micro: i32,
        /// Allowed, in uA.
        limit_micro: i32,
    },
    /// The motor's supply is too low, or gone.
    SupplyLow {
        /// Channel that measured it.
        channel: u8,
        /// Measured.
        supply_uv: i32,
        /// Allowed.
        lowest_uv: i32,
    },
    /// The motor stands still under voltage.
    Stalled {
        /// Channel of its current.
        channel: u8,
        /// The current.
        current_ua: i32,
        /// The voltage at the motor.
        output_uv: i32,
    },
    /// The motor turns, by the voltage that its winding does not take, and its encoder does not count.
    EncoderSilent {
        /// Channel of the encoder's speed.
        channel: u8,
        /// The encoder's speed, urad/s.
        value_micro: i32,
        /// The speed by the winding, urad/s.
        expected_micro: i32,
    },
    /// The encoder counts against the motor's direction.
    EncoderReversed {
        /// Channel of the encoder's speed.
        channel: u8,
        /// The encoder's speed, urad/s.
        value_micro: i32,
        /// The speed by the winding, urad/s.
        expected_micro: i32,
    },
    /// The torque transducer's converter gives no valid conversion.
    TransducerSilent {
        /// Its channel.
        channel: u8,
        /// For how long.
        for_us: u32,
    },
}

impl Fault {
    /// Number of the fault, the same in all versions.
    pub fn code(&self) -> u8 {
        match self {
            Self::EmergencyStop => 1,
            Self::EmergencyStopInput => 2,
            Self::HostSilent { .. } => 3,
            Self::OverSpeed { .. } => 4,
            Self::OverTorque { .. } => 5,
            Self::OverLimit { .. } => 6,
            Self::SensorSaturated { .. } => 7,
            Self::SensorStuck { .. } => 8,
            Self::SensorMissing { .. } => 9,
            Self::ConverterSilent => 10,
            Self::OutputSilent => 11,
            Self::CablePulled => 12,
            Self::Watchdog => 13,
            Self::Reset => 14,
            Self::ConverterStuck { .. } => 15,
            Self::EnableStuck { .. } => 16,
            Self::Corrupted => 17,
            Self::PowerLost => 18,
            Self::RunTooLong { .. } => 19,
            Self::ImageDamaged => 20,
            Self::ClockOff => 21,
            Self::OverCurrent { .. } => 22,
            Self::SupplyLow { .. } => 23,
            Self::Stalled { .. } => 24,
            Self::EncoderSilent { .. } => 25,
            Self::EncoderReversed { .. } => 26,
            Self::TransducerSilent { .. } => 27,
        }
    }

    /// The sentence with the channels' names in place of their numbers.
    pub fn with_names<'a>(&'a self, names: &'a [&'a str]) -> impl fmt::Display + 'a {
        Sentence { fault: self, names }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Sentence { fault: self, names: &[] }.fmt(f)
    }
}

struct Sentence<'a> {
    fault: &'a Fault,
    names: &'a [&'a str],
}

impl fmt::Display for Sentence<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |channel: u8| Name { channel, name: self.names.get(usize::from(channel)).copied() };
        let over = |f: &mut fmt::Formatter<'_>, what: &str, channel, value_micro, limit_micro, unit: &str| {
            let (value, limit) = (Milli(value_micro), Milli(limit_micro));
            write!(f, "{what}{} is {value}{unit}, the limit is {limit}{unit}", name(channel))
        };
        match *self.fault {
            Fault::EmergencyStop => f.write_str("emergency stop by the host"),
            Fault::EmergencyStopInput => f.write_str("emergency stop: the contact at the bench is open"),
            Fault::HostSilent { timeout_us } => {
                write!(
                    f,
                    "no word from the host for {} ms: check the cable and that the host still runs",
                    timeout_us / 1000
                )
            }
            Fault::OverSpeed { channel, value_micro, limit_micro } => {
                over(f, "over-speed: ", channel, value_micro, limit_micro, " rad/s")
            }
            Fault::OverTorque { channel, value_micro, limit_micro } => {
                over(f, "over-torque: ", channel, value_micro, limit_micro, " N m")
            }
            Fault::OverLimit { channel, value_micro, limit_micro } => {
                over(f, "", channel, value_micro, limit_micro, "")
            }
            Fault::SensorSaturated { channel, count } => write!(
                f,
                "{} is saturated: it reads {count} counts, the end of the converter's range",
                name(channel)
            ),
            Fault::SensorStuck { channel, count, for_us } => write!(
                f,
                "{} is stuck: it read {count} counts for {} ms while the bench was driven",
                name(channel),
                for_us / 1000
            ),
            Fault::SensorMissing { channel, value_micro, output_uv } => write!(
                f,
                "{} is missing, or its shaft is locked: it reads {} at a command of {} V",
                name(channel),
                Milli(value_micro),
                Milli(output_uv)
            ),
            Fault::ConverterSilent => {
                f.write_str("the input converter does not answer: check its supply and wiring")
            }
            Fault::OutputSilent => {
                f.write_str("the output converter does not answer: check its supply and wiring")
            }
            Fault::CablePulled => f.write_str("the cable to the host was pulled"),
            Fault::Watchdog => f.write_str("the board's program hung and its watchdog restarted it"),
            Fault::Reset => f.write_str("the board was reset"),
            Fault::ConverterStuck { count } => write!(
                f,
                "all inputs read the same {count} counts: the input converter repeats itself, or its inputs are tied together"
            ),
            Fault::EnableStuck { is_on } => {
                let (is, set) = if is_on { ("high", "low") } else { ("low", "high") };
                write!(
                    f,
                    "the drive's enable line is {is} although the board set it {set}: switch the drive off, then check the line"
                )
            }
            Fault::Corrupted => f.write_str(
                "the board's memory lost a bit of its configuration, profile or state: record again, and replace the board if it recurs",
            ),
            Fault::PowerLost => f.write_str("the board lost its supply in a run: check supply and wiring"),
            Fault::RunTooLong { limit_us } => {
                let (s, tenths) = (limit_us / 1_000_000, limit_us / 100_000 % 10);
                write!(f, "the run lasted longer than the {s}.{tenths} s that the board allows it")
            }
            Fault::ImageDamaged => {
                f.write_str("the program in the board's flash is damaged: flash the board again")
            }
            Fault::ClockOff => f.write_str(
                "the processor's clock and the timer disagree: check the supply, and replace the board if it recurs",
            ),
            Fault::OverCurrent { channel, value_micro, limit_micro } => {
                over(f, "over-current: ", channel, value_micro, limit_micro, " A")
            }
            Fault::SupplyLow { channel, supply_uv, lowest_uv } => write!(
                f,
                "the motor's supply is low or gone: {} is {} V, the least is {} V",
                name(channel),
                Milli(supply_uv),
                Milli(lowest_uv)
            ),
            Fault::Stalled { channel, current_ua, output_uv } => write!(
                f,
                "the motor is stalled: {} is {} A at {} V and its shaft stands still",
                name(channel),
                Milli(current_ua),
                Milli(output_uv)
            ),
            Fault::EncoderSilent { channel, value_micro, expected_micro } => write!(
                f,
                "{} is {} rad/s, but the motor turns at about {} rad/s by its voltage and current: the encoder or its wires are broken, or its \
                 shaft slips",
                name(channel),
                Milli(value_micro),
                Milli(expected_micro)
            ),
            Fault::EncoderReversed { channel, value_micro, expected_micro } => write!(
                f,
                "{} is {} rad/s, but the motor turns at about {} rad/s by its voltage and current: swap the encoder's wires A and B, or the \
                 sign of its counts_per_turn",
                name(channel),
                Milli(value_micro),
                Milli(expected_micro)
            ),
            Fault::TransducerSilent { channel, for_us } => write!(
                f,
                "{} is silent: its converter has sent no valid conversion for {} ms; check its supply and both wires, or record with a \
                 calibration without it",
                name(channel),
                for_us / 1000
            ),
        }
    }
}

struct Name<'a> {
    channel: u8,
    name: Option<&'a str>,
}

impl fmt::Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name {
            Some(name) => f.write_str(name),
            None => write!(f, "channel {}", self.channel),
        }
    }
}

/// Millionths, printed in units with three decimals.
pub(crate) struct Milli(pub(crate) i32);

impl fmt::Display for Milli {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let thousandths = self.0.unsigned_abs() / 1000;
        let sign = if self.0 < 0 { "-" } else { "" };
        write!(f, "{sign}{}.{:03}", thousandths / 1000, thousandths % 1000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn sentences_name_channel_value_and_limit() {
        let fault = Fault::OverTorque { channel: 3, value_micro: -38_250_400, limit_micro: 38_000_000 };
        assert_eq!(fault.to_string(), "over-torque: channel 3 is -38.250 N m, the limit is 38.000 N m");
        let names = ["motor_speed", "output_speed", "torque_in", "torque_out"];
        assert!(fault.with_names(&names).to_string().starts_with("over-torque: torque_out is"));
    }
}
