//! The firmware's image on an emulated board, at a simulated bench.
//!
//! Node runs the microcontroller and the converters (`tests/emulator`); the drivetrain of `socam-sim` runs in a thread here and is asked
//! for voltages over the emulator's standard input and output.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::OnceLock;
use std::thread::JoinHandle;

use serde_json::{Value, json};
use socam_model::Model;
use socam_recording::Calibration;
use socam_sim::{Analog, Setup, Truth, calibration_for};

use crate::firmware;

/// Hidden effects of a bench behind the filters of docs/firmware.md. Each filter has two poles that delay signals by 0.217 ms, as a
/// Bessel filter of 1 kHz does; its parts are a quarter of a per cent off, either way.
pub const FILTERS: [&str; 8] = [
    "sensor_lag@motor_speed:time_constant=1.0805e-4",
    "sensor_lag@motor_speed:time_constant=1.0805e-4",
    "sensor_lag@output_speed:time_constant=1.086e-4",
    "sensor_lag@output_speed:time_constant=1.086e-4",
    "sensor_lag@torque_in:time_constant=1.086e-4",
    "sensor_lag@torque_in:time_constant=1.086e-4",
    "sensor_lag@torque_out:time_constant=1.0805e-4",
    "sensor_lag@torque_out:time_constant=1.0805e-4",
];

/// Bytes of a question or command of the emulator: its kind, a time, a voltage or a bridge's duty, whether the drive is enabled or a number of
/// periods.
const MESSAGE: usize = 25;

/// Period of a gearmotor's bridge.
const BRIDGE_PERIOD_S: f64 = 50e-6;

/// The default bench with something hidden in it, as after `--hide`.
///
/// # Panics
/// When it cannot be built.
#[must_use]
pub fn bench(hidden: &[&str], seed: u64) -> Setup {
    let hidden: Vec<_> = hidden.iter().map(|text| text.parse().expect("a concealed effect")).collect();
    let model = Model::builtin("speed-o-cam").expect("the default model");
    Setup::new(Truth::new(&model, &[], &hidden).expect("the bench is sound"), Calibration::default(), seed)
}

/// The default gearmotor with something hidden in it.
///
/// # Panics
/// When it cannot be built.
#[must_use]
pub fn gearmotor(hidden: &[&str], seed: u64) -> Setup {
    let hidden: Vec<_> = hidden.iter().map(|text| text.parse().expect("a concealed effect")).collect();
    let model = Model::builtin("gearmotor").expect("the gearmotor");
    let truth = Truth::new(&model, &[], &hidden).expect("the bench is sound");
    let calibration = calibration_for(&truth.model);
    Setup::new(truth, calibration, seed)
}

/// A running board.
pub struct Emulator {
    node: Child,
    bench: Option<JoinHandle<()>>,
    control: BufReader<TcpStream>,
    /// The board's name for `socam-host --device`.
    pub device: String,
    /// Port of this machine at which the board's host is awaited.
    pub port: u16,
}

impl Emulator {
    /// The board at a bench, switched on; `None`, with the reason said, where there is no Node or no target.
    ///
    /// # Panics
    /// When the emulator does not start.
    pub fn start(setup: Setup) -> Option<Self> {
        Self::launch(setup, firmware::image()?, &[])
    }

    /// Starts the emulator with an image that `socam-host flash` has made.
    ///
    /// # Panics
    /// When the emulator does not start.
    pub fn start_flashed(setup: Setup, uf2: &Path) -> Option<Self> {
        Self::launch(setup, firmware::image()?, &[uf2])
    }

    /// The gearmotor board at a gearmotor, switched on, likewise.
    ///
    /// # Panics
    /// When the emulator does not start.
    pub fn start_gearmotor(setup: Setup) -> Option<Self> {
        Self::launch(setup, Path::new("gearmotor"), &[firmware::gearmotor()?])
    }

    fn launch(setup: Setup, first: &Path, more: &[&Path]) -> Option<Self> {
        let program = program()?;
        let mut node = Command::new("node")
            .arg(program.join("main.mjs"))
            .arg(first)
            .args(more)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("node starts");
        let (answers, questions) = (node.stdin.take().expect("a pipe"), node.stdout.take().expect("a pipe"));
        let bench = std::thread::spawn(move || serve(&setup, questions, answers));
        let mut stderr = BufReader::new(node.stderr.take().expect("a pipe"));
        let mut line = String::new();
        stderr.read_line(&mut line).expect("the emulator says where it listens");
        let ports: Vec<u16> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let [port, control] = ports[..] else { panic!("the emulator says: {line}{}", rest(&mut stderr)) };
        std::thread::spawn(move || {
            stderr.lines().map_while(Result::ok).for_each(|line| eprintln!("emulator: {line}"))
        });
        let control = BufReader::new(TcpStream::connect(("127.0.0.1", control)).expect("its control"));
        Some(Self { node, bench: Some(bench), control, device: format!("tcp:127.0.0.1:{port}"), port })
    }

