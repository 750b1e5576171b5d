//! Rows and columns.

use std::fmt::Write;

use crate::case::{LEVELS, MOTOR_SPEED_NOISE};
use crate::tally::Tally;
use crate::trial::Trial;

/// Case numbers shown after a count, at most.
const SHOWN: usize = 12;

/// One row for each tally that counted anything; nothing at all where none did.
pub(crate) fn of(title: &str, rows: &[(String, Tally)]) -> String {
    let rows: Vec<_> = rows.iter().filter(|(_, tally)| tally.all() > 0).collect();
    if rows.is_empty() {
        return String::new();
    }
    let mut text = format!("\n{title:<30}");
    for head in ["intervals", "hold %", "+-", "mean z", "std z", "size z", "half width%", "not given"] {
        let _ = write!(text, " {head:>11}");
    }
    text.push('\n');
    for (name, tally) in rows {
        let _ = write!(text, "  {name:<28} {:>11}", tally.intervals());
        if tally.intervals() > 0 {
            let percent = [tally.coverage(), tally.coverage_half_width()].map(|part| 100.0 * part);
            percent.iter().for_each(|percent| text += &format!(" {percent:>11.1}"));
            let sizes = [tally.z_mean(), tally.z_std(), tally.z_size()];
            sizes.iter().for_each(|size| text += &format!(" {size:>11.2}"));
            let _ = write!(text, " {:>11.3}", 100.0 * tally.width_median());
        } else {
            let _ = write!(text, " {:71}", "");
        }
        let _ = writeln!(text, " {:>11}", tally.undetermined);
    }
    text
}

/// One row for each quantity, one column for each noise level of the motor speed.
pub(crate) fn across_levels(trials: &[&Trial], names: &[String]) -> String {
    let mut rows = String::new();
    for name in names {
        let of_level = |level: usize| {
            let trials = trials.iter().copied().filter(|trial| trial.case.motor_speed_level() == Some(level));
            Tally::of(trials, |quantity| quantity.name == *name)
        };
        let tallies: Vec<Tally> = (0..LEVELS).map(of_level).collect();
        if tallies.iter().all(|tally| tally.intervals() == 0) {
            continue;
        }
        let _ = write!(rows, "  {name:<22}");
        tallies.iter().for_each(|tally| rows += &format!(" {:>22}", cell(tally)));
        rows.push('\n');
    }
    if rows.is_empty() {
        return rows;
    }
    let mut head = format!("\n{:<24}", "hold %, mean z, std z");
    MOTOR_SPEED_NOISE.iter().for_each(|std| head += &format!(" {:>22}", format!("{std} rad/s")));
    format!("{head}\n{rows}")
}

fn cell(tally: &Tally) -> String {
    match tally.intervals() {
        0 => "-".to_owned(),
        1 => format!("{:.0} {:+.1} (1)", 100.0 * tally.coverage(), tally.z_mean()),
        n => format!("{:.0} {:+.1} {:.1} ({n})", 100.0 * tally.coverage(), tally.z_mean(), tally.z_std()),
    }
}

/// Numbers of cases, in brackets.
pub(crate) fn cases(numbers: &[u64]) -> String {
    if numbers.is_empty() {
        return String::new();
    }
    let mut shown: Vec<String> = numbers.iter().take(SHOWN).map(u64::to_string).collect();
    if numbers.len() > SHOWN {
        shown.push("..".to_owned());
    }
    format!(" (case {})", shown.join(", "))
}
