//! The hardware watchdog, and the handlers of panics and faults.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_rp::pac;

use crate::clock::now_us;

/// Longest time without a conversion; after it the processor is reset and all lines go low. Conversions are at most 0.5 ms apart.
const BITES_AFTER_US: u32 = 1500;

/// Sampling feeds the watchdog only while the link's task has run within this time.
const LINK_MAY_REST_US: u32 = 1_000_000;

/// Marks, across a reset by the watchdog, that this program was running.
const AT_WORK: u32 = 0x50c4_a3be;

/// Time of the link task's last run.
static LINK_US: AtomicU32 = AtomicU32::new(0);

/// Whether this program ran before the watchdog reset the processor; the boot ROM uses the watchdog too.
pub(crate) fn was_at_work() -> bool {
    pac::WATCHDOG.scratch0().read() == AT_WORK
}

/// Starts the watchdog.
pub(crate) fn start() {
    link_is_at_work();
    pac::WATCHDOG.scratch0().write_value(AT_WORK);
    // Resets everything except the oscillators.
    pac::PSM.wdsel().write_value(pac::psm::regs::Wdsel(0x0001_fffc));
    feed();
    pac::WATCHDOG.ctrl().modify(|ctrl| {
        // By default it pauses where a debugger halts a core, and a halt in a run would leave the drive enabled.
        ctrl.set_pause_dbg0(cfg!(debug_assertions));
        ctrl.set_pause_dbg1(cfg!(debug_assertions));
        ctrl.set_pause_jtag(cfg!(debug_assertions));
        ctrl.set_enable(true);
    });
}

/// Restarts the watchdog's countdown. Must be called at every conversion.
pub(crate) fn feed() {
    let rested_us = now_us().wrapping_sub(LINK_US.load(Ordering::Relaxed));
    if rested_us < LINK_MAY_REST_US {
        // The watchdog counts down two per microsecond (erratum RP2040-E1).
        pac::WATCHDOG.load().write_value(pac::watchdog::regs::Load(2 * BITES_AFTER_US));
        pac::SIO.gpio_out(0).value_xor().write_value(1 << crate::ALIVE_PIN);
    }
}

/// Records that the link's task runs. Must be called by that task, with or without a host.
pub(crate) fn link_is_at_work() {
    LINK_US.store(now_us(), Ordering::Relaxed);
}

/// Disables the drive and resets the processor, which sets every line low.
fn give_up() -> ! {
    cortex_m::interrupt::disable();
    pac::SIO.gpio_oe(0).value_clr().write_value(crate::RELEASED);
    pac::WATCHDOG.scratch0().write_value(AT_WORK);
    pac::PSM.wdsel().write_value(pac::psm::regs::Wdsel(0x0001_fffc));
    pac::WATCHDOG.ctrl().modify(|ctrl| ctrl.set_trigger(true));
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    give_up()
}

#[cortex_m_rt::exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    give_up()
}
