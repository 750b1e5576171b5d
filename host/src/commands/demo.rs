//! `demo`: the whole job on the virtual bench; no hardware.

use std::path::{Path, PathBuf};

use anyhow::Context;
use socam_sim::Override;

use super::record::CourseArgs;
use super::{Outcome, simulate};
use crate::device::run::Report;
use crate::device::virtual_bench::BenchArgs;
use crate::output;

/// Do the whole job on a virtual bench: record it; no hardware needed
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Folder for what is written
    #[arg(long, value_name = "DIR", default_value = "socam-demo")]
    dir: PathBuf,
    /// Draws the sensors' noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// What the virtual bench of the demonstration really is, while its model starts at the catalogue's values: the stiffnesses
/// that the thesis identified (table 4.6), N m/deg.
pub(crate) const TRUTH: [(&str, f64); 4] = [("k1", 1.21), ("k2", 0.94), ("k3", 916.03), ("k4", 2.34)];

/// The recordings: noise of all frequencies, steady levels with transients, and resonances one by one.
const RUNS: [(&str, f64); 3] = [("multisine", 10.0), ("steps", 12.0), ("chirp", 12.0)];

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    std::fs::create_dir_all(&args.dir)
        .with_context(|| format!("cannot create the folder {}", args.dir.display()))?;
    let mut outcome = Outcome::Done;
    for (path, report) in record_all(&args.dir, args.seed)? {
        output::print(&format!(
            "{}: {} samples over {:.1} s\n",
            path.display(),
            report.summary.written,
            report.duration_s
        ))?;
        if report.summary.lost > 0 {
            outcome = Outcome::LostSamples;
        }
    }
    Ok(outcome)
}

/// Records the virtual bench on every profile, each run with noise of its own.
pub(crate) fn record_all(dir: &Path, seed: u64) -> anyhow::Result<Vec<(PathBuf, Report)>> {
    let mut runs = Vec::new();
    for (index, (profile, duration_s)) in RUNS.into_iter().enumerate() {
        let path = dir.join(format!("{profile}.mcap"));
        let course = CourseArgs { profile: Some(profile.into()), duration: Some(duration_s), rate: 1000.0 };
        let bench = BenchArgs {
            model: "speed-o-cam".into(),
            set: TRUTH
                .map(|(name, value)| Override { name: name.into(), value: value.to_degrees() })
                .to_vec(),
            hide: Vec::new(),
            seed: seed.wrapping_add(index as u64),
            no_noise: false,
        };
        let report = simulate::simulate_into(&course, &bench, &path)?;
        super::record::outcome(&path, &report)?;
        runs.push((path, report));
    }
    Ok(runs)
}
