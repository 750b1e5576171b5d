//! Reads a text file by its layout, line by line.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use encoding_rs::Encoding;
use encoding_rs_io::DecodeReaderBytesBuilder;

use super::cells::{Cell, Style, cell, style};
use super::layout::header;
use super::{TextLayout, sniff};
use socam_recording::Warning;

use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

/// Bytes from which encoding and layout are found.
const HEAD_BYTES: u64 = 1 << 16;
/// Longest line, bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// Finds the encoding of a file and the layout of its lines.
pub(crate) fn layout(path: &Path) -> Result<TextLayout> {
    let mut head = Vec::new();
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    file.take(HEAD_BYTES).read_to_end(&mut head).map_err(|error| ImportError::io(path, error))?;
    let is_cut = head.len() as u64 == HEAD_BYTES;
    let encoding = encoding(&head);
    let (text, ..) = encoding.decode(&head);
    sniff(&encoding.name().to_ascii_lowercase(), &text, is_cut).ok_or_else(|| {
        ImportError::file(path, "is no table of numbers: no line holds two cells of which one is a number")
    })
}

/// The encoding by a byte order mark; else UTF-8 where the bytes are valid, else Western European.
fn encoding(head: &[u8]) -> &'static Encoding {
    if let Some((encoding, _)) = Encoding::for_bom(head) {
        return encoding;
    }
    match std::str::from_utf8(head) {
        Ok(_) => encoding_rs::UTF_8,
        // The last character may be cut.
        Err(error) if error.error_len().is_none() => encoding_rs::UTF_8,
        Err(_) => encoding_rs::WINDOWS_1252,
    }
}

/// A column while it is read.
#[derive(Default)]
struct Column {
    name: String,
    unit: Option<String>,
    is_wanted: bool,
    numbers: Vec<f64>,
    dates: Vec<Option<i64>>,
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
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    let decoded = DecodeReaderBytesBuilder::new().encoding(Some(encoding)).bom_override(true).build(file);
    let mut lines =
        Lines { path, reader: BufReader::with_capacity(1 << 18, decoded), line: 0, text: String::new() };
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
    if rows == 0 {
        return Err(ImportError::file(
            path,
            format!("ends before line {}, the first of numbers", layout.first_line),
        ));
    }
    finish(path, columns, rows, layout)
}

fn begin(names: &[String], units: &[String], width: usize, wanted: &Wanted) -> Vec<Column> {
    let column = |index: usize| {
        let name = names.get(index).filter(|name| !name.is_empty()).cloned();
        let name = name.unwrap_or_else(|| format!("column {}", index + 1));
        let is_wanted = wanted.takes("", &name);
        Column { unit: units.get(index).cloned(), is_wanted, name, ..Column::default() }
    };
    (0..width).map(column).collect()
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
fn finish(path: &Path, columns: Vec<Column>, rows: usize, layout: TextLayout) -> Result<Source> {
    let mut source = Source { text: Some(layout), ..Source::default() };
    let mut group = Group::default();
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
        group.signals.push(if column.dates.is_empty() {
            Signal::new(column.name, column.unit, column.numbers)
        } else {
            Signal::of_integers(column.name, Some("ns".into()), column.dates.iter().copied())
        });
    }
    source.groups.push(group);
    Ok(source.tidy())
}

/// Lines of text with their numbers.
struct Lines<'p, R> {
    path: &'p Path,
    reader: BufReader<R>,
    line: usize,
    text: String,
}

impl<R: Read> Lines<'_, R> {
    fn next(&mut self) -> Result<bool> {
        self.text.clear();
        let read = (&mut self.reader).take(LONGEST_LINE).read_line(&mut self.text);
        let read = read.map_err(|error| ImportError::io(self.path, error))?;
        self.line += 1;
        if read as u64 == LONGEST_LINE {
            let problem = format!("is longer than {LONGEST_LINE} bytes; this is no table of numbers");
            return Err(ImportError::line(self.path, self.line, problem));
        }
        Ok(read > 0)
    }
}
