//! The gearmotor board: a Raspberry Pi Pico with two encoders and an H-bridge. Wiring, channels and faults: `docs/gearmotor.md`.
//!
//! All decisions are made in `socam-core`; this program provides encoders, bridge, converter, lines, a clock and a link to the host.
#![no_std]
#![no_main]
// The linker's message is the use of flash and memory.
#![warn(linker_messages)]

mod boot;
#[path = "gearmotor/bridge.rs"]
mod bridge;
mod clock;
#[path = "gearmotor/counters.rs"]
mod counters;
#[path = "gearmotor/currents.rs"]
mod currents;
mod divider;
mod drive;
mod guard;
#[path = "gearmotor/hardware.rs"]
mod hardware;
mod image;
mod light;
mod link;
mod sampling;
mod slot;
mod start;
#[path = "gearmotor/transducer.rs"]
mod transducer;
mod watchdog;

use embassy_executor::Spawner;
use embassy_rp::gpio::{Input, Level, Output, Pull};
use socam_core::Config;
use socam_wire::{BoardKind, FrontEnd, Text};

use bridge::Bridge;
use counters::Counters;
use currents::Currents;
use drive::Drive;
use hardware::{Hardware, Lines};
use transducer::Transducer;

/// The bridge's enable line.
const ENABLE_PIN: u8 = 22;
/// Changes at every conversion while the program is alive, for a watchdog outside of the board.
const ALIVE_PIN: u8 = 2;
/// Lines that are released before the processor is reset: the bridge is off without its enable line.
const RELEASED: u32 = 1 << ENABLE_PIN;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_rp::init(Default::default());
    boot::protect();
    let drive = Drive::new(p.PIN_22, p.PIN_20, p.PIN_21);
    // Never dropped, and so driven from now on.
    core::mem::forget(Output::new(p.PIN_2, Level::Low));
    let stop = Input::new(p.PIN_15, Pull::Down);
    let cable = Input::new(p.PIN_24, Pull::None);
    // The core reads their edges from the pins' registers.
    core::mem::forget([Input::new(p.PIN_10, Pull::Down), Input::new(p.PIN_11, Pull::Down)]);
    let bridge = Bridge::start(p.PWM_SLICE0, (p.PIN_16, p.PIN_17));
    let counters = Counters::start(p.PIO0, (p.PIN_6, p.PIN_7), (p.PIN_8, p.PIN_9));
    let currents = Currents::start(p.ADC, (p.DMA_CH0, p.DMA_CH1), (p.PIN_26, p.PIN_27, p.PIN_28));
    let transducer = Transducer::start(p.PIO1, (p.PIN_12, p.PIN_13));
    let enable_feedback = drive.feedback();
    let lines = Lines { drive, stop, cable };
    let hardware =
        Hardware::new(counters, currents, transducer, bridge, lines, Config::default().sample_period_us);
    let front_end = FrontEnd {
        kind: BoardKind::Gearmotor,
        input_full_scale_uv: currents::FULL_SCALE_UV,
        output_full_scale_uv: hardware::COMMAND_FULL_SCALE_UV,
        channel_step_ns: currents::STEP_NS,
    };
    let about = boot::About { board: Text::new("Raspberry Pi Pico, gearmotor"), front_end, enable_feedback };
    boot::run(spawner, hardware, about, p.USB, Output::new(p.PIN_25, Level::Low));
    core::future::pending().await
}
