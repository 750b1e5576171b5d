//! `calibrate`: measured pairs in, calibration and priors with uncertainty out.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;
use socam_calibrate::tasks::{self, Assumed, Found, Task};
use socam_calibrate::{Estimate, Pairs, edit_calibration, steady};
use socam_recording::{Calibration, Dataset, Selection};
use socam_report::calibration::{self, Titled};

use super::Outcome;
use crate::output::{self, WrongArguments};
use crate::table;

/// p-value below which a nonlinearity is reported.
const BENT: f64 = 0.01;

/// Calibrate sensors, motor and couplings from measured pairs, with uncertainty
///
/// The columns of a table determine what it calibrates: NAME_V with NAME_rpm or NAME_Nm a sensor; command_V with motor_speed_rpm the motor;
/// NAME_V with motor_V, motor_A and motor_speed_rpm a torque sensor by electrical power; NAME_torque_Nm with NAME_twist_deg a coupling. A
/// recording calibrates the motor from its steady states and compares its tachometers. Outlying rows are reported and left out.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host calibrate tachometer.csv torque.csv -o bench.toml
  socam-host calibrate power.csv --motor-efficiency 0.85:0.02 --calibration bench.toml -o better.toml
  socam-host calibrate coupling_3.csv --model speed-o-cam --write-model known.toml
  socam-host calibrate steps.mcap --plot calibration.svg")]
pub(crate) struct Args {
    /// Tables of pairs (.csv) or recordings
    #[arg(value_name = "PAIRS", required = true)]
    files: Vec<String>,
    /// Calibration file to correct [default: that of the default bench]
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Write the corrected calibration to this file, for `record --calibration`
    #[arg(short = 'o', long, value_name = "FILE")]
    write_calibration: Option<PathBuf>,
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = socam_job::MODEL_HELP)]
    model: String,
    /// Write the model, with measured stiffnesses as priors, to this file, for `identify --model`
    #[arg(long, value_name = "FILE")]
    write_model: Option<PathBuf>,
    /// Replace the calibration, the model and the plot, if they exist
    #[arg(long)]
    force: bool,
    /// Standard uncertainty of the reference instruments, per cent of the reading
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0)]
    reference_accuracy: f64,
    /// The motor's efficiency and its standard uncertainty (both 0 to 1), for torque from electrical power
    #[arg(long, value_name = "EFFICIENCY:STD")]
    motor_efficiency: Option<String>,
    /// Draw pairs, lines and residuals into this file (.svg)
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// The names are part of the JSON document.
#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    tasks: &'a [Task],
    warnings: &'a [String],
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.files = output::expanded(&args.files)?;
    let assumed = assumed(&args)?;
    let model = socam_job::load_model(&args.model)?;
    let [calibration_file, model_target, plot_target] =
        [&args.write_calibration, &args.write_model, &args.plot]
            .map(|path| path.as_deref().map(|path| output::create_new(path, args.force)).transpose());
    let (calibration_file, model_target, plot_target) = (calibration_file?, model_target?, plot_target?);
    let mut found = Found::default();
    let mut runs = Vec::new();
    for file in &args.files {
        if is_recording(file)? {
            runs.push(output::open(file)?);
        } else {
            let more = tasks::of(&Pairs::open(Path::new(file))?, &assumed)?;
            found.tasks.extend(more.tasks);
            found.warnings.extend(more.warnings);
        }
    }
    if !runs.is_empty() {
        let more: Found = steady::of(&runs as &[Dataset], &model, &assumed)?;
        found.tasks.extend(more.tasks);
        found.warnings.extend(more.warnings);
    }
    found.warnings.extend(found.tasks.iter().flat_map(remarks));
    if let Some(mut target) = calibration_file {
        target.write_all(corrected(&args, &found.tasks)?.as_bytes())?;
        target.commit()?;
    }
    if let Some(mut target) = model_target {
        target.write_all(with_priors(&model, &found.tasks)?.as_bytes())?;
        target.commit()?;
    }
    if let Some(mut target) = plot_target {
        let titled: Vec<Titled<'_>> = found.tasks.iter().map(titled).collect();
        target.write_all(calibration::svg(&titled).as_bytes())?;
        target.commit()?;
    }
    if args.json {
        let document =
            Document { schema: "socam.calibration-result/1", tasks: &found.tasks, warnings: &found.warnings };
        output::print_json(&document)?;
    } else {
        found.warnings.iter().for_each(output::warn);
        output::print(&text(&found.tasks))?;
    }
    Ok(Outcome::on(&runs))
}

