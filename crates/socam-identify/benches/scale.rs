//! Cost of a fit of long recordings: processor and wall seconds and largest memory, with one thread and with two.
//!
//! `cargo bench -p socam-identify --bench scale -- [MILLIONS..]` records the default bench (its linear equations stepped
//! exactly, and noise) in millions of samples, by default 1 and 10, and fits it from the model file's values, one start. Each
//! fit is a process of its own, as is `scale fit FILE` of a log by `scale record FILE MILLIONS`. Fifty million samples take 4.5 GB under `target/`; a recording is removed after its fits.
//!
//! Linux only: it reads /proc/self.

use std::{error::Error, fs, path::Path, process::Command, time::Instant};

use nalgebra::DMatrix;
use serde_json::{Value, json};
use socam_identify::{Intersample, Options, Problem, output_error};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Recorder, RecordingHeader, SampleRow, Unit};

const STEP_NS: u64 = 1_000_000;
const STEP_S: f64 = STEP_NS as f64 / 1e9;
/// Number of samples after which the motion repeats; the noise does not repeat.
const PERIOD: usize = 60_000;
/// Sensor noise of output speed, torque in, torque out.
const NOISE: [f64; 3] = [0.02, 0.01, 0.05];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["record", file, millions] => {
            return record(Path::new(file), (millions.parse::<f64>()? * 1e6) as u64);
        }
        ["fit", file] => return fit(file),
        _ => {}
    }
    let mut millions = arguments.iter().map(|text| text.parse()).collect::<Result<Vec<f64>, _>>()?;
    if millions.is_empty() {
        millions = vec![1.0, 10.0];
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    println!(
        "   samples  threads    open s     CPU s    wall s   CPU us/sample/pass  memory MiB  speed-up  (on idle cores)"
    );
    for millions in millions {
        let samples = (millions * 1e6) as u64;
        let file = folder.join(format!("scale_{samples}.mcap"));
        record(&file, samples)?;
        let runs = [1, 2].map(|threads| run(&file, threads));
        fs::remove_file(&file)?;
        let [one, two] = runs.map(|run| run.unwrap_or_else(|e| json!({ "error": e.to_string() })));
        for (threads, run) in [(1, &one), (2, &two)] {
            let number = |key: &str| run[key].as_f64().unwrap_or(f64::NAN);
            println!(
                "{samples:10}  {threads:7}  {:8.2}  {:8.2}  {:8.2}   {:18.3}  {:10.0}  {:8.2}  {:15.2}",
                number("open_s"),
                number("cpu_s"),
                number("wall_s"),
                number("cpu_s") / samples as f64 / number("iterations") * 1e6,
                number("memory_kib") / 1024.0,
                one["wall_s"].as_f64().unwrap_or(f64::NAN) / number("wall_s"),
                number("cpu_s") / number("path_s"),
            );
        }
        let same = one["result"] == two["result"];
        println!("            {} iterations; the same digits: {same}", one["iterations"]);
        if !same {
            return Err(format!("results differ: {one} {two}").into());
        }
    }
    Ok(())
}

