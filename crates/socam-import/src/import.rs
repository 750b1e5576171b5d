//! Makes a recording of a file by a mapping.

use std::collections::HashSet;
use std::path::PathBuf;

use socam_recording::{Channel, Dataset, Selection, SettingsError, Warning};

use crate::align::{align, unwrap, usual};
use crate::error::{ImportError, Result};
use crate::formats::read;
use crate::mapping::{Between, ChannelMap, Clock, Mapping, Stamps, Time};
use crate::source::{Found, Source, Wanted};
use crate::times::{Times, median_step_s};

/// A recording made of a file.
#[derive(Debug)]
pub struct Imported {
    /// The recording; what was left out or changed is among its warnings.
    pub data: Dataset,
    /// When it began, ns since 1970; 0 where the file does not say.
    pub start_unix_ns: u64,
    /// What became of each channel.
    pub channels: Vec<Understood>,
}

/// What a signal was understood to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Understood {
    /// The column of the recording: name and unit of the channel.
    pub column: String,
    /// The signal in the file.
    pub signal: String,
    /// Its unit as written.
    pub unit: String,
    /// SI units in one of it.
    pub factor: f64,
    /// Number of values.
    pub values: usize,
    /// Samples per second.
    pub rate_hz: Option<f64>,
    /// Smallest and largest value, SI.
    pub range: Option<(f64, f64)>,
    /// What was done to it.
    pub note: String,
}

/// Makes a recording of a file, or of the selected part of it. Values are kept in memory: 16 bytes for each row and mapped signal.
///
/// # Errors
/// One sentence: where the file cannot be read, the mapping names what it does not hold, or times do not increase.
pub fn import(selection: &Selection, mapping: &Mapping) -> Result<Imported> {
    let path = &selection.path;
    let signals = mapping.channels.iter().map(|channel| channel.signal.clone());
    let times = mapping.clocks.iter().filter_map(|clock| match &clock.time {
        Time::Signal(name, _) => {
            Some(clock.group.as_ref().map_or(name.clone(), |group| format!("{group}/{name}")))
        }
        Time::Rate(_) => None,
    });
    let names: HashSet<String> = signals.chain(times).collect();
    let wanted = Wanted { signals: Some(names), ..Wanted::ALL };
    let source = read(path, mapping.text.as_ref(), mapping.date_format.as_deref(), &wanted)?;
    assemble(selection, mapping, source)
}

/// Makes a recording of what was read.
fn assemble(selection: &Selection, mapping: &Mapping, source: Source) -> Result<Imported> {
    let file = File { path: selection.path.clone(), mapping: mapping.file.clone(), source };
    let mut used: Vec<usize> = Vec::new();
    let mut found = Vec::new();
    for channel in &mapping.channels {
        let (group, column) = file.signal(channel)?;
        if !used.contains(&group) {
            used.push(group);
        }
        found.push((group, column));
    }
    let clocks = file.clocks(mapping, &used)?;
    let base = clocks.iter().position(Option::is_some).unwrap_or(0);
    let base = mapping
        .clocks
        .iter()
        .find_map(|clock| file.group(clock).ok())
        .filter(|g| used.contains(g))
        .unwrap_or(base);
    let (base_times, base_offset_s) =
        clocks[base].as_ref().ok_or_else(|| file.problem("holds no clock".into()))?;
    let rows_s = base_times.relative_to(base_times.epoch_ns, *base_offset_s);
    let mut notes = file.source.notes.clone();
    let mut imported = (Vec::new(), Vec::new(), Vec::new());
    for (channel, (group, column)) in mapping.channels.iter().zip(found) {
        let Some((times, offset_s)) = &clocks[group] else { continue };
        let mut values = file.values(channel, group, column, times);
        let mut remarks = convert(channel, &mut values);
        let times_s = times.relative_to(base_times.epoch_ns, *offset_s);
        let understood = Understood::of(channel, &values, &times_s);
        if group != base {
            let between = channel.between.unwrap_or_else(|| usual(&rows_s, &times_s));
            values = align(&rows_s, &times_s, &values, between);
            remarks.push(match between {
                Between::Linear => "interpolated from another clock".into(),
                Between::Hold => "held from another clock".into(),
                Between::Missing => "of another clock, put at the nearest rows".into(),
            });
        }
        imported.0.push(Channel::new(channel.name.clone(), channel.unit));
        imported.1.push(values);
        imported.2.push(Understood { note: remarks.join("; "), ..understood });
    }
    for (index, clock) in clocks.iter().enumerate() {
        let group = &file.source.groups[index].name;
        let place = if group.is_empty() { String::new() } else { format!("`{group}`: ") };
        notes.extend(
            clock
                .iter()
                .flat_map(|(times, _)| &times.notes)
                .map(|note| Warning::Note(format!("{place}{note}"))),
        );
    }
    let (channels, columns, understood) = imported;
    let data = Dataset::from_columns_within(selection, channels, rows_s, columns)?;
    let data = data.with_warnings(notes);
    Ok(Imported { data, start_unix_ns: base_times.start_unix_ns(), channels: understood })
}

