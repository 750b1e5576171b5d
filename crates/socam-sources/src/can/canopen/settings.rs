//! The objects of a drive that are written before it moves, and put back at the end.

use super::commands::{Marked, OwnLimit};
use super::place::Place;
use super::requests::Request;
use crate::drive::Limits;

/// Heartbeats that the drive waits for, its reaction to their absence, the mode of operation, that mode as it is, and the target velocity.
pub(super) const CONSUMER: Place = (0x1016, 1);
const REACTION: Place = (0x6007, 0);
const MODE: Place = (0x6060, 0);
const MODE_SHOWN: Place = (0x6061, 0);
pub(super) const TARGET: Place = (0x60ff, 0);
/// Abort connection option code: a quick stop.
const QUICK_STOP: u32 = 3;
/// Profile velocity: the drive keeps to its own acceleration (6083, 6084) between two targets.
const PROFILE_VELOCITY: u32 = 3;
/// Time without a heartbeat after which the drive reacts, as a share of that within which it must have stated so.
pub(super) const CONSUMER_SHARE: f64 = 0.8;

/// An object that is written before the drive moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Setting {
    pub(super) place: Place,
    /// Where it is read back.
    pub(super) shown: Place,
    pub(super) width: usize,
    pub(super) want: u32,
    /// A limit of the drive's own that is lower stays.
    pub(super) is_limit: bool,
    /// Its value before.
    pub(super) before: Option<u32>,
}

impl Setting {
    pub(super) fn write(&self, value: u32) -> Request {
        Request::Write(self.place, value.to_le_bytes()[..self.width].to_vec())
    }

    /// Whether it must be written, and put back later.
    pub(super) fn is_changed(&self) -> bool {
        self.before.is_some_and(|before| before != self.want)
    }
}

/// The settings of a drive whose list is marked like this; `effort_factor`: torque or current of one count.
pub(super) fn settings(marked: &Marked, limits: &Limits, effort_factor: f64) -> Vec<Setting> {
    let consumer_ms = (limits.watchdog_s * CONSUMER_SHARE * 1e3) as u32;
    let own = u32::from(marked.own_node) << 16 | consumer_ms;
    let setting =
        |place, shown, width, want, is_limit| Setting { place, shown, width, want, is_limit, before: None };
    let mut settings =
        vec![setting(CONSUMER, CONSUMER, 4, own, false), setting(REACTION, REACTION, 2, QUICK_STOP, false)];
    for limit in &marked.limits {
        let (index, width, want) = match limit {
            OwnLimit::ProfileVelocity => (0x607f, 4, limits.speed_rad_s / marked.factor.abs()),
            OwnLimit::MotorSpeed => (0x6080, 4, limits.speed_rad_s * 30.0 / std::f64::consts::PI),
            OwnLimit::Torque => (0x6072, 2, limits.effort / effort_factor.abs()),
            OwnLimit::Current => (0x6073, 2, limits.effort / effort_factor.abs()),
        };
        let most = if width == 2 { u32::from(u16::MAX) } else { i32::MAX as u32 };
        settings.push(setting((index, 0), (index, 0), width, (want as u32).min(most), true));
    }
    settings.push(setting(MODE, MODE_SHOWN, 1, PROFILE_VELOCITY, false));
    settings.push(setting(TARGET, TARGET, 4, 0, false));
    settings
}

/// What an object is for, in words.
pub(super) fn purpose(place: Place) -> &'static str {
    match place {
        CONSUMER => "the heartbeat that it waits for",
        REACTION => "its reaction where a heartbeat is missing",
        MODE => "its mode of operation, profile velocity",
        TARGET => "its target velocity",
        (0x607f, _) => "its largest profile velocity",
        (0x6080, _) => "its largest motor speed",
        (0x6072, _) => "its largest torque",
        _ => "its largest current",
    }
}
