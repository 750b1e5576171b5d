//! Bits that flip in the memory of the emulated boards during a run.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

use object::{Object, ObjectSymbol};
use serde_json::json;
use socam_core::{Command, Config, Profile, Request, Shape};
use socam_recording::Calibration;
use socam_tests::emulator::{Emulator, bench, gearmotor};
use socam_tests::firmware;
use socam_wire::{Encoder, MAX_FRAME, ToBoard};

/// A constant voltage for ten minutes of the board's time: the drive is switched on and off hundreds of times a second, and must not over-speed.
const fn steady(level_micro: i32) -> Profile {
    Profile {
        command: Command::Voltage,
        shape: Shape::Constant { level_micro },
        ramp_us: 0,
        limit_micro: level_micro,
        slew_micro_s: 3_000_000,
        duration_us: 600_000_000,
    }
}

/// A host that starts a run.
struct Host {
    line: TcpStream,
    encoder: Encoder,
    number: u16,
}

impl Host {
    fn frame(&mut self, request: Request) -> Vec<u8> {
        self.number += 1;
        let mut frame = [0; MAX_FRAME];
        let message = ToBoard::Request { number: self.number, request };
        let len = self.encoder.encode(&message, &mut frame).unwrap();
        frame[..len].to_vec()
    }

    fn say(&mut self, request: Request) {
        let frame = self.frame(request);
        self.line.write_all(&frame).unwrap();
    }

    /// Reads what has come, so that the board is not held up.
    fn listen(&mut self, for_ms: u64) {
        self.line.set_read_timeout(Some(Duration::from_millis(for_ms))).unwrap();
        let mut bytes = [0; 1 << 16];
        while self.line.read(&mut bytes).is_ok_and(|count| count > 0) {}
    }
}

/// More than two for each bit to flip.
const HEARTBEATS: usize = 4000;

/// The words that the output depends on, and those of limits and of times until a sensor counts as stuck, each of which has a word in front that says
/// that there is one; a motor that is watched has one such word.
fn words(config: &Config, profile: &Profile) -> [Vec<u32>; 2] {
    let halves = |value: i64| [value as u32, (value >> 32) as u32];
    let speed = &config.speed;
    let mut words = vec![config.output.clamp_uv as u32, config.host_timeout_us, config.missing_after_us];
    words.extend([config.moving_uv as u32, speed.motor.offset_uv as u32]);
    // Words of the profile as it was loaded; the generator's own copies have other units, or change.
    words.extend([profile.slew_micro_s, profile.duration_us as u32]);
    for value in [config.output.counts_per_uv_q32, speed.proportional_q32, speed.integral_per_s_q32] {
        words.extend(halves(value));
    }
    for channel in config.used_channels() {
        words.extend(halves(channel.scale.micro_per_count_q16));
    }
    let channels = config.used_channels().iter();
    let limits =
        channels.flat_map(|channel| [channel.limit_micro.map(|limit| limit as u32), channel.stuck_after_us]);
    let mut limits: Vec<_> = limits.flatten().collect();
    if let Some(motor) = &config.motor {
        limits.extend(
            [motor.resistance_q16, motor.back_emf_q24, motor.lowest_supply_uv].map(|value| value as u32),
        );
        words.push(motor.after_us);
        words.push(u32::from_le_bytes([motor.speed, motor.current, motor.voltage, motor.supply]));
    }
    // Zeros are everywhere.
    words.retain(|word| *word != 0);
    [words, limits]
}

/// Bytes that the linker gave to the sampling interrupt's data.
fn sampler_bytes(image: &Path) -> u64 {
    let data = std::fs::read(image).unwrap();
    let file = object::File::parse(&*data).unwrap();
    file.symbols().find(|symbol| symbol.name().is_ok_and(|name| name.contains("SAMPLER"))).unwrap().size()
}

/// A board in a run at a steady voltage.
struct Trial<'a> {
    board: Emulator,
    image: &'a Path,
    config: Config,
    volts: f64,
    /// The output stays so near to `volts`.
    near_v: f64,
    /// Time from the profile's load to a steady voltage.
    settles_s: f64,
}

