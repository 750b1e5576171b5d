//! The board: a Raspberry Pi Pico with an ADS8688 and an AD5761R. Wiring, lights and faults: `docs/firmware.md`.
//!
//! All decisions are made in `socam-core`; this program provides converters, lines, a clock and a link to the host.
#![no_std]
#![no_main]
// The linker's message is the use of flash and memory.
#![warn(linker_messages)]

mod bus;
mod clock;
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
use embassy_rp::interrupt::{self, InterruptExt, Priority};
use embassy_rp::peripherals::USB;
use embassy_rp::spi::{Phase, Polarity, Spi};
use embassy_rp::{bind_interrupts, pac, usb};
use socam_converters::{Ad5761r, Ads8688};
use socam_core::{Board, Config, Fault, Ring};
use socam_wire::{BoardKind, BoardLink, EnableFeedback, FrontEnd, Identity, Image, Start, Text};
use static_cell::StaticCell;

use bus::Chip;
use drive::Drive;
use hardware::{Hardware, Lines};
use sampling::{Answer, Ask, RING_SAMPLES};
use slot::Slot;

/// The drive's enable line.
const ENABLE_PIN: u8 = 22;
/// Changes at every conversion while the program is alive, for a watchdog outside of the board.
const ALIVE_PIN: u8 = 2;
/// The output converter's reset line.
const OUTPUT_RESET_PIN: u8 = 14;

/// Below the ADS8688's 17 MHz; both controllers divide 125 MHz by 8.
const SPI_HZ: u32 = 15_625_000;

/// Time from one channel's conversion to the next: 48 clock edges and the gaps between them. `tests/tests/board.rs` measures it.
const CHANNEL_STEP_NS: u32 = 3_700;

bind_interrupts!(struct Interrupts {
    USBCTRL_IRQ => usb::InterruptHandler<USB>;
});

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let p = embassy_rp::init(Default::default());
    // SAFETY: nothing else in this program uses the memory protection unit and the counter of cycles.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    guard::set(&core.MPU);
    clock::start(&mut core.SYST);
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
    let enable_feedback = drive.feedback();
    let lines = Lines { output_reset, drive, stop, cable };
    let hardware = Hardware::new(input, output, lines, Config::default().sample_period_us);

    static RING: StaticCell<Ring<RING_SAMPLES>> = StaticCell::new();
    static ASKS: StaticCell<Slot<Ask>> = StaticCell::new();
    static ANSWERS: StaticCell<Slot<Answer>> = StaticCell::new();
    let (producer, samples) = RING.init_with(Ring::new).split();
    let (asks, core_asks) = ASKS.init(Slot::new()).split();
    let (core_answers, answers) = ANSWERS.init(Slot::new()).split();
    let mut board = Board::new(hardware, producer);
    let image = image::check();
    if image == Image::Damaged {
        board.latch(Fault::ImageDamaged);
    }
    let (begun, cause) = start::cause();
    if let Some(cause) = cause {
        board.latch(cause);
    }

    // Interrupt priorities: sampling first, then embassy's clock, then the link.
    interrupt::TIMER_IRQ_1.set_priority(Priority::P0);
    interrupt::TIMER_IRQ_0.set_priority(Priority::P2);
    interrupt::USBCTRL_IRQ.set_priority(Priority::P3);
    watchdog::start();
    sampling::start(board, core_asks, core_answers);

    let driver = usb::Driver::new(p.USB, Interrupts);
    let link = BoardLink::new(identity(begun, enable_feedback, image), samples);
    spawner.spawn(light::show(Output::new(p.PIN_25, Level::Low)).expect("spawned once"));
    spawner.spawn(link::run(driver, link, link::Core { asks, answers, image }).expect("spawned once"));
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

fn identity(start: Start, enable_feedback: EnableFeedback, image: Image) -> Identity {
    Identity {
        board: Text::new("Raspberry Pi Pico, ADS8688, AD5761R"),
        firmware: Text::new(concat!(env!("CARGO_PKG_VERSION"), " ", env!("SOCAM_COMMIT"))),
        front_end: FrontEnd {
            kind: BoardKind::Analog,
            input_full_scale_uv: Ads8688::<Chip>::FULL_SCALE_UV,
            output_full_scale_uv: Ad5761r::<Chip>::FULL_SCALE_UV,
            channel_step_ns: CHANNEL_STEP_NS,
        },
        start,
        enable_feedback,
        image,
    }
}
