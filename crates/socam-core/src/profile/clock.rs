//! The phase of a shape whose period is a whole number of samples.

/// The phase of a periodic shape, as a fraction of 2^32. Sample n has floor(n * 2^32 / period), without a division per sample and
/// without drift.
#[derive(Debug, Clone, Copy)]
pub(super) struct PeriodClock {
    phase: u32,
    /// The fraction of a count that `phase` truncates, in 1/`period`.
    rest: u32,
    phase_step: u32,
    rest_step: u32,
    period: u32,
    pub(super) periods: u16,
}

impl PeriodClock {
    /// `period` is at least 2.
    pub(super) fn new(period: u32) -> Self {
        let turn = 1u64 << 32;
        let divisor = u64::from(period.max(2));
        Self {
            phase: 0,
            rest: 0,
            phase_step: turn.checked_div(divisor).unwrap_or(0) as u32,
            rest_step: turn.checked_rem(divisor).unwrap_or(0) as u32,
            period: period.max(2),
            periods: 0,
        }
    }

    /// The phase at this sample; advances to the next.
    pub(super) fn step(&mut self) -> u32 {
        let phase = self.phase;
        // Both are below `period` <= 2^32 - 1; u64 keeps their sum.
        let rest = u64::from(self.rest).wrapping_add(u64::from(self.rest_step));
        let carry = rest >= u64::from(self.period);
        self.rest = if carry { rest.wrapping_sub(u64::from(self.period)) } else { rest } as u32;
        // phase_step < 2^31, so neither addition can wrap before the turn is full.
        let (next, wrapped) = phase.overflowing_add(self.phase_step.wrapping_add(u32::from(carry)));
        self.phase = next;
        self.periods = self.periods.wrapping_add(u16::from(wrapped));
        phase
    }
}
