//! Contents of a file, before units and names of channels are decided.

use std::collections::HashSet;

use socam_recording::Warning;

/// Signals of a file, in groups that share a clock each.
#[derive(Debug, Clone, Default)]
pub struct Source {
    /// Groups with at least one signal.
    pub groups: Vec<Group>,
    /// Notes on parts that were left out or are missing.
    pub notes: Vec<Warning>,
    /// Layout by which the lines of a text file were read.
    pub text: Option<crate::TextLayout>,
    /// What the clock showed at time 0 of groups whose times are not since 1970 themselves, ns since 1970.
    pub start_unix_ns: Option<i64>,
    /// The DBC that was named for the frames of a CAN bus.
    pub dbc: Option<std::path::PathBuf>,
}

/// Signals that were sampled together.
#[derive(Debug, Clone, Default)]
pub struct Group {
    /// Name of the group in the file; empty if the file has none.
    pub name: String,
    /// Signals, all of the same length.
    pub signals: Vec<Signal>,
    /// The signal that the file itself declares as the times of the others.
    pub time: Option<usize>,
    /// Whether rows come in the order of their arrival, so that they are sorted by their times.
    pub is_by_arrival: bool,
}

/// One column of numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Signal {
    /// Name of the signal in the group.
    pub name: String,
    /// The unit that the file states apart from the name, as written there.
    pub unit: Option<String>,
    /// Values; NaN is a missing one. What they are relative to is in `origin`.
    pub values: Vec<f64>,
    /// Constant that is added to every value. It keeps all digits of large integers, such as times since 1970 in nanoseconds.
    pub origin: i64,
    /// Unit by a convention that the file does not state.
    pub hint: Option<&'static str>,
    /// Whether the file holds dates or times of day here, which are in ns.
    pub is_date: bool,
}

/// Below this size every integer is a floating-point number.
const EXACT: u64 = 1 << 53;

/// Unit of dates and times of day, s.
pub(crate) const DATE_UNIT_S: f64 = 1e-9;

impl Signal {
    /// A signal of floating-point values.
    pub(crate) fn new(name: impl Into<String>, unit: Option<String>, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: unit.filter(|unit| !unit.trim().is_empty()),
            values,
            ..Self::default()
        }
    }

    /// A signal of integers, some of which may be missing.
    pub(crate) fn of_integers(
        name: impl Into<String>,
        unit: Option<String>,
        values: impl Iterator<Item = Option<i64>> + Clone,
    ) -> Self {
        let first = values.clone().flatten().next().unwrap_or(0);
        let origin = if first.unsigned_abs() >= EXACT { first } else { 0 };
        let relative = |value: Option<i64>| value.map_or(f64::NAN, |value| value.wrapping_sub(origin) as f64);
        Self { origin, ..Self::new(name, unit, values.map(relative).collect()) }
    }

    /// Appends an integer; a large first one becomes the origin of all.
    pub(crate) fn push_integer(&mut self, value: i64) {
        if self.values.is_empty() && value.unsigned_abs() >= EXACT {
            self.origin = value;
        }
        self.values.push(value.wrapping_sub(self.origin) as f64);
    }

    /// A signal of dates, or of times of day, ns; some may be missing.
    pub(crate) fn of_dates(
        name: impl Into<String>,
        values: impl Iterator<Item = Option<i64>> + Clone,
    ) -> Self {
        Self { is_date: true, ..Self::of_integers(name, Some("ns".into()), values) }
    }

    /// Values with the origin added.
    pub fn absolute(&self) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().map(|value| value + self.origin as f64)
    }
}

/// Selection of the signals that are read, and of the number of rows.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// Names as in a mapping (`signal` or `group/signal`); `None` for all.
    pub signals: Option<HashSet<String>>,
    /// Most rows of a group.
    pub most_rows: usize,
}

impl Wanted {
    /// All signals and all rows.
    pub const ALL: Self = Self { signals: None, most_rows: usize::MAX };

    /// Whether a column may be read, before the groups and the final names of the columns are known.
    pub(crate) fn may_take(&self, column: &str) -> bool {
        let is_part = |name: &String| {
            let bare = name.rsplit_once('/').map_or(name.as_str(), |(_, bare)| bare);
            let begins = |name: &str| {
                name.strip_prefix(column).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
            };
            let ends = |name: &str| name.strip_suffix(column).is_some_and(|head| head.ends_with(' '));
            [name.as_str(), bare].into_iter().any(|name| begins(name) || ends(name))
        };
        self.signals.as_ref().is_none_or(|names| names.iter().any(is_part))
    }

    /// Whether a signal is read.
    pub(crate) fn takes(&self, group: &str, signal: &str) -> bool {
        self.signals
            .as_ref()
            .is_none_or(|names| names.contains(signal) || names.contains(&format!("{group}/{signal}")))
    }
}

impl Source {
    /// Number of signals, clocks included.
    #[must_use]
    pub fn signals(&self) -> usize {
        self.groups.iter().map(|group| group.signals.len()).sum()
    }

