//! `efficiency`: losses between two torque sensors with uncertainty, and a comparison of two reducers.

use std::io::Write;
use std::path::PathBuf;

use serde::Serialize;
use socam_calibrate::Estimate;
use socam_efficiency::{Efficiency, Section};
use socam_model::Model;
use socam_recording::Dataset;

use super::Outcome;
use crate::output;
use crate::{calibrated, table};

/// Measure a reducer's efficiency and its losses from recordings, with uncertainty
///
/// Splits the losses between the model's two torque sensors into viscous, torque-proportional and constant ones. If gears and shafts fix the
/// speed ratio, efficiency is a ratio of torques; a difference between the tachometers is then reported as a gain error, and not counted as
/// a loss.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host efficiency steps.mcap triangle.mcap --map efficiency.svg
  socam-host efficiency new.mcap --against old.mcap --map both.svg
  socam-host efficiency coupling.mcap --model coupling-testbed.toml")]
pub(crate) struct Args {
    #[arg(value_name = "RUN", required = true, help = output::RUNS_HELP)]
    runs: Vec<String>,
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = socam_job::MODEL_HELP)]
    model: String,
    /// Calibration file with the sensors' uncertainty [default: that in the recordings]
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// The speed ratio is not fixed (a belt, a fluid coupling): use the speeds of both tachometers
    #[arg(long)]
    slips: bool,
    /// Recordings of another reducer to compare with; may be repeated
    #[arg(long, value_name = "RUN")]
    against: Vec<String>,
    /// Model of the other reducer [default: the same]
    #[arg(long, value_name = "MODEL", requires = "against")]
    against_model: Option<String>,
    /// Draw efficiency over speed and torque into this file (.svg)
    #[arg(long, value_name = "FILE.svg")]
    map: Option<PathBuf>,
    /// Replace the map, if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

/// The names are part of the JSON document.
#[derive(Serialize)]
struct Comparison<'a> {
    schema: &'static str,
    first: &'a Efficiency,
    second: &'a Efficiency,
    differences: Vec<Difference>,
}

/// Difference of the efficiencies, first minus second, at an operating point that both have recorded.
#[derive(Serialize)]
struct Difference {
    speed_rad_s: f64,
    #[serde(rename = "torque_Nm")]
    torque: f64,
    first: Estimate,
    second: Estimate,
    difference: Estimate,
}

pub(crate) fn run(mut args: Args) -> anyhow::Result<Outcome> {
    args.runs = output::expanded(&args.runs)?;
    args.against = output::expanded(&args.against)?;
    let target = args.map.as_deref().map(|path| output::create_new(path, args.force)).transpose()?;
    let model = socam_job::load_model(&args.model)?;
    let [runs, against] = [open_all(&args.runs)?, open_all(&args.against)?];
    let first = measure(&model, &runs, &args.runs, &args)?;
    let second = if args.against.is_empty() {
        None
    } else {
        let other = socam_job::load_model(args.against_model.as_ref().unwrap_or(&args.model))?;
        Some(measure(&other, &against, &args.against, &args)?)
    };
    let names = if second.is_some() { ["First", "Second"] } else { [first.model.as_str(), ""] };
    let sections: Vec<(&str, &Efficiency)> =
        names.into_iter().zip(std::iter::once(&first).chain(second.as_ref())).collect();
    if let Some(mut target) = target {
        target.write_all(socam_report::efficiency::svg(&sections).as_bytes())?;
        target.commit()?;
    }
    match (&second, args.json) {
        (None, true) => output::print_json(&first)?,
        (Some(second), true) => {
            let differences = differences(&first, second);
            output::print_json(&Comparison {
                schema: "socam.efficiency-comparison/1",
                first: &first,
                second,
                differences,
            })?;
        }
        (None, false) => {
            first.warnings.iter().for_each(output::warn);
            output::print(&text(&first))?;
        }
        (Some(second), false) => {
            for (name, section) in &sections {
                section
                    .warnings
                    .iter()
                    .for_each(|warning| output::warn(format_args!("{}: {warning}", name.to_lowercase())));
            }
            let both = format!(
                "First\n{}\nSecond\n{}\n{}",
                text(&first),
                text(second),
                side_by_side(&differences(&first, second))
            );
            output::print(&both)?;
        }
    }
    Ok(Outcome::on(runs.iter().chain(&against)))
}

fn open_all(runs: &[String]) -> anyhow::Result<Vec<Dataset>> {
    runs.iter().map(|run| output::open(run)).collect()
}

fn measure(model: &Model, data: &[Dataset], runs: &[String], args: &Args) -> anyhow::Result<Efficiency> {
    let calibration = calibrated::of(runs, args.calibration.as_deref())?;
    let sensors = calibrated::sensors(calibration.as_ref(), &Section::of(model)?);
    Ok(socam_efficiency::measure(model, data, &sensors, args.slips)?)
}

