//! The trial of an ODrive's watchdog before it is commanded.
//!
//! CAN Simple can neither set nor read the watchdog or the limits of a drive. So the drive's own watchdog is tried at standstill: it is sent
//! nothing, and must report that its watchdog expired in time. It is told its limits, which it cannot confirm.

use crate::odrive::Generation;

/// Time beyond that of the watchdog until a heartbeat says that it expired: two intervals of heartbeats, within these bounds, ns.
const HEARTBEATS: i64 = 2;
const BOUNDS_NS: (i64, i64) = (20_000_000, 300_000_000);

/// How far the trial is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Trial {
    /// It has not begun.
    Waiting,
    /// The drive gets its settings, until a heartbeat states no error.
    Setting { since_ns: i64, is_tried: bool },
    /// Nothing is sent to it.
    Silent { since_ns: i64 },
    /// Its watchdog acted, and its error is cleared.
    Passed,
    /// It must not be commanded, for this reason.
    Failed(String),
}

impl Trial {
    /// Whether an error of the watchdog alone is part of it, as nobody feeds a drive that is not commanded.
    pub(super) fn expects_expiry(&self) -> bool {
        matches!(self, Self::Waiting | Self::Setting { .. } | Self::Silent { .. })
    }

    /// The drive is prepared from now on.
    pub(super) fn begin(&mut self, now_ns: i64) {
        if *self == Self::Waiting {
            *self = Self::Setting { since_ns: now_ns, is_tried: false };
        }
    }

    /// A heartbeat arrived that states this error, after [`Self::passes`].
    pub(super) fn heartbeat(&mut self, arrival_ns: i64, error: u64, generation: Generation) {
        match *self {
            Self::Setting { since_ns, is_tried } if error == 0 && arrival_ns > since_ns => {
                *self = if is_tried { Self::Passed } else { Self::Silent { since_ns: arrival_ns } };
            }
            Self::Silent { since_ns } if error == generation.watchdog() && arrival_ns > since_ns => {
                *self = Self::Setting { since_ns: arrival_ns, is_tried: true };
            }
            Self::Silent { .. } if error != 0 && error != generation.watchdog() => {
                *self = Self::Failed(format!(
                    "{}; clear it first, nothing was commanded",
                    generation.fault_text(error)
                ));
            }
            _ => {}
        }
    }

    /// Gives up where the watchdog, s, has not acted; heartbeats come at an interval, ns.
    pub(super) fn passes(&mut self, now_ns: i64, watchdog_s: f64, interval_ns: i64) {
        let most_ns = (watchdog_s * 1e9) as i64
            + interval_ns.saturating_mul(HEARTBEATS).clamp(BOUNDS_NS.0, BOUNDS_NS.1);
        if let Self::Silent { since_ns } = *self
            && now_ns.saturating_sub(since_ns) > most_ns
        {
            *self = Self::Failed(format!(
                "the ODrive's watchdog did not act within {watchdog_s} s of silence, so it is not commanded: by USB set its `config.watchdog_timeout` to {watchdog_s} or less and `config.enable_watchdog` to True, and save that"
            ));
        }
    }
}