/// A file's signals, with its path for errors.
struct File {
    path: PathBuf,
    /// The mapping's file.
    mapping: Option<PathBuf>,
    source: Source,
}

impl File {
    fn problem(&self, problem: String) -> ImportError {
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
    fn signal(&self, channel: &ChannelMap) -> Result<(usize, usize)> {
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
        let all = crate::formats::read(&self.path, None, None, &Wanted { signals: None, most_rows: 1 });
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
    fn group(&self, clock: &Clock) -> Result<usize> {
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
    fn clocks(&self, mapping: &Mapping, used: &[usize]) -> Result<Vec<Option<(Times, f64)>>> {
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
                    Times::of_signal(taken, column, *unit_s, clock.stamps)
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

    /// The clock that the file itself gives a group.
    fn own_clock(&self, group: usize) -> Result<Times> {
        let taken = &self.source.groups[group];
        let own = taken.time.and_then(|column| {
            let unit_s = taken.signals[column].unit.as_deref().and_then(crate::unit::seconds)?;
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
    fn values(&self, channel: &ChannelMap, group: usize, column: usize, times: &Times) -> Vec<f64> {
        let signal = &self.source.groups[group].signals[column];
        let all: Vec<f64> = signal.absolute().collect();
        let is_none = |value: f64| !value.is_finite() || channel.missing == Some(value);
        times.rows.iter().map(|row| if is_none(all[*row]) { f64::NAN } else { all[*row] }).collect()
    }
}

/// Values in the file's unit to SI. Returns remarks.
fn convert(channel: &ChannelMap, values: &mut [f64]) -> Vec<String> {
    let mut remarks = Vec::new();
    if let Some(range) = channel.wrap {
        let count = unwrap(values, range);
        remarks.push(format!("continued at {count} wraps"));
    }
    for value in values {
        *value = channel.factor * *value + channel.offset;
    }
    remarks
}

impl Understood {
    fn of(channel: &ChannelMap, values: &[f64], times_s: &[f64]) -> Self {
        let held = || values.iter().copied().filter(|value| !value.is_nan());
        let range = held().map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        Self {
            column: Channel::new(channel.name.clone(), channel.unit).column_name(),
            signal: channel.signal.clone(),
            unit: channel.unit_text.clone(),
            factor: channel.factor,
            values: held().count(),
            rate_hz: median_step_s(times_s).filter(|step| *step > 0.0).map(f64::recip),
            range,
            note: String::new(),
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
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect();
    let more = names.len().saturating_sub(SHOWN);
    match (shown.is_empty(), more) {
        (true, _) => "none".into(),
        (false, 0) => shown.join(", "),
        (false, more) => format!("{} and {more} more", shown.join(", ")),
    }
}
