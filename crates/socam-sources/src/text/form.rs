//! The forms of a line.

use std::borrow::Cow;

use serde_json::Value as Json;
use socam_import::parts::{content, record};
use socam_recording::Fields;

use super::frames::{Layout, read_layout};
use super::value::Value;

/// Form of the lines of a device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Form {
    /// Numbers in columns.
    Csv {
        /// Byte between cells; a blank means any number of blanks and tabulators.
        separator: u8,
        /// Whether numbers have a decimal comma.
        decimal_comma: bool,
        /// Names of all columns.
        names: Vec<String>,
    },
    /// Pairs of a name and a number: `speed:1.5,torque:0.2`, `speed=1.5 torque=0.2`, or one pair a line.
    Pairs,
    /// A JSON record; members of members are named `a.b`.
    Json,
    /// No line, but a frame of bytes.
    Frames(Layout),
    /// No line, but messages of the topics of a Foxglove WebSocket server.
    Topics,
}

/// Content of a line.
#[derive(Debug, PartialEq)]
pub(super) enum Line<'l> {
    Values(Vec<(Cow<'l, str>, Value)>),
    /// The names of the columns once more.
    Header,
    /// Text without a number.
    Talk,
}

const SEPARATORS: [(&str, u8); 5] = [(",", b','), (";", b';'), ("tab", b'\t'), ("|", b'|'), ("space", b' ')];

/// Reads the table `[lines]` of a description.
pub(crate) fn read_form(fields: &mut Fields<'_>) -> Form {
    match fields.choice("form", &[("csv", 0), ("pairs", 1), ("json", 2), ("frames", 3), ("foxglove", 4)]) {
        1 => Form::Pairs,
        2 => Form::Json,
        3 => Form::Frames(read_layout(fields)),
        4 => Form::Topics,
        _ => {
            let separator = fields.maybe_choice("separator", &SEPARATORS).unwrap_or(b',');
            let decimal_comma = fields.maybe_choice("decimal", &[(".", false), (",", true)]).unwrap_or(false);
            let names = fields.maybe_texts("names").unwrap_or_default();
            if names.is_empty() {
                fields.complain("`names` is missing; expected the names of all columns".into());
            }
            if decimal_comma && separator == b',' {
                fields.complain_about(
                    "decimal",
                    "a comma cannot stand between cells and within numbers".into(),
                );
            }
            Form::Csv { separator, decimal_comma, names }
        }
    }
}

/// Name of a separator in a description.
pub(super) fn separator_name(separator: u8) -> &'static str {
    SEPARATORS.iter().find(|(_, byte)| *byte == separator).map_or(",", |(name, _)| name)
}

impl Form {
    /// The form in words.
    #[must_use]
    pub fn words(&self) -> &'static str {
        match self {
            Self::Csv { .. } => "lines of numbers in columns",
            Self::Pairs => "lines of names and numbers",
            Self::Json => "lines of JSON",
            Self::Frames(_) => "frames of bytes",
            Self::Topics => "messages of topics",
        }
    }

    /// The values of a line, or why it cannot be trusted.
    pub(super) fn read<'l>(&'l self, line: &'l str) -> Result<Line<'l>, &'static str> {
        match self {
            Self::Csv { separator, decimal_comma, names } => columns(line, *separator, *decimal_comma, names),
            Self::Pairs => pairs(line),
            Self::Json => json(line),
            Self::Frames(_) => Err("a line stands in the place of a frame"),
            Self::Topics => Err("a line stands in the place of a message"),
        }
    }
}

