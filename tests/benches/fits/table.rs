//! The tables of all cases, in Markdown.

use std::fmt::Write;

use socam_sim::challenge::FAMILY_NAMES;

use crate::trial::{Parameter, Trial};

/// Limits of the classes of misfits, in units of noise.
const CLASSES: [(f64, f64); 5] = [(0.0, 1.5), (1.5, 5.0), (5.0, 20.0), (20.0, 60.0), (60.0, f64::INFINITY)];

const FLAWS: [&str; 5] =
    ["uneven stamps", "failed reads", "begins in motion", "redundant sensor", "wrong sign"];

const HEAD: &str = "| | cases | at the best known minimum | intervals | hold the truth | median half-width | not determined | false warnings | \
                    missing warnings | wrong signs named | CPU s, median | largest |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";

/// Everything about all cases.
pub(crate) fn summary(seed: u64, trials: &[Trial]) -> String {
    let some =
        |belongs: &dyn Fn(&Trial) -> bool| trials.iter().filter(|trial| belongs(trial)).collect::<Vec<_>>();
    let is_signed = |trial: &Trial| trial.flaws.wrong_sign.is_some();
    let mut text = format!(
        "Seed {seed}, {} cases. Misfit: residual of the worst output in units of its noise.\n\n{HEAD}",
        trials.len()
    );
    for (from, to) in CLASSES {
        let name = match (from, to) {
            (0.0, to) => format!("misfit below {to}"),
            (from, f64::INFINITY) => format!("above {from}"),
            (from, to) => format!("{from} to {to}"),
        };
        let is_of = |trial: &Trial| trial.fit.as_ref().is_some_and(|fit| (from..to).contains(&fit.misfit));
        text += &row(&name, &some(&|trial| is_of(trial) && !is_signed(trial)));
    }
    text += &row("a wrong sign", &some(&is_signed));
    text += &row("all", &some(&|_| true));
    let _ = write!(text, "\n{HEAD}");
    for family in FAMILY_NAMES {
        text += &row(family, &some(&|trial| trial.family == family));
    }
    let _ = write!(text, "\nA case may have several flaws.\n\n{HEAD}");
    text += &row("neither flaw nor background", &some(&Trial::is_plain));
    text += &row(
        "a background alone",
        &some(&|trial| !trial.background.is_empty() && trial.flaws.names().is_empty()),
    );
    for flaw in FLAWS {
        text += &row(flaw, &some(&|trial| trial.flaws.names().contains(&flaw)));
    }
    text + &lists(trials)
}

fn row(name: &str, trials: &[&Trial]) -> String {
    let fits = || trials.iter().filter_map(|trial| trial.fit.as_ref());
    // Beside a wrong sign no parameter has a meaning.
    let parameters = || {
        let meant = trials.iter().filter(|trial| trial.flaws.wrong_sign.is_none());
        meant.filter_map(|trial| trial.fit.as_ref()).flat_map(|fit| &fit.parameters)
    };
    let intervals = parameters().filter_map(|parameter| parameter.holds(0.0));
    let undetermined = parameters().filter(|parameter| parameter.ci95.is_none()).count();
    let width = median(parameters().filter_map(Parameter::half_width).map(|width| 100.0 * width));
    let seconds = || trials.iter().map(|trial| trial.cpu_s);
    format!(
        "| {name} | {} | {} | {} | {} | {} | {undetermined} | {} | {} | {} | {} | {} |\n",
        trials.len(),
        share(fits().map(|fit| fit.costs.is_best())),
        parameters().count() - undetermined,
        percent(intervals),
        width.map_or_else(none, |width| format!("{width:.2} %")),
        share(trials.iter().filter_map(|trial| trial.is_false_warning())),
        share(trials.iter().filter_map(|trial| trial.is_missing_warning())),
        share(trials.iter().filter_map(|trial| trial.is_sign_named())),
        median(seconds()).map_or_else(none, |s| format!("{s:.2}")),
        seconds().reduce(f64::max).map_or_else(none, |s| format!("{s:.1}")),
    )
}

fn none() -> String {
    "-".into()
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// How many of the outcomes are true.
fn count(outcomes: impl Iterator<Item = bool>) -> (usize, usize) {
    outcomes.fold((0, 0), |(hits, of), hit| (hits + usize::from(hit), of + 1))
}

fn share(outcomes: impl Iterator<Item = bool>) -> String {
    match count(outcomes) {
        (_, 0) => none(),
        (hits, of) => format!("{hits} of {of}"),
    }
}

fn percent(outcomes: impl Iterator<Item = bool>) -> String {
    match count(outcomes) {
        (_, 0) => none(),
        (hits, of) => format!("{:.1} %", 100.0 * hits as f64 / of as f64),
    }
}

/// The cases that went wrong, one a line.
fn lists(trials: &[Trial]) -> String {
    let mut text = String::new();
    let mut list = |title: &str, of: &dyn Fn(&Trial) -> Option<String>| {
        let lines: Vec<String> = trials.iter().filter_map(of).collect();
        if !lines.is_empty() {
            let _ = write!(text, "\n{title}:\n\n- {}\n", lines.join("\n- "));
        }
    };
    list("Not at the best known minimum", &|trial| {
        let fit = trial.fit.as_ref().filter(|fit| !fit.costs.is_best())?;
        let above = 100.0 * fit.costs.above() / fit.costs.own;
        Some(format!("{}; misfit {:.1}, {above:.2} % of the cost above", trial.words(), fit.misfit))
    });
    let verdict = |trial: &Trial| {
        let fit = trial.fit.as_ref();
        let times = fit.and_then(|fit| fit.times_noise).unwrap_or(f64::NAN);
        let misfit = fit.map_or(f64::NAN, |fit| fit.misfit);
        format!("{}; misfit {misfit:.2}, by the verdict {times:.2}", trial.words())
    };
    list("False warnings", &|trial| (trial.is_false_warning() == Some(true)).then(|| verdict(trial)));
    list("Missing warnings", &|trial| (trial.is_missing_warning() == Some(true)).then(|| verdict(trial)));
    list("Wrong signs not named", &|trial| {
        let wrong = trial.flaws.wrong_sign.as_ref().filter(|_| trial.is_sign_named() == Some(false))?;
        let said = trial.fit.as_ref().and_then(|fit| fit.sign.clone()).unwrap_or_else(|| "nothing".into());
        Some(format!("{}; {wrong}, and {said} was named", trial.words()))
    });
    list("Signs named that are right", &|trial| {
        let named = trial.fit.as_ref()?.sign.as_ref().filter(|_| trial.flaws.wrong_sign.is_none())?;
        Some(format!("{}; {named}", trial.words()))
    });
    list("No fit", &|trial| Some(format!("{}; {}", trial.words(), trial.error.as_ref()?)));
    text
}
