//! Two quadrature encoders, counted by the programmable inputs (PIO): an edge takes no time of the processor.

use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::peripherals::{PIN_6, PIN_7, PIN_8, PIN_9, PIO0};
use embassy_rp::pio::program::pio_asm;
use socam_core::ConverterSilent;
use socam_core::encoder::EncoderReading;

/// Ticks of an encoder's clock: one round of the program below.
pub(crate) const TICKS_PER_S: u32 = 5_000_000;
const TICKS_PER_US: u32 = 5;

/// The program has ten instructions a round: 125 MHz by 2.5.
const DIVIDER_INT: u16 = 2;
const DIVIDER_FRAC: u8 = 128;

/// First pin of each encoder: its tracks A and B. The motor's comes first.
const PINS: [u8; 2] = [6, 8];

/// Most words that are read and dropped: those that wait, and any that come meanwhile.
const STALE: u32 = 8;

/// Most attempts to read a fresh word, which comes every 25 cycles of the processor.
const ATTEMPTS: u32 = 50;

/// `set y, 0`, `mov x, ~null` and `mov osr, pins`: no counts, no time, and the tracks as they are.
const AT_START: [u16; 3] = [0xe040, 0xa02b, 0xa0e0];

/// Both encoders.
pub(crate) struct Counters {
    counts: [i32; 2],
}

impl Counters {
    /// Starts counting. The pins have pull-ups, for outputs with an open collector.
    pub(crate) fn start(
        _pio: Peri<'static, PIO0>,
        _motor: (Peri<'static, PIN_6>, Peri<'static, PIN_7>),
        _output: (Peri<'static, PIN_8>, Peri<'static, PIN_9>),
    ) -> Self {
        // A round: the tracks before and now, as four bits, are the address of what to do. y counts; x counts rounds since an edge
        // downwards. Both go out in one word, so that no reading mixes two rounds. A transition of both tracks is no direction and
        // no count. Without an edge a round has ten instructions, with one two or five more.
        let round = pio_asm!(
            ".origin 0",
            "jmp still",
            "jmp up",
            "jmp down",
            "jmp still",
            "jmp down",
            "jmp still",
            "jmp still",
            "jmp up",
            "jmp up",
            "jmp still",
            "jmp still",
            "jmp down",
            "jmp still",
            "jmp down",
            "jmp up",
            "jmp still",
            "up:",
            "mov y, ~y",
            "jmp y-- less",
            "less:",
            "mov y, ~y",
            "jmp edge",
            "down:",
            "jmp y-- edge",
            "edge:",
            "mov x, ~null",
            "still:",
            "jmp x-- tell",
            "tell:",
            "in y, 16",
            "in x, 16",
            "push noblock [1]",
            "public look:",
            "out isr, 2",
            "in pins, 2",
            "mov osr, isr",
            "mov pc, isr",
        );
        for (place, word) in round.program.code.iter().enumerate() {
            pac::PIO0.instr_mem(place).write(|memory| memory.set_instr_mem(*word));
        }
        for (number, first) in PINS.into_iter().enumerate() {
            for pin in [first, first + 1] {
                pac::PADS_BANK0.gpio(usize::from(pin)).modify(|pad| {
                    pad.set_pue(true);
                    pad.set_pde(false);
                    pad.set_ie(true);
                    pad.set_schmitt(true);
                });
            }
            let machine = pac::PIO0.sm(number);
            machine.clkdiv().write(|divider| {
                divider.set_int(DIVIDER_INT);
                divider.set_frac(DIVIDER_FRAC);
            });
            machine.pinctrl().write(|pins| pins.set_in_base(first));
            machine.shiftctrl().write(|shift| {
                shift.set_in_shiftdir(false);
                shift.set_out_shiftdir(true);
            });
            // An unconditional jump is its address.
            let begin = round.public_defines.look as u16;
            for instruction in AT_START.into_iter().chain([begin]) {
                machine.instr().write(|instr| instr.set_instr(instruction));
            }
        }
        pac::PIO0.ctrl().modify(|ctrl| ctrl.set_sm_enable(0b11));
        Self { counts: [0; 2] }
    }

    /// Reads an encoder at this time. It takes at most a few microseconds.
    pub(crate) fn read(&mut self, number: usize, now_us: u32) -> Result<EncoderReading, ConverterSilent> {
        // A full queue holds old words: those of after the last reading.
        for _ in 0..STALE {
            let _ = next(number);
        }
        let word = (0..ATTEMPTS).find_map(|_| next(number)).ok_or(ConverterSilent)?;
        let count = self.counts.get_mut(number).ok_or(ConverterSilent)?;
        let passed = ((word >> 16) as u16).wrapping_sub(*count as u16) as i16;
        *count = count.wrapping_add(i32::from(passed));
        Ok(EncoderReading {
            count: *count,
            // Wraps after 13 ms; it is used only where an edge has come since the reading before.
            age_ticks: u32::from(!(word as u16)),
            now_ticks: now_us.wrapping_mul(TICKS_PER_US),
        })
    }
}

fn next(number: usize) -> Option<u32> {
    let is_empty = pac::PIO0.fstat().read().rxempty() & (1 << number) != 0;
    (!is_empty).then(|| pac::PIO0.rxf(number).read())
}
