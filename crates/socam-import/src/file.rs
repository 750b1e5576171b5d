//! A file's signals, clocks and values as a mapping names them.

use std::path::PathBuf;

use socam_recording::SettingsError;

use crate::error::{ImportError, Result, few};
use crate::formats::Hints;
use crate::mapping::{ChannelMap, Clock, Mapping, Stamps, Time};
use crate::source::{DATE_UNIT_S, Found, Signal, Source, Wanted};
use crate::times::Times;

/// A file's signals, with its path for errors.
pub(crate) struct File {
    pub(crate) path: PathBuf,
    /// The mapping's file.
    pub(crate) mapping: Option<PathBuf>,
    /// The DBC by which it was read.
    pub(crate) dbc: Option<PathBuf>,
    pub(crate) source: Source,
}

impl File {
    pub(crate) fn problem(&self, problem: String) -> ImportError {
        ImportError::file(&self.path, problem)
    }

    /// An error of the mapping where it has a file, else of the recording.
    fn at(&self, line: usize, message: String) -> ImportError {
        match &self.mapping {
            Some(mapping) if line > 0 => SettingsError::at(line, message).in_file(mapping).into(),
            _ => self.problem(message),
        }
    }

    /// Group and column of a channel's signal.
    pub(crate) fn signal(&self, channel: &ChannelMap) -> Result<(usize, usize)> {
        match self.source.find(&channel.signal) {
            Found::One(group, column, _) => Ok((group, column)),
            Found::Several(count) => Err(self.at(
                channel.line,
                format!(
                    "`{}` holds {count} signals named `{}`; write the group before it: \"{}\"",
                    self.path.display(),
                    channel.signal,
                    self.examples(&channel.signal)
                ),
            )),
            Found::None => Err(self.at(channel.line, self.lacking(&channel.signal))),
        }
    }

    fn examples(&self, name: &str) -> String {
        let groups =
            self.source.groups.iter().filter(|group| group.signals.iter().any(|signal| signal.name == name));
        let names: Vec<String> = groups.take(3).map(|group| format!("{}/{name}", group.name)).collect();
        names.join("\" or \"")
    }

    /// A sentence about a signal that is not there.
    fn lacking(&self, name: &str) -> String {
        let all = crate::formats::read(
            &self.path,
            Hints { dbc: self.dbc.as_deref(), ..Hints::default() },
            &Wanted { signals: None, most_rows: 1 },
        );
        let names: Vec<String> = all.map_or_else(
            |_| Vec::new(),
            |all| {
                all.groups
                    .iter()
                    .enumerate()
                    .flat_map(|(g, group)| (0..group.signals.len()).map(move |c| (g, c)))
                    .map(|(g, c)| all.name_of(g, c))
                    .collect()
            },
        );
        let near = names.iter().max_by(|a, b| likeness(a, name).total_cmp(&likeness(b, name)));
        let hint = match near.filter(|near| likeness(near, name) > 0.5) {
            Some(near) => format!("; is it `{near}`?"),
            None => format!("; it holds {}", listed(&names)),
        };
        format!("`{}` holds no signal `{name}` of numbers{hint}", self.path.display())
    }

    /// The group of a clock.
    pub(crate) fn group(&self, clock: &Clock) -> Result<usize> {
        let groups = &self.source.groups;
        let names = || groups.iter().map(|group| group.name.clone()).collect::<Vec<_>>();
        match (&clock.group, &clock.time) {
            (Some(name), _) => groups.iter().position(|group| group.name == *name).ok_or_else(|| {
                let message = format!(
                    "`{}` holds no group `{name}` that is used; it holds {}",
                    self.path.display(),
                    listed(&names())
                );
                self.at(clock.line, message)
            }),
            (None, _) if groups.len() == 1 => Ok(0),
            (None, Time::Signal(name, _)) => match self.source.find(name) {
                Found::One(group, ..) => Ok(group),
                Found::None => Err(self.at(clock.line, self.lacking(name))),
                Found::Several(_) => Err(self.at(
                    clock.line,
                    format!("`group` is left out, and `{name}` is in several: {}", listed(&names())),
                )),
            },
            (None, Time::Rate(_)) => Err(self
                .at(clock.line, format!("`group` is left out, and there are several: {}", listed(&names())))),
        }
    }

