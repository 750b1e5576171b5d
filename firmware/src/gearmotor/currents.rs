//! Currents and supply, by the converter of the RP2040: always the mean over one period of the bridge's modulation.
//!
//! The converter runs by itself and takes its three inputs in turns, eight times in 50 us, which is the bridge's period to the cycle:
//! both count the same crystal. So the ripple of the modulation is averaged out wherever the period begins.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::pac::dma::vals::{DataSize, TreqSel};
use embassy_rp::peripherals::{ADC, DMA_CH0, DMA_CH1, PIN_26, PIN_27, PIN_28};
use socam_core::ConverterSilent;

/// Voltage at 2^15 counts.
pub(crate) const FULL_SCALE_UV: u32 = 3_300_000;

/// Time from one input's conversion to the next one's: 100 cycles of 48 MHz.
pub(crate) const STEP_NS: u32 = 2083;
const STEP_CYCLES: u16 = 100;

/// Motor's current, supply's current, supply's voltage: GP26, GP27 and GP28.
pub(crate) const INPUTS: usize = 3;
const FIRST_PIN: usize = 26;

/// Conversions of each input in a period. Eight of 12 bits fill 15.
const TURNS: u32 = 8;
const WINDOW: u32 = TURNS * INPUTS as u32;

/// Entries of the ring that the conversions go to, and the logarithm of its bytes.
const RING: u32 = 32;
const RING_BYTES_LOG2: u8 = 6;

/// Conversions after which the transfer starts anew: whole turns of the inputs and of the ring.
static RENEW_AFTER: AtomicU32 = AtomicU32::new(RING * INPUTS as u32 * 1000);

#[repr(align(64))]
struct Conversions([AtomicU16; RING as usize]);

static CONVERSIONS: Conversions = Conversions([const { AtomicU16::new(0) }; RING as usize]);

/// The transfer, and what starts it anew.
const TRANSFER: usize = 0;
const RENEWAL: usize = 1;

/// The running converter.
pub(crate) struct Currents {
    /// What the transfer had left at the last reading.
    left: u32,
}

impl Currents {
    /// Starts the converter.
    pub(crate) fn start(
        _converter: Peri<'static, ADC>,
        _channels: (Peri<'static, DMA_CH0>, Peri<'static, DMA_CH1>),
        _inputs: (Peri<'static, PIN_26>, Peri<'static, PIN_27>, Peri<'static, PIN_28>),
    ) -> Self {
        for pin in FIRST_PIN..FIRST_PIN + INPUTS {
            pac::PADS_BANK0.gpio(pin).modify(|pad| {
                pad.set_ie(false);
                pad.set_od(true);
                pad.set_pue(false);
                pad.set_pde(false);
            });
        }
        pac::ADC.cs().write(|cs| cs.set_en(true));
        // Ready in a microsecond.
        for _ in 0..1000 {
            if pac::ADC.cs().read().ready() {
                break;
            }
        }
        pac::ADC.div().write(|divider| divider.set_int(STEP_CYCLES - 1));
        begin();
        Self { left: 0 }
    }

    /// The latest mean of each input, at 2^15 counts for full scale.
    pub(crate) fn read(&mut self) -> Result<[i16; INPUTS], ConverterSilent> {
        let left = pac::DMA.ch(TRANSFER).trans_count().read();
        // After a lost conversion the inputs would be taken for one another.
        if left == self.left || pac::ADC.fcs().read().over() {
            begin();
            return Err(ConverterSilent);
        }
        self.left = left;
        let done = RENEW_AFTER.load(Ordering::Relaxed).wrapping_sub(left);
        // The latest one may be on its way to memory.
        let first = done.wrapping_add(RING * INPUTS as u32 - WINDOW - 1);
        let mut sums = [0i16; INPUTS];
        let mut place = first;
        for _ in 0..TURNS {
            for sum in &mut sums {
                let entry = CONVERSIONS.0.get((place % RING) as usize);
                // At most 8 times 4095.
                *sum = sum.wrapping_add(entry.map_or(0, |entry| entry.load(Ordering::Relaxed)) as i16);
                place = place.wrapping_add(1);
            }
        }
        // The first sum is that of the input whose turn it was.
        let [one, next, last] = sums;
        Ok(match first % INPUTS as u32 {
            0 => sums,
            1 => [last, one, next],
            _ => [next, last, one],
        })
    }
}

/// Starts conversions with the first input, and their transfer with the first entry of the ring.
fn begin() {
    pac::ADC.cs().modify(|cs| cs.set_start_many(false));
    pac::DMA.chan_abort().write(|abort| abort.set_chan_abort(1 << TRANSFER | 1 << RENEWAL));
    // A conversion takes 2 us.
    cortex_m::asm::delay(500);
    pac::ADC.fcs().write(|fcs| {
        fcs.set_en(true);
        fcs.set_dreq_en(true);
        fcs.set_thresh(1);
        fcs.set_over(true);
        fcs.set_under(true);
    });
    for _ in 0..4 {
        let _ = pac::ADC.fifo().read();
    }
    let renewal = pac::DMA.ch(RENEWAL);
    let transfer = pac::DMA.ch(TRANSFER);
    renewal.read_addr().write_value(RENEW_AFTER.as_ptr().addr() as u32);
    renewal.write_addr().write_value(transfer.al1_trans_count_trig().as_ptr().addr() as u32);
    renewal.trans_count().write_value(1);
    renewal.al1_ctrl().write_value(control(|ctrl| {
        ctrl.set_data_size(DataSize::SIZE_WORD);
        ctrl.set_treq_sel(TreqSel::PERMANENT);
        ctrl.set_chain_to(RENEWAL as u8);
    }));
    transfer.read_addr().write_value(pac::ADC.fifo().as_ptr().addr() as u32);
    transfer.write_addr().write_value((&raw const CONVERSIONS).addr() as u32);
    transfer.trans_count().write_value(RENEW_AFTER.load(Ordering::Relaxed));
    transfer.ctrl_trig().write_value(pac::dma::regs::CtrlTrig(control(|ctrl| {
        ctrl.set_data_size(DataSize::SIZE_HALFWORD);
        ctrl.set_incr_write(true);
        ctrl.set_ring_sel(true);
        ctrl.set_ring_size(RING_BYTES_LOG2);
        ctrl.set_treq_sel(TreqSel::ADC);
        ctrl.set_chain_to(RENEWAL as u8);
    })));
    pac::ADC.cs().modify(|cs| {
        cs.set_ainsel(0);
        cs.set_rrobin((1 << INPUTS) - 1);
        cs.set_start_many(true);
    });
}

fn control(set: impl FnOnce(&mut pac::dma::regs::CtrlTrig)) -> u32 {
    let mut ctrl = pac::dma::regs::CtrlTrig(0);
    ctrl.set_en(true);
    ctrl.set_irq_quiet(true);
    set(&mut ctrl);
    ctrl.0
}
