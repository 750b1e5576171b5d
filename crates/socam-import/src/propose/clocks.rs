//! Finds the signal that contains a group's times, and its unit.

use socam_units::{Meaning, column, seconds};

use super::ProposedClock;
use crate::mapping::Stamps;
use crate::source::{Group, Signal, Source};
use crate::time_names::is_named;
use crate::times::Times;

/// The clock of each group.
pub(super) fn find(source: &Source) -> Vec<ProposedClock> {
    let mut clocks: Vec<ProposedClock> =
        source.groups.iter().enumerate().map(|(index, group)| clock(index, group)).collect();
    // The fastest clock gives the rows.
    clocks.sort_by(|a, b| b.rate_hz().unwrap_or(0.0).total_cmp(&a.rate_hz().unwrap_or(0.0)));
    offsets(source, &mut clocks);
    clocks
}

fn clock(index: usize, group: &Group) -> ProposedClock {
    let none = ProposedClock {
        group: index,
        time: None,
        assumed: None,
        times: None,
        stamps: Stamps::Exact,
        restarts: None,
        offset: None,
    };
    let candidates = group.signals.iter().enumerate().filter_map(|(column, signal)| {
        let (unit, assumed) = time_unit(signal)?;
        let (times, stamps) = usable(group, column, seconds(&unit)?)?;
        // A message's own stamp is nearer to the measurement than the time of its arrival.
        let rank = match signal.name.as_str() {
            _ if is_own(signal) => 4,
            name if name.contains("stamp") => 3,
            _ if group.time == Some(column) => 2,
            "publish_time" => 1,
            _ => 2,
        };
        Some((rank, column, unit, assumed, times, stamps))
    });
    // Of equal candidates the first one in the file is taken.
    let best = candidates.reduce(|best, next| if next.0 > best.0 { next } else { best });
    let best = best.or_else(|| {
        let mut unknown = group.signals.iter().enumerate().filter(|(_, signal)| !is_value(signal));
        unknown.find_map(|(at, signal)| {
            let (unit, assumed) = rising(signal)?;
            let (times, stamps) = usable(group, at, seconds(&unit)?)?;
            Some((0, at, unit, assumed, times, stamps))
        })
    });
    match best {
        Some((_, column, unit, assumed, times, stamps)) => {
            ProposedClock { time: Some((column, unit)), assumed, times: Some(times), stamps, ..none }
        }
        None => ProposedClock { restarts: group.signals.iter().find_map(restarts), ..none },
    }
}

/// Where a signal that is named as a time begins anew: "`time` begins anew at row 501 and 3 more times".
fn restarts(signal: &Signal) -> Option<String> {
    time_unit(signal)?;
    let pairs = signal.values.windows(2).enumerate();
    // The first row of numbers is row 1.
    let mut rows = pairs.filter(|(_, pair)| pair[1] < pair[0]).map(|(row, _)| row + 2);
    let first = rows.next()?;
    let more = match rows.count() {
        0 => String::new(),
        1 => " and once more".into(),
        more => format!(" and {more} more times"),
    };
    Some(format!("`{}` begins anew at row {first}{more}", signal.name))
}

/// Whether a signal has the unit of a channel.
fn is_value(signal: &Signal) -> bool {
    matches!(column(&signal.name, signal.unit.as_deref()).meaning, Meaning::Values(_))
}

/// Whether a signal is the clock of tables that are named by the rule of this program's own.
pub(super) fn is_own(signal: &Signal) -> bool {
    signal.name == "t_s" || signal.name.ends_with(".t_s")
}

