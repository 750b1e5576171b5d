//! The board: a Raspberry Pi Pico with an ADS8688 and an AD5761R. Wiring, lights and faults: `docs/firmware.md`.
//!
//! All decisions are made in `socam-core`; this program provides converters, lines, a clock and a link to the host.
#![no_std]
#![no_main]
// The linker's message is the use of flash and memory.
#![warn(linker_messages)]

mod boot;
mod bus;
mod clock;
mod divider;
mod drive;
mod guard;
mod hardware;
mod image;
mod light;
mod link;
mod sampling;
mod slot;
mod start;
mod watchdog;

use embassy_executor::Spawner;
use embassy_rp::gpio::{Input, Level, Output, Pull};
use embassy_rp::pac;
use embassy_rp::spi::{Phase, Polarity, Spi};
use socam_converters::{Ad5761r, Ads8688};
use socam_core::Config;
use socam_wire::{BoardKind, FrontEnd, Text};

use bus::Chip;
use drive::Drive;
use hardware::{Hardware, Lines};

/// The drive's enable line.
const ENABLE_PIN: u8 = 22;
/// Changes at every conversion while the program is alive, for a watchdog outside of the board.
const ALIVE_PIN: u8 = 2;
/// The output converter's reset line.
const OUTPUT_RESET_PIN: u8 = 14;
/// Lines that are released before the processor is reset.
const RELEASED: u32 = 1 << ENABLE_PIN | 1 << OUTPUT_RESET_PIN;

/// Below the ADS8688's 17 MHz; both controllers divide 125 MHz by 8.
const SPI_HZ: u32 = 15_625_000;

/// Time from one channel's conversion to the next: 48 clock edges and the gaps between them. `tests/tests/board.rs` measures it.
const CHANNEL_STEP_NS: u32 = 3_700;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_rp::init(Default::default());
    boot::protect();
    let drive = Drive::new(p.PIN_22, p.PIN_20, p.PIN_21);
    // Never dropped, and so driven from now on.
    core::mem::forget(Output::new(p.PIN_2, Level::Low));
    let output_reset = Output::new(p.PIN_14, Level::Low);
    let stop = Input::new(p.PIN_15, Pull::Down);
    let cable = Input::new(p.PIN_24, Pull::None);
    // Clock 18, data out 19, data in 16, select 17.
    let _inputs = Spi::new_blocking(p.SPI0, p.PIN_18, p.PIN_19, p.PIN_16, spi());
    let input = Chip::new(pac::SPI0, Output::new(p.PIN_17, Level::High));
    // Clock 10, data out 11, data in 12, select 13.
    let _outputs = Spi::new_blocking(p.SPI1, p.PIN_10, p.PIN_11, p.PIN_12, spi());
    let output = Chip::new(pac::SPI1, Output::new(p.PIN_13, Level::High));
    let about = boot::About {
        board: Text::new("Raspberry Pi Pico, ADS8688, AD5761R"),
        front_end: FrontEnd {
            kind: BoardKind::Analog,
            input_full_scale_uv: Ads8688::<Chip>::FULL_SCALE_UV,
            output_full_scale_uv: Ad5761r::<Chip>::FULL_SCALE_UV,
            channel_step_ns: CHANNEL_STEP_NS,
        },
        enable_feedback: drive.feedback(),
    };
    let lines = Lines { output_reset, drive, stop, cable };
    let hardware = Hardware::new(input, output, lines, Config::default().sample_period_us);
    boot::run(spawner, hardware, about, p.USB, Output::new(p.PIN_25, Level::Low));
    core::future::pending().await
}

fn spi() -> embassy_rp::spi::Config {
    let mut config = embassy_rp::spi::Config::default();
    config.frequency = SPI_HZ;
    // Both converters sample data at the falling edge.
    config.polarity = Polarity::IdleLow;
    config.phase = Phase::CaptureOnSecondTransition;
    config
}
