//! Reason why the program started, and the fault to report from the time before.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_rp::pac;
use socam_core::Fault;
use socam_wire::Start;

use crate::watchdog;

/// Stands in [`RUNNING`] during a run.
const IN_A_RUN: u32 = 0x6e57_11c3;

/// Two words that nothing initialises: memory keeps them over a short loss of the supply. After a long one it holds something else
/// (these words by chance once in 2^64 times).
#[unsafe(link_section = ".uninit.RUNNING")]
static RUNNING: [AtomicU32; 2] = [AtomicU32::new(0), AtomicU32::new(0)];

/// Records whether the output is live. Must be called at every tick.
pub(crate) fn note(is_live: bool) {
    let word = if is_live { IN_A_RUN } else { 0 };
    let [plain, inverse] = &RUNNING;
    plain.store(word, Ordering::Relaxed);
    inverse.store(!word, Ordering::Relaxed);
}

fn was_running() -> bool {
    let [plain, inverse] = &RUNNING;
    plain.load(Ordering::Relaxed) == IN_A_RUN && inverse.load(Ordering::Relaxed) == !IN_A_RUN
}

/// Why the program started, and the fault to latch, if any. To be called once, before the first tick.
pub(crate) fn cause() -> (Start, Option<Fault>) {
    if pac::WATCHDOG.reason().read().0 != 0 {
        return (Start::Watchdog, watchdog::was_at_work().then_some(Fault::Watchdog));
    }
    let reset = pac::VREG_AND_CHIP_RESET.chip_reset().read();
    if reset.had_psm_restart() {
        (Start::Debugger, Some(Fault::Reset))
    } else if reset.had_run() {
        (Start::Pin, Some(Fault::Reset))
    } else {
        (Start::Supply, was_running().then_some(Fault::PowerLost))
    }
}