/// The unit of a time, and a sentence where the file does not state it.
fn time_unit(signal: &Signal) -> Option<(String, Option<String>)> {
    let column = column(&signal.name, signal.unit.as_deref());
    match (column.meaning, column.unit) {
        (Meaning::Time(_), Some(unit)) => Some((unit, None)),
        (Meaning::Values(_), _) => None,
        _ if is_named(&column.name) => {
            let first = signal.absolute().find(|value| value.is_finite())?;
            // Seconds since 1970 are of this size for the next two hundred years, and so are their thousandths.
            let (unit, why) = match first {
                first if first > 1e17 => ("ns", "its size is that of nanoseconds since 1970".to_owned()),
                first if first > 1e14 => ("us", "its size is that of microseconds since 1970".into()),
                first if first > 1e11 => ("ms", "its size is that of milliseconds since 1970".into()),
                first if first > 1e8 => ("s", "its size is that of seconds since 1970".into()),
                _ => by_step(signal)?,
            };
            Some((unit.into(), Some(why)))
        }
        _ => unnamed(signal),
    }
}

/// The unit in which a named time has a step of usual length, and why.
fn by_step(signal: &Signal) -> Option<(&'static str, String)> {
    let step = socam_recording::clocks::median_step_s(&signal.values).filter(|step| *step > 0.0)?;
    let (unit, unit_s) = match step {
        step if step < 0.5 => ("s", 1.0),
        step if step <= 200.0 => ("ms", 1e-3),
        step if step <= 2e5 => ("us", 1e-6),
        _ => ("ns", 1e-9),
    };
    Some((unit, format!("its step of {} is then {} Hz", short(step), short(1.0 / (step * unit_s)))))
}

/// The first column of a table without names, where it rises by the same step in nearly all rows.
fn unnamed(signal: &Signal) -> Option<(String, Option<String>)> {
    const EVEN: f64 = 0.05;
    const NEARLY_ALL: f64 = 0.9;
    let is_first = signal.name == "column 1" || (signal.name.ends_with(".1") && !signal.name.contains(' '));
    let step =
        socam_recording::clocks::median_step_s(&signal.values).filter(|step| *step > 0.0 && *step < 0.5)?;
    let steps = || signal.values.windows(2).map(|pair| pair[1] - pair[0]);
    let even = steps().filter(|own| (own - step).abs() < EVEN * step).count();
    let is_even = steps().all(|own| own > 0.0) && even as f64 >= NEARLY_ALL * steps().count() as f64;
    let why = format!(
        "it is the first of columns without names, and increases in steps of {}, {} Hz",
        short(step),
        short(1.0 / step)
    );
    (is_first && is_even).then(|| ("s".into(), Some(why)))
}

/// A column that rises in every row, where no other holds times: the first one, in the unit in which its step has a usual length. One that
/// rises by one is a number of the sample.
fn rising(signal: &Signal) -> Option<(String, Option<String>)> {
    const FEWEST: usize = 8;
    let steps = || signal.values.windows(2).map(|pair| pair[1] - pair[0]);
    if signal.values.len() < FEWEST || !steps().all(|step| step > 0.0) || steps().all(|step| step == 1.0) {
        return None;
    }
    let (least, most) = steps().fold((f64::INFINITY, 0.0_f64), |(a, b), step| (a.min(step), b.max(step)));
    let (unit, _) = by_step(signal)?;
    let by = if least == most { short(least) } else { format!("{} to {}", short(least), short(most)) };
    Some((unit.into(), Some(format!("it rises in every row, by {by}"))))
}

fn short(number: f64) -> String {
    format!("{:.6}", number).trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The times, where they increase, or would if they were evened out.
fn usable(group: &Group, column: usize, seconds: f64) -> Option<(Times, Stamps)> {
    let exact = Times::of_signal(group, column, seconds, Stamps::Exact);
    let is_still = matches!(&exact, Err(problem) if problem.contains("stands still"));
    match exact {
        Ok(times) => Some((times, Stamps::Exact)),
        Err(_) if is_still => {
            Times::of_signal(group, column, seconds, Stamps::Jitter).ok().map(|times| (times, Stamps::Jitter))
        }
        Err(_) => None,
    }
}

/// Offsets between clocks, where two of them measured the same motion.
fn offsets(source: &Source, clocks: &mut [ProposedClock]) {
    let Some((base, others)) = clocks.split_first_mut() else { return };
    for clock in others {
        clock.offset = crate::offset::between(source, (base.group, &base.times), (clock.group, &clock.times));
    }
}
