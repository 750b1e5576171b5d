//! What a fleet's diagnosis finds, and what it costs: virtual fleets of known truth, with faults in 2 % and wear in 5 % of the machines.
//!
//! `cargo bench -p socam-tests --bench fleet -- --fleets 5 --machines 200` prints power and false discoveries over five fleets;
//! `--cost 20` prints the CPU time of an adequate recording in the cascade and in the full diagnosis.

mod cost;
mod score;

use std::process::ExitCode;

use clap::Parser;
use socam_fleet::FleetOptions;
use socam_model::Model;
use socam_recording::ProfileFile;
use socam_sim::{FleetPlan, VirtualFleet};

/// Period of the samples, µs.
const PERIOD_US: u32 = 1000;

/// Measure false discoveries, power and cost on virtual fleets
#[derive(Debug, Parser)]
struct Args {
    /// Number of fleets
    #[arg(long, value_name = "N", default_value_t = 3)]
    fleets: u64,
    /// Machines of each
    #[arg(long, value_name = "N", default_value_t = 100)]
    machines: usize,
    /// Recordings of each machine, a month apart
    #[arg(long, value_name = "N", default_value_t = 6)]
    dates: usize,
    /// Length of a recording, s
    #[arg(long, value_name = "S", default_value_t = 5.0)]
    duration: f64,
    /// Seed of the first fleet
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Model
    #[arg(long, default_value = "two-mass")]
    model: String,
    /// False discovery rate
    #[arg(long, value_name = "Q", default_value_t = 0.05)]
    fdr: f64,
    /// Share of the machines that have a fault
    #[arg(long, value_name = "SHARE", default_value_t = 0.02)]
    faulty: f64,
    /// Measure the CPU time of so many adequate recordings instead
    #[arg(long, value_name = "N")]
    cost: Option<usize>,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let result = match args.cost {
        Some(recordings) => cost::run(&args, recordings),
        None => score::run(&args),
    };
    match result {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

impl Args {
    fn model(&self) -> Result<Model, String> {
        Model::builtin(&self.model).ok_or_else(|| format!("there is no embedded model {}", self.model))
    }

    fn profile(&self) -> Result<socam_core::Profile, String> {
        let file = ProfileFile::open("multisine").map_err(|e| e.to_string())?;
        let file = ProfileFile { duration_s: self.duration, ..file };
        file.profile(PERIOD_US).map_err(|e| e.to_string())
    }

    /// Faults of both models' machines, of a size that a mechanic would care about.
    fn plan(&self, fleet: u64) -> Result<FleetPlan, String> {
        let (faults, wear): (&[&str], &[&str]) = match self.model.as_str() {
            "two-mass" => (
                &[
                    "coulomb_friction@load_bearing:torque=0.05",
                    "sensor_gain@load_speed:gain=1.02",
                    "stiffness_hardening@shaft:cubic=1e6",
                    "gravity_unbalance@load:torque=0.05,phase=0.3",
                ],
                &["load_damping=0.3", "stiffness=-0.1"],
            ),
            _ => (
                &[
                    "coulomb_friction@load_bearing:torque=0.1",
                    "sensor_gain@torque_out:gain=1.03",
                    "mesh_loss@mesh:fraction=0.05",
                ],
                &["c5=0.3", "k4=-0.1"],
            ),
        };
        Ok(FleetPlan {
            model: self.model()?,
            machines: self.machines,
            dates: self.dates,
            spread: 0.05,
            faults: read(faults)?,
            faulty_share: self.faulty,
            wear: read(wear)?,
            worn_share: 0.05,
            seed: self.seed + fleet,
        })
    }

    /// The fleet's options with a reference of ten healthy machines of another fleet.
    fn options(&self) -> Result<FleetOptions, String> {
        const HEALTHY: usize = 10;
        let plan = FleetPlan {
            machines: HEALTHY,
            dates: 1,
            faulty_share: 0.0,
            worn_share: 0.0,
            seed: 999_983,
            ..self.plan(0)?
        };
        let (model, fleet, profile) = (self.model()?, VirtualFleet::draw(&plan), self.profile()?);
        let options = FleetOptions::default();
        let each = (0..HEALTHY).map(|machine| {
            let data = fleet.record(machine, 0, &profile, PERIOD_US).map_err(|e| e.to_string())?;
            socam_fleet::Frozen::of(&model, &data, &socam_diagnose::Options::default())
                .map_err(|e| e.to_string())
        });
        let frozen = socam_fleet::Frozen::median(&each.collect::<Result<Vec<_>, String>>()?);
        Ok(FleetOptions { frozen, ..options })
    }
}

/// Faults or changes, as a command line names them.
fn read<T: std::str::FromStr<Err = socam_sim::SimError>>(all: &[&str]) -> Result<Vec<T>, String> {
    all.iter().map(|text| text.parse().map_err(|error: socam_sim::SimError| error.to_string())).collect()
}
