//! The board's hardware, as the core's `Ports`.

use embassy_rp::gpio::{Input, Output};
use socam_converters::{Ad5761r, Ads8688, Order};
use socam_core::{Average, Ceilings, ConverterSilent, MAX_CHANNELS, Ports};

use crate::bus::Chip;
use crate::clock;
use crate::drive::Drive;

/// What its channels are counted in.
pub(crate) type Count = i16;

/// Number of connected inputs.
pub(crate) const CHANNELS: u8 = 4;

/// Limits that this image never exceeds, for the thesis' bench: the drive's input of +-5 V, and a motor whose tachometer ends at
/// 152 rad/s. 5 kHz is the fastest rate that leaves time for the link; below 100 Hz a fault would be noticed too late.
const CEILINGS: Ceilings = Ceilings {
    output_uv: 5_000_000,
    speed_urad_s: 200_000_000,
    run_us: 3_600_000_000,
    shortest_period_us: 200,
    longest_period_us: 10_000,
};

/// Time from the release of the output converter's reset line until it is ready: 1 us.
const RELEASE_CYCLES: u32 = 125;

/// Converters, lines and clock.
pub(crate) struct Hardware {
    input: Ads8688<Chip>,
    input_answers: bool,
    output: Ad5761r<Chip>,
    output_answers: bool,
    /// Low: the output converter is in reset. This line and the drive's enable line go low when the processor is reset.
    output_reset: Output<'static>,
    drive: Drive,
    /// High while the emergency stop is closed: measured after its contact, at the output converter's reset pin.
    stop: Input<'static>,
    /// High while the cable to the host carries a supply.
    cable: Input<'static>,
    average: Average,
    latest: [i16; MAX_CHANNELS],
    /// Conversions of each channel, up to the latest, that gave the code of the one before.
    repeated: [u32; MAX_CHANNELS],
    /// A conversion of the current sample failed.
    failed: bool,
}

/// The lines of [`Hardware`].
pub(crate) struct Lines {
    pub(crate) output_reset: Output<'static>,
    pub(crate) drive: Drive,
    pub(crate) stop: Input<'static>,
    pub(crate) cable: Input<'static>,
}

impl Hardware {
    /// Hardware with converters that are not configured: the first conversion and the first write configure them.
    pub(crate) fn new(input: Chip, output: Chip, lines: Lines, sample_period_us: u32) -> Self {
        Self {
            input: Ads8688::new(input, CHANNELS),
            input_answers: false,
            output: Ad5761r::new(output),
            output_answers: false,
            output_reset: lines.output_reset,
            drive: lines.drive,
            stop: lines.stop,
            cable: lines.cable,
            average: Average::new(sample_period_us, CHANNELS),
            latest: [0; MAX_CHANNELS],
            repeated: [0; MAX_CHANNELS],
            failed: false,
        }
    }

    /// Starts a new sampling interval of this length.
    pub(crate) fn restart(&mut self, sample_period_us: u32) {
        self.average = Average::new(sample_period_us, CHANNELS);
        self.failed = false;
    }

    /// Number of the next conversion within its sampling interval.
    pub(crate) fn position(&self) -> u32 {
        self.average.position()
    }

    /// Converts all channels; returns whether that completes a sample.
    pub(crate) fn convert(&mut self) -> bool {
        let is_even = self.average.position() & 1 == 0;
        let order = if is_even { Order::Forth } else { Order::Back };
        let before = self.latest;
        if !self.input_answers {
            self.input_answers = self.input.configure().is_ok();
        }
        if self.input_answers {
            self.input_answers = self.input.convert(order, &mut self.latest).is_ok();
        }
        self.failed |= !self.input_answers;
        for ((repeated, before), latest) in
            self.repeated.iter_mut().zip(&before).zip(&self.latest).take(usize::from(CHANNELS))
        {
            *repeated = if before == latest { repeated.saturating_add(1) } else { 0 };
        }
        self.average.push(&self.latest)
    }

    /// A missed conversion repeats the one before it.
    pub(crate) fn skip(&mut self) {
        self.average.push(&self.latest);
    }
}

impl Ports for Hardware {
    type Count = Count;

    const CEILINGS: Ceilings = CEILINGS;

    fn now_us(&mut self) -> u64 {
        clock::whole_us()
    }

    fn read(&mut self, counts: &mut [i16]) -> Result<(), ConverterSilent> {
        let failed = core::mem::replace(&mut self.failed, false);
        counts.iter_mut().zip(self.average.sample()).for_each(|(count, sample)| *count = *sample);
        if failed || counts.len() > usize::from(CHANNELS) { Err(ConverterSilent) } else { Ok(()) }
    }

    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        if self.output_reset.is_set_low() {
            self.output_reset.set_high();
            cortex_m::asm::delay(RELEASE_CYCLES);
        }
        if self.emergency_stop() {
            // The contact holds the converter in reset, its output clamped to ground.
            self.output_answers = false;
            return if count == 0 { Ok(()) } else { Err(ConverterSilent) };
        }
        if !self.output_answers {
            self.output_answers = self.output.configure().is_ok();
        }
        if self.output_answers {
            self.output_answers = self.output.write(count).is_ok();
        }
        if self.output_answers {
            return Ok(());
        }
        if !self.emergency_stop() {
            // This sets the output to 0 V from any state.
            self.output_reset.set_low();
        }
        Err(ConverterSilent)
    }

    fn enable(&mut self, on: bool) {
        self.drive.set(on);
    }

    fn enable_line(&mut self) -> Option<bool> {
        Some(self.drive.read())
    }

    fn repeated(&mut self, channel: u8) -> Option<u32> {
        self.repeated.get(usize::from(channel)).copied()
    }

    fn emergency_stop(&mut self) -> bool {
        self.output_reset.is_set_high() && self.stop.is_low()
    }

    fn cable_pulled(&mut self) -> bool {
        self.cable.is_low()
    }
}