fn assumed(args: &Args) -> anyhow::Result<Assumed> {
    if !(0.0..50.0).contains(&args.reference_accuracy) {
        let message =
            format!("--reference-accuracy {}: expected per cent from 0 to 50", args.reference_accuracy);
        return Err(WrongArguments(message).into());
    }
    let motor_efficiency = args.motor_efficiency.as_deref().map(|text| {
        let wrong =
            || WrongArguments(format!("--motor-efficiency {text}: expected EFFICIENCY:STD, as in 0.85:0.02"));
        let (value, std) = text.split_once(':').ok_or_else(wrong)?;
        let (value, std): (f64, f64) =
            (value.parse().map_err(|_| wrong())?, std.parse().map_err(|_| wrong())?);
        let is_sound = value > 0.0 && value <= 1.0 && (0.0..1.0).contains(&std);
        if is_sound { Ok((value, std)) } else { Err(wrong()) }
    });
    Ok(Assumed {
        reference_accuracy: 0.01 * args.reference_accuracy,
        motor_efficiency: motor_efficiency.transpose()?,
    })
}

/// Whether a file is a recording, and not a table of pairs.
fn is_recording(file: &str) -> anyhow::Result<bool> {
    let path = Selection::parse(file)?.path;
    if path.extension().is_none_or(|extension| extension != "csv") {
        return Ok(true);
    }
    let text =
        socam_recording::read_text(&path).with_context(|| format!("cannot read `{}`", path.display()))?;
    let head = text.lines().find(|line| !line.starts_with('#'));
    Ok(head.is_some_and(|head| head.split(',').next().is_some_and(|first| first.trim() == "t_s")))
}

/// Warnings about a calibration.
fn remarks(task: &Task) -> Vec<String> {
    let (name, line) = (name(task), task.line());
    let mut said = Vec::new();
    if !line.outliers.is_empty() {
        let rows: Vec<String> = line.outliers.iter().map(|row| (row + 1).to_string()).collect();
        said.push(format!("{name}: pairs {} do not belong to the others and were left out", rows.join(", ")));
    }
    if let Some(bent) = line.nonlinearity.filter(|bent| bent.chance < BENT) {
        said.push(format!(
            "{name} is no straight line: it departs by {} % of its span at {}, which gain and offset cannot follow",
            table::number(bent.percent_of_span.value),
            table::number(bent.at)
        ));
    }
    if let Task::Spring { .. } = task
        && line.gain.value <= 0.0
    {
        said.push(backwards(&name));
    }
    if let Task::Tachometers { name, reference, line, .. } = task
        && !line.gain.holds(1.0)
    {
        said.push(format!(
            "{name} reads {:.2} % {} than {reference} and the gears between them allow: the gain of one of the two is off, which one a \
             recording cannot tell",
            100.0 * (line.gain.value - 1.0).abs(),
            if line.gain.value < 1.0 { "less" } else { "more" }
        ));
    }
    said
}

fn backwards(spring: &str) -> String {
    format!(
        "{spring}: the torque falls as the twist grows; one of its two columns counts the other way, so turn the sign of one of them"
    )
}

fn name(task: &Task) -> String {
    match task {
        Task::Sensor { name, by_power: true, .. } => format!("{name}, by electrical power"),
        Task::Sensor { name, .. } | Task::Spring { name, .. } => name.clone(),
        Task::Motor { .. } => "motor".into(),
        Task::Tachometers { name, reference, .. } => format!("{name} over {reference}"),
    }
}

