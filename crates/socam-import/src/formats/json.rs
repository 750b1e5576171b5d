//! JSON: records, columns, tables of rows, lines of records, and logs of WPILib's SysId.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use socam_recording::Warning;

use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// Parts between which a row of a table is no longer a row, such as lists in a record.
const LIST: &str = "holds a list in a record, which is left aside";

/// The tests of a log of SysId, in the order in which they are made.
const TESTS: [&str; 8] = [
    "slow-forward",
    "slow-backward",
    "fast-forward",
    "fast-backward",
    "quasistatic-forward",
    "quasistatic-reverse",
    "dynamic-forward",
    "dynamic-reverse",
];

/// Whether a text begins like JSON.
pub(crate) fn is_json(head: &str) -> bool {
    let start = head.trim_start_matches('\u{feff}').trim_start();
    let Some(rest) = start.strip_prefix(['{', '[']) else { return false };
    rest.trim_start()
        .starts_with(['"', '{', '[', '}', ']', '-', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9', 'n'])
}

/// Reads all tables of a file: a group for each.
pub(crate) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    let mut values = serde_json::Deserializer::from_reader(BufReader::new(file));
    let damaged = |error: serde_json::Error| {
        let problem = format!("is no JSON from here on ({error}); copy it again from its source");
        ImportError::line(path, error.line(), problem)
    };
    let first = First { most_rows: wanted.most_rows }.deserialize(&mut values).map_err(damaged)?;
    let mut values = values.into_iter::<Value>();
    let mut source = Source::default();
    match (first, values.next().transpose().map_err(damaged)?) {
        // Records, one below the other.
        (first, Some(second)) => {
            let mut records = Records::default();
            match &first {
                Read::Value(first) => records.push(first),
                Read::Records(_) => records.rows = 1,
            }
            for value in std::iter::once(Ok(second)).chain(values) {
                if records.rows >= wanted.most_rows {
                    break;
                }
                records.push(&value.map_err(damaged)?);
            }
            records.finish("", &mut source);
        }
        (Read::Records(records), None) => records.finish("", &mut source),
        (Read::Value(first), None) => match sys_id(&first) {
            Some(found) => source = found.map_err(|problem| ImportError::file(path, problem))?,
            None => tables("", &first, wanted.most_rows, &mut source),
        },
    }
    if source.groups.is_empty() {
        let problem = "is JSON without a table: expected a list of records, lists of equal length by name, or `columns` and `data`";
        return Err(ImportError::file(path, problem));
    }
    let mut source = source.tidy();
    source.keep(wanted);
    Ok(source)
}

/// The first value of a file.
enum Read {
    Value(Value),
    /// A list of records, none of which is kept as it was written: values of JSON take many times the memory of their numbers.
    Records(Records),
}

/// Reads the first value, and records in a list one by one.
struct First {
    most_rows: usize,
}

impl<'de> DeserializeSeed<'de> for First {
    type Value = Read;

    fn deserialize<D: Deserializer<'de>>(self, file: D) -> Result<Read, D::Error> {
        file.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for First {
    type Value = Read;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a list or an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<Read, A::Error> {
        Value::deserialize(MapAccessDeserializer::new(members)).map(Read::Value)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Read, A::Error> {
        let mut before: Vec<Value> = Vec::new();
        while let Some(item) = items.next_element::<Value>()? {
            let is_record = item.is_object();
            before.push(item);
            if is_record {
                return self.records(before, items).map(Read::Records);
            }
        }
        Ok(Read::Value(Value::Array(before)))
    }
}

impl First {
    /// Records of a list: the first ones, and those that are still to be read.
    fn records<'de, A: SeqAccess<'de>>(self, first: Vec<Value>, mut items: A) -> Result<Records, A::Error> {
        let mut records = Records::default();
        first.iter().take(self.most_rows).for_each(|record| records.push(record));
        while records.rows < self.most_rows {
            match items.next_element::<Value>()? {
                Some(record) => records.push(&record),
                None => return Ok(records),
            }
        }
        while items.next_element::<IgnoredAny>()?.is_some() {}
        Ok(records)
    }
}

/// Finds the tables in a value.
fn tables(place: &str, value: &Value, most_rows: usize, source: &mut Source) {
    let below = |key: &str| if place.is_empty() { key.to_owned() } else { format!("{place}/{key}") };
    match value {
        Value::Array(rows) if rows.iter().any(Value::is_object) => {
            let mut records = Records::default();
            rows.iter().take(most_rows).for_each(|row| records.push(row));
            records.finish(place, source);
        }
        Value::Array(rows) if is_matrix(rows) => matrix(place, &[], rows, most_rows, source),
        Value::Object(members) => {
            if let (Some(Value::Array(names)), Some(Value::Array(rows))) =
                (members.get("columns"), members.get("data"))
                && is_matrix(rows)
            {
                let names: Vec<&str> = names.iter().filter_map(Value::as_str).collect();
                return matrix(place, &names, rows, most_rows, source);
            }
            columns(place, members, most_rows, source);
            let others = members.iter().filter(|(_, member)| column(member, most_rows).is_none());
            others.for_each(|(key, member)| tables(&below(key), member, most_rows, source));
        }
        _ => {}
    }
}

/// Lists of values by name, those of equal length as one table.
fn columns(place: &str, members: &Map<String, Value>, most_rows: usize, source: &mut Source) {
    let mut by_length: BTreeMap<usize, Vec<Signal>> = BTreeMap::new();
    for (name, member) in members {
        if let Some(values) = column(member, most_rows) {
            by_length.entry(values.len()).or_default().push(signal(name.clone(), values));
        }
    }
    let longest_first = by_length.into_iter().rev();
    source.groups.extend(longest_first.map(|(_, signals)| Group {
        name: place.to_owned(),
        signals,
        ..Group::default()
    }));
}

/// A list of numbers, or one by row number as pandas writes it.
fn column(value: &Value, most_rows: usize) -> Option<Vec<Cell>> {
    let cells: Vec<Cell> = match value {
        Value::Array(items) if items.len() > 1 => items.iter().take(most_rows).map(Cell::of).collect(),
        Value::Object(items) if items.len() > 1 => {
            let rows: Option<BTreeMap<u64, Cell>> =
                items.iter().map(|(key, item)| Some((key.parse().ok()?, Cell::of(item)))).collect();
            rows?.into_values().take(most_rows).collect()
        }
        _ => return None,
    };
    let holds = |cell: &Cell| matches!(cell, Cell::Number(_) | Cell::Date(_));
    let has_other = cells.iter().any(|cell| matches!(cell, Cell::Other));
    (cells.iter().any(holds) && !has_other).then_some(cells)
}

fn is_matrix(rows: &[Value]) -> bool {
    let width = |row: &Value| row.as_array().map(Vec::len);
    let Some(Some(first)) = rows.first().map(width) else { return false };
    first > 1 && rows.iter().all(|row| width(row) == Some(first))
}

fn matrix(place: &str, names: &[&str], rows: &[Value], most_rows: usize, source: &mut Source) {
    let width = rows.first().and_then(Value::as_array).map_or(0, Vec::len);
    let cells =
        |at: usize| rows.iter().take(most_rows).map(move |row| row.get(at).map_or(Cell::Missing, Cell::of));
    let signals = (0..width).map(|at| {
        let name = names.get(at).map_or_else(|| format!("column {}", at + 1), |name| (*name).to_owned());
        signal(name, cells(at).collect())
    });
    source.groups.push(Group { name: place.to_owned(), signals: signals.collect(), ..Group::default() });
}

/// A value in a table.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cell {
    Number(f64),
    /// ns since 1970.
    Date(i64),
    Missing,
    Text,
    /// A list or an object.
    Other,
}

impl Cell {
    fn of(value: &Value) -> Self {
        match value {
            Value::Null => Self::Missing,
            Value::Bool(value) => Self::Number(f64::from(u8::from(*value))),
            Value::Number(number) => number.as_f64().map_or(Self::Missing, Self::Number),
            Value::String(text) => match crate::dates::nanoseconds(text, None) {
                Some(date) => Self::Date(date),
                None => text.trim().parse().map_or(Self::Text, Self::Number),
            },
            Value::Array(_) | Value::Object(_) => Self::Other,
        }
    }
}

fn signal(name: String, cells: Vec<Cell>) -> Signal {
    let date = |cell: &Cell| if let Cell::Date(date) = cell { Some(*date) } else { None };
    if cells.iter().any(|cell| date(cell).is_some()) {
        return Signal::of_dates(name, cells.iter().map(date));
    }
    let number = |cell: &Cell| if let Cell::Number(number) = cell { *number } else { f64::NAN };
    Signal::new(name, None, cells.iter().map(number).collect())
}

/// Calls `take` with each value of a record: `a.b` for members of members, `a.0` for numbers of short lists. Other lists are handed over whole.
pub(crate) fn flatten(place: &str, members: &Map<String, Value>, take: &mut dyn FnMut(String, &Value)) {
    for (key, member) in members {
        let name = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
        match member {
            Value::Object(inner) => flatten(&name, inner, take),
            Value::Array(items) if items.len() <= 8 && items.iter().all(Value::is_number) => {
                items.iter().enumerate().for_each(|(index, item)| take(format!("{name}.{index}"), item));
            }
            other => take(name, other),
        }
    }
}

/// Records while they are read.
#[derive(Default)]
struct Records {
    rows: usize,
    /// Names in the order of their first appearance, with the cells so far.
    columns: Vec<(String, Vec<Cell>)>,
    places: BTreeMap<String, usize>,
    lists: Vec<String>,
}

impl Records {
    fn push(&mut self, record: &Value) {
        if let Value::Object(members) = record {
            self.take("", members);
        }
        self.rows += 1;
    }

    fn take(&mut self, place: &str, members: &Map<String, Value>) {
        flatten(place, members, &mut |name, value| match value {
            Value::Array(_) => {
                if !self.lists.contains(&name) {
                    self.lists.push(name);
                }
            }
            other => self.put(name, Cell::of(other)),
        });
    }

    fn put(&mut self, name: String, cell: Cell) {
        let place = *self.places.entry(name.clone()).or_insert_with(|| {
            self.columns.push((name, Vec::new()));
            self.columns.len() - 1
        });
        let cells = &mut self.columns[place].1;
        cells.resize(self.rows, Cell::Missing);
        cells.push(cell);
    }

    fn finish(mut self, place: &str, source: &mut Source) {
        for name in &self.lists {
            source.notes.push(Warning::Note(format!("`{name}` {LIST}")));
        }
        let mut signals = Vec::new();
        for (name, mut cells) in std::mem::take(&mut self.columns) {
            cells.resize(self.rows, Cell::Missing);
            if cells.iter().any(|cell| matches!(cell, Cell::Number(_) | Cell::Date(_))) {
                let texts = cells.iter().filter(|cell| matches!(cell, Cell::Text)).count();
                if texts > 0 {
                    let problem = format!(
                        "column `{name}` holds text in {texts} of {} rows, which are missing",
                        cells.len()
                    );
                    source.notes.push(Warning::Note(problem));
                }
                signals.push(signal(name, cells));
            } else {
                source.notes.push(Warning::Note(format!("column `{name}` is text and is left aside")));
            }
        }
        source.groups.push(Group { name: place.to_owned(), signals, ..Group::default() });
    }
}

/// The tests of a log of SysId as one recording with gaps between them; `None` for other JSON.
fn sys_id(value: &Value) -> Option<Result<Source, String>> {
    let members = value.as_object()?;
    let tests: Vec<(&str, &Vec<Value>)> =
        TESTS.iter().filter_map(|test| Some((*test, members.get(*test)?.as_array()?))).collect();
    if tests.is_empty() || !(members.contains_key("test") || members.contains_key("sysid")) {
        return None;
    }
    let width = tests.iter().find_map(|(_, rows)| rows.first()?.as_array().map(Vec::len)).unwrap_or(0);
    let unit = match members.get("units").and_then(Value::as_str).unwrap_or("Rotations") {
        "Rotations" => "rot",
        "Degrees" => "deg",
        "Radians" => "rad",
        "Meters" => "m",
        "Feet" => "ft",
        "Inches" => "in",
        other => return Some(Err(format!("is a log of SysId in `{other}`, a unit that is not known here"))),
    };
    let names = match width {
        4 => ["voltage", "position", "velocity"].map(str::to_owned).to_vec(),
        9 => [
            "left_voltage",
            "right_voltage",
            "left_position",
            "right_position",
            "left_velocity",
            "right_velocity",
            "angle",
            "angular_rate",
        ]
        .map(str::to_owned)
        .to_vec(),
        other => {
            return Some(Err(format!(
                "is a log of SysId with {other} columns; expected 4, or 9 of a drivetrain"
            )));
        }
    };
    let unit_of = |name: &str| match name {
        "angle" => "rad".to_owned(),
        "angular_rate" => "rad/s".to_owned(),
        name if name.ends_with("voltage") => "V".to_owned(),
        name if name.ends_with("position") => unit.to_owned(),
        _ => format!("{unit}/s"),
    };
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut notes = Vec::new();
    for (test, of_test) in tests {
        let read = |row: &Value| -> Option<Vec<f64>> {
            let row = row.as_array().filter(|row| row.len() == width)?;
            row.iter().map(Value::as_f64).collect()
        };
        let Some(mut read) = of_test.iter().map(read).collect::<Option<Vec<_>>>() else {
            return Some(Err(format!(
                "holds a row in `{test}` that has not {width} numbers; copy it again from its source"
            )));
        };
        // Tests that count from zero each follow one another with a gap.
        let (last, first) = (rows.last().map(|row| row[0]), read.first().map(|row| row[0]));
        if let (Some(last), Some(first)) = (last, first)
            && first <= last
        {
            let shift_s = last + 10.0 - first;
            read.iter_mut().for_each(|row| row[0] += shift_s);
            notes.push(Warning::Note(format!(
                "the test `{test}` counts its time anew: it was put 10 s behind the one before"
            )));
        }
        rows.extend(read);
    }
    let values = |at: usize| rows.iter().map(|row| row[at]).collect();
    let clock = Signal::new("timestamp", Some("s".into()), values(0));
    let others = names
        .iter()
        .enumerate()
        .map(|(at, name)| Signal::new(name.clone(), Some(unit_of(name)), values(at + 1)));
    let signals = std::iter::once(clock).chain(others).collect();
    let group = Group { signals, time: Some(0), ..Group::default() };
    Some(Ok(Source { groups: vec![group], notes, ..Source::default() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str, most_rows: usize) -> Result<Source> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.json");
        std::fs::write(&path, text).unwrap();
        read(&path, &Wanted { signals: None, most_rows })
    }

    /// The columns by their names.
    fn values(source: &Source) -> Vec<(&str, &[f64])> {
        let signals = source.groups.iter().flat_map(|group| &group.signals);
        let mut all: Vec<_> =
            signals.map(|signal| (signal.name.as_str(), signal.values.as_slice())).collect();
        all.sort_by_key(|(name, _)| *name);
        all
    }

    #[test]
    fn records_are_the_same_in_a_list_and_one_below_the_other() {
        let records = [
            r#"{"t": 0, "motor": {"speed": 1}}"#,
            r#"{"t": 1, "motor": {"speed": 2}}"#,
            r#"{"t": 2, "motor": {"speed": 3}}"#,
        ];
        let expected: [(&str, &[f64]); 2] = [("motor.speed", &[1.0, 2.0, 3.0]), ("t", &[0.0, 1.0, 2.0])];
        for text in [format!("[{}]", records.join(",")), records.join("\n")] {
            assert_eq!(values(&read_text(&text, usize::MAX).unwrap()), expected);
            assert_eq!(values(&read_text(&text, 2).unwrap())[1].1, [0.0, 1.0]);
        }
    }

    #[test]
    fn other_lists_are_read_as_before_and_damage_in_a_list_is_said() {
        let matrix = read_text("[[0, 5], [1, 6], [2, 7]]", usize::MAX).unwrap();
        assert_eq!(values(&matrix), [("column 1", &[0.0, 1.0, 2.0][..]), ("column 2", &[5.0, 6.0, 7.0][..])]);
        // A row that is no record has no value.
        let mixed = read_text(r#"[null, {"t": 1}, {"t": 2}]"#, usize::MAX).unwrap();
        assert!(values(&mixed)[0].1[0].is_nan() && values(&mixed)[0].1[1..] == [1.0, 2.0]);
        let cut = read_text("[{\"t\": 0},\n {\"t\": 1", usize::MAX).unwrap_err().to_string();
        assert!(cut.contains("line 2") && cut.contains("is no JSON from here on"), "{cut}");
        assert!(read_text("[{\"t\": 0}, {\"t\" 1}]", 1).is_err());
    }
}
