//! Bits that flip in the memory of the emulated board during a run.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use object::{Object, ObjectSymbol};
use serde_json::json;
use socam_core::{Command, Config, Profile, Request, Shape};
use socam_recording::Calibration;
use socam_tests::emulator::{Emulator, bench};
use socam_tests::firmware;
use socam_wire::{Encoder, MAX_FRAME, ToBoard};

/// 0.6 V for ten minutes of the board's time: the drive is switched on and off hundreds of times a second, and must not over-speed.
const PROFILE: Profile = Profile {
    command: Command::Voltage,
    shape: Shape::Constant { level_micro: 600_000 },
    ramp_us: 0,
    limit_micro: 600_000,
    slew_micro_s: 3_000_000,
    duration_us: 600_000_000,
};

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
/// that there is one.
fn words(config: &Config) -> [Vec<u32>; 2] {
    let halves = |value: i64| [value as u32, (value >> 32) as u32];
    let speed = &config.speed;
    let mut words = vec![config.output.clamp_uv as u32, config.host_timeout_us, config.missing_after_us];
    words.extend([config.moving_uv as u32, speed.motor.offset_uv as u32]);
    // Words of the profile as it was loaded; the generator's own copies have other units, or change.
    words.extend([PROFILE.slew_micro_s, PROFILE.duration_us as u32]);
    for value in [config.output.counts_per_uv_q32, speed.proportional_q32, speed.integral_per_s_q32] {
        words.extend(halves(value));
    }
    for channel in config.used_channels() {
        words.extend(halves(channel.scale.micro_per_count_q16));
    }
    let channels = config.used_channels().iter();
    let limits =
        channels.flat_map(|channel| [channel.limit_micro.map(|limit| limit as u32), channel.stuck_after_us]);
    let limits = limits.flatten().collect();
    // Zeros are everywhere.
    words.retain(|word| *word != 0);
    [words, limits]
}

/// Bytes that the linker gave to the sampling interrupt's data.
fn sampler_bytes() -> u64 {
    let data = std::fs::read(firmware::image().unwrap()).unwrap();
    let file = object::File::parse(&*data).unwrap();
    file.symbols().find(|symbol| symbol.name().is_ok_and(|name| name.contains("SAMPLER"))).unwrap().size()
}

#[test]
fn no_bit_that_flips_in_the_configuration_moves_the_bench() {
    let Some(mut board) = Emulator::start(bench(&[], 3)) else { return };
    let mut calibration = Calibration::default();
    calibration.input.full_scale_v = 10.24;
    let config = calibration.config(1000).unwrap();
    let line = TcpStream::connect(("127.0.0.1", board.port)).unwrap();
    let mut host = Host { line, encoder: Encoder::new(), number: 0 };
    // The board enumerates first.
    board.run_for(0.2);
    for request in [Request::Configure(config), Request::Load(PROFILE), Request::Arm, Request::Run] {
        host.say(request);
        board.run_for(0.02);
    }
    for _ in 0..4 {
        host.say(Request::Heartbeat);
        board.run_for(0.2);
    }
    let log = board.log();
    let enabled = log.iter().rfind(|entry| entry.what == "enable").expect("a run");
    assert_eq!(enabled.value, true, "{log:?}");
    // The word in front of a limit says that there is one. A thousand is the sampling period next to the host's timeout only.
    let [values, limits] = words(&config);
    let near = json!({ "value": config.sample_period_us, "of": config.host_timeout_us, "bytes": 16 });
    let heartbeats = (0..HEARTBEATS).map(|_| host.frame(Request::Heartbeat));
    let heartbeats =
        heartbeats.map(|frame| frame.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
    let mut heartbeats: Vec<_> = heartbeats.collect();
    heartbeats.reverse();
    let flip = json!({
        "ask": "flip", "values": values, "limits": limits, "near": near, "bytes": sampler_bytes(), "heartbeats": heartbeats
    });
    let asking = std::thread::spawn(move || (board.ask(&flip), board));
    while !asking.is_finished() {
        host.listen(5);
    }
    let (outcome, _board) = asking.join().unwrap();
    println!("measured: bits flipped in the configuration: {outcome}");
    assert_eq!((&outcome["harmful"], &outcome["left"]), (&json!([]), &json!(0)));
    // Bits that are noticed are so before the next voltage is computed.
    assert!(outcome["peakV"].as_f64().unwrap() <= 0.601, "{outcome}");
    let [words, off] = ["words", "off"].map(|count| outcome[count].as_u64().unwrap());
    // Some of the words are what moved values left behind, also in what is none now: only the compiler says how many. These are all that count.
    assert!(words >= 34 && off >= 35 * 32, "{outcome}");
}
