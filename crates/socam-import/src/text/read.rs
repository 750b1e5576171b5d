//! Reads a text file by its layout, line by line.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use encoding_rs::Encoding;

use super::cells::{Cell, Style, cell, style};
use super::layout::header;
use super::lines::{self, HEAD_BYTES, Lines};
use super::{TextLayout, sniff};
use socam_recording::Warning;

use super::columns::{Dated, by_clock, joined};
use crate::dates::Moment;
use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// Finds the encoding of a file and the layout of its lines.
pub(crate) fn layout(path: &Path) -> Result<TextLayout> {
    let mut head = Vec::new();
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    file.take(HEAD_BYTES).read_to_end(&mut head).map_err(|error| ImportError::io(path, error))?;
    let is_cut = head.len() as u64 == HEAD_BYTES;
    let encoding = lines::encoding(&head);
    let (text, ..) = encoding.decode(&head);
    sniff(&encoding.name().to_ascii_lowercase(), &text, is_cut).ok_or_else(|| {
        ImportError::file(path, "is no table of numbers: no line holds two cells of which one is a number")
    })
}

/// A column while it is read.
#[derive(Default)]
struct Column {
    name: String,
    unit: Option<String>,
    is_wanted: bool,
    numbers: Vec<f64>,
    dates: Vec<Option<Moment>>,
    texts: usize,
    first_text: Option<(usize, String)>,
    /// The first cell with a point for its decimal sign in a file with commas, and the first with a point between thousands only.
    points: [Option<(usize, String)>; 2],
}

/// Reads the columns of a text file.
pub(crate) fn read(
    path: &Path,
    layout: Option<&TextLayout>,
    date: Option<&str>,
    wanted: &Wanted,
) -> Result<Source> {
    let layout = match layout {
        Some(layout) => layout.clone(),
        None => self::layout(path)?,
    };
    let encoding = Encoding::for_label(layout.encoding.as_bytes())
        .ok_or_else(|| ImportError::file(path, format!("`{}` is no encoding known here", layout.encoding)))?;
    let mut lines = Lines::open(path, encoding)?;
    let (mut names, mut units) = (Vec::new(), Vec::new());
    let mut columns: Vec<Column> = Vec::new();
    let mut rows = 0;
    while rows < wanted.most_rows && lines.next()? {
        let number = lines.line;
        if number == layout.header_line || number == layout.units_line {
            let cells = layout.cells(header(&lines.text));
            let texts = cells.iter().map(|text| text.trim().trim_matches('"').trim().to_owned()).collect();
            if number == layout.header_line { names = texts } else { units = texts }
        }
        if number < layout.first_line || lines.text.trim().is_empty() {
            continue;
        }
        let cells = layout.cells(lines.text.trim_end_matches(['\r', '\n']));
        if columns.is_empty() {
            columns = begin(&names, &units, cells.len(), wanted);
        }
        if cells.len() != columns.len() {
            let problem = format!(
                "{} cells where the lines before have {}; correct it, or delete it and what follows",
                cells.len(),
                columns.len()
            );
            return Err(ImportError::line(path, number, problem));
        }
        for (column, text) in columns.iter_mut().zip(cells) {
            column.push(text, number, &layout, date);
        }
        rows += 1;
    }
    number_in_seconds(&names, &units, &mut columns);
    if rows == 0 {
        return Err(ImportError::file(
            path,
            format!("ends before line {}, the first of numbers", layout.first_line),
        ));
    }
    finish(path, columns, rows, layout, wanted)
}

fn begin(names: &[String], units: &[String], width: usize, wanted: &Wanted) -> Vec<Column> {
    let column = |index: usize| {
        let name = names.get(index).filter(|name| !name.is_empty()).cloned();
        let name = name.unwrap_or_else(|| format!("column {}", index + 1));
        let is_wanted = wanted.may_take(&name);
        Column { unit: units.get(index).cloned(), is_wanted, name, ..Column::default() }
    };
    (0..width).map(column).collect()
}

