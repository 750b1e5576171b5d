//! The state machine of CiA 402 (IEC 61800-7-201): which controlword (6040) leads where.

use super::place::Place;

/// The controlword.
pub(super) const CONTROLWORD: Place = (0x6040, 0);

/// Commands of the controlword.
const DISABLE_VOLTAGE: u16 = 0x00;
const QUICK_STOP: u16 = 0x02;
const SHUTDOWN: u16 = 0x06;
const SWITCH_ON: u16 = 0x07;
const ENABLE: u16 = 0x0f;
const RESET: u16 = 0x80;

/// State of a drive, as far as commands need it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    /// It initialises itself, or reacts to a fault.
    Busy,
    Disabled,
    ReadyToSwitchOn,
    SwitchedOn,
    Enabled,
    QuickStop,
    Fault,
}

impl State {
    /// The state that a statusword states.
    pub(super) fn of(word: u16) -> Self {
        match (word & 0x4f, word & 0x6f) {
            (0x40, _) => Self::Disabled,
            (0x08, _) => Self::Fault,
            (_, 0x21) => Self::ReadyToSwitchOn,
            (_, 0x23) => Self::SwitchedOn,
            (_, 0x27) => Self::Enabled,
            (_, 0x07) => Self::QuickStop,
            _ => Self::Busy,
        }
    }

    /// Controlwords that lead towards operation; a fault is reset by an edge of its bit.
    pub(super) fn towards_operation(self) -> &'static [u16] {
        match self {
            Self::Busy | Self::Enabled => &[],
            Self::Disabled => &[SHUTDOWN],
            Self::ReadyToSwitchOn => &[SWITCH_ON],
            Self::SwitchedOn => &[ENABLE],
            Self::QuickStop => &[DISABLE_VOLTAGE],
            Self::Fault => &[DISABLE_VOLTAGE, RESET],
        }
    }

    /// The controlword of a stop: a quick stop while it is enabled; then, once it `is_still`, the voltage is off.
    pub(super) fn towards_rest(self, is_still: bool) -> u16 {
        match self {
            Self::Enabled => QUICK_STOP,
            Self::QuickStop if !is_still => QUICK_STOP,
            _ => DISABLE_VOLTAGE,
        }
    }
}