/// Fits in a process of its own and gives back what it printed.
fn run(file: &Path, threads: usize) -> Result<Value, Box<dyn Error>> {
    let output = Command::new(std::env::current_exe()?)
        .arg("fit")
        .arg(file)
        .env("RAYON_NUM_THREADS", threads.to_string())
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn fit(file: &str) -> Result<(), Box<dyn Error>> {
    let started = Instant::now();
    let model = Model::builtin("speed-o-cam").ok_or("no default model")?;
    let data = [Dataset::open(file)?];
    let open_s = started.elapsed().as_secs_f64();
    let options = Options { starts: 1, intersample: Some(Intersample::Linear), ..Options::default() };
    let problem = Problem::new(&model, &data, options)?;
    let mut result = output_error(&problem)?;
    // The only figure that may differ from run to run.
    result.cpu_s = 0.0;
    let report = json!({
        "open_s": open_s,
        "wall_s": started.elapsed().as_secs_f64(),
        "cpu_s": cpu_time::ProcessTime::now().as_duration().as_secs_f64(),
        "path_s": longest_path_s(),
        "memory_kib": status_kib("VmHWM:"),
        "iterations": result.iterations,
        "result": serde_json::to_value(&result)?,
    });
    println!("{report}");
    Ok(())
}

/// Records the default bench with other stiffnesses and dampings than its file's, driven by tones up to 90 Hz.
fn record(file: &Path, samples: u64) -> Result<(), Box<dyn Error>> {
    let model = Model::builtin("speed-o-cam").ok_or("no default model")?;
    let mut values = model.values();
    for (name, factor) in [("k1", 1.2), ("k4", 0.9), ("c3", 1.3), ("c4", 1.4), ("c5", 0.8)] {
        values[model.parameter(name).ok_or("the default model has no such parameter")?] *= factor;
    }
    let mut bench = Bench::new(&model, &values)?;
    let channels = [
        ("command", Unit::V),
        ("motor_speed", Unit::RadPerS),
        ("output_speed", Unit::RadPerS),
        ("torque_in", Unit::Nm),
        ("torque_out", Unit::Nm),
    ];
    let mut header = RecordingHeader::new(channels.map(|(name, unit)| Channel::new(name, unit)).to_vec());
    header.replace = true;
    let mut recorder = Recorder::create(file, &header)?;
    for sequence in 0..samples {
        while sequence % 4096 == 0 && !recorder.has_room() {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        let row = bench.next();
        recorder.push_samples(&[SampleRow {
            device_time_ns: (sequence * STEP_NS) as i64,
            sequence,
            flags: 0,
            raw_counts: &[],
            values: &row,
        }]);
    }
    let summary = recorder.finish()?;
    if summary.written != samples {
        return Err(format!("{} of {samples} samples were recorded", summary.written).into());
    }
    Ok(())
}

/// The bench's linear equations, exact for an input that is straight between samples.
struct Bench {
    motion: Vec<f64>,
    row: usize,
    /// x+ = [state | before | after] [x; u; u+], row by row.
    step: Vec<Vec<f64>>,
    /// y = [output | feedthrough] [x; u].
    sensors: Vec<Vec<f64>>,
    x: Vec<f64>,
    random: u64,
}

impl Bench {
    fn new(model: &Model, values: &[f64]) -> Result<Self, Box<dyn Error>> {
        let equations = model.equations(values)?;
        let (a, b) = (&equations.state, &equations.input);
        let states = a.nrows();
        // exp of [A B 0; 0 0 1/T; 0 0 0] T holds what a constant and a ramp do.
        let mut whole = DMatrix::zeros(states + 2, states + 2);
        whole.view_mut((0, 0), (states, states)).copy_from(&(a * STEP_S));
        whole.view_mut((0, states), (states, 1)).copy_from(&(b * STEP_S));
        whole[(states, states + 1)] = 1.0;
        let step = whole.exp();
        let rows = (0..states).map(|i| {
            let state = (0..states).map(|j| step[(i, j)]);
            let (constant, ramp) = (step[(i, states)], step[(i, states + 1)]);
            state.chain([constant - ramp, ramp]).collect()
        });
        let sensors = (0..equations.output.nrows()).map(|i| {
            let seen = (0..states).map(|j| equations.output[(i, j)]);
            seen.chain([equations.feedthrough[(i, 0)]]).collect()
        });
        Ok(Self {
            motion: motion(),
            row: 0,
            step: rows.collect(),
            sensors: sensors.collect(),
            x: vec![0.0; states],
            random: 1,
        })
    }

    /// Command, input, outputs; at rest at first.
    fn next(&mut self) -> [f64; 5] {
        let input = |row: usize| if row == 0 { 0.0 } else { self.motion[row % PERIOD] };
        let (now, next) = (input(self.row), input(self.row + 1));
        self.row += 1;
        let known: Vec<f64> = self.x.iter().copied().chain([now, next]).collect();
        let mut row = [now / 20.0, now, 0.0, 0.0, 0.0];
        for ((value, sensor), noise) in row[2..].iter_mut().zip(&self.sensors).zip(NOISE) {
            let uniform = |random: &mut u64| {
                *random =
                    random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (*random >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
            };
            // Three uniforms have variance one together.
            let normal: f64 = (0..3).map(|_| uniform(&mut self.random)).sum();
            *value = sensor.iter().zip(&known).map(|(a, b)| a * b).sum::<f64>() + noise * normal;
        }
        self.x = self.step.iter().map(|row| row.iter().zip(&known).map(|(a, b)| a * b).sum()).collect();
        row
    }
}

/// A mean and tones that fit into the period.
fn motion() -> Vec<f64> {
    let tones =
        [(0.7, 8.0), (2.3, 9.0), (7.1, 6.0), (13.3, 5.0), (19.7, 4.0), (36.1, 4.0), (61.3, 3.0), (88.9, 2.0)];
    let speed = |k: usize| {
        let t = k as f64 * STEP_S;
        let tone = |(i, (f, a)): (usize, &(f64, f64))| a * (std::f64::consts::TAU * f * t + i as f64).sin();
        60.0 + tones.iter().enumerate().map(tone).sum::<f64>()
    };
    (0..PERIOD).map(speed).collect()
}

/// Processor seconds one after the other: the main thread's, while it does not wait for the others, and the busiest other's.
fn longest_path_s() -> f64 {
    let threads = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let (mut main, mut busiest) = (0.0, 0.0_f64);
    for thread in threads {
        let times = fs::read_to_string(thread.path().join("schedstat")).unwrap_or_default();
        let nanoseconds = times.split_whitespace().next().and_then(|text| text.parse::<f64>().ok());
        let seconds = nanoseconds.unwrap_or(f64::NAN) / 1e9;
        if thread.file_name().to_str() == Some(&std::process::id().to_string()) {
            main = seconds;
        } else {
            busiest = busiest.max(seconds);
        }
    }
    main + busiest
}

fn status_kib(name: &str) -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default();
    line.split_whitespace().next().and_then(|kib| kib.parse().ok()).unwrap_or(0)
}
