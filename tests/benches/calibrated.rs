//! Do the intervals of `calibrate` hold the truth? Random sensors with random instruments, some of whose readings are wrong, and the
//! motor and tachometers of random virtual benches.
//!
//! `cargo bench -p socam-tests --bench calibrated -- --draws 300` prints the table.

use clap::Parser;
use rayon::prelude::*;
use socam_calibrate::tasks::{Assumed, Task};
use socam_calibrate::{Line, steady};
use socam_core::scaling::MotorCalibration;
use socam_model::Model;
use socam_recording::{Calibration, ProfileFile, Waveform};
use socam_sim::{Override, Setup, Truth};
use socam_tests::Draw;

/// Of the default motor, (rad/s)/(N m): see the simulator's drive.
const DROOP: f64 = 1.5;

#[derive(Debug, Parser)]
struct Args {
    /// Sensors and benches to draw
    #[arg(long, default_value_t = 300)]
    draws: u64,
    /// Another number, other draws
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// What was judged, and whether its interval held.
type Held = Vec<(&'static str, bool)>;

/// A sensor, calibrated by hand.
fn sensor(draw: &mut Draw) -> Held {
    let (gain, offset) = (draw.between(0.01, 3.0), draw.between(-0.1, 0.1));
    let (low, high) = (draw.between(-50.0, 10.0), draw.between(20.0, 150.0));
    let count = draw.between(8.0, 40.0) as usize;
    let span = gain * (high - low);
    let noise = span * draw.between(0.0005, 0.005);
    let wrong = draw.between(0.0, 0.15);
    let accuracy = if draw.chance(0.5) { 0.0 } else { draw.between(0.001, 0.01) };
    let instrument = 1.0 + accuracy * draw.normal();
    let pairs: Vec<[f64; 2]> = (0..count)
        .map(|i| {
            let truth = low + (high - low) * i as f64 / (count - 1) as f64;
            let slip = if draw.chance(wrong) { span * draw.between(-0.3, 0.3) } else { 0.0 };
            [truth * instrument, offset + gain * truth + noise * draw.normal() + slip]
        })
        .collect();
    let Ok(line) = Line::through("sensor", "reading", &pairs, accuracy) else { return Vec::new() };
    let bent = line.nonlinearity.is_some_and(|bent| bent.chance < 0.01);
    vec![
        ("sensor: gain", line.gain.holds(gain)),
        ("sensor: offset", line.offset.holds(offset)),
        ("sensor: called straight", !bent),
    ]
}

/// A virtual bench, recorded over a staircase of commands: what a drive's and a converter's last digits do to one of them is the same
/// every time, and would be judged as if it were chance.
fn bench(draw: &mut Draw) -> Result<Held, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let model = Model::builtin("speed-o-cam").ok_or("no default model")?;
    let load = draw.between(0.02, 0.1);
    let gains = [draw.between(0.97, 1.03), draw.between(0.97, 1.03)];
    let hidden = ["motor_speed", "output_speed"]
        .iter()
        .zip(gains)
        .map(|(channel, gain)| format!("sensor_gain@{channel}:gain={gain}").parse());
    let hidden: Vec<_> = hidden.collect::<Result<_, _>>().map_err(|e| text(&e))?;
    let truth =
        Truth::new(&model, &[Override { name: "c5".into(), value: load }], &hidden).map_err(|e| text(&e))?;
    let setup = Setup::new(truth, Calibration::default(), draw.between(0.0, 1e9) as u64);
    let (first, last) = (draw.between(0.5, 0.8), draw.between(1.3, 1.7));
    let count = draw.between(5.0, 11.0) as u16;
    let step = (last - first) / f64::from(count - 1);
    // A whole number of samples.
    let dwell_s = 1e-3 * (10e3 / f64::from(count)).floor();
    let mut profile = ProfileFile::open("steps").map_err(|e| text(&e))?;
    profile.duration_s = 10.0;
    profile.waveform = Waveform::Staircase { first, step, count, dwell_s, and_back: false };
    let waveform = profile.profile(1000).map_err(|e| text(&e))?;
    let data = setup.record("steps", &waveform, 1000).map_err(|e| text(&e))?;
    let found = steady::of(&[data], &model, &Assumed::default()).map_err(|e| text(&e))?;
    let motor = MotorCalibration::LOADED;
    let yields = 1.0 + DROOP * load / 64.0;
    let mut held = Vec::new();
    for task in &found.tasks {
        match task {
            Task::Motor { line } => {
                held.push(("motor: gain", line.gain.holds(gains[0] * motor.rpm_per_volt / yields)));
                held.push(("motor: offset", line.offset.holds(gains[0] * motor.offset_rpm / yields)));
            }
            Task::Tachometers { line, .. } => {
                held.push(("tachometers: ratio", line.gain.holds(gains[1] / gains[0])))
            }
            _ => {}
        }
    }
    Ok(held)
}

fn main() -> Result<(), String> {
    let args = Args::parse();
    let one = |number: u64| {
        let mut draw = Draw::new(args.seed, number);
        let mut held = sensor(&mut draw);
        held.extend(bench(&mut draw)?);
        Ok(held)
    };
    let all: Vec<Held> = (0..args.draws).into_par_iter().map(one).collect::<Result<_, String>>()?;
    let all: Vec<(&str, bool)> = all.into_iter().flatten().collect();
    let mut names: Vec<&str> = Vec::new();
    all.iter().for_each(|(name, _)| {
        if !names.contains(name) {
            names.push(name)
        }
    });
    println!("95 % intervals that hold the truth, {} draws", args.draws);
    for name in names {
        let own: Vec<bool> = all.iter().filter(|(other, _)| *other == name).map(|(_, held)| *held).collect();
        let held = own.iter().filter(|held| **held).count();
        println!("  {name:<26} {:5.1} %  ({held} of {})", 100.0 * held as f64 / own.len() as f64, own.len());
    }
    Ok(())
}
