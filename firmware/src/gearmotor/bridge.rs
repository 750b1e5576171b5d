//! The H-bridge: its two inputs, modulated at 20 kHz.
//!
//! Both inputs high brake, so that at a duty of d one is always high and the other for 1 - d of the time: the current goes on through the
//! bridge's lower or upper half between two pulses. Without its enable line the bridge is off and the motor coasts.

use embassy_rp::Peri;
use embassy_rp::pac;
use embassy_rp::peripherals::{PIN_16, PIN_17, PWM_SLICE0};
use socam_core::{ConverterSilent, bridge};

use crate::clock::CYCLES_PER_US;

/// Cycles of the processor in a period: 50 us.
const PERIOD: u16 = 6250;

const SLICE: usize = 0;
const PINS: [usize; 2] = [16, 17];
/// The pins' function that is modulation.
const MODULATED: u8 = 4;

/// The bridge, its present duty and the one before, in 1/2^15.
pub(crate) struct Bridge {
    duty: i32,
    before: i32,
    /// Time at which the present duty begins or began: a new one waits for the end of a period.
    from_us: u32,
}

impl Bridge {
    /// A bridge that brakes.
    pub(crate) fn start(
        _slice: Peri<'static, PWM_SLICE0>,
        _pins: (Peri<'static, PIN_16>, Peri<'static, PIN_17>),
    ) -> Self {
        let slice = pac::PWM.ch(SLICE);
        slice.div().write(|divider| divider.set_int(1));
        slice.top().write(|top| top.set_top(PERIOD - 1));
        slice.cc().write_value(compare(0));
        slice.csr().write(|csr| csr.set_en(true));
        for pin in PINS {
            pac::PADS_BANK0.gpio(pin).modify(|pad| pad.set_od(false));
            pac::IO_BANK0.gpio(pin).ctrl().write(|ctrl| ctrl.set_funcsel(MODULATED));
        }
        Self { duty: 0, before: 0, from_us: 0 }
    }

    /// Sets the duty, from the next period on, and reads it back.
    pub(crate) fn set(&mut self, duty: i32, now_us: u32) -> Result<(), ConverterSilent> {
        let slice = pac::PWM.ch(SLICE);
        let wanted = compare(duty);
        slice.cc().write_value(wanted);
        let left = u32::from(PERIOD).saturating_sub(u32::from(slice.ctr().read().ctr()));
        self.before = core::mem::replace(&mut self.duty, duty);
        self.from_us = now_us.wrapping_add(left / CYCLES_PER_US);
        if slice.cc().read() == wanted && slice.csr().read().en() { Ok(()) } else { Err(ConverterSilent) }
    }

    /// The mean duty from one time to another, which is after the latest change was asked for.
    pub(crate) fn mean(&self, since_us: u32, until_us: u32) -> i32 {
        let passed_us = until_us.wrapping_sub(since_us);
        let late_us = self.from_us.wrapping_sub(since_us) as i32;
        // Without a division where nothing changed, which is mostly so.
        if late_us <= 0 {
            return self.duty;
        }
        let late_us = late_us.unsigned_abs();
        if late_us >= passed_us {
            return self.before;
        }
        let change = self.before.wrapping_sub(self.duty);
        let part = change.unsigned_abs().wrapping_mul(late_us).checked_div(passed_us).unwrap_or(0) as i32;
        self.duty.wrapping_add(if change < 0 { part.wrapping_neg() } else { part })
    }
}

/// How long each input is high.
fn compare(duty: i32) -> pac::pwm::regs::ChCc {
    let on = duty.unsigned_abs().min(bridge::FULL_DUTY as u32).wrapping_mul(PERIOD.into()) >> 15;
    let braking = PERIOD.wrapping_sub(on as u16);
    let (first, second) = if duty < 0 { (braking, PERIOD) } else { (PERIOD, braking) };
    let mut compare = pac::pwm::regs::ChCc(0);
    compare.set_a(first);
    compare.set_b(second);
    compare
}
