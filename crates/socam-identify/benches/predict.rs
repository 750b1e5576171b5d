//! Simulation of the nonlinear reference problem: error and simulated seconds per processor second, over tolerances.
//!
//! `SOCAM_BENCH=DIR cargo bench -p socam-identify --bench predict` where DIR holds `data/nl_1.csv` and `truth.json`. The
//! reference solution is the one that came with the problem (`data/nl_reference.npy`) if it is there, else our own at a
//! tolerance that changes nothing any more. Errors are the largest of any output, relative to that output's standard deviation.
//! Without the variable it says so and does nothing.

mod common;

use std::{error::Error, path::Path};

use cpu_time::ProcessTime;
use serde_json::Value;
use socam_identify::{DEFAULT_TOLERANCE, Intersample, Predictor, Start};
use socam_recording::Dataset;

const RUNS: usize = 9;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = common::folder("predict") else { return Ok(()) };
    let truth: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json"))?)?;
    let model = common::model(&truth, "nl", &common::numbers(&truth, "truth"))?;
    let values = model.values();
    let data = Dataset::open(&folder.join("data/nl_1.csv").to_string_lossy())?;
    let channel = model.inputs().next().ok_or("the model has no input")?.column.clone();
    let input = data.load(&[&channel])?.columns[0].values().to_vec();
    let step_s = data.sample_time_s();
    let seconds = input.len() as f64 * step_s;
    let run = |tolerance: f64| {
        Predictor::new(&model, &values, step_s)?.with_tolerance(tolerance).run(
            &[&input],
            &[Intersample::Linear],
            Start::Equilibrium,
        )
    };
    let finest = run(1e-13)?;
    let reference = read_npy(&folder.join("data/nl_reference.npy"), finest.outputs.len());
    let theirs = reference.as_ref().map(|reference| error(&finest.outputs, reference));
    println!("predict: {seconds} s at {step_s} s, {} states", finest.end.len());
    if let Some(theirs) = theirs {
        println!(
            "  our finest solution ({} steps) against the reference that came with it: {theirs:.1e}",
            finest.steps
        );
    }
    let reference = reference.unwrap_or(finest.outputs);
    for tolerance in [1e-5, 1e-6, 1e-7, DEFAULT_TOLERANCE, 1e-9] {
        let mut cpu = Vec::new();
        for _ in 0..RUNS {
            let clock = ProcessTime::now();
            run(tolerance)?;
            cpu.push(clock.elapsed().as_secs_f64());
        }
        cpu.sort_by(f64::total_cmp);
        let result = run(tolerance)?;
        println!(
            "  tolerance {tolerance:.0e}: error {:.1e}, {:6.0} simulated seconds per CPU second, {} steps, {} unresolved",
            error(&result.outputs, &reference),
            seconds / cpu[RUNS / 2],
            result.steps,
            result.unresolved,
        );
    }
    Ok(())
}

/// Largest difference of any output, in its standard deviations.
fn error(outputs: &[Vec<f64>], reference: &[Vec<f64>]) -> f64 {
    let each = outputs.iter().zip(reference).map(|(output, reference)| {
        let count = reference.len() as f64;
        let mean = reference.iter().sum::<f64>() / count;
        let spread = (reference.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / count).sqrt();
        output.iter().zip(reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / spread
    });
    each.fold(0.0, f64::max)
}

/// Little-endian doubles, row by row, after a header whose length is in the bytes from byte 8.
fn read_npy(path: &Path, columns: usize) -> Option<Vec<Vec<f64>>> {
    let bytes = std::fs::read(path).ok()?;
    let header = usize::from(u16::from_le_bytes([*bytes.get(8)?, *bytes.get(9)?]));
    let values = bytes.get(10 + header..)?.chunks_exact(8).map(|b| b.try_into().map(f64::from_le_bytes));
    let values: Vec<f64> = values.collect::<Result<_, _>>().ok()?;
    Some((0..columns).map(|column| values.iter().skip(column).step_by(columns).copied().collect()).collect())
}
