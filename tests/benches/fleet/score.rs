//! Power and false discoveries of fleets whose truth is known.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use socam_fleet::{FleetOptions, Row, Source, Summary, diagnose_one};
use socam_recording::export_csv;
use socam_sim::{FleetMachine, VirtualFleet};

use crate::{Args, PERIOD_US};

/// A month, ms.
const MONTH_MS: i64 = 30 * 86_400_000;

/// What a list found.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    there: usize,
    found: usize,
    listed: usize,
    wrong: usize,
}

impl Tally {
    fn line(&self, name: &str, fleets: &[Self]) -> String {
        let shares = fleets.iter().map(|one| one.wrong as f64 / one.listed.max(1) as f64);
        let rate = shares.sum::<f64>() / fleets.len() as f64;
        format!(
            "{name:<28} {:>5} of {:<5} found; {:>3} of {:<4} listed are false; mean share over fleets {:.3}\n",
            self.found, self.there, self.wrong, self.listed, rate
        )
    }
}

pub(crate) fn run(args: &Args) -> Result<String, String> {
    let options = args.options()?;
    let (mut faults, mut trends, mut right) = (Vec::new(), Vec::new(), [0; 4]);
    let (mut p_values, mut least) = (Vec::new(), BTreeMap::<String, Vec<f64>>::new());
    for number in 0..args.fleets {
        let fleet = VirtualFleet::draw(&args.plan(number)?);
        let rows = rows(args, &fleet, &options)?;
        let truth: BTreeMap<&str, &FleetMachine> =
            fleet.machines.iter().map(|machine| (machine.serial.as_str(), machine)).collect();
        let healthy = rows.iter().filter(|row| truth[row.machine_name()].fault.is_none());
        p_values.extend(healthy.filter_map(|row| row.p_value));
        let mut rivals: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for row in &rows {
            let own = rivals.entry(row.machine_name().to_owned()).or_default();
            own.extend(row.findings.iter().flat_map(|finding| finding.rivals.iter().cloned()));
        }
        let summary = Summary::of(rows.into_iter().map(Ok), args.fdr).map_err(|e| e.to_string())?;
        faults.push(of_faults(&summary, (&truth, &rivals), &mut right));
        trends.push(of_trends(&summary, &truth));
        for one in &summary.parameters {
            least.entry(one.parameter.clone()).or_default().extend(one.detectable_change);
        }
        let changing: Vec<&str> = summary.trends.iter().map(|one| one.machine.as_str()).collect();
        let worn = truth.iter().filter_map(|(serial, machine)| Some((serial, machine.wear.as_ref()?)));
        let missed: Vec<&str> = worn
            .filter(|(serial, _)| !changing.contains(serial))
            .map(|(_, wear)| wear.name.as_str())
            .collect();
        for one in summary.faulty.iter().filter(|one| truth[one.machine.as_str()].fault.is_none()) {
            eprintln!("false in fleet {number}: {one:?}");
        }
        eprintln!("fleet {number}: {:?}, {:?}; missed wear: {missed:?}", faults.last(), trends.last());
    }
    let sum = |all: &[Tally]| {
        all.iter().fold(Tally::default(), |sum, one| Tally {
            there: sum.there + one.there,
            found: sum.found + one.found,
            listed: sum.listed + one.listed,
            wrong: sum.wrong + one.wrong,
        })
    };
    let mut text = format!(
        "{} fleets of {} machines ({}), {} recordings of {} s each, false discovery rate {}\n",
        args.fleets, args.machines, args.model, args.dates, args.duration, args.fdr
    );
    text.push_str(&sum(&faults).line("machines with a fault", &faults));
    text.push_str(&sum(&trends).line("machines that wear", &trends));
    for (parameter, changes) in &least {
        let mean = changes.iter().sum::<f64>() / changes.len().max(1) as f64;
        if mean.is_finite() && mean > 0.0 {
            let _ =
                writeln!(text, "a change of {parameter} by {:.1} % would be listed with 80 %", 100.0 * mean);
        }
    }
    let [named, placed, rival, of] = right;
    let _ = writeln!(
        text,
        "of {of} faults that were found, {named} have the right effect; {placed} the right effect and place, {rival} as a rival"
    );
    for level in [0.001, 0.01, 0.05, 0.2] {
        let below = p_values.iter().filter(|p| **p < level).count();
        let share = below as f64 / p_values.len().max(1) as f64;
        let _ = writeln!(
            text,
            "p < {level}: {share:.4} of {} recordings of machines without a fault",
            p_values.len()
        );
    }
    Ok(text)
}

