//! The second half of `demo`: the same bench with a hidden friction.

use std::path::Path;

use socam_diagnose::Answer;
use socam_job::{Diagnose, HeldOutRecording, options};
use socam_model::Model;

use super::{MODEL, Outcome, record, worse};
use crate::commands::diagnose;
use crate::interrupt::Interrupt;
use crate::{output, provenance, watch};

/// The hidden effect: Coulomb friction at the load.
const HIDDEN: &str = "coulomb_friction@load_bearing:torque=0.25";
const FITTED: [&str; 4] = ["multisine", "steps", "triangle", "reversals"];
const HELD_OUT: &str = "prbs";
const DURATION_S: f64 = 10.0;
/// Seed offset: the noise differs from that of the first half.
const SEEDS: u64 = 100;

pub(super) fn run(dir: &Path, model: &Model, seed: u64) -> anyhow::Result<Outcome> {
    output::print("\nThe same bench again, now with physics concealed in it that the model lacks\n")?;
    let (mut outcome, mut paths) = (Outcome::Done, Vec::new());
    for (index, profile) in FITTED.into_iter().chain([HELD_OUT]).enumerate() {
        let path = dir.join(format!("{profile}-hidden.mcap"));
        let seed = seed.wrapping_add(SEEDS + index as u64);
        outcome = worse(outcome, record(&path, profile, DURATION_S, seed, vec![HIDDEN.to_owned()])?);
        paths.push(path);
    }
    let names: Vec<String> = paths.iter().map(|path| path.to_string_lossy().into_owned()).collect();
    let (fitted, held_out) = names.split_at(FITTED.len());
    let training = fitted.iter().map(|run| output::open(run)).collect::<Result<Vec<_>, _>>()?;
    let held_out = held_out.iter().cloned().map(HeldOutRecording::File).collect();
    let task: Diagnose = options::defaults()?;
    let done = watch::fit(&Interrupt::listen(), false, |progress| {
        task.run(model.clone(), &training, held_out, progress)
    })?;
    let report = dir.join("report");
    let made = provenance::of(MODEL, model, &names)?;
    let Answer { diagnosis, evidence, model_toml } = &done.answer;
    socam_report::diagnosis::write(&report, diagnosis, evidence, (model, Some(model_toml)), &made)?;
    output::print(&format!("\nDiagnosis: {}", diagnose::text(diagnosis)))?;
    output::print(&format!("\nConcealed was {HIDDEN}.\n"))?;
    Ok(outcome)
}
