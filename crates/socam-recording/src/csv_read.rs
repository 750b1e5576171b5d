//! CSV recordings, streamed: `t_s` first, then one column per channel named with its unit.

use std::path::Path;

use crate::Channel;
use crate::csv_lines::{CsvLines, number};
use crate::error::{RecordingError, Result};
use crate::line_problem::LineProblem;
use crate::part::{EndOfRows, Part, Place};
use crate::table::{BLOCK_ROWS, Table};
use crate::warning::Warning;

/// Rows streaming from a CSV file.
pub(crate) struct CsvRows {
    lines: CsvLines,
    channels: Vec<Channel>,
    columns: Vec<CsvColumn>,
    warnings: Vec<Warning>,
    previous_s: f64,
}

/// The column of a channel, and whether it has held numbers or text so far.
struct CsvColumn {
    cell: usize,
    numbers: bool,
    /// Line and content of its first text.
    text: Option<(u64, String)>,
}

/// The cells of a file's channels in each line.
#[derive(Debug, Clone)]
pub(crate) struct CsvLayout {
    /// Number of cells in every line.
    cells: usize,
    /// Cell of each channel.
    channels: Vec<(usize, Channel)>,
}

impl CsvRows {
    /// Reads the header.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let mut lines = CsvLines::open(path)?;
        let header = lines.header("t_s")?;
        let mut named = Vec::new();
        let mut warnings = Vec::new();
        for (cell, column) in header.iter().enumerate().skip(1) {
            match Channel::from_column_name(column) {
                Some(channel) => named.push((cell, channel)),
                None => warnings.push(Warning::ColumnWithoutUnit { column: column.clone() }),
            }
        }
        if named.is_empty() {
            return Err(RecordingError::NoChannels { path: path.into() });
        }
        Ok(Self::new(lines, named, warnings, false))
    }

    /// Reads some of the channels again, from a place on.
    pub(crate) fn resume(path: &Path, layout: &CsvLayout, columns: &[usize], place: Place) -> Result<Self> {
        let mut lines = CsvLines::open(path)?;
        lines.cells = layout.cells;
        lines.seek(place)?;
        let named = columns.iter().map(|column| layout.channels[*column].clone()).collect();
        Ok(Self::new(lines, named, Vec::new(), true))
    }

    fn new(lines: CsvLines, named: Vec<(usize, Channel)>, warnings: Vec<Warning>, numbers: bool) -> Self {
        let column = |(cell, channel)| (CsvColumn { cell, numbers, text: None }, channel);
        let (columns, channels) = named.into_iter().map(column).unzip();
        Self { lines, channels, columns, warnings, previous_s: f64::NEG_INFINITY }
    }

    pub(crate) fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Appends at most `rows` rows; false at the file's end.
    pub(crate) fn read(&mut self, table: &mut Table, rows: usize) -> Result<bool> {
        for _ in 0..rows {
            if !self.lines.next()? {
                return Ok(false);
            }
            self.row(table).map_err(|problem| self.lines.error(problem))?;
        }
        Ok(true)
    }

    /// The next block of rows.
    pub(crate) fn next(&mut self) -> Result<Vec<Part>> {
        let place = self.lines.place();
        let mut table = Table::with_columns(self.channels.len());
        self.read(&mut table, BLOCK_ROWS)?;
        Ok(if table.rows() > 0 {
            vec![Part { place, end_byte: self.lines.place().byte, table }]
        } else {
            Vec::new()
        })
    }

    fn row(&mut self, table: &mut Table) -> Result<(), LineProblem> {
        let record = &self.lines.record;
        let time_s =
            number(&record[0], "t_s")?.ok_or_else(|| LineProblem::MissingTime { column: "t_s".into() })?;
        if time_s <= self.previous_s {
            return Err(LineProblem::TimeNotIncreasing { previous_s: self.previous_s, time_s });
        }
        self.previous_s = time_s;
        table.time_s.push(time_s);
        for ((column, channel), values) in self.columns.iter_mut().zip(&self.channels).zip(&mut table.columns)
        {
            let value = column.number(&record[column.cell], channel, self.lines.line)?;
            values.push(value.unwrap_or(f64::NAN));
        }
        Ok(())
    }

    /// The layout, and which columns are text or empty.
    pub(crate) fn finish(self) -> (CsvLayout, EndOfRows) {
        let mut unusable = Vec::new();
        let mut warnings = self.warnings;
        for (index, (column, channel)) in self.columns.iter().zip(&self.channels).enumerate() {
            if column.numbers {
                continue;
            }
            unusable.push(index);
            let name = channel.column_name();
            warnings.push(match column.text {
                Some(_) => Warning::TextColumn { column: name },
                None => Warning::EmptyColumn { column: name },
            });
        }
        let cells = self.columns.iter().map(|column| column.cell);
        let layout = CsvLayout { cells: self.lines.cells, channels: cells.zip(self.channels).collect() };
        (layout, EndOfRows { unusable, warnings, lost_samples: 0, cut: None, contents: None })
    }
}

impl CsvColumn {
    /// A cell's number. Text is accepted as missing while the column has held no number.
    fn number(&mut self, cell: &[u8], channel: &Channel, line: u64) -> Result<Option<f64>, LineProblem> {
        let value = match number(cell, "") {
            Ok(Some(value)) => value,
            Ok(None) => return Ok(None),
            Err(LineProblem::NotANumber { found, .. }) if !self.numbers => {
                self.text.get_or_insert((line, found));
                return Ok(None);
            }
            Err(problem) => return Err(problem.in_column(channel)),
        };
        self.numbers = true;
        match &self.text {
            None => Ok(Some(value)),
            Some((text_line, found)) => Err(LineProblem::MixedColumn {
                column: channel.column_name(),
                found: found.clone(),
                text_line: *text_line,
            }),
        }
    }
}

impl LineProblem {
    fn in_column(mut self, channel: &Channel) -> Self {
        if let Self::NotANumber { column, .. } | Self::NotFinite { column, .. } = &mut self {
            *column = channel.column_name();
        }
        self
    }
}