fn of_faults(
    summary: &Summary,
    (truth, rivals): (&BTreeMap<&str, &FleetMachine>, &BTreeMap<String, Vec<String>>),
    [named, placed, rival, of]: &mut [usize; 4],
) -> Tally {
    let is_faulty = |machine: &str| truth[machine].fault.is_some();
    let found: Vec<_> = summary.faulty.iter().filter(|one| is_faulty(&one.machine)).collect();
    for one in &found {
        let Some(fault) = &truth[one.machine.as_str()].fault else { continue };
        let named_effect = format!("{}@", fault.effect);
        *of += 1;
        *named += usize::from(one.findings.iter().any(|finding| finding.starts_with(&named_effect)));
        let key = format!("{named_effect}{}", fault.place);
        let is_placed = one.findings.contains(&key);
        *placed += usize::from(is_placed);
        *rival += usize::from(!is_placed && rivals[&one.machine].contains(&key));
    }
    Tally {
        there: truth.values().filter(|machine| machine.fault.is_some()).count(),
        found: found.len(),
        listed: summary.faulty.len(),
        wrong: summary.faulty.len() - found.len(),
    }
}

/// A machine that wears is found by a trend of any of its parameters in the direction of the wear: by that of a combination where the
/// parameter itself is not determined.
fn of_trends(summary: &Summary, truth: &BTreeMap<&str, &FleetMachine>) -> Tally {
    let wears = |machine: &str| truth[machine].wear.is_some();
    let is_right = |one: &&socam_fleet::Trend| {
        let wear = truth[one.machine.as_str()].wear.as_ref();
        wear.is_some_and(|wear| wear.value.signum() == one.change.signum())
    };
    let found: BTreeSet<&str> =
        summary.trends.iter().filter(is_right).map(|one| one.machine.as_str()).collect();
    Tally {
        there: truth.values().filter(|machine| machine.wear.is_some()).count(),
        found: found.len(),
        listed: summary.trends.len(),
        wrong: summary.trends.iter().filter(|one| !wears(&one.machine)).count(),
    }
}

/// The rows of a fleet, each recording simulated, written as CSV and diagnosed on one thread.
fn rows(args: &Args, fleet: &VirtualFleet, options: &FleetOptions) -> Result<Vec<Row>, String> {
    let (model, profile) = (args.model()?, args.profile()?);
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let todo: Vec<(usize, usize)> =
        (0..args.machines).flat_map(|machine| (0..args.dates).map(move |date| (machine, date))).collect();
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let one = |machine: usize, date: usize| -> Result<Row, String> {
        let serial = &fleet.machines[machine].serial;
        let name = format!("{serial}/{date}.csv");
        let path = folder.path().join(format!("{serial}-{date}.csv"));
        let data = fleet.record(machine, date, &profile, PERIOD_US).map_err(|e| e.to_string())?;
        export_csv(&data, &path).map_err(|e| e.to_string())?;
        let date = Some(MONTH_MS * date as i64);
        let source = Source { name, machine: Some(serial.clone()), date, ..Source::path(&path) };
        let row = diagnose_one(&source, &model, options, 1);
        std::fs::remove_file(&path).map_err(|e| e.to_string())?;
        Ok(row)
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some((machine, date)) = todo.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let row = one(*machine, *date);
                    found.lock().unwrap_or_else(PoisonError::into_inner).push(row);
                }
            });
        }
    });
    let all = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut rows = all.into_iter().collect::<Result<Vec<Row>, String>>()?;
    rows.sort_by(|a, b| a.recording.cmp(&b.recording));
    Ok(rows)
}