    /// Times of each used group, and what is added to them.
    pub(crate) fn clocks(&self, mapping: &Mapping, used: &[usize]) -> Result<Vec<Option<(Times, f64)>>> {
        let mut clocks: Vec<Option<(Times, f64)>> = vec![None; self.source.groups.len()];
        for clock in &mapping.clocks {
            let group = self.group(clock)?;
            if clocks[group].is_some() {
                return Err(self.at(clock.line, "this group has a clock already; leave one out".into()));
            }
            let taken = &self.source.groups[group];
            let times = match &clock.time {
                Time::Rate(rate_hz) => {
                    Times::of_rate(taken.signals.first().map_or(0, |s| s.values.len()), *rate_hz)
                }
                Time::Signal(name, unit_s) => {
                    let column = taken.signals.iter().position(|signal| signal.name == *name);
                    let column = column.ok_or_else(|| self.at(clock.line, self.lacking(name)))?;
                    let unit_s = self.unit_of(clock, &taken.signals[column], *unit_s)?;
                    Times::of_signal(taken, column, unit_s, clock.stamps)
                        .map_err(|problem| self.problem(format!("cannot be imported: {problem}")))?
                }
            };
            clocks[group] = Some((times, clock.offset_s));
        }
        for group in used {
            if clocks[*group].is_none() {
                clocks[*group] = Some((self.own_clock(*group)?, 0.0));
            }
        }
        Ok(clocks)
    }

    /// The unit of a clock's times, s: the mapping's, or that of dates, which have one of their own.
    fn unit_of(&self, clock: &Clock, times: &Signal, stated: Option<f64>) -> Result<f64> {
        let name = &times.name;
        let wrong = match stated {
            Some(unit_s) if !times.is_date || unit_s == DATE_UNIT_S => return Ok(unit_s),
            None if times.is_date => return Ok(DATE_UNIT_S),
            Some(_) => format!("`{name}` holds dates or times of day, which have no unit; leave `unit` out"),
            None => "`unit` of the clock is left out; expected s, ms, us, ns, min or h".to_owned(),
        };
        Err(self.at(clock.line, wrong))
    }

    /// The clock that the file itself gives a group.
    fn own_clock(&self, group: usize) -> Result<Times> {
        let taken = &self.source.groups[group];
        let own = taken.time.and_then(|column| {
            let unit_s = taken.signals[column].unit.as_deref().and_then(socam_units::seconds)?;
            Some((column, unit_s))
        });
        let Some((column, unit_s)) = own else {
            let place =
                if taken.name.is_empty() { String::new() } else { format!(" of group `{}`", taken.name) };
            let message = format!(
                "does not say when the samples{place} were taken; add [[clocks]] with `time` or `rate_Hz` to the mapping"
            );
            return Err(self.problem(message));
        };
        Times::of_signal(taken, column, unit_s, Stamps::Exact)
            .map_err(|problem| self.problem(format!("cannot be imported: {problem}")))
    }

    /// A signal's values at the rows that have a time.
    pub(crate) fn values(&self, channel: &ChannelMap, place: (usize, usize), times: &Times) -> Vec<f64> {
        let signal = &self.source.groups[place.0].signals[place.1];
        let value = |row: &usize| {
            let value = signal.values[*row] + signal.origin as f64;
            if !value.is_finite() || channel.missing == Some(value) { f64::NAN } else { value }
        };
        times.rows.iter().map(value).collect()
    }

    /// Drops the values of all other signals, which need memory.
    pub(crate) fn keep_values(&mut self, places: &[(usize, usize)]) {
        for (group, taken) in self.source.groups.iter_mut().enumerate() {
            for (column, signal) in taken.signals.iter_mut().enumerate() {
                if !places.contains(&(group, column)) {
                    signal.values = Vec::new();
                }
            }
        }
    }
}

/// Share of pairs of letters that two names have in common.
fn likeness(a: &str, b: &str) -> f64 {
    let pairs = |text: &str| {
        let letters: Vec<char> = text.to_lowercase().chars().collect();
        letters.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>()
    };
    let (a, mut b) = (pairs(a), pairs(b));
    let total = (a.len() + b.len()) as f64;
    let mut common = 0;
    for pair in a {
        if let Some(at) = b.iter().position(|other| *other == pair) {
            b.swap_remove(at);
            common += 1;
        }
    }
    if total > 0.0 { 2.0 * f64::from(common) / total } else { 0.0 }
}

/// The first names of many.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 12;
    if names.is_empty() { "none".into() } else { few(names, SHOWN, |name| format!("`{name}`")) }
}
