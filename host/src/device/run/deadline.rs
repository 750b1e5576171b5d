//! Planned end of a run, and the interpretation of a run that ends at another time.

/// Largest time by which a profile may end earlier than planned, by the last sample that arrived: the samples after it may be lost.
const EARLY_NS: i64 = 500_000_000;

/// Largest time by which a run may exceed its plan before the host stops it; then the time in which the board must come to rest.
const OVER_NS: i64 = 2_000_000_000;
const REST_NS: i64 = 10_000_000_000;

/// The end of a profile.
pub(super) struct Deadline {
    /// Duration of the profile, ns, without its ramp.
    planned_ns: i64,
    /// Duration of the ramp at its end, ns.
    ramp_ns: i64,
    /// Whether the host has stopped the run.
    is_missed: bool,
}

/// Action on a run that lasts too long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Overdue {
    No,
    Stop,
    GiveUp,
}

impl Deadline {
    pub(super) fn new([planned_us, ramp_us]: [u64; 2]) -> Self {
        let ns = |us: u64| i64::try_from(us.saturating_mul(1000)).unwrap_or(i64::MAX);
        Self { planned_ns: ns(planned_us), ramp_ns: ns(ramp_us), is_missed: false }
    }

    /// Action on a run that has lasted until now; it is stopped only once.
    pub(super) fn check(&mut self, now_ns: i64) -> Overdue {
        let over_ns = now_ns - self.planned_ns.saturating_add(self.ramp_ns);
        match over_ns {
            OVER_NS.. if !self.is_missed => {
                self.is_missed = true;
                Overdue::Stop
            }
            over_ns if over_ns > OVER_NS + REST_NS => Overdue::GiveUp,
            _ => Overdue::No,
        }
    }

    /// Why a run that the board has ended by now is broken; `None` where it is not.
    pub(super) fn broken(&self, now_ns: i64) -> Option<String> {
        let [ended_s, planned_s] = [now_ns, self.planned_ns].map(|ns| ns as f64 * 1e-9);
        if self.is_missed {
            return Some(format!(
                "the board went on after the end of its profile of {planned_s:.3} s, so the host stopped it"
            ));
        }
        // A board at rest before the end of its profile names no reason: it has restarted.
        (now_ns < self.planned_ns - EARLY_NS).then(|| {
            format!(
                "the board went to rest without a reason after {ended_s:.3} s of a profile of {planned_s:.3} s, \
                 as after a loss of power: check its supply and cable, then record again"
            )
        })
    }

    /// Message about a board that does not stop either.
    pub(super) fn given_up(&self) -> String {
        format!(
            "the board does not end its profile of {:.3} s and does not stop: use the bench's emergency stop",
            self.planned_ns as f64 * 1e-9
        )
    }
}
