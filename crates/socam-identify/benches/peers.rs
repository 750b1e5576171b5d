//! The two reference problems of other people's solvers, on their terms: white noise of given sigmas, input linear
//! between samples, equilibrium start, k2, c3 and k3 fixed, one start; processor seconds of the solve.
//!
//! `SOCAM_BENCH=DIR cargo bench -p socam-identify --bench peers` where DIR holds `data/`, `truth.json`,
//! `optimum.json` and, if the peers were run there in the same hour, their `results.jsonl`: then the ratios are printed
//! too. Without the variable it says so and does nothing. `-- nl` runs the one whose name contains that.

mod common;

use std::{error::Error, path::Path};

use common::NAMES;
use serde_json::Value;
use socam_identify::{
    Identification, Intersample, Noise, NoiseLevels, Options, Problem, StartState, output_error,
};
use socam_recording::Dataset;

const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = common::folder("peers") else { return Ok(()) };
    let truth: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json"))?)?;
    let optimum: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("optimum.json"))?)?;
    let peers = std::fs::read_to_string(folder.join("results.jsonl")).unwrap_or_default();
    let only: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    for (kind, problem, is_known) in
        [("lin", "lin_wp", true), ("nl", "nl_wp", true), ("lin", "lin_wp by defaults", false)]
    {
        if !only.is_empty() && !only.iter().any(|name| problem.contains(name.as_str())) {
            continue;
        }
        let mut runs = Vec::new();
        for _ in 0..RUNS {
            runs.push(solve(&folder, &truth, kind, is_known)?);
        }
        let problem = problem.trim_end_matches(" by defaults");
        let mut cpu: Vec<f64> = runs.iter().map(|run| run.cpu_s).collect();
        cpu.sort_by(f64::total_cmp);
        let median = cpu[RUNS / 2];
        let run = &runs[0];
        let names = truth["names"].as_array().ok_or("truth.json has no names")?;
        let worst = names.iter().enumerate().filter_map(|(i, name)| {
            let index = run.parameters.iter().position(|p| Some(p.name.as_str()) == name.as_str())?;
            Some((run.point[index] / optimum[problem]["p"][i].as_f64()? - 1.0).abs())
        });
        println!(
            "{problem}: {median:.4} CPU s (median of {RUNS}, least {:.4}), {} iterations, {:?}, cost {:.3} (optimum {:.3}), worst parameter error {:.1e}",
            cpu[0],
            run.iterations,
            run.end,
            run.cost,
            optimum[problem]["cost"].as_f64().unwrap_or(f64::NAN),
            worst.fold(0.0, f64::max),
        );
        ratios(&peers, problem, median);
    }
    Ok(())
}

fn solve(folder: &Path, truth: &Value, kind: &str, is_known: bool) -> Result<Identification, Box<dyn Error>> {
    let (known, mut values) =
        (common::numbers(truth, "truth"), common::numbers(truth, &format!("p0_{kind}")));
    let held = ["k2", "c3", "k3"];
    for (i, _) in NAMES.iter().enumerate().filter(|(_, name)| held.contains(name)) {
        values[i] = known[i];
    }
    let mut model = common::model(truth, kind, &values)?;
    for name in NAMES {
        if let Some(index) = model.parameter(name) {
            model.parameters[index].fixed = held.contains(&name);
        }
    }
    let files = truth[format!("files_{kind}")].as_array().ok_or("truth.json names no files")?;
    let paths = files.iter().filter_map(Value::as_str).map(|file| folder.join("data").join(file));
    let datasets = paths.map(|path| Dataset::open(&path.to_string_lossy())).collect::<Result<Vec<_>, _>>()?;
    let options = Options {
        noise: Noise::Given(NoiseLevels {
            outputs: common::numbers(truth, &format!("sigma_{kind}")),
            inputs: vec![0.0],
        }),
        start_state: StartState::Equilibrium,
        intersample: Some(Intersample::Linear),
        starts: 1,
        ..Options::default()
    };
    let options = if is_known { options } else { Options::default() };
    Ok(output_error(&Problem::new(&model, &datasets, options)?)?)
}

/// Processor time of each peer over ours; medians where a peer ran several times.
fn ratios(results: &str, problem: &str, ours: f64) {
    let mut peers: std::collections::BTreeMap<String, Vec<f64>> = std::collections::BTreeMap::new();
    for line in results.lines() {
        let Ok(result) = serde_json::from_str::<Value>(line) else { continue };
        if let (Some(name), Some(cpu)) = (result["name"].as_str(), result["cpu_solve"].as_f64())
            && result["problem"] == problem
        {
            peers.entry(name.into()).or_default().push(cpu);
        }
    }
    for (name, mut cpu) in peers {
        cpu.sort_by(f64::total_cmp);
        let median = cpu[cpu.len() / 2];
        println!("  {:7.1} x  {name}: {median:.3} CPU s", median / ours);
    }
}
