//! The ticks of the sampling period: number of the present one, and number of missed ones.

/// Counts ticks of a fixed period since the first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Schedule {
    period_us: u32,
    /// Time at which the latest tick was due; `None` before the first.
    due_us: Option<u64>,
    tick: u32,
    overruns: u32,
}

impl Schedule {
    pub(crate) fn new(period_us: u32) -> Self {
        Self { period_us: period_us.max(1), due_us: None, tick: 0, overruns: 0 }
    }

    /// Sets a new period; tick numbers continue.
    pub(crate) fn set_period(&mut self, period_us: u32) {
        self.period_us = period_us.max(1);
        self.due_us = None;
    }

    /// Advances to a sampling instant at `now_us`; returns the number of ticks missed before it.
    pub(crate) fn advance(&mut self, now_us: u64) -> u32 {
        let Some(last_due_us) = self.due_us else {
            self.due_us = Some(now_us);
            self.tick = self.tick.wrapping_add(1);
            return 0;
        };
        let due_us = last_due_us.wrapping_add(u64::from(self.period_us));
        // Early, or the clock decreased: no tick was missed.
        let late_us = now_us.saturating_sub(due_us);
        let late_us = u32::try_from(late_us).unwrap_or(u32::MAX);
        // The common case avoids a division, which the board does in software.
        let missed =
            if late_us < self.period_us { 0 } else { late_us.checked_div(self.period_us).unwrap_or(0) };
        let skipped_us = u64::from(missed).wrapping_mul(u64::from(self.period_us));
        self.due_us = Some(due_us.wrapping_add(skipped_us));
        self.tick = self.tick.wrapping_add(1).wrapping_add(missed);
        self.overruns = self.overruns.saturating_add(missed);
        missed
    }

    /// Number of the latest tick; the first is 1.
    pub(crate) fn tick(&self) -> u32 {
        self.tick
    }

    /// Ticks missed since power-on.
    pub(crate) fn overruns(&self) -> u32 {
        self.overruns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_is_no_overrun_and_a_missed_tick_is_counted_once() {
        let mut schedule = Schedule::new(1000);
        let instants = [5, 1007, 2004, 3900, 4006, 7010, 8005];
        let missed: [u32; 7] = instants.map(|now| schedule.advance(now));
        assert_eq!(missed, [0, 0, 0, 0, 0, 2, 0]);
        assert_eq!((schedule.tick(), schedule.overruns()), (9, 2));
    }

    #[test]
    fn slow_drift_of_the_clock_does_not_accumulate_unseen() {
        // Interrupts every 1001 us instead of 1000: after 1000 of them one whole tick is missing.
        let mut schedule = Schedule::new(1000);
        let missed: u32 = (0..=1000).map(|i| schedule.advance(i * 1001)).sum();
        assert_eq!(missed, 1);
    }
}
