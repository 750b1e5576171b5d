//! `demo`: recording, identification and diagnosis on the virtual bench.

mod hidden;

use std::path::{Path, PathBuf};

use anyhow::Context;
use socam_identify::{Fit, Identification, Options, Problem};
use socam_job::{Record, VirtualBench, options};
use socam_model::Model;
use socam_recording::Dataset;

use super::{Outcome, simulate};
use crate::interrupt::Interrupt;
use crate::{output, table, watch};

/// Do the whole job on a virtual bench, no hardware needed: record and identify it, then conceal physics in it and find that
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Folder for recordings, models and the report
    #[arg(long, value_name = "DIR", default_value = "socam-demo")]
    dir: PathBuf,
    /// Seed of the sensors' noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

const MODEL: &str = "speed-o-cam";

/// True parameters of the virtual bench, N m/rad and N m s/rad: the stiffnesses that the thesis identified (table 4.6: 1.21, 0.94, 916.03
/// and 2.34 N m/deg), and dampings. The model starts from the catalogue's values.
const TRUTH: [(&str, f64); 8] = [
    ("k1", 69.33),
    ("k2", 53.86),
    ("k3", 52_484.6),
    ("k4", 134.07),
    ("c2", 0.031),
    ("c3", 0.017),
    ("c4", 0.11),
    ("c5", 0.042),
];

/// Profiles of fitted runs: broadband noise, steady levels with transients, and resonances.
const RUNS: [(&str, f64); 3] = [("multisine", 10.0), ("steps", 12.0), ("chirp", 12.0)];
/// Profile of the validation run.
const HELD_OUT: (&str, f64) = ("prbs", 10.0);

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    std::fs::create_dir_all(&args.dir)
        .with_context(|| format!("cannot create the folder {}", args.dir.display()))?;
    let mut paths = Vec::new();
    let mut outcome = Outcome::Done;
    output::print("Recording the virtual bench\n")?;
    for (index, (profile, duration_s)) in RUNS.into_iter().chain([HELD_OUT]).enumerate() {
        let seed = args.seed.wrapping_add(index as u64);
        let path = args.dir.join(format!("{profile}.mcap"));
        outcome = worse(outcome, record(&path, profile, duration_s, seed, Vec::new())?);
        paths.push(path);
    }
    let model = socam_job::load_model(MODEL)?;
    let data =
        paths.iter().map(|path| output::open(&path.to_string_lossy())).collect::<Result<Vec<_>, _>>()?;
    let (fitted, held_out) = data.split_at(RUNS.len());
    let result = watch::fit(&Interrupt::listen(), false, |progress| {
        let options = Options { progress, ..Options::default() };
        socam_identify::output_error(&Problem::new(&model, fitted, options)?)
    })?;
    let test = socam_identify::evaluate(&Problem::new(&model, held_out, Options::default())?, &result.point)?;
    let identified = args.dir.join("identified.toml");
    output::write_whole(&identified, &result.model_text(&model)?)?;
    output::print(&report(&model, &result, &test, &held_out[0]))?;
    let outcome = worse(outcome, hidden::run(&args.dir, &model, args.seed)?);
    output::print(&next_steps(&args.dir, &identified))?;
    Ok(outcome)
}

fn worse(one: Outcome, other: Outcome) -> Outcome {
    if matches!(one, Outcome::Done) { other } else { one }
}

fn record(
    path: &Path,
    profile: &str,
    duration_s: f64,
    seed: u64,
    hide: Vec<String>,
) -> anyhow::Result<Outcome> {
    let record =
        Record { profile: Some(profile.into()), duration_s: Some(duration_s), ..options::defaults()? };
    let values = TRUTH.map(|(name, value)| format!("{name}={value}"));
    let bench =
        VirtualBench { model: MODEL.into(), values: values.to_vec(), hide, seed, ..options::defaults()? };
    let report = simulate::simulate_into(&record, &bench, path)?;
    super::record::outcome(path, &report)?;
    let (written, seconds) = (report.summary.written, report.duration_s);
    output::print(&format!("  {}: {written} samples over {seconds:.1} s\n", path.display()))?;
    Ok(if report.summary.lost > 0 { Outcome::LostSamples } else { Outcome::Done })
}

