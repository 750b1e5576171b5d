//! Makes a recording of a file by a mapping.

use std::collections::HashSet;

use socam_recording::clocks::{Between, at_rows, median_step_s, usual};
use socam_recording::{Channel, Dataset, Epoch, Selection, Warning};

use crate::counts::unwrap;
use crate::error::{ImportError, Result};
use crate::file::File;
use crate::formats::{Hints, read};
use crate::mapping::{ChannelMap, Mapping, Time};
use crate::source::{Source, Wanted};

/// A recording made of a file.
#[derive(Debug)]
pub struct Imported {
    /// The recording; what was left out or changed is among its warnings.
    pub data: Dataset,
    /// Interpretation of each channel.
    pub channels: Vec<Understood>,
}

/// Interpretation of a signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Understood {
    /// The column of the recording: name and unit of the channel.
    pub column: String,
    /// The signal in the file.
    pub signal: String,
    /// Unit as written in the file.
    pub unit: String,
    /// SI units in one of it.
    pub factor: f64,
    /// Number of values.
    pub values: usize,
    /// Samples per second.
    pub rate_hz: Option<f64>,
    /// Smallest and largest value, SI.
    pub range: Option<(f64, f64)>,
    /// Note on the processing of the signal.
    pub note: String,
}

/// Makes a recording of a file, or of the selected part of it. Values are kept in memory: 16 bytes for each row and mapped signal.
///
/// # Errors
/// One sentence: where the file cannot be read, the mapping names what it does not hold, or times do not increase.
pub fn import(selection: &Selection, mapping: &Mapping) -> Result<Imported> {
    import_noted(selection, mapping, Vec::new())
}

/// Imports files as [`import`] does, and adds notes on the signals that the mapping leaves out.
pub(crate) fn import_noted(
    selection: &Selection,
    mapping: &Mapping,
    notes: Vec<Warning>,
) -> Result<Imported> {
    each(selection, |part| import_file(part, mapping, notes.clone()))
}

/// What a selection names, of files that are imported one by one.
pub(crate) fn each(
    selection: &Selection,
    import: impl Fn(&Selection) -> Result<Imported>,
) -> Result<Imported> {
    let mut channels = Vec::new();
    let data = Dataset::open_by(selection, |part| {
        let imported = import(part)?;
        Understood::join(&mut channels, imported.channels);
        Ok::<_, ImportError>(imported.data)
    })?;
    Ok(Imported { data, channels })
}

fn import_file(selection: &Selection, mapping: &Mapping, mut notes: Vec<Warning>) -> Result<Imported> {
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
    let hints = Hints {
        layout: mapping.text.as_ref(),
        date: mapping.date_format.as_deref(),
        dbc: mapping.dbc.as_deref(),
    };
    let source = read(path, hints, &wanted)?;
    let new: Vec<Warning> = source.notes.iter().filter(|note| !notes.contains(note)).cloned().collect();
    notes.extend(new);
    assemble(selection, mapping, source, notes)
}

/// Makes a recording of what was read.
fn assemble(
    selection: &Selection,
    mapping: &Mapping,
    source: Source,
    mut notes: Vec<Warning>,
) -> Result<Imported> {
    let mut file = File {
        path: selection.path.clone(),
        mapping: mapping.file.clone(),
        dbc: mapping.dbc.clone(),
        source,
    };
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
    file.keep_values(&found);
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
    let mut imported = (Vec::new(), Vec::new(), Vec::new());
    for (index, (channel, place)) in mapping.channels.iter().zip(&found).enumerate() {
        let group = place.0;
        let Some((times, offset_s)) = &clocks[group] else { continue };
        let mut values = file.values(channel, *place, times);
        file.keep_values(&found[index + 1..]);
        let mut remarks = convert(channel, &mut values);
        let times_s = times.relative_to(base_times.epoch_ns, *offset_s);
        let understood = Understood::of(channel, &values, &times_s);
        if group != base {
            let between = channel.between.unwrap_or_else(|| usual(&rows_s, &times_s));
            values = at_rows(&rows_s, &times_s, &values, between);
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
    let epoch = base_times.epoch().or(file.source.start_unix_ns.map(Epoch::Date));
    let data = data.with_warnings(notes).with_epoch(epoch);
    Ok(Imported { data, channels: understood })
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
    /// Adds what became of the signals of the next file.
    pub(crate) fn join(all: &mut Vec<Self>, next: Vec<Self>) {
        for own in next {
            let Some(known) = all.iter_mut().find(|known| known.column == own.column) else {
                all.push(own);
                continue;
            };
            known.values += own.values;
            known.range = match (known.range, own.range) {
                (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
                (a, b) => a.or(b),
            };
        }
    }

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
