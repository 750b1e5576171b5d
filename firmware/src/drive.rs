//! The drive's enable line, and what reads it back.

use embassy_rp::Peri;
use embassy_rp::gpio::{Input, Level, Output, Pull};
use embassy_rp::pac;
use embassy_rp::peripherals::{PIN_20, PIN_21, PIN_22};
use socam_wire::EnableFeedback;

use crate::ENABLE_PIN;

/// The line is set by constants, not by a pin number in memory: no flipped bit there keeps it from being switched off.
const ENABLE: u32 = 1 << ENABLE_PIN;

/// The drive's enable line.
pub(crate) struct Drive {
    _line: Output<'static>,
    /// The line behind the emergency stop's contact, at the drive; `None` where no wire brings it back.
    feedback: Option<Input<'static>>,
}

impl Drive {
    /// A disabled drive. `strap` is tied to ground where `feedback` is wired.
    pub(crate) fn new(
        line: Peri<'static, PIN_22>,
        strap: Peri<'static, PIN_20>,
        feedback: Peri<'static, PIN_21>,
    ) -> Self {
        let line = Output::new(line, Level::Low);
        let strap = Input::new(strap, Pull::Up);
        // The pull-up needs a microsecond to charge the pin.
        cortex_m::asm::delay(1250);
        let feedback = strap.is_low().then(|| Input::new(feedback, Pull::Down));
        Self { _line: line, feedback }
    }

    /// Place at which the line is read back.
    pub(crate) fn feedback(&self) -> EnableFeedback {
        if self.feedback.is_some() { EnableFeedback::Drive } else { EnableFeedback::Pin }
    }

    pub(crate) fn set(&mut self, is_on: bool) {
        let register = pac::SIO.gpio_out(0);
        let register = if is_on { register.value_set() } else { register.value_clr() };
        register.write_value(ENABLE);
    }

    /// State in which the board has put the line.
    pub(crate) fn is_set(&self) -> bool {
        pac::SIO.gpio_out(0).value().read() & ENABLE != 0
    }

    /// State of the line as read back; it differs from the commanded one if pad or feedback say so.
    pub(crate) fn read(&self) -> bool {
        let is_set = self.is_set();
        let pad = pac::SIO.gpio_in(0).read() & ENABLE != 0;
        let feedback = self.feedback.as_ref().map_or(is_set, Input::is_high);
        if pad == is_set && feedback == is_set { is_set } else { !is_set }
    }
}
