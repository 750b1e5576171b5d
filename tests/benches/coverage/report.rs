//! The tables.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::case::{Family, LEVELS, MOTOR_SPEED_NOISE};
use crate::tally::{Tally, median};
use crate::trial::{Quantity, Trial};

/// What must never be called determined by mistake.
const ALONE: [&str; 5] = ["k1", "k2", "k3", "c2", "c3"];

/// What must always be determined.
const SERIES: &str = "k_series_12";

/// Limits of the groups by length of all recordings, s.
const LENGTHS_S: [(f64, f64); 4] = [(0.0, 12.0), (12.0, 25.0), (25.0, 40.0), (40.0, 100.0)];

/// Everything about some trials.
pub(crate) fn summary(title: &str, trials: &[&Trial]) -> String {
    let mut text = format!("{title}: {} benches\n\n", trials.len());
    text += &table(&[vec![("all, pooled".to_owned(), pooled(trials.iter().copied(), |_| true))]].concat());
    let names = names(trials);
    let each = |name: &String| (name.clone(), Tally::of(trials.iter().copied(), |q| q.name == *name));
    text += &format!("\nby quantity\n{}", table(&names.iter().map(each).collect::<Vec<_>>()));
    let chosen = |group: &dyn Fn(&Trial) -> bool| {
        pooled(trials.iter().copied().filter(|trial| group(trial)), |_| true)
    };
    let levels = MOTOR_SPEED_NOISE.iter().enumerate().map(|(level, std)| {
        let is_of = |trial: &Trial| trial.case.family.has_motor_speed() && trial.case.level == level;
        (format!("{std} rad/s"), chosen(&is_of))
    });
    text += &format!("\nby noise of the motor speed\n{}", table(&levels.collect::<Vec<_>>()));
    let families = Family::ALL
        .map(|family| (family.name().to_owned(), chosen(&|trial: &Trial| trial.case.family == family)));
    text += &format!("\nby kind of bench\n{}", table(&families));
    let lengths = LENGTHS_S.map(|(from, to)| {
        let is_of = |trial: &Trial| (from..to).contains(&trial.case.duration_s());
        (format!("{from} to {to} s"), chosen(&is_of))
    });
    text += &format!("\nby length of all recordings\n{}", table(&lengths));
    text += &format!(
        "\nby quantity and noise of the motor speed: hold %, mean z, std z\n{}",
        cross(trials, &names)
    );
    text + &verdicts(trials)
}

/// Intervals that count, each of them once.
fn pooled<'t>(trials: impl IntoIterator<Item = &'t Trial>, wanted: impl Fn(&Quantity) -> bool) -> Tally {
    Tally::of(trials, |quantity| !quantity.repeats && wanted(quantity))
}

fn names(trials: &[&Trial]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for quantity in trials.iter().flat_map(|trial| trial.quantities()) {
        if !names.contains(&quantity.name) {
            names.push(quantity.name.clone());
        }
    }
    names
}

fn table(rows: &[(String, Tally)]) -> String {
    let mut text = format!(
        "  {:<18} {:>10} {:>7} {:>8} {:>7} {:>7} {:>7} {:>7} {:>11}\n",
        "", "determined", "not", "hold %", "+-", "mean z", "std z", "size z", "half width%"
    );
    for (name, tally) in rows {
        let _ = write!(text, "  {name:<18} {:>10} {:>7}", tally.intervals(), tally.undetermined);
        if tally.intervals() > 0 {
            let _ = write!(
                text,
                " {:>8.1} {:>7.1} {:>7.2} {:>7.2} {:>7.2} {:>11.2}",
                100.0 * tally.coverage(),
                100.0 * tally.coverage_half_width(),
                tally.z_mean(),
                tally.z_std(),
                tally.z_size(),
                100.0 * tally.width_median(),
            );
        }
        text.push('\n');
    }
    text
}

fn cross(trials: &[&Trial], names: &[String]) -> String {
    let mut text = format!("  {:<18}", "");
    for std in MOTOR_SPEED_NOISE {
        let _ = write!(text, " {:>24}", format!("{std} rad/s"));
    }
    text.push('\n');
    for name in names {
        let tallies: Vec<Tally> = (0..LEVELS)
            .map(|level| {
                let chosen = trials
                    .iter()
                    .copied()
                    .filter(|trial| trial.case.family.has_motor_speed() && trial.case.level == level);
                Tally::of(chosen, |quantity| quantity.name == *name)
            })
            .collect();
        if tallies.iter().all(|tally| tally.intervals() == 0) {
            continue;
        }
        let _ = write!(text, "  {name:<18}");
        for tally in &tallies {
            let cell = if tally.intervals() == 0 {
                "-".to_owned()
            } else {
                let (hold, mean, std) = (100.0 * tally.coverage(), tally.z_mean(), tally.z_std());
                format!("{hold:.0} {mean:+.1} {std:.1} ({})", tally.intervals())
            };
            let _ = write!(text, " {cell:>24}");
        }
        text.push('\n');
    }
    text
}