/// Puts the numbers of an oscilloscope's samples in seconds, see [`is_sequence`](super::layout::is_sequence).
fn number_in_seconds(names: &[String], units: &[String], columns: &mut [Column]) {
    let below = |name: &str| {
        let at = names.iter().position(|own| own == name)?;
        units.get(at)?.parse::<f64>().ok()
    };
    let is_sequence = units.first().is_some_and(|first| first == "Sequence");
    let (Some(start_s), Some(step_s), true) = (below("Start"), below("Increment"), is_sequence) else {
        return;
    };
    if let Some(first) = columns.first_mut() {
        first.numbers.iter_mut().for_each(|number| *number = start_s + step_s * *number);
        first.unit = Some("s".into());
    }
}

impl Column {
    fn push(&mut self, text: &str, line: usize, layout: &TextLayout, date: Option<&str>) {
        if !self.is_wanted {
            return;
        }
        let is_missing = layout.missing.iter().any(|word| word == text.trim());
        let found = if is_missing { Cell::Missing } else { cell(text, layout.decimal_comma, date) };
        let (number, date) = match found {
            Cell::Number(number) => {
                let place = match style(text, layout.decimal_comma) {
                    Style::Plain => None,
                    Style::Pointed => Some(0),
                    Style::Grouped => Some(1),
                };
                if let Some(place) = place {
                    self.points[place].get_or_insert_with(|| (line, text.trim().to_owned()));
                }
                (number, None)
            }
            Cell::Date(date) => (f64::NAN, Some(date)),
            Cell::Missing => (f64::NAN, None),
            Cell::Text => {
                self.texts += 1;
                self.first_text.get_or_insert_with(|| (line, text.trim().chars().take(40).collect()));
                (f64::NAN, None)
            }
        };
        if date.is_some() && self.dates.is_empty() {
            self.dates = vec![None; self.numbers.len()];
        }
        self.numbers.push(number);
        if !self.dates.is_empty() || date.is_some() {
            self.dates.push(date);
        }
    }
}

/// Columns of text are left aside; one that holds both is an error at its first text.
fn finish(
    path: &Path,
    columns: Vec<Column>,
    rows: usize,
    layout: TextLayout,
    wanted: &Wanted,
) -> Result<Source> {
    let mut source = Source { text: Some(layout), ..Source::default() };
    let mut group = Group::default();
    let mut dated: Vec<(usize, Dated)> = Vec::new();
    for column in columns.into_iter().filter(|column| column.is_wanted) {
        if let Some((line, text)) = column.first_text {
            if column.texts == rows || (2 * column.texts > rows && column.dates.is_empty()) {
                source
                    .notes
                    .push(Warning::Note(format!("column `{}` is text and is left aside", column.name)));
                continue;
            }
            let problem = format!(
                "`{text}` in column `{}`, where other lines hold numbers; delete it, or say `missing = [\"{text}\"]` in [text] of the mapping",
                column.name
            );
            return Err(ImportError::line(path, line, problem));
        }
        if let [Some((line, pointed)), Some((other, grouped))] = &column.points {
            let problem = format!(
                "`{grouped}` in column `{}` has a point between thousands or for its decimal sign, as `{pointed}` has one in line {line}; write all numbers of the file with one decimal sign",
                column.name
            );
            return Err(ImportError::line(path, *other, problem));
        }
        let is_empty = column.dates.is_empty() && column.numbers.iter().all(|value| value.is_nan());
        if is_empty {
            source
                .notes
                .push(Warning::Note(format!("column `{}` holds no value and is left aside", column.name)));
            continue;
        }
        if column.dates.is_empty() {
            group.signals.push(Signal::new(column.name, column.unit, column.numbers));
        } else {
            dated.push((group.signals.len(), Dated { name: column.name, moments: column.dates }));
        }
    }
    for (before, (at, column)) in joined(dated, &mut source.notes).into_iter().enumerate() {
        group.signals.insert(at + before, column);
    }
    source.groups = by_clock(group);
    let mut source = source.with_shared_clocks().tidy();
    source.keep(wanted);
    Ok(source)
}
