//! Traces of PLCs (CODESYS, ctrlX): variables one below the other, each with its own times.

use std::path::Path;

use super::cells::{Cell, cell};
use super::lines::Lines;
use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// The name of a variable in a line `0.Variable; Main.rSpeed`.
fn variable(line: &str) -> Option<&str> {
    let (key, name) = line.split_once(';')?;
    let (number, word) = key.trim().split_once('.')?;
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    (is_number && word == "Variable").then_some(name.trim())
}

/// Whether a text is the beginning of such a trace.
pub(crate) fn is_trace(head: &str) -> bool {
    head.trim_start_matches('\u{feff}').starts_with("[key]")
        || head.lines().any(|line| variable(line).is_some())
}

/// Reads the variables, each with its own clock; those with the same times share one. The file states no unit.
pub(crate) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let mut lines = Lines::sniffed(path)?;
    let mut source = Source::default();
    let mut open: Option<(String, Vec<f64>, Vec<f64>)> = None;
    let group = |(name, times, values): (String, Vec<f64>, Vec<f64>)| Group {
        name: name.clone(),
        signals: vec![Signal::new("time", None, times), Signal::new(name, None, values)],
        time: Some(0),
        ..Group::default()
    };
    while lines.next()? {
        let line = lines.bare();
        if let Some(name) = variable(line) {
            let name = name.to_owned();
            source.groups.extend(open.replace((name, Vec::new(), Vec::new())).map(group));
            continue;
        }
        let Some(rest) = line.trim_start().strip_prefix(';') else { continue };
        let Some((_, times, values)) = &mut open else { continue };
        if times.len() >= wanted.most_rows {
            continue;
        }
        let cells: Vec<&str> = rest.split(';').map(str::trim).collect();
        // With decimal commas or points, whatever the file has.
        let number = |text: &str| match cell(text, text.contains(',') && !text.contains('.'), None) {
            Cell::Number(number) => Some(number),
            Cell::Missing => Some(f64::NAN),
            _ => None,
        };
        let read = match cells.as_slice() {
            [time, value, ..] => number(time).zip(number(value)),
            _ => None,
        };
        let Some((time, value)) = read else {
            return Err(
                lines.problem(format!("expected `; time; value`, found `{line}`; correct it, or delete it"))
            );
        };
        times.push(time);
        values.push(value);
    }
    source.groups.extend(open.map(group));
    source.groups.retain(|group| group.signals.iter().all(|signal| !signal.values.is_empty()));
    if source.groups.is_empty() {
        return Err(ImportError::file(path, "is a trace of a PLC without a value; record again"));
    }
    let mut source = source.with_shared_clocks().tidy();
    source.keep(wanted);
    Ok(source)
}
