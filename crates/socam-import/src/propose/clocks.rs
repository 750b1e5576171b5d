//! Finds the signal that contains a group's times, and its unit.

use socam_units::{Column, Meaning, column, plain_name, seconds};

use super::ProposedClock;
use crate::mapping::Stamps;
use crate::source::{Group, Signal, Source};
use crate::times::Times;

/// Words that name times.
const WORDS: [&str; 10] =
    ["t", "time", "times", "timestamp", "stamp", "zeit", "temps", "clock", "secs", "elapsed"];

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
    match best {
        Some((_, column, unit, assumed, times, stamps)) => {
            ProposedClock { time: Some((column, unit)), assumed, times: Some(times), stamps, ..none }
        }
        None => none,
    }
}

/// Whether a column seems to hold times.
pub(super) fn is_time_like(column: &Column) -> bool {
    match column.meaning {
        Meaning::Time(_) => true,
        Meaning::Values(_) => false,
        _ => is_named(&column.name),
    }
}

/// Whether a signal is the clock of tables that are named by the rule of this program's own.
pub(super) fn is_own(signal: &Signal) -> bool {
    signal.name == "t_s" || signal.name.ends_with(".t_s")
}

fn is_named(bare: &str) -> bool {
    let small = plain_name(bare);
    let last = small.rsplit('_').next().unwrap_or(&small);
    WORDS.contains(&small.as_str()) || WORDS.contains(&last)
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
                _ => {
                    let step = crate::times::median_step_s(&signal.values)
                        .filter(|step| *step > 0.0 && *step < 0.5)?;
                    ("s", format!("its step of {} is then {} Hz", short(step), short(1.0 / step)))
                }
            };
            Some((unit.into(), Some(why)))
        }
        _ => unnamed(signal),
    }
}

/// The first column of a table without names, where it increases evenly.
fn unnamed(signal: &Signal) -> Option<(String, Option<String>)> {
    const EVEN: f64 = 0.05;
    let is_first = signal.name == "column 1" || (signal.name.ends_with(".1") && !signal.name.contains(' '));
    let step = crate::times::median_step_s(&signal.values).filter(|step| *step > 0.0 && *step < 0.5)?;
    let is_even = signal.values.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < EVEN * step);
    let why = format!(
        "it is the first of columns without names, and increases in steps of {}, {} Hz",
        short(step),
        short(1.0 / step)
    );
    (is_first && is_even).then(|| ("s".into(), Some(why)))
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
