//! Exports of TwinCAT's Scope View: a column of times before each variable, and lines of properties above.

use std::path::Path;

use super::cells::{Cell, cell, split};
use super::lines::Lines;
use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// The separator of the line of names, `Name⇥SPEED⇥Name⇥TORQUE`, if this is one.
fn separator(line: &str) -> Option<u8> {
    [b'\t', b';', b','].into_iter().find(|separator| {
        let cells = split(line, *separator);
        cells.len() >= 4 && cells.iter().step_by(2).take(cells.len() / 2).all(|text| text.trim() == "Name")
    })
}

/// Whether a text is the beginning of such an export: a line of names and one of `SampleTime[ms]`.
pub(crate) fn is_scope(head: &str) -> bool {
    head.contains("SampleTime[ms]") && names(head).is_some()
}

/// The line of names, from 1, and its separator.
fn names(head: &str) -> Option<(usize, u8)> {
    let lines: Vec<&str> = head.lines().collect();
    let at = lines.iter().position(|line| line.trim_start().starts_with("SampleTime[ms]"))?;
    (0..at)
        .rev()
        .find_map(|index| Some((index + 1, separator(lines[index]).or_else(|| single(lines[index]))?)))
}

/// The separator of a line of one name.
fn single(line: &str) -> Option<u8> {
    let separator =
        [b'\t', b';', b','].into_iter().find(|one| line.starts_with(&format!("Name{}", char::from(*one))))?;
    Some(separator)
}

/// Reads the variables, each with its own clock in ms; those with the same times share one.
pub(crate) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let mut lines = Lines::sniffed(path)?;
    let mut head = String::new();
    while head.len() < 1 << 16 && lines.next()? {
        head.push_str(&lines.text);
    }
    let Some((line, separator)) = names(&head) else {
        return Err(ImportError::file(path, "has no line of names above `SampleTime[ms]`"));
    };
    let mut lines = Lines::sniffed(path)?;
    let mut columns: Vec<(Signal, Signal)> = Vec::new();
    let mut rows = 0;
    let mut decimal_comma = None;
    while rows < wanted.most_rows && lines.next()? {
        let text = lines.bare();
        if lines.line < line || text.trim().is_empty() {
            continue;
        }
        let cells: Vec<&str> = split(text, separator).into_iter().map(str::trim).collect();
        let of_variables = || cells.chunks(2).filter_map(|pair| pair.get(1).copied());
        if lines.line == line {
            let begin = |name: &str| {
                (Signal::new("time", Some("ms".into()), Vec::new()), Signal::new(name, None, Vec::new()))
            };
            columns = of_variables().filter(|name| !name.is_empty()).map(begin).collect();
            continue;
        }
        let starts_with_number = matches!(cell(cells[0], cells[0].contains(','), None), Cell::Number(_));
        if !starts_with_number && rows == 0 {
            if cells[0] == "Unit" {
                for ((_, signal), unit) in columns.iter_mut().zip(of_variables()) {
                    signal.unit = Some(unit.to_owned()).filter(|unit| !unit.is_empty() && unit != "(None)");
                }
            }
            continue;
        }
        let comma = *decimal_comma
            .get_or_insert_with(|| separator != b',' && cells.iter().any(|text| text.contains(',')));
        for (index, (time, signal)) in columns.iter_mut().enumerate() {
            let number = |at: usize| match cell(cells.get(at).copied().unwrap_or(""), comma, None) {
                Cell::Number(number) => Ok(number),
                Cell::Missing => Ok(f64::NAN),
                _ => Err(at),
            };
            match (number(2 * index), number(2 * index + 1)) {
                (Ok(at), Ok(value)) => {
                    time.values.push(at);
                    signal.values.push(value);
                }
                (Err(at), _) | (_, Err(at)) => {
                    let problem = format!(
                        "`{}` of `{}` is no number; correct it, or delete the line",
                        cells[at], signal.name
                    );
                    return Err(lines.problem(problem));
                }
            }
        }
        rows += 1;
    }
    if rows == 0 {
        return Err(ImportError::file(path, "is an export of a scope without a value; export it again"));
    }
    let group = |(time, signal): (Signal, Signal)| Group {
        name: signal.name.clone(),
        signals: vec![time, signal],
        time: Some(0),
        ..Group::default()
    };
    let mut source = Source { groups: columns.into_iter().map(group).collect(), ..Source::default() }
        .with_shared_clocks()
        .tidy();
    source.keep(wanted);
    Ok(source)
}