/// What is called determined and should not be, or the other way round; ends and costs.
fn verdicts(trials: &[&Trial]) -> String {
    let mut text = String::from("\ncalled determined alone, and missed\n");
    for name in ALONE {
        let tally = Tally::of(trials.iter().copied(), |quantity| quantity.name == name);
        let all = tally.intervals() + tally.undetermined;
        let _ = writeln!(text, "  {name}: {} of {all}, {} missed", tally.intervals(), tally.misses());
    }
    let series = Tally::of(trials.iter().copied(), |quantity| quantity.name == SERIES);
    let all = series.intervals() + series.undetermined;
    let _ = writeln!(text, "{SERIES} not determined: {} of {all}", series.undetermined);
    let mut ends: BTreeMap<String, usize> = BTreeMap::new();
    for trial in trials {
        let end = trial.fit.as_ref().map_or_else(|_| "failed".to_owned(), |fit| format!("{:?}", fit.end));
        *ends.entry(end).or_default() += 1;
    }
    let ends: Vec<String> = ends.iter().map(|(end, count)| format!("{end} {count}")).collect();
    let _ = writeln!(text, "ends: {}", ends.join(", "));
    for trial in trials {
        if let Err(error) = &trial.fit {
            let _ = writeln!(text, "  case {} failed: {error}", trial.case.number);
        }
    }
    let mut times: Vec<f64> = trials.iter().map(|trial| trial.fit_s).collect();
    times.sort_by(f64::total_cmp);
    let simulation_s: f64 = trials.iter().map(|trial| trial.simulation_s).sum();
    let recorded_s: f64 = trials.iter().map(|trial| trial.case.duration_s()).sum();
    let _ = writeln!(
        text,
        "processor time: {simulation_s:.1} s to simulate {recorded_s:.0} s; fits {:.1} s, median {:.2} s, longest {:.2} s",
        times.iter().sum::<f64>(),
        median(&times),
        times.last().copied().unwrap_or(f64::NAN),
    );
    text
}

/// One line about a case.
pub(crate) fn line(trial: &Trial) -> String {
    let case = &trial.case;
    let runs: Vec<String> =
        case.runs.iter().map(|run| format!("{} {:.0} s", run.name, run.profile.duration_s)).collect();
    let mut text = format!(
        "case {:>4} {:<11} input {:<6} {:<60}",
        case.number,
        case.family.name(),
        case.noise[0].1,
        runs.join(", ")
    );
    match &trial.fit {
        Err(error) => text += &format!(" failed: {error}"),
        Ok(fit) => {
            let _ = write!(text, " {:?} {:.2} s", fit.end, trial.fit_s);
            for quantity in &fit.quantities {
                if let (Some(false), Some(z)) = (quantity.holds(), quantity.z()) {
                    let _ = write!(text, ", {} misses by {z:+.1}", quantity.name);
                }
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
        let _ = writeln!(text, "{}, seed {}: {:?}", run.name, run.seed, run.profile.course);
    }
    let Ok(fit) = &trial.fit else { return text };
    let _ = writeln!(text, "\n{:?} after {} iterations\n", fit.end, fit.iterations);
    for (channel, used, sensor) in &fit.noise {
        let _ = writeln!(text, "noise of {channel}: {used:.4e}, its sensor's {sensor:.4e}");
    }
    let _ = writeln!(
        text,
        "\n  {:<18} {:>12} {:>12} {:>12} {:>8} {:>11}",
        "", "start", "truth", "found", "z", "half width%"
    );
    for quantity in &fit.quantities {
        let start = case.start.iter().find(|(name, _)| *name == quantity.name);
        let start = start.map_or_else(String::new, |(_, value)| format!("{value:.5e}"));
        let _ = write!(text, "  {:<18} {start:>12} {:>12.5e}", quantity.name, quantity.truth);
        if let (Some(found), Some(z), Some(half)) =
            (quantity.found, quantity.z(), quantity.relative_half_width())
        {
            let _ = write!(text, " {:>12.5e} {z:>8.2} {:>11.2}", found.value, 100.0 * half);
        }
        text.push('\n');
    }
    for warning in &fit.warnings {
        let _ = writeln!(text, "{warning}");
    }
    text
}
