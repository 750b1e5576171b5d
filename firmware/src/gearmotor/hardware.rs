//! The gearmotor board's hardware, as the core's `Ports`: encoders, bridge, currents and supply.

use embassy_rp::gpio::Input;
use embassy_rp::pac;
use socam_core::encoder::{Encoder, EncoderReading};
use socam_core::{
    Applied, Average, Ceilings, ChannelKind, Config, ConverterSilent, GearmotorChannel, MAX_CHANNELS, Ports,
    bridge, conversions_per_sample,
};

use crate::bridge::Bridge;
use crate::clock::{now_us, whole_us};
use crate::counters::{Counters, TICKS_PER_S};
use crate::currents::{Currents, FULL_SCALE_UV, INPUTS};
use crate::drive::Drive;
use crate::transducer::Transducer;

/// What its channels are counted in.
pub(crate) type Count = i32;

/// Voltage at 2^15 counts of the command.
pub(crate) const COMMAND_FULL_SCALE_UV: u32 = 16_000_000;

/// The supply's divider.
const SUPPLY_DIVIDER: u32 = 6;

/// Limits that this image never exceeds, for a motor of 12 V. 5 kHz is the fastest rate that leaves time for the link.
const CEILINGS: Ceilings = Ceilings {
    output_uv: 16_000_000,
    speed_urad_s: 2_000_000_000,
    run_us: 3_600_000_000,
    shortest_period_us: 200,
    longest_period_us: 10_000,
};

/// Digital inputs: pins 10 and 11. The first takes the index of the motor's encoder.
const FIRST_INPUT: usize = 10;
const PINS_PER_REGISTER: usize = 8;

/// Encoders, bridge, converter, lines and clock.
pub(crate) struct Hardware {
    counters: Counters,
    readings: [EncoderReading; 2],
    encoders: [Encoder; 2],
    currents: Currents,
    transducer: Transducer,
    /// Whether the transducer takes the place of the supply's current.
    has_transducer: bool,
    bridge: Bridge,
    applied: Applied,
    drive: Drive,
    /// High while the emergency stop's second contact is closed.
    stop: Input<'static>,
    /// High while the cable to the host carries a supply.
    cable: Input<'static>,
    average: Average,
    /// Both currents and the supply.
    latest: [i16; MAX_CHANNELS],
    /// Time of the latest conversion.
    converted_us: u32,
    /// A conversion of the current sample failed.
    failed: bool,
}

/// The lines of [`Hardware`].
pub(crate) struct Lines {
    pub(crate) drive: Drive,
    pub(crate) stop: Input<'static>,
    pub(crate) cable: Input<'static>,
}

impl Hardware {
    pub(crate) fn new(
        counters: Counters,
        currents: Currents,
        transducer: Transducer,
        bridge: Bridge,
        lines: Lines,
        period_us: u32,
    ) -> Self {
        let log2 = conversions_per_sample(period_us).trailing_zeros();
        Self {
            counters,
            readings: [EncoderReading::default(); 2],
            encoders: [Encoder::new(TICKS_PER_S, log2); 2],
            currents,
            transducer,
            has_transducer: false,
            bridge,
            applied: Applied::new(log2),
            drive: lines.drive,
            stop: lines.stop,
            cable: lines.cable,
            average: Average::new(period_us, INPUTS as u8),
            latest: [0; MAX_CHANNELS],
            converted_us: 0,
            failed: false,
        }
    }

    /// Starts a new sampling interval of this length.
    pub(crate) fn restart(&mut self, sample_period_us: u32) {
        let log2 = conversions_per_sample(sample_period_us).trailing_zeros();
        self.average = Average::new(sample_period_us, INPUTS as u8);
        self.applied = Applied::new(log2);
        self.encoders.iter_mut().for_each(|encoder| encoder.restart(log2));
        self.failed = false;
    }

    /// Number of the next conversion within its sampling interval.
    pub(crate) fn position(&self) -> u32 {
        self.average.position()
    }

    /// Reads encoders and converter; returns whether that completes a sample.
    pub(crate) fn convert(&mut self) -> bool {
        let now_us = now_us();
        for (number, reading) in self.readings.iter_mut().enumerate() {
            match self.counters.read(number, now_us) {
                Ok(fresh) => *reading = fresh,
                Err(ConverterSilent) => self.failed = true,
            }
        }
        match self.currents.read() {
            Ok(means) => self.latest.iter_mut().zip(means).for_each(|(latest, mean)| *latest = mean),
            Err(ConverterSilent) => self.failed = true,
        }
        self.transducer.look();
        self.take(now_us)
    }

