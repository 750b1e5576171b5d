//! Tables of older oscilloscopes of Tektronix (TDS, TPS): cells of the header stand beside the first rows, `name,value,,time,volts`.

use std::path::Path;

use super::cells::{Cell, cell, split};
use super::lines::Lines;
use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// Place of the times in a row; values follow.
const TIME: usize = 3;

/// Whether a text begins like such a table.
pub(crate) fn is_tektronix(head: &str) -> bool {
    let line = head.trim_start_matches('\u{feff}').lines().next().unwrap_or_default();
    separator(line).is_some_and(|separator| {
        let cells = split(line, separator);
        cells.get(TIME).is_some_and(|text| number(text, separator).is_some())
    })
}

/// What stands behind the first name.
fn separator(line: &str) -> Option<u8> {
    let behind = line.trim_start_matches('"').strip_prefix("Record Length")?.trim_start_matches('"');
    behind.bytes().next().filter(|separator| b",;\t".contains(separator))
}

fn number(text: &str, separator: u8) -> Option<f64> {
    match cell(text, separator != b',' && text.contains(','), None) {
        Cell::Number(number) => Some(number),
        _ => None,
    }
}

pub(crate) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let mut lines = Lines::sniffed(path)?;
    let mut separator = b',';
    let (mut name, mut unit, mut unit_of_time) = (None, None, None);
    let (mut time, mut value) = (Vec::new(), Vec::new());
    while time.len() < wanted.most_rows && lines.next()? {
        let line = lines.bare();
        if line.trim().is_empty() {
            continue;
        }
        if lines.line == 1 {
            separator = self::separator(line.trim_start_matches('\u{feff}')).unwrap_or(b',');
        }
        let cells = split(line, separator);
        let text = |at: usize| {
            cells.get(at).map(|text| text.trim().trim_matches('"').trim()).filter(|text| !text.is_empty())
        };
        if let (Some(key), Some(said)) = (text(0), text(1)) {
            let to = match key {
                "Source" => &mut name,
                "Vertical Units" => &mut unit,
                "Horizontal Units" => &mut unit_of_time,
                _ => &mut None,
            };
            *to = Some(said.to_owned());
        }
        let number = |at: usize| text(at).and_then(|text| self::number(text, separator));
        match (number(TIME), number(TIME + 1)) {
            (Some(at), Some(of)) => {
                time.push(at);
                value.push(of);
            }
            _ => {
                let problem = "holds no time and value in its fourth and fifth cell; correct it, or delete it and what follows";
                return Err(lines.problem(problem));
            }
        }
    }
    if time.is_empty() {
        return Err(ImportError::file(
            path,
            "is a table of an oscilloscope without a value; export it again",
        ));
    }
    let time = Signal::new("time", Some(unit_of_time.unwrap_or_else(|| "s".into())), time);
    let value = Signal::new(name.unwrap_or_else(|| "channel".into()), unit, value);
    let group = Group { signals: vec![time, value], time: Some(0), ..Group::default() };
    let mut source = Source { groups: vec![group], ..Source::default() };
    source.keep(wanted);
    Ok(source)
}
