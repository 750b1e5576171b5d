//! What is said of all cases, of some, of one.

use std::collections::BTreeMap;
use std::fmt::Write;

use socam_identify::End;

use crate::case::{Family, MOTOR_SPEED_NOISE};
use crate::table;
use crate::tally::{Tally, median};
use crate::trial::Trial;

/// What is asked of the estimator: at least so many intervals, so many of them holding the truth.
const ENOUGH: usize = 1500;
const COVERAGE: (f64, f64) = (0.93, 0.97);

/// What must never be called determined by mistake.
const ALONE: [&str; 5] = ["k1", "k2", "k3", "c2", "c3"];

/// What must always be determined.
const SERIES: &str = "k_series_12";

/// Limits of the groups by length of all recordings, s.
const LENGTHS_S: [(f64, f64); 4] = [(0.0, 12.0), (12.0, 25.0), (25.0, 40.0), (40.0, 100.0)];

/// Everything about some trials.
pub(crate) fn summary(title: &str, trials: &[&Trial]) -> String {
    let some = |name: String, belongs: &dyn Fn(&Trial) -> bool| {
        (name, Tally::of(trials.iter().copied().filter(|trial| belongs(trial)), |_| true))
    };
    let names = names(trials);
    let quantities =
        names.iter().map(|name| (name.clone(), Tally::of(trials.iter().copied(), |q| q.name == *name)));
    let levels = MOTOR_SPEED_NOISE.iter().enumerate().map(|(level, std)| {
        some(format!("{std} rad/s"), &|trial| trial.case.motor_speed_level() == Some(level))
    });
    let families = Family::ALL.map(|family| some(family.name().into(), &|trial| trial.case.family == family));
    let lengths = LENGTHS_S.map(|(from, to)| {
        some(format!("{from} to {to} s"), &|trial| (from..to).contains(&trial.case.duration_s()))
    });
    let excitations = [
        some("with prbs".into(), &|trial| trial.case.has_prbs()),
        some("without".into(), &|trial| !trial.case.has_prbs()),
    ];
    let starts = [
        some("the model file".into(), &|trial| !trial.case.starts_anywhere),
        some("anywhere near".into(), &|trial| trial.case.starts_anywhere),
    ];
    let all = [some("all".into(), &|_| true), some("where converged".into(), &converged)];
    let mut text = format!("{title}: {} benches\n{}", trials.len(), table::of("pooled", &all));
    text += &table::of("by noise of the motor speed", &levels.collect::<Vec<_>>());
    text += &table::of("by quantity", &quantities.collect::<Vec<_>>());
    text += &table::of("by kind of bench", &families);
    text += &table::of("by length of all recordings", &lengths);
    text += &table::of("by excitation", &excitations);
    text += &table::of("by start of the fit", &starts);
    text += &table::across_levels(trials, &names);
    text += &verdicts(trials);
    text + &verdict(&all[0].1)
}

/// The answer in one line.
fn verdict(all: &Tally) -> String {
    let (low, high) = COVERAGE;
    let is_good = (low..=high).contains(&all.coverage()) && all.intervals() >= ENOUGH;
    format!(
        "{}: {:.1} % of {} intervals hold the truth; {:.0} to {:.0} % of at least {ENOUGH} should\n",
        if is_good { "good" } else { "not there" },
        100.0 * all.coverage(),
        all.intervals(),
        100.0 * low,
        100.0 * high
    )
}

fn converged(trial: &Trial) -> bool {
    trial.fit.as_ref().is_ok_and(|fit| matches!(fit.end, End::Converged | End::AtBound))
}

/// In the order of their first appearance.
fn names(trials: &[&Trial]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for quantity in trials.iter().flat_map(|trial| trial.quantities()) {
        if !names.contains(&quantity.name) {
            names.push(quantity.name.clone());
        }
    }
    names
}

/// What is called determined and should not be, or the other way round; how fits ended; what it cost.
fn verdicts(trials: &[&Trial]) -> String {
    let mut text = String::from("\ncalled determined alone\n");
    for name in ALONE {
        let tally = Tally::of(trials.iter().copied(), |quantity| quantity.name == name);
        let _ = write!(text, "  {name}: {} of {}, missed {}", tally.intervals(), tally.all(), tally.misses());
        let _ = writeln!(text, "{}", table::cases(&tally.missed_in));
    }
    let series = Tally::of(trials.iter().copied(), |quantity| quantity.name == SERIES);
    let _ = writeln!(text, "{SERIES} called not determined: {} of {}", series.undetermined, series.all());
    let mut ends: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    for trial in trials {
        ends.entry(end(trial)).or_default().push(trial.case.number);
    }
    let _ = writeln!(text, "\nhow fits ended");
    for (end, numbers) in &ends {
        let which = if *end == CONVERGED { String::new() } else { table::cases(numbers) };
        let _ = writeln!(text, "  {end}: {}{which}", numbers.len());
    }
    text + &costs(trials)
}