    /// Finds a signal by `signal`, where that name is unique, or by `group/signal`.
    pub fn find(&self, name: &str) -> Found<'_> {
        let mut found = Found::None;
        for (index, group) in self.groups.iter().enumerate() {
            for (column, signal) in group.signals.iter().enumerate() {
                let is_full = name.strip_suffix(&signal.name).and_then(|head| head.strip_suffix('/'));
                if is_full.is_some_and(|head| head == group.name) {
                    return Found::One(index, column, signal);
                }
                if signal.name == name {
                    found = match found {
                        Found::None => Found::One(index, column, signal),
                        Found::One(..) => Found::Several(2),
                        Found::Several(count) => Found::Several(count + 1),
                    };
                }
            }
        }
        found
    }

    /// The name by which [`Source::find`] finds a signal.
    #[must_use]
    pub fn name_of(&self, group: usize, column: usize) -> String {
        let (group, signal) = (&self.groups[group], &self.groups[group].signals[column]);
        match self.find(&signal.name) {
            Found::Several(_) => format!("{}/{}", group.name, signal.name),
            _ => signal.name.clone(),
        }
    }

    /// Joins groups whose clocks hold the same times. A single group needs no name.
    pub(crate) fn with_shared_clocks(self) -> Self {
        let mut source = self.with_joined_groups();
        if let [only] = source.groups.as_mut_slice() {
            only.name.clear();
        }
        source
    }

    /// Joins groups whose clocks hold the same times; the first one gives its name.
    pub(crate) fn with_joined_groups(mut self) -> Self {
        let mut joined: Vec<Group> = Vec::new();
        let same = |a: &Signal, b: &Signal| {
            let pairs = || a.values.iter().zip(&b.values);
            a.origin == b.origin
                && a.unit == b.unit
                && a.values.len() == b.values.len()
                && pairs().all(|(a, b)| a.to_bits() == b.to_bits())
        };
        for group in self.groups {
            let clock = group.time.and_then(|time| group.signals.get(time));
            let shared = joined.iter_mut().find(|other| {
                let theirs = other.time.and_then(|time| other.signals.get(time));
                clock.zip(theirs).is_some_and(|(own, theirs)| same(own, theirs))
            });
            match shared {
                Some(other) => {
                    let own = group.signals.into_iter().enumerate().filter(|(at, _)| Some(*at) != group.time);
                    other.signals.extend(own.map(|(_, signal)| signal));
                }
                None => joined.push(group),
            }
        }
        self.groups = joined;
        self
    }

    /// Drops the signals that are not read; the clocks stay.
    pub(crate) fn keep(&mut self, wanted: &Wanted) {
        for group in &mut self.groups {
            let (name, clock) = (group.name.clone(), group.time.map(|time| group.signals[time].name.clone()));
            group.signals.retain(|one| Some(&one.name) == clock.as_ref() || wanted.takes(&name, &one.name));
            group.time = clock.and_then(|clock| group.signals.iter().position(|one| one.name == clock));
        }
    }

    /// Signals of a group have the same length, except in a damaged file.
    fn even_lengths(&mut self) {
        for group in &mut self.groups {
            let lengths = || group.signals.iter().map(|signal| signal.values.len());
            let (shortest, longest) = (lengths().min().unwrap_or(0), lengths().max().unwrap_or(0));
            if shortest < longest {
                group.signals.iter_mut().for_each(|signal| signal.values.truncate(shortest));
                let what = format!("a column has {shortest} values where another has {longest}");
                self.notes.push(Warning::Incomplete { what });
            }
        }
    }

    /// Gives every group and every signal of a group another name, and drops groups without signals.
    pub(crate) fn tidy(mut self) -> Self {
        for group in &mut self.groups {
            let mut taken = HashSet::new();
            for signal in &mut group.signals {
                let bare = signal.name.clone();
                let mut count = 1;
                while !taken.insert(signal.name.clone()) {
                    count += 1;
                    signal.name = format!("{bare} #{count}");
                }
            }
        }
        self.groups.retain(|group| !group.signals.is_empty());
        self.even_lengths();
        let mut taken = HashSet::new();
        for group in &mut self.groups {
            let bare = group.name.clone();
            let mut count = 1;
            while !taken.insert(group.name.clone()) {
                count += 1;
                group.name = format!("{bare} #{count}");
            }
        }
        self
    }
}

/// The result of a search by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Found<'s> {
    /// No signal has this name.
    None,
    /// Group, column and signal.
    One(usize, usize, &'s Signal),
    /// Number of signals of different groups that have this name.
    Several(usize),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_integers_keep_their_digits() {
        let stamps = [1_700_000_000_123_456_789_i64, 1_700_000_000_123_456_790];
        let signal = Signal::of_integers("t", None, stamps.iter().map(|t| Some(*t)));
        assert_eq!((signal.origin, signal.values.as_slice()), (stamps[0], [0.0, 1.0].as_slice()));
        let small = Signal::of_integers("n", None, [Some(3), None].into_iter());
        assert_eq!((small.origin, small.values[0], small.values[1].is_nan()), (0, 3.0, true));
    }

    #[test]
    fn a_name_in_two_groups_needs_its_group() {
        let group = |name: &str| Group {
            name: name.into(),
            signals: vec![Signal::new("speed", None, vec![1.0])],
            ..Group::default()
        };
        let source = Source { groups: vec![group("motor"), group("load")], ..Source::default() };
        assert_eq!(source.find("speed"), Found::Several(2));
        assert!(matches!(source.find("load/speed"), Found::One(1, 0, _)));
        assert_eq!(source.find("torque"), Found::None);
        assert_eq!(source.name_of(1, 0), "load/speed");
    }
}
