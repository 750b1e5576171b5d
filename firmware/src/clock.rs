//! The processor's clock against the timer's.
//!
//! Both come from the crystal, the processor's through a multiplier. Where that fails, the processor is slow while the timer goes on, and
//! ticks come late without being missed by it.

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use embassy_rp::pac;

/// Clock cycles of the processor per microsecond.
pub(crate) const CYCLES_PER_US: u32 = 125;

/// The counter has 24 bits, which last 134 ms.
const COUNTER: u32 = 0x00ff_ffff;
const LONGEST_US: u32 = 100_000;

/// Allowed difference: a sixteenth, and what two readings of whole microseconds leave.
const FRACTION_LOG2: u32 = 4;
const READINGS_CYCLES: u32 = 2 * CYCLES_PER_US;

/// The timer's lower half, microseconds.
pub(crate) fn now_us() -> u32 {
    pac::TIMER.timerawl().read()
}

/// The timer, microseconds.
pub(crate) fn whole_us() -> u64 {
    // Raw registers: the latching pair would disturb code that was interrupted between reading its two halves.
    let timer = pac::TIMER;
    loop {
        let high = timer.timerawh().read();
        let low = timer.timerawl().read();
        if timer.timerawh().read() == high {
            return u64::from(high) << 32 | u64::from(low);
        }
    }
}

/// Starts the counter of the processor's cycles.
pub(crate) fn start(counter: &mut SYST) {
    counter.set_clock_source(SystClkSource::Core);
    counter.set_reload(COUNTER);
    counter.clear_current();
    counter.enable_counter();
}

/// Both clocks at the latest check.
pub(crate) struct Clocks {
    us: u32,
    cycles: u32,
}

impl Clocks {
    /// The clocks now.
    pub(crate) fn now(us: u32) -> Self {
        Self { us, cycles: SYST::get_current() }
    }

    /// Whether both have advanced alike since the latest check.
    pub(crate) fn agree(&mut self, us: u32) -> bool {
        let before = core::mem::replace(self, Self::now(us));
        let passed_us = us.wrapping_sub(before.us);
        if passed_us > LONGEST_US {
            return true;
        }
        // The counter counts down.
        let cycles = before.cycles.wrapping_sub(self.cycles) & COUNTER;
        let expected = passed_us * CYCLES_PER_US;
        cycles.abs_diff(expected) <= (expected >> FRACTION_LOG2) + READINGS_CYCLES
    }
}
