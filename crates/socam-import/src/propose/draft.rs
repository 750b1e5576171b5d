//! Draft of a mapping from the first rows of a file.

use std::path::Path;

use socam_recording::Warning;
use socam_units::{Meaning, column, conversion, distinct_names, seconds};

use super::{Proposed, ProposedClock, ROWS, clocks, names};
use crate::error::{ImportError, Result};
use crate::formats::{Hints, read};
use crate::mapping::{ChannelMap, Clock, Mapping, Time};
use crate::source::{Source, Wanted};
use crate::time_names::is_time_like;

/// Draft of a mapping from the first rows of a file.
pub(super) struct Draft {
    pub(super) source: Source,
    pub(super) clocks: Vec<ProposedClock>,
    pub(super) channels: Vec<Proposed>,
    /// Notes on what was left out, and other remarks.
    pub(super) notes: Vec<Warning>,
}

impl Draft {
    pub(super) fn of(path: &Path, dbc: Option<&Path>) -> Result<Self> {
        let hints = Hints { dbc, ..Hints::default() };
        let source = read(path, hints, &Wanted { signals: None, most_rows: ROWS })?;
        let clocks = clocks::find(&source);
        let notes = source.notes.clone();
        let mut draft = Self { source, clocks, channels: Vec::new(), notes };
        draft.find_channels();
        if !draft.channels.iter().any(|channel| channel.conversion().is_some() || !channel.is_constant()) {
            let notes: Vec<String> = draft.notes.iter().map(ToString::to_string).collect();
            let notes = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join("; ")) };
            return Err(ImportError::file(path, format!("holds nothing but times and constants{notes}")));
        }
        Ok(draft)
    }

    /// Makes a channel of every signal, or adds a note that says why not.
    fn find_channels(&mut self) {
        let mut columns = Vec::new();
        for (index, group) in self.source.groups.iter().enumerate() {
            let clock = self.clocks.iter().find(|clock| clock.group == index);
            let time = clock.and_then(|clock| Some(clock.time.as_ref()?.0));
            let prefix = names::common_prefix(group);
            for (place, signal) in group.signals.iter().enumerate().filter(|(place, _)| Some(*place) != time)
            {
                let own = signal.name.get(prefix..).filter(|own| own.starts_with(char::is_alphabetic));
                let column = column(own.unwrap_or(&signal.name), signal.unit.as_deref());
                let full_name = self.source.name_of(index, place);
                if group.time == Some(place) || is_time_like(&column) {
                    // The times at which messages were logged and published belong to the log.
                    if !group.is_by_arrival {
                        self.notes.push(Warning::SecondTime { column: full_name });
                    }
                    continue;
                }
                self.notes.extend(Warning::of_doubt(&full_name, &column));
                let mut proposed = Proposed::of(signal, full_name, column.clone());
                if proposed.range.is_none() {
                    self.notes.push(Warning::EmptyColumn { column: proposed.signal });
                    continue;
                }
                proposed.rate_hz = clock.and_then(ProposedClock::rate_hz);
                proposed.is_own = clock.is_some_and(|clock| clock.is_own(&self.source));
                columns.push((column, group.name.as_str()));
                self.channels.push(proposed);
            }
        }
        for (channel, name) in self.channels.iter_mut().zip(distinct_names(&columns)) {
            channel.name = name;
        }
    }

    /// Unknown facts about clocks, and about the units of channels that vary.
    pub(super) fn unknown(&self) -> Vec<String> {
        let is_open = |channel: &&Proposed| channel.conversion().is_none() && !channel.is_constant();
        let units = self.channels.iter().filter(is_open);
        let units = units.map(|channel| format!("the unit of `{}`{}", channel.signal, channel.guess));
        units.chain(self.unknown_clocks()).collect()
    }

    /// Groups without times, in words.
    pub(super) fn unknown_clocks(&self) -> impl Iterator<Item = String> + '_ {
        self.clocks.iter().filter(|clock| clock.time.is_none()).map(|clock| {
            let group = &self.source.groups[clock.group].name;
            let place = if group.is_empty() { String::new() } else { format!(" of group `{group}`") };
            let why = clock.restarts.as_ref();
            let why = why.map(|why| {
                format!(" ({why}: write each part as a file of its own, or the rate in a mapping)")
            });
            format!("when the samples{place} were taken{}", why.unwrap_or_default())
        })
    }

    pub(super) fn assumed(&self) -> Vec<String> {
        self.clocks.iter().filter_map(|clock| clock.assumption(&self.source)).collect()
    }

    /// Leaves aside constants without a unit, and all columns without one of tables that are named by the rule of the own CSV.
    pub(super) fn leave_unstated_aside(&mut self) {
        for channel in std::mem::take(&mut self.channels) {
            let column = channel.signal.clone();
            match channel.range {
                _ if channel.conversion().is_some() => self.channels.push(channel),
                _ if channel.is_own => self.notes.push(Warning::ColumnWithoutUnit { column }),
                Some((low, high)) if low == high => self.notes.push(Warning::Note(format!(
                    "column `{column}` is {low} throughout, states no unit, and is left aside"
                ))),
                _ => self.channels.push(channel),
            }
        }
    }

    /// Takes the likeliest unit of each channel whose unit is not stated; one that no word of its name gives is left aside. Returns what was
    /// taken, in words.
    pub(super) fn take_guesses(&mut self) -> Vec<String> {
        let mut taken = self.assumed();
        for mut channel in std::mem::take(&mut self.channels) {
            if channel.conversion().is_none() {
                let unit = names::likeliest(&channel.column).filter(|_| !channel.is_constant());
                let Some((unit, conversion)) = unit.and_then(|unit| Some((unit, conversion(unit)?))) else {
                    self.notes.push(Warning::Note(format!(
                        "column `{}` states no unit, its name suggests none, and it is left aside",
                        channel.signal
                    )));
                    continue;
                };
                taken.push(format!("the unit of `{}`, taken for {unit} by its name", channel.signal));
                channel.unit = Some(unit.to_owned());
                channel.column.meaning = Meaning::Values(conversion);
            }
            self.channels.push(channel);
        }
        taken
    }

    /// Says which single letters were read as units, in tables that are not named by the rule of the own CSV.
    pub(super) fn say_letters(&mut self) {
        let letters = self.channels.iter().filter(|channel| channel.column.is_letter && !channel.is_own);
        let letters: Vec<String> = letters
            .filter_map(|channel| Some(format!("`{}` in {}", channel.signal, channel.conversion()?.unit)))
            .collect();
        if !letters.is_empty() {
            let read = letters.join(", ");
            self.notes.push(Warning::Note(format!(
                "read by the last letter of its name: {read}; where that is an index and no unit, import it with a mapping"
            )));
        }
    }

    /// Mapping of all facts that are known.
    pub(super) fn mapping(&self) -> Mapping {
        let clock = |clock: &ProposedClock| {
            let group = &self.source.groups[clock.group];
            let (column, unit) = clock.time.as_ref()?;
            Some(Clock {
                group: Some(group.name.clone()),
                time: Time::Signal(group.signals[*column].name.clone(), Some(seconds(unit)?)),
                offset_s: 0.0,
                stamps: clock.stamps,
                line: 0,
            })
        };
        let channel = |proposed: &Proposed| {
            let conversion = proposed.conversion()?;
            Some(ChannelMap {
                name: proposed.name.clone(),
                signal: proposed.signal.clone(),
                unit: conversion.unit,
                unit_text: proposed.unit.clone().unwrap_or_default(),
                factor: conversion.factor,
                offset: conversion.offset,
                wrap: None,
                missing: None,
                between: None,
                line: 0,
            })
        };
        Mapping {
            file: None,
            text: self.source.text.clone(),
            date_format: None,
            dbc: self.source.dbc.clone(),
            clocks: self.clocks.iter().filter_map(clock).collect(),
            channels: self.channels.iter().filter_map(channel).collect(),
        }
    }
}
