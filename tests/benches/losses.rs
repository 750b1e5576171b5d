//! Do the intervals of `efficiency` hold the truth, and is a tachometer's gain told from a loss? Virtual benches with random losses, loads
//! and sensors.
//!
//! `cargo bench -p socam-tests --bench losses -- --draws 300` prints the table.

use clap::Parser;
use rayon::prelude::*;
use socam_calibrate::Estimate;
use socam_efficiency::{SensorStd, Sensors, measure};
use socam_model::{BUILTIN, Model};
use socam_recording::{Calibration, ProfileFile};
use socam_sim::{Concealed, Override, Setup, Truth};
use socam_tests::Draw;

#[derive(Debug, Parser)]
struct Args {
    /// Benches to draw
    #[arg(long, default_value_t = 300)]
    draws: u64,
    /// Another number, other draws
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// One line for each bench
    #[arg(long)]
    list: bool,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// One quantity of one bench; what a bench does not determine is missing there.
struct Judged {
    name: &'static str,
    truth: f64,
    found: Estimate,
}

/// The default bench with a bearing that drags.
fn model() -> Result<Model, String> {
    let parameter =
        "\nc_cam = { value = 1e-4, unit = \"N m s/rad\", bounds = [0, 1], source = \"assumed\" }\nJ2 = {";
    let text = BUILTIN[0].1.replacen("\nJ2 = {", parameter, 1).replacen(
        "at = \"cam_shaft\"",
        "at = \"cam_shaft\"\ndamping = \"c_cam\"",
        1,
    );
    Model::parse(&text).map_err(|error| error.to_string())
}

/// Relative standard uncertainty of the torque sensors' gains, as a calibration would say it, and of the tachometers' error.
const GAIN_STD: f64 = 0.002;
const TACHOMETER_ERROR: f64 = 0.02;

fn bench(seed: u64, number: u64) -> Result<Vec<Judged>, String> {
    let mut draw = Draw::new(seed, number);
    let share = draw.between(0.01, 0.12);
    let (viscous, load) = (draw.between(0.0, 3e-4), draw.between(0.02, 0.1));
    let constant = if draw.chance(0.5) { 0.0 } else { draw.between(2e-3, 2e-2) };
    let tachometer = if draw.chance(0.5) { 1.0 - TACHOMETER_ERROR } else { 1.0 + TACHOMETER_ERROR };
    let noise = draw.between(0.0, 1e9) as u64;
    let gains = [draw.normal(), draw.normal()].map(|normal| 1.0 + GAIN_STD * normal);
    let mut hidden = vec![
        format!("mesh_loss@mesh:fraction={share},transition_torque=0.01"),
        format!("sensor_gain@output_speed:gain={tachometer}"),
        format!("sensor_gain@torque_in:gain={}", gains[0]),
        format!("sensor_gain@torque_out:gain={}", gains[1]),
    ];
    if constant > 0.0 {
        hidden.push(format!("coulomb_friction@cam_bearing:torque={constant}"));
    }
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let hidden: Vec<Concealed> =
        hidden.iter().map(|text| text.parse()).collect::<Result<_, _>>().map_err(|e| text(&e))?;
    let model = model()?;
    let overrides = [("c5", load), ("c_cam", viscous.max(1e-9))]
        .map(|(name, value)| Override { name: name.into(), value });
    let truth = Truth::new(&model, &overrides, &hidden).map_err(|e| text(&e))?;
    let mut setup = Setup::new(truth, Calibration::default(), noise);
    let mut runs = Vec::new();
    for name in ["steps", "triangle"] {
        setup.seed += 1;
        let mut profile = ProfileFile::open(name).map_err(|e| text(&e))?;
        profile.duration_s = 10.0;
        let waveform = profile.profile(1000).map_err(|e| text(&e))?;
        runs.push(setup.record(name, &waveform, 1000).map_err(|e| text(&e))?);
    }
    let known = SensorStd { gain: Some(GAIN_STD), offset: None };
    let sensors = Sensors { torque_in: known, torque_out: known, ..Sensors::default() };
    let default = Model::builtin("speed-o-cam").ok_or("no default model")?;
    let found = measure(&default, &runs, &sensors, false).map_err(|e| text(&e))?;
    let mut judged = Vec::new();
    let mut judge = |name, truth, found: Option<Estimate>| {
        judged.extend(found.map(|found| Judged { name, truth, found }))
    };
    judge("loss in proportion to torque", share, found.losses.torque_share);
    judge("loss in proportion to speed", viscous * (1.0 - share), found.losses.viscous);
    judge("constant loss", constant * (1.0 - share), found.losses.constant);
    let point = found.points.get(2).ok_or("no operating point")?;
    let lost = share + (1.0 - share) * (viscous * point.speed_rad_s + constant) / point.torque;
    judge("efficiency", 1.0 - lost, Some(point.efficiency));
    let tachometers = found.tachometers.ok_or("no tachometers")?;
    judge("gain of the tachometer", tachometer, Some(tachometers.ratio));
    let seen = Estimate { value: f64::from(u8::from(tachometers.disagree)), std: 0.0, ci95: [0.0; 2] };
    judge("tachometer's error found", 1.0, Some(Estimate { ci95: [seen.value; 2], ..seen }));
    Ok(judged)
}

fn main() -> Result<(), String> {
    let args = Args::parse();
    let all: Vec<Vec<Judged>> = (0..args.draws)
        .into_par_iter()
        .map(|number| bench(args.seed, number))
        .collect::<Result<_, String>>()?;
    if args.list {
        for (number, bench) in all.iter().enumerate() {
            let cell = |j: &Judged| {
                format!(
                    "{} {:.5} ({:+.1} std of {:.1e})",
                    j.name,
                    j.truth,
                    (j.found.value - j.truth) / j.found.std,
                    j.found.std
                )
            };
            println!("{number}: {}", bench.iter().map(cell).collect::<Vec<_>>().join("; "));
        }
    }
    println!("95 % intervals that hold the truth, {} benches", args.draws);
    let mut names: Vec<&str> = Vec::new();
    all.iter().flatten().for_each(|judged| {
        if !names.contains(&judged.name) {
            names.push(judged.name)
        }
    });
    for name in names {
        let own: Vec<&Judged> = all.iter().flatten().filter(|judged| judged.name == name).collect();
        let held = own.iter().filter(|j| j.found.holds(j.truth)).count();
        let mut halves: Vec<f64> = own.iter().map(|j| 0.5 * (j.found.ci95[1] - j.found.ci95[0])).collect();
        halves.sort_by(f64::total_cmp);
        let percent = 100.0 * held as f64 / own.len() as f64;
        println!(
            "  {name:<30} {percent:5.1} %  ({held} of {}), median half-width {:.2e}",
            own.len(),
            halves[halves.len() / 2]
        );
    }
    Ok(())
}