    /// Sends a question or a command to the emulator and returns its answer.
    ///
    /// # Panics
    /// When it does not answer, or does not know what is asked.
    pub fn ask(&mut self, question: &Value) -> Value {
        writeln!(self.control.get_mut(), "{question}").expect("the emulator listens");
        let mut line = String::new();
        self.control.read_line(&mut line).expect("the emulator answers");
        let answer: Value =
            serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {question}: {line}"));
        assert!(answer.get("error").is_none(), "{question}: {answer}");
        answer
    }

    /// Does something to the board, so long after the drive is enabled next, or at once.
    pub fn inject(&mut self, what: &str, after_s: Option<f64>) {
        let _ = self.ask(&json!({ "ask": "inject", "what": what, "afterS": after_s }));
    }

    /// Lets this much of the board's time pass.
    pub fn run_for(&mut self, for_s: f64) {
        let _ = self.ask(&json!({ "ask": "run", "forS": for_s }));
    }

    /// Events on the board's lines so far.
    ///
    /// # Panics
    /// When the emulator's log is no log.
    pub fn log(&mut self) -> Vec<Happened> {
        let log = self.ask(&json!({ "ask": "log" }));
        let entries = log.as_array().expect("a list").iter();
        entries
            .map(|entry| Happened {
                at_s: entry["ns"].as_f64().expect("a time") * 1e-9,
                what: entry["what"].as_str().expect("a name").to_owned(),
                value: entry["value"].clone(),
            })
            .collect()
    }
}

/// A line of the emulator's log.
#[derive(Debug, Clone, PartialEq)]
pub struct Happened {
    /// Time since power-on, s.
    pub at_s: f64,
    /// `boot`, `enable`, `light`, `volts` (to and from 0 V) or `injected`.
    pub what: String,
    /// The cause of the boot, the new state of the line, the new voltage, or what was injected.
    pub value: Value,
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let _ = self.node.kill();
        let _ = self.node.wait();
        if let Some(bench) = self.bench.take() {
            let _ = bench.join();
        }
    }
}

fn rest(stream: &mut impl Read) -> String {
    let mut text = String::new();
    let _ = stream.read_to_string(&mut text);
    text
}

/// The bench's end of the emulator's questions, until it falls silent.
fn serve(setup: &Setup, mut questions: ChildStdout, mut answers: ChildStdin) {
    let ran = Analog::run(setup, |bench| {
        let mut message = [0; MESSAGE];
        let mut volts = vec![0.0; bench.channels()];
        while questions.read_exact(&mut message).is_ok() {
            let number = |at: usize| f64::from_le_bytes(std::array::from_fn(|i| message[at + i]));
            let (at_s, command_v, is_enabled) = (number(1), number(9), number(17) != 0.0);
            if message[0] == b'g' {
                // Several periods at a duty; negative where the bridge is off.
                let periods = number(17);
                let duty = (periods > 0.0).then_some(command_v);
                let mut reply = Vec::new();
                for period in 0..periods.abs() as u32 {
                    let at_s = at_s + f64::from(period) * BRIDGE_PERIOD_S;
                    let pins = bench.bridge(at_s, duty).expect("the bench goes on").expect("a gearmotor");
                    let numbers = pins.angles_rad.iter().chain(&pins.volts);
                    reply.extend(numbers.flat_map(|number| number.to_le_bytes()));
                }
                if answers.write_all(&reply).is_err() {
                    break;
                }
                continue;
            }
            if message[0] == b'c' {
                bench.command(at_s, command_v, is_enabled).expect("the bench goes on");
                continue;
            }
            bench.voltages(at_s, &mut volts).expect("the bench goes on");
            let reply: Vec<u8> = volts.iter().flat_map(|volts| volts.to_le_bytes()).collect();
            if answers.write_all(&reply).is_err() {
                break;
            }
        }
    });
    ran.expect("the bench can be built");
}

/// Output of a program on its serial line until it reaches a breakpoint, run by the emulated processor alone. `None` without Node;
/// the reason is then printed.
///
/// # Panics
/// When the emulator does not start or the program does not end.
pub fn say(image: &Path) -> Option<String> {
    let ran =
        Command::new("node").arg(program()?.join("alone.mjs")).arg(image).output().expect("node starts");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    Some(String::from_utf8(ran.stdout).expect("text"))
}

/// The emulator's folder with what it needs; `None`, with the reason said, where there was no set-up.
fn program() -> Option<&'static Path> {
    static PROGRAM: OnceLock<Option<PathBuf>> = OnceLock::new();
    let program = PROGRAM.get_or_init(copy).as_deref();
    if program.is_none() {
        crate::skip("the board's emulator is not installed (tests/run --set-up does it where there is Node)");
    }
    program
}

/// Copies the emulator's sources to the packages that `tests/run --set-up` has installed beside the build.
fn copy() -> Option<PathBuf> {
    let folder = firmware::kept("emulator");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("emulator");
    if !crate::readers::is_set_up(&source.join("package-lock.json"), &folder) {
        return None;
    }
    for entry in source.read_dir().expect("tests/emulator").map_while(Result::ok) {
        std::fs::copy(entry.path(), folder.join(entry.file_name())).expect("a copy beside the build");
    }
    Some(folder)
}
