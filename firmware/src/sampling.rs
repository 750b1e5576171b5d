//! The sampling interrupt: the only code that accesses the board's core.
//!
//! It has the highest priority and runs at every conversion, a few times per sample. Other code puts its request to the
//! core into a slot and pends the interrupt, so that no lock ever delays it.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};

use critical_section::Mutex;
use embassy_rp::interrupt;
use embassy_rp::pac;
use socam_core::{Board, Fault, Layout, Refusal, Request, Status, conversions_per_sample};

use crate::clock::{Clocks, now_us};
use crate::hardware::Hardware;
use crate::slot::{Filler, Taker};
use crate::start;
use crate::watchdog;

/// Samples between sampling and sending: 0.2 s at 5 kHz.
pub(crate) const RING_SAMPLES: usize = 1024;

/// The timer alarm of sampling; alarm 0 is embassy's.
const ALARM: usize = 1;

/// A request is postponed when the next conversion is nearer than this; requests that are allowed during a run take less.
const REQUEST_TAKES_US: u32 = 25;

/// The alarm is this much before a conversion and the rest is busy waiting, so code that disables interrupts for less than this does
/// not shift a sampling instant.
const AWAITED_US: u32 = 4;

/// Most missed conversions that are repeated at once. After a longer pause the sampling interval restarts.
const MADE_UP_FOR: u32 = 64;

/// A request to the core.
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub(crate) enum Ask {
    /// A request of the host.
    Request(Request),
    /// State and counters.
    Status,
}

/// An answer of the core.
pub(crate) struct Answer {
    pub(crate) result: Result<(), Refusal>,
    pub(crate) status: Status,
    pub(crate) layout: Layout,
}

/// State and fault of the core for read-only use: the state's code plus 256 times the fault's.
pub(crate) static STATE_AND_FAULT: AtomicU32 = AtomicU32::new(0);

static SAMPLER: Mutex<RefCell<Option<Sampler>>> = Mutex::new(RefCell::new(None));

/// The data of the interrupt.
pub(crate) struct Sampler {
    board: Board<'static, Hardware, RING_SAMPLES>,
    asks: Taker<'static, Ask>,
    answers: Filler<'static, Answer>,
    period_us: u32,
    /// Two to the power of this is the number of conversions in a sampling interval.
    log2_conversions: u32,
    /// Start of the current sampling interval, on the timer's lower half.
    interval_us: u32,
    /// Time of the next conversion.
    next_us: u32,
    clocks: Clocks,
}

/// Passes the data to the interrupt and starts it.
pub(crate) fn start(
    board: Board<'static, Hardware, RING_SAMPLES>,
    asks: Taker<'static, Ask>,
    answers: Filler<'static, Answer>,
) {
    let clocks = Clocks::now(now_us());
    let mut sampler = Sampler {
        board,
        asks,
        answers,
        period_us: 0,
        log2_conversions: 0,
        interval_us: 0,
        next_us: 0,
        clocks,
    };
    sampler.keep_pace();
    critical_section::with(|cs| SAMPLER.borrow(cs).replace(Some(sampler)));
    pac::TIMER.inte().modify(|inte| inte.set_alarm(ALARM, true));
    cortex_m::peripheral::NVIC::unpend(interrupt::TIMER_IRQ_1);
    // SAFETY: the data that the interrupt needs are in place.
    unsafe { cortex_m::peripheral::NVIC::unmask(interrupt::TIMER_IRQ_1) };
}

/// Pends the interrupt, so that it reads its slot.
pub(crate) fn nudge() {
    cortex_m::peripheral::NVIC::pend(interrupt::TIMER_IRQ_1);
}

#[interrupt]
fn TIMER_IRQ_1() {
    critical_section::with(|cs| {
        if let Ok(mut sampler) = SAMPLER.borrow(cs).try_borrow_mut()
            && let Some(sampler) = sampler.as_mut()
        {
            sampler.interrupt();
        }
    });
}

impl Sampler {
    fn interrupt(&mut self) {
        pac::TIMER.intr().write(|intr| intr.set_alarm(ALARM, true));
        if self.time_left_us() <= AWAITED_US {
            while self.time_left_us() > 0 {}
            self.convert();
        } else if self.time_left_us() >= REQUEST_TAKES_US {
            self.answer();
        }
    }

    /// Time until the next conversion, 0 when it is due.
    fn time_left_us(&self) -> u32 {
        let left_us = self.next_us.wrapping_sub(now_us());
        if left_us < 1 << 31 { left_us } else { 0 }
    }

    /// One conversion, and the tick that it may complete.
    fn convert(&mut self) {
        let is_sample = self.board.ports_mut().convert();
        self.step();
        if !self.clocks.agree(now_us()) {
            self.board.latch(Fault::ClockOff);
        }
        if is_sample {
            self.board.tick();
            self.tell_mood();
        } else {
            self.board.prepare();
        }
        watchdog::feed();
        self.catch_up();
    }

    /// Advances to the next conversion.
    fn step(&mut self) {
        let position = self.board.ports_mut().position();
        if position == 0 {
            self.interval_us = self.interval_us.wrapping_add(self.period_us);
        }
        let passed_us =
            position.wrapping_add(1).wrapping_mul(self.period_us).wrapping_shr(self.log2_conversions);
        self.next_us = self.interval_us.wrapping_add(passed_us);
        pac::TIMER.alarm(ALARM).write_value(self.next_us.wrapping_sub(AWAITED_US));
    }

    /// Sets the alarm. An alarm in the past would never occur, so conversions whose time has passed are skipped.
    fn catch_up(&mut self) {
        for _ in 0..MADE_UP_FOR {
            let left_us = self.time_left_us();
            if left_us > AWAITED_US || pac::TIMER.intr().read().alarm(ALARM) {
                return;
            }
            if left_us > 0 {
                nudge();
                return;
            }
            self.board.ports_mut().skip();
            self.step();
        }
        self.begin();
    }

    /// Starts a sampling interval now.
    fn begin(&mut self) {
        self.board.ports_mut().restart(self.period_us);
        // The first conversion is one step after the start.
        self.interval_us = now_us().wrapping_sub(self.period_us);
        self.step();
    }

    /// Applies the configured sampling period.
    fn keep_pace(&mut self) {
        let period_us = self.board.config().sample_period_us;
        if period_us != self.period_us {
            self.period_us = period_us;
            self.log2_conversions = conversions_per_sample(period_us).trailing_zeros();
            self.begin();
        }
    }

    fn answer(&mut self) {
        if !self.answers.has_room() {
            return;
        }
        let Some(ask) = self.asks.take() else { return };
        let begins = matches!(ask, Ask::Request(Request::Run));
        let configures = matches!(ask, Ask::Request(Request::Configure(_)));
        let result = match ask {
            Ask::Request(request) => self.board.handle(request),
            Ask::Status => Ok(()),
        };
        if begins {
            // The next tick is the first, possibly without a conversion before it.
            self.board.prepare();
        }
        // Nowhere else: a tick verifies the configuration before it is used, and this is before that.
        if configures && result.is_ok() {
            self.keep_pace();
        }
        self.tell_mood();
        let layout = self.board.layout();
        self.answers.put(Answer { result, status: self.board.status(), layout });
    }

    fn tell_mood(&self) {
        let status = self.board.status();
        let fault = status.fault.map_or(0, |fault| fault.code());
        start::note(status.state.is_live());
        STATE_AND_FAULT.store(u32::from(status.state.code()) | u32::from(fault) << 8, Ordering::Relaxed);
    }
}