fn columns<'l>(
    line: &'l str,
    separator: u8,
    decimal_comma: bool,
    names: &'l [String],
) -> Result<Line<'l>, &'static str> {
    let mut cells = cells(line, separator);
    if cells.len() == names.len() + 1 && cells.last().is_some_and(|cell| cell.trim().is_empty()) {
        cells.pop();
    }
    let values: Vec<Value> = cells.iter().map(|cell| content(cell, decimal_comma).into()).collect();
    if !values.iter().any(|value| matches!(value, Value::Number(_))) {
        let is_header = cells.len() == names.len() && cells.iter().zip(names).all(|(a, b)| a.trim() == b);
        let is_missing = cells.len() == names.len() && values.iter().all(|value| *value == Value::Missing);
        if is_missing {
            return Ok(Line::Values(named(names, values)));
        }
        return Ok(if is_header { Line::Header } else { Line::Talk });
    }
    if values.len() != names.len() {
        return Err("a line has another number of columns");
    }
    Ok(Line::Values(named(names, values)))
}

fn named(names: &[String], values: Vec<Value>) -> Vec<(Cow<'_, str>, Value)> {
    names.iter().map(|name| Cow::Borrowed(name.as_str())).zip(values).collect()
}

/// Cells of a line. A blank stands for any number of blanks and tabulators.
pub(super) fn cells(line: &str, separator: u8) -> Vec<&str> {
    if separator == b' ' {
        line.split_whitespace().collect()
    } else {
        line.split(char::from(separator)).collect()
    }
}

fn pairs(line: &str) -> Result<Line<'_>, &'static str> {
    // Teleplot puts a mark before its lines.
    let line = line.trim().trim_start_matches('>');
    let mut values = Vec::new();
    for pair in split_pairs(line) {
        let Some((name, value)) = pair.split_once([':', '=']) else {
            return if values.is_empty() { Ok(Line::Talk) } else { Err("a name has no value") };
        };
        let value: Value = content(value, false).into();
        if values.is_empty() && value == Value::Text {
            return Ok(Line::Talk);
        }
        values.push((Cow::Borrowed(name.trim()), value));
    }
    if values.iter().enumerate().any(|(at, (name, _))| values[..at].iter().any(|(other, _)| other == name)) {
        return Err("a name stands twice in a line");
    }
    Ok(if values.is_empty() { Line::Talk } else { Line::Values(values) })
}

/// Pairs between commas, semicolons or tabulators; if there are none, between blanks, where a blank behind a colon separates nothing.
pub(super) fn split_pairs(line: &str) -> Vec<&str> {
    const MARKS: [char; 4] = [',', ';', '\t', '|'];
    let is_filled = |part: &&str| !part.trim().is_empty();
    if line.contains(MARKS) || line.matches([':', '=']).count() < 2 {
        return line.split(MARKS).filter(is_filled).map(str::trim).collect();
    }
    let mut pairs = Vec::new();
    let mut start = 0;
    let mut has_value = false;
    for (at, c) in line.char_indices() {
        match c {
            ' ' if has_value => {
                pairs.push(line[start..at].trim());
                (start, has_value) = (at, false);
            }
            ' ' => {}
            _ => {
                let before = line[start..at].trim_end();
                has_value = before.contains([':', '=']);
            }
        }
    }
    pairs.push(line[start..].trim());
    pairs.retain(|part| !part.is_empty());
    pairs
}

/// The values of a JSON record with their names, which are made up.
pub(super) fn json_values(line: &str) -> Result<Vec<(String, Value)>, &'static str> {
    let members = match serde_json::from_str::<Json>(line) {
        Ok(Json::Object(members)) => members,
        Ok(_) => return Err("a line is JSON, but no record"),
        Err(_) => return Err("a line is no whole JSON record"),
    };
    let mut values = Vec::new();
    record(&members, &mut |name, content| values.push((name, content.into())));
    Ok(values)
}

fn json(line: &str) -> Result<Line<'_>, &'static str> {
    if !line.trim_start().starts_with('{') {
        return Ok(Line::Talk);
    }
    let values = json_values(line)?.into_iter().map(|(name, value)| (Cow::Owned(name), value));
    Ok(Line::Values(values.collect()))
}
