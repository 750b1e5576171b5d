//! A torque transducer: a load cell behind an HX711, whose bits the programmable inputs (PIO) shift in. It takes no time of the processor
//! but that of looking into their queue.

use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::peripherals::{PIN_12, PIN_13, PIO1};
use embassy_rp::pio::program::pio_asm;
use socam_converters::hx711;
use socam_core::transducer::NO_CONVERSION;

/// A cycle is 1 us: pulses are 2 us high and 2 us low, and must be between 0.2 us and 50 us.
const DIVIDER: u16 = 125;

/// The converter's DOUT and PD_SCK.
const DATA: u8 = 12;
const CLOCK: u8 = 13;
/// The pins' function that is the second PIO.
const PROGRAMMED: u8 = 7;

/// `set pindirs, 1`: the clock is an output.
const CLOCK_IS_OUTPUT: u16 = 0xe081;

/// Words that the queue holds.
const QUEUE: u32 = 4;

/// The running transducer.
pub(crate) struct Transducer {
    /// A conversion that no sample has taken yet.
    latest: i32,
}

impl Transducer {
    /// Starts shifting. The data line has a pull-up: a wire that is off is never ready.
    pub(crate) fn start(
        _pio: Peri<'static, PIO1>,
        _lines: (Peri<'static, PIN_12>, Peri<'static, PIN_13>),
    ) -> Self {
        // Each bit is taken a microsecond after its pulse has begun. A full queue loses a word; the program never stands with the clock high.
        let program = pio_asm!(
            ".side_set 1",
            ".origin 0",
            "set x, 24 side 0",
            "wait 0 pin 0 side 0",
            "pulse:",
            "nop side 1",
            "in pins, 1 side 1",
            "jmp x-- pulse side 0 [1]",
            "push noblock side 0 [1]",
            "jmp 0 side 0",
        );
        for (place, word) in program.program.code.iter().enumerate() {
            pac::PIO1.instr_mem(place).write(|memory| memory.set_instr_mem(*word));
        }
        pac::PADS_BANK0.gpio(usize::from(DATA)).modify(|pad| {
            pad.set_pue(true);
            pad.set_pde(false);
            pad.set_ie(true);
            pad.set_schmitt(true);
        });
        pac::PADS_BANK0.gpio(usize::from(CLOCK)).modify(|pad| pad.set_od(false));
        pac::IO_BANK0.gpio(usize::from(CLOCK)).ctrl().write(|ctrl| ctrl.set_funcsel(PROGRAMMED));
        let machine = pac::PIO1.sm(0);
        machine.clkdiv().write(|divider| divider.set_int(DIVIDER));
        machine.pinctrl().write(|pins| {
            pins.set_in_base(DATA);
            pins.set_set_base(CLOCK);
            pins.set_set_count(1);
            pins.set_sideset_base(CLOCK);
            pins.set_sideset_count(1);
        });
        machine.shiftctrl().write(|shift| shift.set_in_shiftdir(false));
        // An unconditional jump is its address: to the beginning.
        for instruction in [CLOCK_IS_OUTPUT, 0] {
            machine.instr().write(|instr| instr.set_instr(instruction));
        }
        pac::PIO1.ctrl().modify(|ctrl| ctrl.set_sm_enable(1));
        Self { latest: NO_CONVERSION }
    }

    /// Looks for a conversion that has come.
    pub(crate) fn look(&mut self) {
        for _ in 0..QUEUE {
            if pac::PIO1.fstat().read().rxempty() & 1 != 0 {
                return;
            }
            if let Ok(code) = hx711::conversion(pac::PIO1.rxf(0).read()) {
                self.latest = code;
            }
        }
    }

    /// The conversion that came since the last call, once.
    pub(crate) fn take(&mut self) -> i32 {
        core::mem::replace(&mut self.latest, NO_CONVERSION)
    }
}
