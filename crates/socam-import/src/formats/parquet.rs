//! Parquet tables.

use std::fs::File;
use std::path::Path;

use parquet::basic::{LogicalType, Repetition, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use socam_recording::Warning;

use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let damaged = |error: ParquetError| ImportError::damaged(path, error);
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    let reader = SerializedFileReader::new(file).map_err(damaged)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let (mut group, mut notes) = (Group::default(), Vec::new());
    for (index, column) in schema.columns().iter().enumerate() {
        let name = column.path().string();
        if !wanted.takes("", &name) {
            continue;
        }
        let is_list = column.max_rep_level() > 0
            || column.self_type().get_basic_info().repetition() == Repetition::REPEATED;
        if is_list {
            notes.push(Warning::Note(format!("column `{name}` is a list and is left aside")));
            continue;
        }
        match self::column(&reader, index, column, wanted.most_rows).map_err(damaged)? {
            Some(Values::Floats(values)) => group.signals.push(Signal::new(name, None, values)),
            Some(Values::Integers(values)) => {
                let unit = time_unit(column).map(str::to_owned);
                group.signals.push(Signal::of_integers(name, unit, values.iter().copied()));
            }
            None => notes.push(Warning::Note(format!("column `{name}` is no number and is left aside"))),
        }
    }
    Ok(Source { groups: vec![group], notes, ..Source::default() }.tidy())
}

enum Values {
    Floats(Vec<f64>),
    Integers(Vec<Option<i64>>),
}

/// All values of a column; `None` where it holds no numbers.
fn column(
    reader: &SerializedFileReader<File>,
    index: usize,
    column: &ColumnDescriptor,
    most_rows: usize,
) -> Result<Option<Values>, ParquetError> {
    let full = column.max_def_level();
    let (mut floats, mut integers) = (Vec::new(), Vec::new());
    let mut is_integer = false;
    for group in 0..reader.num_row_groups() {
        let left = most_rows.saturating_sub(floats.len().max(integers.len()));
        let group = reader.get_row_group(group)?;
        let rows = left.min(usize::try_from(group.metadata().num_rows()).unwrap_or(0));
        match group.get_column_reader(index)? {
            ColumnReader::DoubleColumnReader(reader) => {
                floats.extend(values(reader, rows, full)?.map(|v| v.unwrap_or(f64::NAN)))
            }
            ColumnReader::FloatColumnReader(reader) => {
                floats.extend(values(reader, rows, full)?.map(|v| v.map_or(f64::NAN, f64::from)));
            }
            ColumnReader::BoolColumnReader(reader) => {
                floats.extend(
                    values(reader, rows, full)?.map(|v| v.map_or(f64::NAN, |v| f64::from(u8::from(v)))),
                );
            }
            ColumnReader::Int32ColumnReader(reader) => {
                is_integer = true;
                integers.extend(values(reader, rows, full)?.map(|v| v.map(i64::from)));
            }
            ColumnReader::Int64ColumnReader(reader) => {
                is_integer = true;
                integers.extend(values(reader, rows, full)?);
            }
            _ => return Ok(None),
        }
    }
    Ok(Some(if is_integer { Values::Integers(integers) } else { Values::Floats(floats) }))
}

/// Values of one row group, with those that are missing in their places.
fn values<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    full: i16,
) -> Result<impl Iterator<Item = Option<T::T>>, ParquetError> {
    let (mut levels, mut present) = (Vec::new(), Vec::new());
    let mut read = 0;
    while read < rows {
        let (records, ..) = reader.read_records(rows - read, Some(&mut levels), None, &mut present)?;
        if records == 0 {
            break;
        }
        read += records;
    }
    if full == 0 {
        levels = vec![0; present.len()];
    }
    let mut present = present.into_iter();
    Ok(levels.into_iter().map(move |level| if level == full { present.next() } else { None }))
}

fn time_unit(column: &ColumnDescriptor) -> Option<&'static str> {
    match column.logical_type_ref()? {
        LogicalType::Timestamp(stamp) => Some(match stamp.unit {
            TimeUnit::MILLIS => "ms",
            TimeUnit::MICROS => "us",
            TimeUnit::NANOS => "ns",
        }),
        _ => None,
    }
}
