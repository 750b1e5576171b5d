//! A bench behind the ports of a board, and runs on it.

use socam_core::{Board, Ceilings, Command, ConverterSilent, MAX_CHANNELS, Ports, Profile, Request, Shape};

/// A first-order bench behind the converters, with switchable faults.
#[derive(Debug)]
pub(crate) struct Bench {
    pub(crate) now_us: u64,
    pub(crate) speed_urad_s: f64,
    pub(crate) ripple: i16,
    pub(crate) converter_silent: bool,
    pub(crate) output_silent: bool,
    pub(crate) stop_pressed: bool,
    /// Readings forced onto a channel.
    pub(crate) forced: [Option<i16>; MAX_CHANNELS],
    pub(crate) output: i16,
    pub(crate) enabled: bool,
    /// State in which the enable line is stuck, if it is.
    pub(crate) line_stuck: Option<bool>,
    /// Equal codes in a row that the converter has given on channel 2.
    pub(crate) codes: Option<u32>,
}

impl Ports for Bench {
    type Count = i16;

    const CEILINGS: Ceilings = Ceilings {
        output_uv: 5_000_000,
        speed_urad_s: 250_000_000,
        run_us: 10_000_000,
        shortest_period_us: 200,
        longest_period_us: 10_000,
    };

    fn now_us(&mut self) -> u64 {
        self.now_us
    }

    fn read(&mut self, counts: &mut [i16]) -> Result<(), ConverterSilent> {
        let volts = if self.enabled { f64::from(self.output) * 10.0 / 32768.0 } else { 0.0 };
        self.speed_urad_s += (volts * 75.6e6 - self.speed_urad_s) * 0.02;
        // Ripple of one count: no real sensor repeats a count for a second.
        self.ripple = -1 - self.ripple;
        let motor = (self.speed_urad_s / 4632.0) as i16;
        let healthy = [motor, (f64::from(motor) * 0.3497) as i16, 100, 200, 0, 0, 0, 0];
        for ((count, healthy), forced) in counts.iter_mut().zip(healthy).zip(self.forced) {
            *count = forced.unwrap_or(healthy.saturating_add(self.ripple));
        }
        if self.converter_silent { Err(ConverterSilent) } else { Ok(()) }
    }

    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        if self.output_silent {
            return Err(ConverterSilent);
        }
        self.output = count;
        Ok(())
    }

    fn enable(&mut self, on: bool) {
        self.enabled = on;
    }

    fn enable_line(&mut self) -> Option<bool> {
        Some(self.line_stuck.unwrap_or(self.enabled))
    }

    fn repeated(&mut self, channel: u8) -> Option<u32> {
        self.codes.filter(|_| channel == 2)
    }

    fn emergency_stop(&mut self) -> bool {
        self.stop_pressed
    }
}

pub(crate) const RING: usize = 4096;

pub(crate) fn bench() -> Bench {
    Bench {
        now_us: 0,
        speed_urad_s: 0.0,
        ripple: 0,
        converter_silent: false,
        output_silent: false,
        stop_pressed: false,
        forced: [None; MAX_CHANNELS],
        output: 0x1234,
        enabled: true,
        line_stuck: None,
        codes: None,
    }
}

pub(crate) fn constant(level_micro: i32, command: Command) -> Profile {
    Profile {
        command,
        shape: Shape::Constant { level_micro },
        ramp_us: 0,
        limit_micro: 200_000_000,
        slew_micro_s: if command == Command::Voltage { 20_000_000 } else { 1_000_000_000 },
        duration_us: 3_000_000,
    }
}

pub(crate) fn ticks(board: &mut Board<'_, Bench, RING>, count: u32) {
    for _ in 0..count {
        board.ports_mut().now_us += 1000;
        board.tick();
    }
}

/// Ticks with a heartbeat every 100 of them.
pub(crate) fn attended(board: &mut Board<'_, Bench, RING>, count: u32) {
    for _ in 0..count.div_ceil(100) {
        board.handle(Request::Heartbeat).unwrap();
        ticks(board, count.min(100));
    }
}

pub(crate) fn running(board: &mut Board<'_, Bench, RING>, profile: Profile) {
    for request in [Request::Stream(true), Request::Load(profile), Request::Arm, Request::Run] {
        board.handle(request).unwrap();
    }
}