    /// A missed conversion repeats the one before it.
    pub(crate) fn skip(&mut self) {
        self.take(now_us());
    }

    fn take(&mut self, now_us: u32) -> bool {
        for (encoder, reading) in self.encoders.iter_mut().zip(&self.readings) {
            encoder.push(reading);
        }
        let since_us = core::mem::replace(&mut self.converted_us, now_us);
        let duty = if self.drive.is_set() { self.bridge.mean(since_us, now_us) } else { 0 };
        self.applied.push(bridge::applied(duty, self.supply_count()));
        self.average.push(&self.latest)
    }

    fn supply_count(&self) -> i32 {
        let [_, _, supply, ..] = self.latest;
        supply.into()
    }

    fn supply_uv(&self) -> i32 {
        // 604 and a quarter for a count.
        self.supply_count().wrapping_mul((FULL_SCALE_UV * SUPPLY_DIVIDER / 2048) as i32) >> 4
    }
}

impl Ports for Hardware {
    type Count = Count;

    const WATCHES_MOTOR: bool = true;

    const TRANSDUCER: Option<u8> = Some(GearmotorChannel::SupplyCurrent as u8);

    const CEILINGS: Ceilings = CEILINGS;

    fn now_us(&mut self) -> u64 {
        whole_us()
    }

    fn choose(&mut self, config: &Config) {
        let channel = config.channels.get(GearmotorChannel::SupplyCurrent.index());
        self.has_transducer = channel.is_some_and(|channel| channel.kind == ChannelKind::Transducer);
    }

    fn read(&mut self, counts: &mut [Count]) -> Result<(), ConverterSilent> {
        let failed = core::mem::replace(&mut self.failed, false);
        let [motor, output] = &self.encoders;
        let ([motor_angle, motor_speed], [output_angle, output_speed]) = (motor.sample(), output.sample());
        let [motor_a, supply_a, supply, ..] = *self.average.sample();
        // Taken in any case, so that what is taken first is not old.
        let torque = self.transducer.take();
        let supply_or_torque = if self.has_transducer { torque } else { supply_a.into() };
        let mut all = [0; MAX_CHANNELS];
        for (channel, count) in [
            (GearmotorChannel::MotorAngle, motor_angle),
            (GearmotorChannel::MotorSpeed, motor_speed),
            (GearmotorChannel::OutputAngle, output_angle),
            (GearmotorChannel::OutputSpeed, output_speed),
            (GearmotorChannel::MotorCurrent, motor_a.into()),
            (GearmotorChannel::SupplyCurrent, supply_or_torque),
            (GearmotorChannel::SupplyVoltage, supply.into()),
            (GearmotorChannel::MotorVoltage, self.applied.sample()),
        ] {
            if let Some(place) = all.get_mut(channel.index()) {
                *place = count;
            }
        }
        counts.iter_mut().zip(all).for_each(|(count, read)| *count = read);
        if failed { Err(ConverterSilent) } else { Ok(()) }
    }

    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        // 488 and a quarter for a count.
        let wanted_uv = i32::from(count).wrapping_mul((COMMAND_FULL_SCALE_UV / 1024) as i32) >> 5;
        let duty = bridge::duty(wanted_uv, self.supply_uv());
        self.bridge.set(duty, now_us())
    }

    fn enable(&mut self, on: bool) {
        self.drive.set(on);
    }

    fn enable_line(&mut self) -> Option<bool> {
        Some(self.drive.read())
    }

    fn inputs(&mut self) -> u8 {
        let register = pac::IO_BANK0.intr(FIRST_INPUT / PINS_PER_REGISTER);
        let first = FIRST_INPUT % PINS_PER_REGISTER;
        let seen = register.read();
        let mut clear = pac::io::regs::Int(0);
        let mut inputs = 0;
        for place in 0..2 {
            clear.set_edge_high(first + place, true);
            if seen.edge_high(first + place) || seen.level_high(first + place) {
                inputs |= 1 << place;
            }
        }
        register.write_value(clear);
        inputs
    }

    fn emergency_stop(&mut self) -> bool {
        self.stop.is_low()
    }

    fn cable_pulled(&mut self) -> bool {
        self.cable.is_low()
    }
}
