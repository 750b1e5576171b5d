//! CPU time of recordings of healthy machines.

use cpu_time::ProcessTime;
use socam_fleet::{FleetOptions, Source, diagnose_one, row::Stage};
use socam_recording::{Dataset, export_csv};
use socam_sim::{FleetPlan, VirtualFleet};

use crate::{Args, PERIOD_US};

pub(crate) fn run(args: &Args, recordings: usize) -> Result<String, String> {
    let plan =
        FleetPlan { machines: recordings, dates: 1, faulty_share: 0.0, worn_share: 0.0, ..args.plan(0)? };
    let (model, fleet, profile) = (args.model()?, VirtualFleet::draw(&plan), args.profile()?);
    let options = args.options()?;
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let mut paths = Vec::new();
    for machine in 0..recordings {
        let data = fleet.record(machine, 0, &profile, PERIOD_US).map_err(|e| e.to_string())?;
        let path = folder.path().join(format!("{machine}.csv"));
        export_csv(&data, &path).map_err(|e| e.to_string())?;
        paths.push(path);
    }
    let mut stages = [0; 2];
    let mut cascade = |options: &FleetOptions| {
        let clock = ProcessTime::now();
        for path in &paths {
            let row = diagnose_one(&Source::path(path), &model, options, 1);
            stages[usize::from(row.stage == Stage::Diagnosis)] += 1;
        }
        clock.elapsed().as_secs_f64() / recordings as f64
    };
    let frozen = cascade(&options);
    let own = cascade(&FleetOptions { frozen: None, ..options.clone() });
    let clock = ProcessTime::now();
    for path in &paths {
        let data = Dataset::open(&path.display().to_string()).map_err(|e| e.to_string())?;
        socam_diagnose::diagnose(
            &model,
            &[data],
            socam_diagnose::HeldOut::none(),
            &socam_diagnose::Options::default(),
        )
        .map_err(|e| e.to_string())?;
    }
    let full = clock.elapsed().as_secs_f64() / recordings as f64;
    let million = 1e6 / 3600.0;
    Ok(format!(
        "{recordings} adequate recordings of {} s at {} Hz, {}\nCPU s a recording: {frozen:.3} in the cascade with a reference, {own:.3} without, {full:.3} in the full \
         diagnosis\n{} of {} rows ended at the score test\n10^6 recordings: {:.0} core hours in the cascade, {:.0} in the full diagnosis",
        args.duration,
        1_000_000 / PERIOD_US,
        args.model,
        stages[0],
        stages[0] + stages[1],
        frozen * million,
        full * million
    ))
}