/// Differences at the typical operating points of both.
fn differences(first: &Efficiency, second: &Efficiency) -> Vec<Difference> {
    let points = first.points.iter().chain(&second.points).map(|point| [point.speed_rad_s, point.torque]);
    let near = |efficiency: &Efficiency, [speed, torque]: [f64; 2]| {
        let is_near = |visited: &&[f64; 2]| {
            (visited[0] / speed - 1.0).abs() < 0.15 && (visited[1] / torque - 1.0).abs() < 0.25
        };
        efficiency.visited.iter().find(is_near).is_some()
    };
    let shared = points.filter(|point| near(first, *point) && near(second, *point));
    let mut all: Vec<Difference> = shared
        .map(|[speed, torque]| {
            let (a, b) = (first.losses.efficiency(speed, torque), second.losses.efficiency(speed, torque));
            let difference = Estimate::new(a.value - b.value, a.std.hypot(b.std), 1e6);
            Difference { speed_rad_s: speed, torque, first: a, second: b, difference }
        })
        .collect();
    all.sort_by(|a, b| a.speed_rad_s.total_cmp(&b.speed_rad_s));
    all
}

fn percent(estimate: &Estimate) -> Vec<String> {
    let ends = estimate.ci95.map(|end| format!("{:.2}", 100.0 * end));
    vec![format!("{:.2} %", 100.0 * estimate.value), format!("[{}, {}]", ends[0], ends[1])]
}

fn text(efficiency: &Efficiency) -> String {
    let [from, to] = &efficiency.between;
    let tied = if efficiency.kinematic_constraint {
        "speeds tied by the ratio"
    } else {
        "both tachometers believed"
    };
    let mut text = format!(
        "{} from {from} to {to}, ratio {}; {} averaging windows, {tied}\n",
        efficiency.model,
        table::number(efficiency.ratio),
        efficiency.losses.windows
    );
    let head = ["input speed", "torque in", "efficiency", "95 % interval", "by tachometers"]
        .map(String::from)
        .to_vec();
    let mut rows = vec![head];
    for point in &efficiency.points {
        let by_tachometers =
            point.by_tachometers.map_or_else(|| "-".into(), |value| format!("{:.2} %", 100.0 * value));
        let place = vec![format!("{:.1} rad/s", point.speed_rad_s), format!("{:.4} N m", point.torque)];
        rows.push([place, percent(&point.efficiency), vec![by_tachometers]].concat());
    }
    text.push_str(&table::align(&rows, &[true, true, true, false, true]));
    let losses = &efficiency.losses;
    let head = ["loss at the input", "estimate", "unit", "95 % interval"].map(String::from).to_vec();
    let mut rows = vec![head];
    let mut row = |what: &str, estimate: &Option<Estimate>, unit: &str| {
        let cells = estimate.as_ref().map_or_else(
            || vec!["-".into(), unit.into(), "not told apart".into()],
            |e| vec![table::number(e.value), unit.into(), table::interval(e.ci95.map(Some))],
        );
        rows.push([vec![what.to_owned()], cells].concat());
    };
    row("in proportion to torque", &losses.torque_share, "1");
    row("in proportion to speed", &losses.viscous, "N m s/rad");
    row("constant", &losses.constant, "N m");
    text.push('\n');
    text.push_str(&table::align(&rows, &[false, true, false, false]));
    if let Some(tachometers) = &efficiency.tachometers {
        let ratio = &tachometers.ratio;
        text.push_str(&format!(
            "\n  output over input tachometer, ratio taken out: {} {}\n",
            table::number(ratio.value),
            table::interval(ratio.ci95.map(Some))
        ));
    }
    text
}

fn side_by_side(differences: &[Difference]) -> String {
    if differences.is_empty() {
        return "They have no operating point in common: nothing can be compared. Record both at the same speeds and torques.\n".into();
    }
    let head = ["input speed", "torque in", "first", "second", "difference", "95 % interval", ""]
        .map(String::from)
        .to_vec();
    let mut rows = vec![head];
    for d in differences {
        let points = d.difference.ci95.map(|end| format!("{:+.2}", 100.0 * end));
        rows.push(vec![
            format!("{:.1} rad/s", d.speed_rad_s),
            format!("{:.4} N m", d.torque),
            format!("{:.2} %", 100.0 * d.first.value),
            format!("{:.2} %", 100.0 * d.second.value),
            format!("{:+.2}", 100.0 * d.difference.value),
            format!("[{}, {}]", points[0], points[1]),
            if d.difference.holds(0.0) { "not told apart" } else { "" }.into(),
        ]);
    }
    format!("Side by side\n{}", table::align(&rows, &[true, true, true, true, true, false, false]))
}