/// Estimates and true values.
fn report(model: &Model, result: &Identification, test: &Fit, held_out: &Dataset) -> String {
    let rows: Vec<Row> = parameter_rows(result).chain(combination_rows(model, result)).collect();
    let determined: Vec<&Row> = rows.iter().filter(|row| row.estimate.is_some()).collect();
    let held = determined.iter().filter(|row| row.holds()).count();
    let mut text = format!(
        "\nIdentified by output error: {} after {} iterations, {:.2} CPU s\n\n{}\n",
        table::end(result.end),
        result.iterations,
        result.cpu_s,
        table::align(&with_head(&rows), &[false, true, true, false, false, false]),
    );
    text.push_str(&format!("{held} of {} intervals hold the truth (95 % should).\n", determined.len()));
    text.push_str(&table::advice(result));
    text.push_str(&table::fit(&format!("Prediction of {}, which was not fitted", held_out.name()), test));
    text
}

/// A line of the comparison.
struct Row {
    name: String,
    unit: String,
    truth: f64,
    estimate: Option<f64>,
    ci95: [Option<f64>; 2],
    note: String,
}

impl Row {
    fn holds(&self) -> bool {
        matches!(self.ci95, [Some(low), Some(high)] if low <= self.truth && self.truth <= high)
    }
}

fn parameter_rows(result: &Identification) -> impl Iterator<Item = Row> {
    TRUTH.iter().filter_map(|(name, truth)| {
        let found = result.parameters.iter().find(|parameter| parameter.name == *name)?;
        Some(Row {
            name: found.name.clone(),
            unit: found.unit.clone(),
            truth: *truth,
            estimate: found.value,
            ci95: found.ci95,
            note: found.note.clone(),
        })
    })
}

/// Combinations; their true values by the same formulas.
fn combination_rows(model: &Model, result: &Identification) -> impl Iterator<Item = Row> {
    let mut values = model.values();
    for (name, truth) in TRUTH {
        if let Some(index) = model.parameter(name) {
            values[index] = truth;
        }
    }
    let truths = socam_identify::combination_values(model, &values);
    result.combinations.iter().filter_map(move |found| {
        let (_, truth) = truths.iter().find(|(name, _)| *name == found.name)?;
        Some(Row {
            name: found.name.clone(),
            unit: found.unit.clone(),
            truth: *truth,
            estimate: found.value,
            ci95: found.ci95,
            note: format!("= {}", found.expression),
        })
    })
}

fn with_head(rows: &[Row]) -> Vec<Vec<String>> {
    let head = ["", "truth", "estimate", "unit", "95 % interval", ""].map(String::from).to_vec();
    let line = |row: &Row| {
        let verdict = match (row.estimate.is_some(), row.holds()) {
            (false, _) => String::new(),
            (true, true) => "holds the truth".into(),
            (true, false) => "misses the truth".into(),
        };
        vec![
            row.name.clone(),
            table::number(row.truth),
            row.estimate.map_or_else(|| "-".into(), table::number),
            row.unit.clone(),
            if row.estimate.is_some() { table::interval(row.ci95) } else { String::new() },
            [verdict, row.note.clone()]
                .into_iter()
                .filter(|part| !part.is_empty())
                .collect::<Vec<_>>()
                .join(" "),
        ]
    };
    std::iter::once(head).chain(rows.iter().map(line)).collect()
}

fn next_steps(dir: &Path, model: &Path) -> String {
    let dir = dir.display();
    format!(
        "\nThe identified model is {}. Open {dir}/report/index.html in a browser, and go on with:\n  \
         socam-host info {dir}/multisine.mcap\n  \
         socam-host check {dir}/multisine.mcap\n  \
         socam-host identify {dir}/multisine.mcap {dir}/steps.mcap --validate {dir}/prbs.mcap\n",
        model.display()
    )
}
