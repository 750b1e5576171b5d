//! Columns of dates, and tables with several clocks.

use socam_recording::Warning;
use socam_units::column;

use crate::dates::Moment;
use crate::source::{Group, Signal};
use crate::time_names::is_time_like;

const DAY_NS: i64 = 86_400_000_000_000;

/// A column of dates, of days or of times of day.
pub(super) struct Dated {
    pub(super) name: String,
    pub(super) moments: Vec<Option<Moment>>,
}

impl Dated {
    fn is(&self, kind: impl Fn(&Moment) -> bool) -> bool {
        self.moments.iter().flatten().all(kind)
    }

    fn ns(&self) -> impl Iterator<Item = Option<i64>> + Clone + '_ {
        self.moments.iter().map(|moment| moment.map(Moment::nanoseconds))
    }
}

/// Signals of columns of dates, each with its place. A column of days and one of times of day become one signal; days alone are left aside;
/// times of day go on behind midnight.
pub(super) fn joined(columns: Vec<(usize, Dated)>, notes: &mut Vec<Warning>) -> Vec<(usize, Signal)> {
    let is_day = |dated: &Dated| dated.is(|moment| matches!(moment, Moment::Day(_)));
    let is_clock = |dated: &Dated| dated.is(|moment| matches!(moment, Moment::Clock(_)));
    let (days, others): (Vec<_>, Vec<_>) = columns.into_iter().partition(|(_, dated)| is_day(dated));
    let clocks = others.iter().filter(|(_, dated)| is_clock(dated)).count();
    let mut signals = Vec::new();
    for (place, dated) in others {
        if !is_clock(&dated) {
            signals.push((place, Signal::of_dates(&*dated.name, dated.ns())));
        } else if let ([(_, day)], 1) = (days.as_slice(), clocks) {
            let both = day.ns().zip(dated.ns()).map(|(day, clock)| Some(day? + clock?));
            signals.push((place, Signal::of_dates(format!("{} {}", day.name, dated.name), both)));
        } else {
            signals.push((place, behind_midnight(&dated, notes)));
        }
    }
    let is_joined = days.len() == 1 && clocks == 1;
    for (_, day) in days.iter().filter(|_| !is_joined) {
        notes
            .push(Warning::Note(format!("column `{}` holds days without times and is left aside", day.name)));
    }
    signals
}

/// Times of day, with a day added at each fall by more than half a day.
fn behind_midnight(dated: &Dated, notes: &mut Vec<Warning>) -> Signal {
    let (mut last, mut added) = (None, 0);
    let mut ns = Vec::with_capacity(dated.moments.len());
    for (row, clock) in dated.ns().enumerate() {
        if let (Some(last), Some(clock)) = (last, clock)
            && last - clock > DAY_NS / 2
        {
            added += DAY_NS;
            notes.push(Warning::Note(format!(
                "the times of day in `{}` pass midnight in row {}: a day was added from there on",
                dated.name,
                row + 1
            )));
        }
        last = clock.or(last);
        ns.push(clock.map(|clock| clock + added));
    }
    Signal::of_dates(&*dated.name, ns.iter().copied())
}

/// A table by its clocks: where the name of the first column, a time, comes back before other columns, each such column is the clock of those
/// behind it.
pub(super) fn by_clock(table: Group) -> Vec<Group> {
    let root = |signal: &Signal| {
        signal.name.trim_end_matches(|c: char| c.is_ascii_digit() || " _#.".contains(c)).to_lowercase()
    };
    let is_time = |signal: &Signal| is_time_like(&column(&signal.name, signal.unit.as_deref()));
    let Some(first) = table.signals.first().filter(|first| is_time(first)).map(root) else {
        return vec![table];
    };
    let clocks: Vec<usize> = (0..table.signals.len())
        .filter(|at| is_time(&table.signals[*at]) && root(&table.signals[*at]) == first)
        .collect();
    let ends = clocks.iter().copied().skip(1).chain([table.signals.len()]);
    let has_values = clocks.iter().zip(ends).all(|(from, to)| to > from + 1);
    if clocks.len() < 2 || !has_values {
        return vec![table];
    }
    let mut groups: Vec<Group> = Vec::new();
    for (at, signal) in table.signals.into_iter().enumerate() {
        if clocks.contains(&at) {
            groups.push(Group { time: Some(0), ..Group::default() });
        }
        if let Some(group) = groups.last_mut() {
            if group.signals.len() == 1 {
                group.name.clone_from(&signal.name);
            }
            group.signals.push(signal);
        }
    }
    groups
}
