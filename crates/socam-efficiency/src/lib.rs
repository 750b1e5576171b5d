//! Efficiency of the section between two torque sensors from recordings: losses by their laws, with uncertainty.
//!
//! [`measure`] averages recordings over [`Window`]s of a fraction of a second, fits [`Losses`] to them, and compares both tachometers. In a positive drive (gears,
//! shafts and couplings that cannot slip) the speed ratio is fixed, efficiency is a ratio of torques, and a difference between speeds is
//! a gain error of a tachometer.
//!
//! SI inside, unit in the name. Nothing here prints.

mod error;
mod losses;
mod section;
mod tachometers;
mod windows;

use serde::Serialize;
use socam_calibrate::Estimate;
use socam_model::Model;
use socam_recording::Dataset;

pub use error::EfficiencyError;
pub use losses::{Losses, SensorStd, Sensors};
pub use section::Section;
pub use tachometers::Tachometers;
pub use windows::Window;

/// Version of [`Efficiency`]'s JSON form.
pub const SCHEMA: &str = "socam.efficiency/1";

/// Number of operating points that are listed.
const POINTS: usize = 5;

/// The result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Efficiency {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Name of the model.
    pub model: String,
    /// Recordings.
    pub recordings: Vec<String>,
    /// Channels of the torque sensors at both ends of the section.
    pub between: [String; 2],
    /// Input turns per output turn.
    pub ratio: f64,
    /// Whether the output speed was computed from the ratio, and not taken from its tachometer.
    pub kinematic_constraint: bool,
    /// Losses by their laws.
    pub losses: Losses,
    /// Comparison of the tachometers.
    pub tachometers: Option<Tachometers>,
    /// Efficiency at typical operating points of the recordings.
    pub points: Vec<Point>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Speed, rad/s, and torque, N m, of all averaging windows in which the input drives the load.
    #[serde(skip)]
    pub visited: Vec<[f64; 2]>,
}

/// Efficiency at one operating point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Speed at the input, rad/s.
    pub speed_rad_s: f64,
    /// Torque in, N m.
    #[serde(rename = "torque_Nm")]
    pub torque: f64,
    /// Power out over power in.
    pub efficiency: Estimate,
    /// Power out over power in, with speeds of both tachometers, as in chapter 5 of the thesis.
    pub by_tachometers: Option<f64>,
}

/// Measures the section between a model's torque sensors. `slips`: the speed ratio is not fixed, so both tachometers are used.
///
/// # Errors
/// When the model has no such section, a channel is missing, or the recordings hold too little motion.
pub fn measure(
    model: &Model,
    data: &[Dataset],
    sensors: &Sensors,
    slips: bool,
) -> Result<Efficiency, EfficiencyError> {
    let section = Section::of(model)?;
    let mut all = Vec::new();
    for data in data {
        all.extend(windows::of(data, &section)?);
    }
    let is_positive = section.is_positive && !slips;
    let used = windows::substantial(&all);
    let losses = Losses::of(&used, &section, sensors)?;
    let tachometers = Tachometers::of(&all);
    let visited: Vec<[f64; 2]> = used
        .iter()
        .filter(|window| window.is_driven && window.torque_in * window.direction > 0.0)
        .map(|window| [window.speed.abs(), window.torque_in.abs()])
        .collect();
    let speeds = tachometers.as_ref().map(|tachometers| tachometers.ratio);
    let speeds_std = sensors.speed_in.gain.zip(sensors.speed_out.gain).map(|(a, b)| a.hypot(b));
    let points = typical(&visited).into_iter().map(|[speed, torque]| {
        let by_torques = losses.efficiency(speed, torque);
        let by_tachometers = speeds.map(|ratio| by_torques.value * ratio.value);
        let efficiency = match speeds.filter(|_| !is_positive) {
            Some(ratio) => times(by_torques, ratio, speeds_std.unwrap_or(0.0)),
            None => by_torques,
        };
        Point { speed_rad_s: speed, torque, efficiency, by_tachometers }
    });
    let points = points.collect();
    let warnings = warnings(&section, &losses, tachometers.as_ref(), sensors, is_positive);
    Ok(Efficiency {
        schema: SCHEMA,
        model: model.name.clone(),
        recordings: data.iter().map(|data| data.name().to_owned()).collect(),
        between: [section.torque_in.at.clone(), section.torque_out.at.clone()],
        ratio: section.ratio,
        kinematic_constraint: is_positive,
        losses,
        tachometers,
        points,
        warnings,
        visited,
    })
}

/// An efficiency by torques times a ratio of speeds, with the uncertainty of the tachometers' gains.
fn times(by_torques: Estimate, ratio: Estimate, gain_std: f64) -> Estimate {
    let value = by_torques.value * ratio.value;
    let relative = (by_torques.std / by_torques.value).hypot(ratio.std / ratio.value).hypot(gain_std);
    Estimate::new(value, relative * value.abs(), 1e6)
}

/// Operating points across the recorded speeds, each with the median torque near it.
fn typical(visited: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = visited.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let part = sorted.len().div_ceil(POINTS).max(1);
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    sorted
        .chunks(part)
        .map(|part| {
            [median(part.iter().map(|p| p[0]).collect()), median(part.iter().map(|p| p[1]).collect())]
        })
        .collect()
}

fn warnings(
    section: &Section,
    losses: &Losses,
    tachometers: Option<&Tachometers>,
    sensors: &Sensors,
    is_positive: bool,
) -> Vec<String> {
    let mut said = Vec::new();
    let output = section.speed_out.as_ref().map_or("the output tachometer", |channel| &channel.name);
    if let Some(tachometers) = tachometers.filter(|tachometers| is_positive && tachometers.disagree) {
        let ratio = tachometers.ratio;
        said.push(format!(
            "{output} reads {:.2} % {} than {} and the ratio {} allow (95 %: {:.2} to {:.2} %); nothing between them can slip, so this is the gain of a tachometer and was not counted as a loss",
            100.0 * (ratio.value - 1.0).abs(),
            if ratio.value < 1.0 { "less" } else { "more" },
            section.speed_in.name,
            section.ratio,
            100.0 * (ratio.ci95[0] - 1.0),
            100.0 * (ratio.ci95[1] - 1.0),
        ));
    }
    if !is_positive {
        said.push(match sensors.speed_in.gain.zip(sensors.speed_out.gain) {
            Some((a, b)) => format!(
                "nothing ties output and input speed here, so the efficiency rests on the gains of {} and {output}: {:.2} % of it are their uncertainty",
                section.speed_in.name,
                196.0 * a.hypot(b)
            ),
            None => format!(
                "nothing ties output and input speed here, so the efficiency rests on the gains of {} and {output}, whose uncertainty nobody measured: 1 % of gain is 1 % of efficiency (`calibrate` measures it, --calibration gives it)",
                section.speed_in.name
            ),
        });
    }
    if sensors.torque_in.gain.is_none() || sensors.torque_out.gain.is_none() {
        said.push(format!(
            "the gains of {} and {} count as exact, as nobody measured their uncertainty; a wrong gain and a loss in proportion to torque look alike while torque flows one way (`calibrate` measures it, --calibration gives it)",
            section.torque_in.name, section.torque_out.name
        ));
    }
    for [a, b] in &losses.entangled {
        said.push(format!(
            "{a} and {b} are not told apart by these recordings: only what they make together is known"
        ));
    }
    if losses.constant.is_none() {
        said.push(
            "a constant loss cannot be told from the others in these recordings and was left out".into(),
        );
    }
    said
}
