//! Exercises of the core, run on the board's processor and on the host to compare the results bit by bit.

use socam_core::encoder::{self, EncoderReading};
use socam_core::scaling::{self, Converter, MotorCalibration, Sensor};
use socam_core::{
    Applied, Average, Board, Command, Config, ConverterSilent, Generator, Layout, Lines, MAX_CHANNELS, Ports,
    Profile, Request, Ring, Sample, Shape, bridge,
};
use socam_wire::{
    BoardKind, BoardLink, Decoder, EnableFeedback, Encoder, FrontEnd, Identity, Image, MAX_FRAME, Start,
    Text, ToBoard, ToHost,
};

/// Runs all exercises; each gives its name and a hash of its results.
pub(crate) fn run(mut tell: impl FnMut(&str, u64)) {
    tell("floating point", floating_point());
    tell("profiles", profiles());
    tell("averages", averages());
    tell("gearmotor", gearmotor());
    tell("closed loop", board(Command::SpeedClosedLoop));
    tell("open loop", board(Command::SpeedOpenLoop));
    tell("messages", messages());
}

/// FNV-1a hash.
struct Digest(u64);

impl Digest {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    fn integer(&mut self, value: i64) {
        self.bytes(&value.to_le_bytes());
    }

    fn float(&mut self, value: f64) {
        self.bytes(&value.to_bits().to_le_bytes());
    }
}

/// All floating-point functions of the core, at ordinary, extreme and infinite values.
fn floating_point() -> u64 {
    let mut digest = Digest::new();
    let values =
        [0.0, -0.0, 1e-9, 0.499_999_5, 0.5, 1.0 / 3.0, -2.5, 9.999_9, 1425.3, -1e7, 1e300, f64::INFINITY];
    for value in values {
        digest.integer(i64::from(scaling::micro(value)));
        for bits in [12, 16] {
            let converter = Converter { bits, full_scale_v: 10.24 };
            digest.integer(i64::from(converter.count(value)));
            digest.integer(scaling::counts_per_uv_q32(&converter));
            for sensor in
                [Sensor::MOTOR_SPEED, Sensor::TORQUE_OUT, Sensor { volts_per_unit: 0.7, offset_v: -0.03 }]
            {
                digest.float(sensor.value(value));
                digest.float(sensor.volts(value));
                digest.integer(sensor.scale(&converter).micro_per_count_q16);
            }
        }
        digest.float(MotorCalibration::LOADED.volts(value));
        digest.float(MotorCalibration::UNLOADED.speed_rad_s(value));
    }
    let mut frame = [0; MAX_FRAME];
    let configure = ToBoard::Request { number: 1, request: Request::Configure(Config::default()) };
    let len = Encoder::new().encode(&configure, &mut frame).expect("it fits");
    digest.bytes(&frame[..len]);
    digest.0
}

fn profile(command: Command, shape: Shape) -> Profile {
    Profile {
        command,
        shape,
        ramp_us: 200_000,
        limit_micro: 140_000_000,
        slew_micro_s: 2_000_000_000,
        duration_us: 900_000,
    }
}

fn profiles() -> u64 {
    let (offset_micro, amplitude_micro) = (60_000_000, 30_000_000);
    let shapes = [
        Shape::Constant { level_micro: -offset_micro },
        Shape::Staircase {
            first_micro: 0,
            step_micro: 7_000_001,
            count: 9,
            dwell_us: 50_000,
            and_back: true,
        },
        Shape::Sine { offset_micro, amplitude_micro, frequency_uhz: 7_300_000, periods: Some(3) },
        Shape::Triangle { offset_micro, amplitude_micro, period_us: 333_000 },
        Shape::Chirp {
            offset_micro,
            amplitude_micro,
            start_uhz: 500_000,
            end_uhz: 180_000_000,
            sweep_us: 1_000_000,
        },
        Shape::Prbs { offset_micro, amplitude_micro, bit_us: 3000, order: 9, seed: 77 },
        multisine(offset_micro),
    ];
    let mut digest = Digest::new();
    for shape in shapes {
        let mut generator =
            Generator::new(&profile(Command::SpeedOpenLoop, shape), 1000).expect("a sound profile");
        for sample in 0..1200 {
            if sample == 1000 {
                generator.stop();
            }
            let setpoint = generator.step();
            digest.integer(i64::from(setpoint.value_micro));
            digest.bytes(&setpoint.segment.to_le_bytes());
            digest.bytes(&[
                u8::from(setpoint.limited),
                u8::from(setpoint.stopping),
                u8::from(setpoint.finished),
            ]);
        }
    }
    digest.0
}

fn multisine(offset_micro: i32) -> Shape {
    Shape::Multisine {
        offset_micro,
        line_micro: 1_000_000,
        period_us: 500_000,
        lines: Lines::Odd,
        first_line: 1,
        last_line: 99,
        seed: 5,
    }
}

/// Pseudo-random counts (xorshift).
struct Counts(u32);

impl Counts {
    fn next(&mut self) -> i16 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (self.0 >> 8) as i16
    }
}

fn averages() -> u64 {
    let (mut digest, mut counts) = (Digest::new(), Counts(1));
    for period_us in [100, 200, 1000, 20_000] {
        let mut average = Average::new(period_us, MAX_CHANNELS as u8);
        for _ in 0..400 {
            if average.push(&core::array::from_fn(|_| counts.next())) {
                average.sample().iter().for_each(|count| digest.integer(i64::from(*count)));
            }
        }
    }
    digest.0
}