const CONVERGED: &str = "converged";

fn end(trial: &Trial) -> &'static str {
    match trial.fit.as_ref().map(|fit| fit.end) {
        Ok(End::Converged) => CONVERGED,
        Ok(End::AtBound) => "at a bound",
        Ok(End::Stalled) => "stalled",
        Ok(End::IterationLimit) => "iteration limit",
        Ok(End::Interrupted | End::Budget) => "interrupted",
        Err(_) => "failed",
    }
}

fn costs(trials: &[&Trial]) -> String {
    let mut fits_s: Vec<f64> = trials.iter().map(|trial| trial.fit_s).collect();
    fits_s.sort_by(f64::total_cmp);
    let recordings_s: f64 = trials.iter().map(|trial| trial.recording_s).sum();
    let length_s: f64 = trials.iter().map(|trial| trial.case.duration_s()).sum();
    format!(
        "processor time: {recordings_s:.1} s for recordings of {length_s:.0} s; fits {:.1} s, median {:.2} s, longest {:.2} s\n",
        fits_s.iter().sum::<f64>(),
        median(&fits_s),
        fits_s.last().copied().unwrap_or(f64::NAN),
    )
}

/// One line about a case.
pub(crate) fn line(trial: &Trial) -> String {
    let case = &trial.case;
    let runs: Vec<String> =
        case.runs.iter().map(|run| format!("{} {:.0} s", run.name, run.profile.duration_s)).collect();
    let (_, input_noise) = &case.noise[0];
    let (number, family, runs) = (case.number, case.family.name(), runs.join(", "));
    let mut text =
        format!("{number:>4} {family:<11} {input_noise:<6} {runs:<58} {} {:.2} s", end(trial), trial.fit_s);
    match &trial.fit {
        Err(error) => text += &format!(": {error}"),
        Ok(fit) => {
            for quantity in fit.quantities.iter().filter(|quantity| quantity.holds() == Some(false)) {
                let _ = write!(text, "  {} {:+.1}", quantity.name, quantity.z().unwrap_or(f64::NAN));
            }
        }
    }
    text
}

/// Everything about one case.
pub(crate) fn detail(trial: &Trial) -> String {
    let case = &trial.case;
    let mut text = format!("{}\n\n", line(trial));
    for run in &case.runs {
        let _ = writeln!(text, "{}, {:.3} s: {:?}", run.name, run.profile.duration_s, run.profile.waveform);
    }
    let Ok(fit) = &trial.fit else { return text };
    let _ = writeln!(text, "\n{} after {} iterations", end(trial), fit.iterations);
    for (channel, used, sensor) in &fit.noise {
        let _ = writeln!(text, "noise of {channel}: taken as {used:.4e}, of its sensor {sensor:.4e}");
    }
    let head = ["start", "truth", "found", "z", "half width%"];
    let _ = write!(text, "\n  {:<16}", "");
    head.iter().for_each(|head| text += &format!(" {head:>12}"));
    text.push('\n');
    for quantity in &fit.quantities {
        let start = case.start.iter().find(|(name, _)| *name == quantity.name);
        let start = start.map_or_else(String::new, |(_, value)| format!("{value:.5e}"));
        let _ = write!(text, "  {:<16} {start:>12} {:>12.5e}", quantity.name, quantity.truth);
        if let (Some(found), Some(z), Some(half)) =
            (quantity.found, quantity.z(), quantity.relative_half_width())
        {
            let _ = write!(text, " {:>12.5e} {z:>12.2} {:>12.3}", found.value, 100.0 * half);
        } else if let Some(point) = quantity.point {
            let _ = write!(text, " {point:>12.5e} not determined");
        }
        text.push('\n');
    }
    fit.warnings.iter().for_each(|warning| text += &format!("{warning}\n"));
    text
}

/// Every quantity of every case, for a spreadsheet.
pub(crate) fn csv(trials: &[Trial]) -> String {
    let mut text =
        "case,half,kind,input_noise,length_s,prbs,end,quantity,truth,value,std,low,high,z\n".to_owned();
    for trial in trials {
        let case = &trial.case;
        let half = if case.is_kept_aside() { "kept aside" } else { "tuning" };
        let of_case = format!(
            "{},{half},{},{},{},{},{}",
            case.number,
            case.family.name(),
            case.noise[0].1,
            case.duration_s(),
            case.has_prbs(),
            end(trial)
        );
        for quantity in trial.quantities() {
            let _ = write!(text, "{of_case},{},{}", quantity.name, quantity.truth);
            match (quantity.found, quantity.z()) {
                (Some(f), Some(z)) => {
                    let _ = writeln!(text, ",{},{},{},{},{z}", f.value, f.std, f.low, f.high);
                }
                _ => text += ",,,,,\n",
            }
        }
    }
    text
}