/// How many words there were, and how many bits of them cut the output.
struct Outcome {
    words: u64,
    off: u64,
}

/// Flips all bits of the words of the configuration, one after the other.
fn flip(trial: Trial) -> Outcome {
    let Trial { mut board, image, config, volts, near_v, settles_s } = trial;
    let profile = steady((volts * 1e6) as i32);
    let line = TcpStream::connect(("127.0.0.1", board.port)).unwrap();
    let mut host = Host { line, encoder: Encoder::new(), number: 0 };
    // The board enumerates first.
    board.run_for(0.2);
    for request in [Request::Configure(config), Request::Load(profile), Request::Arm, Request::Run] {
        host.say(request);
        board.run_for(0.02);
    }
    for _ in 0..(settles_s / 0.2).ceil() as u32 {
        host.say(Request::Heartbeat);
        board.run_for(0.2);
    }
    let log = board.log();
    let enabled = log.iter().rfind(|entry| entry.what == "enable").expect("a run");
    assert_eq!(enabled.value, true, "{log:?}");
    // The word in front of a limit says that there is one. A thousand is the sampling period next to the host's timeout only.
    let [values, limits] = words(&config, &profile);
    let near = json!({ "value": config.sample_period_us, "of": config.host_timeout_us, "bytes": 16 });
    let heartbeats = (0..HEARTBEATS).map(|_| host.frame(Request::Heartbeat));
    let heartbeats =
        heartbeats.map(|frame| frame.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
    let mut heartbeats: Vec<_> = heartbeats.collect();
    heartbeats.reverse();
    let flip = json!({
        "ask": "flip", "values": values, "limits": limits, "near": near, "bytes": sampler_bytes(image), "heartbeats": heartbeats,
        "nearV": near_v,
    });
    let asking = std::thread::spawn(move || (board.ask(&flip), board));
    while !asking.is_finished() {
        host.listen(5);
    }
    let (outcome, _board) = asking.join().unwrap();
    println!(
        "measured: bits flipped in the configuration of {}: {outcome}",
        image.file_name().unwrap().display()
    );
    assert_eq!((&outcome["harmful"], &outcome["left"]), (&json!([]), &json!(0)));
    // Bits that are noticed are so before the next voltage is computed.
    assert!(outcome["peakV"].as_f64().unwrap() <= volts + near_v, "{outcome}");
    let [words, off] = ["words", "off"].map(|count| outcome[count].as_u64().unwrap());
    Outcome { words, off }
}

#[test]
fn no_bit_that_flips_in_the_configuration_moves_the_bench() {
    let Some(board) = Emulator::start(bench(&[], 3)) else { return };
    let mut calibration = Calibration::default();
    calibration.input.full_scale_v = 10.24;
    let config = calibration.config(1000).unwrap();
    let image = firmware::image().unwrap();
    let Outcome { words, off } =
        flip(Trial { board, image, config, volts: 0.6, near_v: 1e-3, settles_s: 0.8 });
    // Some of the words are what moved values left behind, also in what is none now: only the compiler says how many. These are all that count.
    assert!(words >= 34 && off >= 35 * 32, "{words} {off}");
}

#[test]
fn no_bit_that_flips_in_a_gearmotors_configuration_drives_its_bridge() {
    let setup = gearmotor(&[], 3);
    let config = setup.calibration.config(1000).unwrap();
    let Some(board) = Emulator::start_gearmotor(setup) else { return };
    let image = firmware::gearmotor().unwrap();
    // The bridge's duty follows the supply as it is measured. The generator's copy of the voltage is not sealed: no other word of the profile
    // or the configuration has its value in microvolts.
    let Outcome { words, off } =
        flip(Trial { board, image, config, volts: 2.5, near_v: 0.05, settles_s: 1.6 });
    assert!(words >= 38 && off >= 36 * 32, "{words} {off}");
}
