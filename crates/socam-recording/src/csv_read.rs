//! CSV recordings, streamed: `t_s` first, then one column per channel named with its unit.

use std::path::Path;

use crate::Channel;
use crate::cell::number;
use crate::channel::{TableColumn, table_columns};
use crate::csv_lines::CsvLines;
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
    column: TableColumn,
    numbers: bool,
    /// Line and content of its first text.
    text: Option<(u64, String)>,
}

/// The cells of a file's channels in each line.
#[derive(Debug, Clone)]
pub(crate) struct CsvLayout {
    /// Number of cells in every line.
    cells: usize,
    /// Column of each channel.
    columns: Vec<TableColumn>,
}

impl CsvRows {
    /// Reads the header.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let mut lines = CsvLines::open(path)?;
        let header = lines.header("t_s")?;
        let (named, warnings) = table_columns(&header);
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
        let named = columns.iter().map(|column| layout.columns[*column].clone()).collect();
        Ok(Self::new(lines, named, Vec::new(), true))
    }

    fn new(lines: CsvLines, named: Vec<TableColumn>, warnings: Vec<Warning>, numbers: bool) -> Self {
        let channels = named.iter().map(|column| column.channel.clone()).collect();
        let columns = named.into_iter().map(|column| CsvColumn { column, numbers, text: None }).collect();
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
        for (column, values) in self.columns.iter_mut().zip(&mut table.columns) {
            let value = column.value(&record[column.column.cell], self.lines.line)?;
            values.push(value.unwrap_or(f64::NAN));
        }
        Ok(())
    }

    /// The layout, and which columns are text or empty.
    pub(crate) fn finish(self) -> (CsvLayout, EndOfRows) {
        let mut unusable = Vec::new();
        let mut warnings = self.warnings;
        for (index, column) in self.columns.iter().enumerate() {
            if column.numbers {
                continue;
            }
            unusable.push(index);
            let title = column.column.title.clone();
            warnings.push(match column.text {
                Some(_) => Warning::TextColumn { column: title },
                None => Warning::EmptyColumn { column: title },
            });
        }
        let columns = self.columns.into_iter().map(|column| column.column).collect();
        let layout = CsvLayout { cells: self.lines.cells, columns };
        (layout, EndOfRows { unusable, warnings, lost_samples: 0, cut: None, contents: None })
    }
}

impl CsvColumn {
    /// The SI value in a cell. Text is accepted as missing while the column has held no number.
    fn value(&mut self, cell: &[u8], line: u64) -> Result<Option<f64>, LineProblem> {
        let value = match self.column.value(cell) {
            Ok(Some(value)) => value,
            Ok(None) => return Ok(None),
            Err(LineProblem::NotANumber { found, .. }) if !self.numbers => {
                self.text.get_or_insert((line, found));
                return Ok(None);
            }
            Err(problem) => return Err(problem),
        };
        self.numbers = true;
        match &self.text {
            None => Ok(Some(value)),
            Some((text_line, found)) => Err(LineProblem::MixedColumn {
                column: self.column.title.clone(),
                found: found.clone(),
                text_line: *text_line,
            }),
        }
    }
}
