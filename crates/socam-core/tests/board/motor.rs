//! A gearmotor behind the ports: winding, shaft and encoder, and what can go wrong with each.

use socam_core::encoder::{Encoder, EncoderReading};
use socam_core::{
    Board, Channel, ChannelKind, Command, Config, ConverterSilent, Fault, MAX_CHANNELS, MotorWatch, Output,
    Ports, Profile, Request, Ring, Scale, Shape, SpeedControl, State, scaling,
};

const OHM: f64 = 2.2;
const V_S: f64 = 0.011;
const COUNTS_PER_TURN: f64 = 64.0;
const TICKS_PER_S: u32 = 10_000_000;

/// Counts are millivolt and milliampere.
const MILLI: Scale = Scale { micro_per_count_q16: 1000 << 16, offset_micro: 0 };

struct Motor {
    now_us: u64,
    supply_v: f64,
    volts: f64,
    enabled: bool,
    rad_s: f64,
    amperes: f64,
    turns: f64,
    count: i32,
    edge_ticks: u32,
    encoder: Encoder,
    is_locked: bool,
    /// Factor of the encoder's count: 0 broken, -1 swapped.
    counts: f64,
}

impl Motor {
    fn step(&mut self, seconds: f64) {
        let winding_v = self.volts - V_S * self.rad_s;
        self.amperes = if self.enabled { winding_v / OHM } else { 0.0 };
        let friction = 2e-3 * (self.rad_s / 0.5).tanh();
        self.rad_s += (V_S * self.amperes - friction) / 3e-6 * seconds;
        self.rad_s *= f64::from(u8::from(!self.is_locked));
        self.turns += self.counts * self.rad_s / core::f64::consts::TAU * seconds;
        let count = (self.turns * COUNTS_PER_TURN).floor() as i32;
        if count != self.count {
            self.edge_ticks = (self.now_us * 10) as u32;
            self.count = count;
        }
    }
}

impl Ports for Motor {
    type Count = i32;

    const WATCHES_MOTOR: bool = true;

    fn now_us(&mut self) -> u64 {
        self.now_us
    }

    fn read(&mut self, counts: &mut [i32]) -> Result<(), ConverterSilent> {
        let [angle, speed] = self.encoder.sample();
        let milli = |value: f64| (value * 1e3) as i32;
        let all = [angle, speed, milli(self.amperes), milli(self.supply_v), milli(self.volts)];
        counts.iter_mut().zip(all).for_each(|(count, value)| *count = value);
        Ok(())
    }

    fn write(&mut self, count: i16) -> Result<(), ConverterSilent> {
        self.volts = (f64::from(count) * 16.0 / 32768.0).clamp(-self.supply_v, self.supply_v);
        Ok(())
    }

    fn enable(&mut self, on: bool) {
        self.enabled = on;
    }
}

fn motor() -> Motor {
    Motor {
        now_us: 0,
        supply_v: 12.0,
        volts: 0.0,
        enabled: false,
        rad_s: 0.0,
        amperes: 0.0,
        turns: 0.3,
        count: 19,
        edge_ticks: 0,
        encoder: Encoder::new(TICKS_PER_S, 2),
        is_locked: false,
        counts: 1.0,
    }
}

/// The bench's configuration, with a winding that is `known` times as large as it is.
fn config(known: f64) -> Config {
    let radians = core::f64::consts::TAU / COUNTS_PER_TURN * 1e6 * 65536.0;
    let encoder = |per_count: f64| Scale { micro_per_count_q16: per_count as i64, offset_micro: 0 };
    let used = [
        Channel { kind: ChannelKind::EncoderAngle, scale: encoder(radians / 16.0), ..Channel::UNUSED },
        Channel {
            kind: ChannelKind::EncoderSpeed,
            scale: encoder(radians / 256.0),
            limit_micro: Some(1_200_000_000),
            ..Channel::UNUSED
        },
        Channel { kind: ChannelKind::Current, scale: MILLI, limit_micro: Some(6_000_000), ..Channel::UNUSED },
        Channel { scale: MILLI, ..Channel::UNUSED },
        Channel { scale: MILLI, ..Channel::UNUSED },
    ];
    let mut channels = [Channel::UNUSED; MAX_CHANNELS];
    channels.iter_mut().zip(used).for_each(|(slot, channel)| *slot = channel);
    let line = scaling::MotorCalibration { rpm_per_volt: 860.0, offset_rpm: -300.0 };
    Config {
        channel_count: 5,
        channels,
        output: Output {
            counts_per_uv_q32: scaling::counts_per_uv_q32(&scaling::Converter {
                bits: 16,
                full_scale_v: 16.0,
            }),
            clamp_uv: 12_000_000,
        },
        speed: SpeedControl::with_gains(&line, 1, 0.005, 0.1),
        confirm_samples: 2,
        moving_uv: 2_000_000,
        motor: Some(MotorWatch {
            speed: 1,
            current: 2,
            voltage: 4,
            supply: 3,
            resistance_q16: (OHM * known * 65536.0) as i32,
            back_emf_q24: (V_S * known * 16_777_216.0) as i32,
            after_us: 50_000,
            lowest_supply_uv: 8_000_000,
        }),
        ..Config::default()
    }
}