/// Units of gain and offset.
fn units(task: &Task) -> (String, &'static str) {
    match task {
        Task::Sensor { unit, .. } => (format!("V/({unit})"), "V"),
        Task::Motor { .. } => ("rpm/V".into(), "rpm"),
        Task::Spring { .. } => ("N m/rad".into(), "N m"),
        Task::Tachometers { .. } => ("1".into(), "rad/s"),
    }
}

fn titled(task: &Task) -> Titled<'_> {
    let (over, of) = match task {
        Task::Sensor { unit, .. } => (format!("Reference ({unit})"), "Sensor (V)"),
        Task::Motor { .. } => ("Command (V)".into(), "Speed (rpm)"),
        Task::Spring { .. } => ("Twist (rad)".into(), "Torque (N m)"),
        Task::Tachometers { reference, .. } => {
            (format!("{reference} (rad/s)"), "Reading \u{d7} ratio (rad/s)")
        }
    };
    Titled { title: name(task), over, of: of.into(), line: task.line() }
}

fn text(found: &[Task]) -> String {
    let head = ["", "", "estimate", "unit", "95 % interval", ""].map(String::from).to_vec();
    let mut rows = vec![head];
    let cell = |what: &str, estimate: &Estimate, unit: &str| {
        vec![
            what.into(),
            table::number(estimate.value),
            unit.into(),
            table::interval(estimate.ci95.map(Some)),
        ]
    };
    for task in found {
        let (line, (gain_unit, offset_unit)) = (task.line(), units(task));
        let what = if matches!(task, Task::Spring { .. }) { "stiffness" } else { "gain" };
        let points = format!("{} pairs, {} left out", line.points, line.outliers.len());
        let relative = 50.0 * (line.gain.ci95[1] - line.gain.ci95[0]) / line.gain.value.abs();
        let first = cell(what, &line.gain, &gain_unit);
        rows.push([vec![name(task)], first, vec![format!("+-{:.3} %; {points}", relative)]].concat());
        rows.push(
            [vec![String::new()], cell("offset", &line.offset, offset_unit), vec![String::new()]].concat(),
        );
        if let Some(bent) = &line.nonlinearity {
            let note = if bent.chance < BENT { "bent" } else { "straight, as far as these pairs tell" };
            let own = cell("nonlinearity", &bent.percent_of_span, "% of span");
            rows.push([vec![String::new()], own, vec![note.into()]].concat());
        }
    }
    table::align(&rows, &[false, false, true, false, false, false])
}

fn corrected(args: &Args, found: &[Task]) -> anyhow::Result<String> {
    let text = match &args.calibration {
        Some(path) => {
            socam_recording::read_text(path).with_context(|| format!("cannot read `{}`", path.display()))?
        }
        None => Calibration::default_text().to_owned(),
    };
    let sensors: Vec<_> = found.iter().filter_map(Task::measured_sensor).collect();
    let motor = found.iter().find_map(Task::measured_motor);
    if sensors.is_empty() && motor.is_none() {
        let message =
            "nothing here belongs into a calibration; --write-model takes what was measured of couplings";
        return Err(WrongArguments(message.into()).into());
    }
    Ok(edit_calibration(&text, &sensors, motor.as_ref())?)
}

/// Springs are named by their place or by their stiffness.
fn with_priors(model: &socam_model::Model, found: &[Task]) -> anyhow::Result<String> {
    let mut priors = Vec::new();
    for (name, prior) in found.iter().filter_map(Task::prior) {
        let by_place = model.springs.iter().find(|spring| spring.name == name).map(|spring| spring.stiffness);
        let Some(index) = by_place.or_else(|| model.parameter(name)) else {
            let places: Vec<&str> = model.springs.iter().map(|spring| spring.name.as_str()).collect();
            let message =
                format!("the model {} has no spring {name}; it has {}", model.name, places.join(", "));
            return Err(WrongArguments(message).into());
        };
        anyhow::ensure!(prior.value > 0.0, backwards(name));
        priors.push((model.parameters[index].name.as_str(), prior));
    }
    if priors.is_empty() {
        let message =
            "no coupling was measured here; --write-model needs NAME_torque_Nm beside NAME_twist_deg";
        return Err(WrongArguments(message.into()).into());
    }
    Ok(model.text_with_priors(&priors, "static test")?)
}