/// An encoder whose edges come at random, forth and back, rarely and often, and a bridge at random voltages: what the board divides in hardware.
fn gearmotor() -> u64 {
    let (mut digest, mut counts) = (Digest::new(), Counts(7));
    let (mut encoder, mut applied) = (encoder::Encoder::new(5_000_000, 1), Applied::new(1));
    let mut reading = EncoderReading::default();
    for conversion in 0..4000 {
        let passed = i32::from(counts.next()) >> (3 + conversion / 400);
        reading.count = reading.count.wrapping_add(passed);
        reading.now_ticks = reading.now_ticks.wrapping_add(500);
        reading.age_ticks = u32::from(counts.next().unsigned_abs()) % 500;
        let supply = i32::from(counts.next());
        let duty = bridge::duty(i32::from(counts.next()).wrapping_mul(300), supply.wrapping_mul(604));
        digest.integer(duty.into());
        applied.push(bridge::applied(duty, supply));
        if encoder.push(&reading) {
            let [position, speed] = encoder.sample();
            [position, speed, applied.sample()].into_iter().for_each(|value| digest.integer(value.into()));
        }
    }
    digest.0
}

/// A motor that follows its command, with noise.
struct Motor {
    now_us: u64,
    speed_urad_s: i64,
    output: i16,
    enabled: bool,
    noise: Counts,
}

impl Ports for Motor {
    type Count = i16;

    fn now_us(&mut self) -> u64 {
        self.now_us
    }

    fn read(&mut self, counts: &mut [i16]) -> Result<(), ConverterSilent> {
        let driven_urad_s = if self.enabled { i64::from(self.output) * 23_000 } else { 0 };
        self.speed_urad_s += (driven_urad_s - self.speed_urad_s) / 50;
        let tachometer = (self.speed_urad_s / 4632) as i16;
        for (count, share) in counts.iter_mut().zip([1000, 350, 20, 60]) {
            *count = (i32::from(tachometer) * share / 1000) as i16 + self.noise.next() / 4096;
        }
        Ok(())
    }

    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        self.output = count;
        Ok(())
    }

    fn enable(&mut self, on: bool) {
        self.enabled = on;
    }
}

/// A run, a stop, another run that exceeds a limit: every sample and status.
fn board(command: Command) -> u64 {
    let mut digest = Digest::new();
    let mut ring = Ring::<i16, 16>::new();
    let (producer, mut samples) = ring.split();
    let motor = Motor { now_us: 0, speed_urad_s: 0, output: 0, enabled: false, noise: Counts(9) };
    let mut board = Board::new(motor, producer);
    let mut low = Config::default();
    low.channels[0].limit_micro = Some(50_000_000);
    for config in [Config::default(), low] {
        let run = profile(command, multisine(60_000_000));
        let requests = [
            Request::Configure(config),
            Request::Load(run),
            Request::Arm,
            Request::Stream(true),
            Request::Run,
        ];
        for request in requests {
            board.handle(request).expect("a sound request");
        }
        for tick in 0..1300 {
            if tick % 100 == 0 {
                let _ = board.handle(Request::Heartbeat);
            }
            board.ports_mut().now_us += 1000;
            board.tick();
            while let Some(sample) = samples.pop() {
                sample.counts.iter().for_each(|count| digest.integer(i64::from(*count)));
                digest.integer(i64::from(sample.output_count));
                digest.integer(i64::from(sample.setpoint_micro));
                digest.bytes(&[sample.flags.0]);
            }
        }
    }
    let status = board.status();
    digest.integer(i64::from(status.fault.map_or(0, |fault| fault.code())));
    digest.integer(i64::from(status.limited));
    digest.0
}

/// Frames to the host over a line that damages every seventh, and the decoded messages.
fn messages() -> u64 {
    let (mut digest, mut counts) = (Digest::new(), Counts(3));
    let mut ring = Ring::<i16, 64>::new();
    let (mut producer, samples) = ring.split();
    let front_end = FrontEnd {
        kind: BoardKind::Analog,
        input_full_scale_uv: 1,
        output_full_scale_uv: 2,
        channel_step_ns: 3,
    };
    let identity = Identity {
        board: Text::new("board"),
        firmware: Text::new("firmware"),
        front_end,
        start: Start::Pin,
        enable_feedback: EnableFeedback::Pin,
        image: Image::Unsealed,
    };
    let (mut link, mut decoder) = (BoardLink::new(identity, samples), Decoder::<ToHost>::new());
    let mut frame = [0; MAX_FRAME];
    for number in 0..40 {
        for at in 0..20 {
            let counts = core::array::from_fn(|_| counts.next());
            let tick = number * 20 + at;
            producer.push(&Sample { tick, seq: tick, counts, ..Sample::default() });
        }
        let len = link.samples(Layout::narrow(4), 1, &mut frame).expect("samples wait");
        if number % 7 == 3 {
            frame[len / 2] ^= 0x10;
        }
        digest.bytes(&frame[..len]);
        let mut bytes = &frame[..len];
        while let Some(item) = decoder.next(&mut bytes) {
            digest.integer(i64::from(item.is_ok()));
            if let Ok(ToHost::Samples(batch)) = item {
                batch.samples().for_each(|sample| digest.integer(i64::from(sample.counts[3])));
            }
        }
    }
    digest.0
}