type MotorBoard<'r> = Board<'r, Motor, 4>;

fn run_for(board: &mut MotorBoard<'_>, milliseconds: u32) {
    for _ in 0..milliseconds {
        board.handle(Request::Heartbeat).unwrap();
        for _ in 0..4 {
            let ports = board.ports_mut();
            for _ in 0..25 {
                ports.now_us += 10;
                ports.step(1e-5);
            }
            let now_ticks = (ports.now_us * 10) as u32;
            let (count, age_ticks) = (ports.count, now_ticks.wrapping_sub(ports.edge_ticks));
            ports.encoder.push(&EncoderReading { count, age_ticks, now_ticks });
        }
        board.tick();
    }
}

fn start(board: &mut MotorBoard<'_>, config: Config, profile: Profile) {
    run_for(board, 3);
    for request in [Request::Configure(config), Request::Load(profile), Request::Arm, Request::Run] {
        board.handle(request).unwrap();
    }
}

fn profile(command: Command, shape: Shape, limit_micro: i32) -> Profile {
    let slew_micro_s = if command == Command::Voltage { 200_000_000 } else { 2_000_000_000 };
    Profile { command, shape, ramp_us: 0, limit_micro, slew_micro_s, duration_us: 2_000_000 }
}

#[test]
fn each_failure_of_motor_encoder_and_supply_stops_the_run_and_is_named() {
    type Provoke = fn(&mut Motor);
    let cases: [(Provoke, u32, &str); 6] = [
        (|m| m.is_locked = true, 60, "the motor is stalled: current is 4.09"),
        (|m| m.counts = 0.0, 60, "speed is 1.959 rad/s, but the motor turns at about 78"),
        (|m| m.counts = -1.0, 60, "speed is -7"),
        (
            |m| m.supply_v = 1.0,
            2,
            "the motor's supply is low or gone: supply is 1.000 V, the least is 8.000 V",
        ),
        (|m| m.volts = -12.0, 5, "over-current: current is -"),
        (|m| m.rad_s = 1300.0, 5, "over-speed: speed is 1"),
    ];
    for (provoke, within_ticks, sentence) in cases {
        let mut ring = Ring::new();
        let (producer, _consumer) = ring.split();
        let mut board = Board::new(motor(), producer);
        start(
            &mut board,
            config(1.0),
            profile(Command::Voltage, Shape::Constant { level_micro: 9_000_000 }, 12_000_000),
        );
        run_for(&mut board, 500);
        assert_eq!(board.status().fault, None, "before {sentence}");
        assert!((board.ports_mut().rad_s - 780.0).abs() < 20.0, "{}", board.ports_mut().rad_s);
        provoke(board.ports_mut());
        for _ in 0..within_ticks {
            if sentence.starts_with("over-speed") {
                board.ports_mut().rad_s = 1300.0;
            } else if sentence.starts_with("over-current") {
                board.ports_mut().volts = -12.0;
            }
            run_for(&mut board, 1);
        }
        let fault = board.status().fault.expect(sentence);
        let names = ["angle", "speed", "current", "supply", "voltage"];
        let said = fault.with_names(&names).to_string();
        assert!(said.starts_with(sentence), "{said}");
        assert!(!board.ports_mut().enabled, "{sentence}: still enabled");
    }
}

#[test]
fn a_healthy_motor_that_reverses_raises_no_alarm_with_a_winding_known_to_a_quarter() {
    for known in [0.75, 1.0, 1.25] {
        let mut ring = Ring::new();
        let (producer, _consumer) = ring.split();
        let mut board = Board::new(motor(), producer);
        let swing = Shape::Triangle { amplitude_micro: 9_000_000, offset_micro: 0, period_us: 300_000 };
        start(&mut board, config(known), profile(Command::Voltage, swing, 12_000_000));
        run_for(&mut board, 2100);
        assert_eq!((board.status().fault, board.status().state), (None, State::Idle), "{known}");
    }
}

#[test]
fn the_speed_loop_runs_on_an_encoder_and_a_swapped_one_is_found_before_it_runs_away() {
    let mut ring = Ring::new();
    let (producer, _consumer) = ring.split();
    let mut board = Board::new(motor(), producer);
    let hold =
        || profile(Command::SpeedClosedLoop, Shape::Constant { level_micro: 300_000_000 }, 600_000_000);
    start(&mut board, config(1.0), hold());
    run_for(&mut board, 1500);
    let speed = board.ports_mut().rad_s;
    assert!((speed - 300.0).abs() < 3.0, "{speed}");

    let mut ring = Ring::new();
    let (producer, _consumer) = ring.split();
    let mut board = Board::new(Motor { counts: -1.0, ..motor() }, producer);
    start(&mut board, config(1.0), hold());
    run_for(&mut board, 400);
    assert!(
        matches!(board.status().fault, Some(Fault::EncoderReversed { channel: 1, .. })),
        "{:?}",
        board.status().fault
    );
}
