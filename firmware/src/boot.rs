//! What every board's program starts around its hardware: core, samples, watchdog, sampling, link and light.

use embassy_executor::Spawner;
use embassy_rp::gpio::Output;
use embassy_rp::interrupt::{self, InterruptExt, Priority};
use embassy_rp::peripherals::USB;
use embassy_rp::{Peri, bind_interrupts, usb};
use socam_core::{Board, Fault, Ring};
use socam_wire::{BoardLink, EnableFeedback, FrontEnd, Identity, Image, Start, Text};
use static_cell::StaticCell;

use crate::hardware::{Count, Hardware};
use crate::sampling::{Answer, Ask, RING_SAMPLES};
use crate::slot::Slot;
use crate::{clock, guard, image, light, link, sampling, start, watchdog};

bind_interrupts!(struct Interrupts {
    USBCTRL_IRQ => usb::InterruptHandler<USB>;
});

/// What a board is.
pub(crate) struct About {
    pub(crate) board: Text<48>,
    pub(crate) front_end: FrontEnd,
    pub(crate) enable_feedback: EnableFeedback,
}

/// Guards the stack and starts the counter of cycles.
pub(crate) fn protect() {
    // SAFETY: nothing else in this program uses the memory protection unit and the counter of cycles.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    guard::set(&core.MPU);
    clock::start(&mut core.SYST);
}

/// Starts sampling and the tasks of link and light. To be called once.
pub(crate) fn run(
    spawner: Spawner,
    hardware: Hardware,
    about: About,
    usb: Peri<'static, USB>,
    light: Output<'static>,
) {
    static RING: StaticCell<Ring<Count, RING_SAMPLES>> = StaticCell::new();
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

    let driver = usb::Driver::new(usb, Interrupts);
    let link = BoardLink::new(identity(about, begun, image), samples);
    spawner.spawn(light::show(light).expect("spawned once"));
    spawner.spawn(link::run(driver, link, link::Core { asks, answers, image }).expect("spawned once"));
}

fn identity(about: About, start: Start, image: Image) -> Identity {
    Identity {
        board: about.board,
        firmware: Text::new(concat!(env!("CARGO_PKG_VERSION"), " ", env!("SOCAM_COMMIT"))),
        front_end: about.front_end,
        start,
        enable_feedback: about.enable_feedback,
        image,
    }
}
