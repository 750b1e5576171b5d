//! The sampling interrupt: the only place that touches the board's core.
//!
//! It has the highest priority and runs at every conversion, a few times per sample. Whatever else wants something of the core
//! leaves it in a slot and pends the interrupt, so that no lock is ever held against it.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};

use critical_section::Mutex;
use embassy_rp::interrupt;
use embassy_rp::pac;
use socam_core::{Board, Refusal, Request, Status, conversions_per_sample};

use crate::hardware::Hardware;
use crate::slot::{Filler, Taker};
use crate::watchdog;

/// Samples between sampling and sending: 0.2 s at 5 kHz.
pub(crate) const RING_SAMPLES: usize = 1024;

/// The alarm of the timer that belongs to sampling; alarm 0 is embassy's.
const ALARM: usize = 1;

/// A request is not begun when the next conversion is nearer than this: those that are allowed while the bench runs take less.
const REQUEST_TAKES_US: u32 = 25;

/// The alarm rings so long before a conversion, and the rest is waited for: whatever keeps interrupts off for less than this shifts no
/// sampling instant.
const AWAITED_US: u32 = 4;

/// Conversions that may be made up for at once. Whoever stood still for longer begins anew.
const MADE_UP_FOR: u32 = 64;

/// What is asked of the core.
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub(crate) enum Ask {
    /// A request of the host.
    Request(Request),
    /// How it is doing.
    Status,
}

/// What the core says.
pub(crate) struct Answer {
    pub(crate) result: Result<(), Refusal>,
    pub(crate) status: Status,
    pub(crate) channels: u8,
}

/// State and fault of the core, for those who only watch: the state's code, and 256 times the fault's.
pub(crate) static MOOD: AtomicU32 = AtomicU32::new(0);

static SAMPLER: Mutex<RefCell<Option<Sampler>>> = Mutex::new(RefCell::new(None));

/// What the interrupt owns.
pub(crate) struct Sampler {
    board: Board<'static, Hardware, RING_SAMPLES>,
    asks: Taker<'static, Ask>,
    answers: Filler<'static, Answer>,
    period_us: u32,
    /// When the current sampling interval began, on the timer's lower half.
    interval_us: u32,
    /// When the next conversion is due.
    next_us: u32,
}

/// Hands everything to the interrupt and starts it.
pub(crate) fn start(
    board: Board<'static, Hardware, RING_SAMPLES>,
    asks: Taker<'static, Ask>,
    answers: Filler<'static, Answer>,
) {
    let mut sampler = Sampler { board, asks, answers, period_us: 0, interval_us: 0, next_us: 0 };
    sampler.keep_pace();
    critical_section::with(|cs| SAMPLER.borrow(cs).replace(Some(sampler)));
    pac::TIMER.inte().modify(|inte| inte.set_alarm(ALARM, true));
    cortex_m::peripheral::NVIC::unpend(interrupt::TIMER_IRQ_1);
    // SAFETY: the interrupt finds everything that it needs.
    unsafe { cortex_m::peripheral::NVIC::unmask(interrupt::TIMER_IRQ_1) };
}

/// Makes the interrupt look at its slot.
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

/// The timer's lower half, microseconds.
fn now_us() -> u32 {
    pac::TIMER.timerawl().read()
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
        if is_sample {
            self.board.tick();
            self.tell_mood();
        } else {
            self.board.prepare();
        }
        watchdog::feed();
        self.catch_up();
    }

    /// To the next conversion.
    fn step(&mut self) {
        let position = self.board.ports_mut().position();
        if position == 0 {
            self.interval_us = self.interval_us.wrapping_add(self.period_us);
        }
        let log2 = conversions_per_sample(self.period_us).trailing_zeros();
        let passed_us = position.wrapping_add(1).wrapping_mul(self.period_us) >> log2;
        self.next_us = self.interval_us.wrapping_add(passed_us);
        pac::TIMER.alarm(ALARM).write_value(self.next_us.wrapping_sub(AWAITED_US));
    }

    /// An alarm that was set in the past never rings: conversions whose time has passed meanwhile are left out.
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

    /// Begins a sampling interval now.
    fn begin(&mut self) {
        self.board.ports_mut().restart(self.period_us);
        // The first conversion is due one step after the beginning.
        self.interval_us = now_us().wrapping_sub(self.period_us);
        self.step();
    }

    /// Follows the configured sampling period.
    fn keep_pace(&mut self) {
        let period_us = self.board.config().sample_period_us;
        if period_us != self.period_us {
            self.period_us = period_us;
            self.begin();
        }
    }

    fn answer(&mut self) {
        if !self.answers.has_room() {
            return;
        }
        let Some(ask) = self.asks.take() else { return };
        let begins = matches!(ask, Ask::Request(Request::Run));
        let result = match ask {
            Ask::Request(request) => self.board.handle(request),
            Ask::Status => Ok(()),
        };
        if begins {
            // The first tick comes next, perhaps without a conversion before it.
            self.board.prepare();
        }
        self.keep_pace();
        self.tell_mood();
        let channels = self.board.config().channel_count;
        self.answers.put(Answer { result, status: self.board.status(), channels });
    }

    fn tell_mood(&self) {
        let status = self.board.status();
        let fault = status.fault.map_or(0, |fault| fault.code());
        MOOD.store(u32::from(status.state.code()) | u32::from(fault) << 8, Ordering::Relaxed);
    }
}
