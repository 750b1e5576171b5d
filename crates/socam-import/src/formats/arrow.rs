//! Arrow files (Feather) and streams.

mod messages;

use std::path::Path;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    DurationMicrosecondType, DurationMillisecondType, DurationNanosecondType, DurationSecondType,
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, TimestampMicrosecondType,
    TimestampMillisecondType, TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType};
use arrow_schema::{DataType, Field, TimeUnit};

use messages::Messages;
use socam_recording::Warning;

use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let bytes = std::fs::read(path).map_err(|error| ImportError::io(path, error))?;
    let mut messages = Messages::open(bytes).map_err(|problem| ImportError::damaged(path, problem))?;
    let schema = messages.schema.clone();
    let mut notes = Vec::new();
    let mut columns = Vec::new();
    for (index, field) in schema.fields().iter().enumerate() {
        if !wanted.takes("", field.name()) {
            continue;
        }
        match kind(field.data_type()) {
            Some(kind) => columns.push((index, kind, Vec::new(), Vec::new())),
            None => {
                notes.push(Warning::Note(format!("column `{}` is no number and is left aside", field.name())))
            }
        }
    }
    let taken: Vec<usize> = columns.iter().map(|(index, ..)| *index).collect();
    let mut rows = 0;
    while rows < wanted.most_rows {
        match messages.rows(&taken) {
            Ok(None) => break,
            Ok(Some(batch)) => {
                for ((.., floats, integers), column) in columns.iter_mut().zip(batch.columns()) {
                    append(column.as_ref(), floats, integers);
                }
                rows += batch.num_rows();
            }
            // Rows before a damaged batch are good.
            Err(problem) if rows > 0 => {
                notes
                    .push(Warning::Incomplete { what: format!("rows after {rows} are missing ({problem})") });
                break;
            }
            Err(problem) => return Err(ImportError::damaged(path, problem)),
        }
    }
    let signal = |(index, kind, floats, integers): (usize, Number, Vec<f64>, Vec<Option<i64>>)| {
        let field = schema.field(index);
        let unit = kind.unit.map(str::to_owned).or_else(|| unit_of(field));
        if kind.is_integer {
            Signal::of_integers(field.name(), unit, integers.iter().copied())
        } else {
            Signal::new(field.name(), unit, floats)
        }
    };
    let group = Group { signals: columns.into_iter().map(signal).collect(), ..Group::default() };
    Ok(Source { groups: vec![group], notes, ..Source::default() }.tidy())
}

fn unit_of(field: &Field) -> Option<String> {
    field.metadata().get("unit").or_else(|| field.metadata().get("units")).cloned()
}

struct Number {
    is_integer: bool,
    unit: Option<&'static str>,
}

fn kind(data_type: &DataType) -> Option<Number> {
    let (is_integer, unit) = match data_type {
        DataType::Float32 | DataType::Float64 | DataType::Boolean | DataType::UInt64 => (false, None),
        DataType::Int8 | DataType::Int16 | DataType::Int32 | DataType::Int64 => (true, None),
        DataType::UInt8 | DataType::UInt16 | DataType::UInt32 => (true, None),
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => (
            true,
            Some(match unit {
                TimeUnit::Second => "s",
                TimeUnit::Millisecond => "ms",
                TimeUnit::Microsecond => "us",
                TimeUnit::Nanosecond => "ns",
            }),
        ),
        _ => return None,
    };
    Some(Number { is_integer, unit })
}

fn append(array: &dyn Array, floats: &mut Vec<f64>, integers: &mut Vec<Option<i64>>) {
    fn of<T: ArrowPrimitiveType, V>(
        array: &dyn Array,
        to: &mut Vec<V>,
        value: impl Fn(Option<T::Native>) -> V,
    ) {
        to.extend(array.as_primitive::<T>().iter().map(value));
    }
    match array.data_type() {
        DataType::Float64 => of::<Float64Type, _>(array, floats, |v| v.unwrap_or(f64::NAN)),
        DataType::Float32 => of::<Float32Type, _>(array, floats, |v| v.map_or(f64::NAN, f64::from)),
        DataType::UInt64 => of::<UInt64Type, _>(array, floats, |v| v.map_or(f64::NAN, |v| v as f64)),
        DataType::Boolean => {
            floats.extend(array.as_boolean().iter().map(|v| v.map_or(f64::NAN, |v| f64::from(u8::from(v)))))
        }
        DataType::Int8 => of::<Int8Type, _>(array, integers, |v| v.map(i64::from)),
        DataType::Int16 => of::<Int16Type, _>(array, integers, |v| v.map(i64::from)),
        DataType::Int32 => of::<Int32Type, _>(array, integers, |v| v.map(i64::from)),
        DataType::Int64 => of::<Int64Type, _>(array, integers, |v| v),
        DataType::UInt8 => of::<UInt8Type, _>(array, integers, |v| v.map(i64::from)),
        DataType::UInt16 => of::<UInt16Type, _>(array, integers, |v| v.map(i64::from)),
        DataType::UInt32 => of::<UInt32Type, _>(array, integers, |v| v.map(i64::from)),
        DataType::Timestamp(unit, _) => match unit {
            TimeUnit::Second => of::<TimestampSecondType, _>(array, integers, |v| v),
            TimeUnit::Millisecond => of::<TimestampMillisecondType, _>(array, integers, |v| v),
            TimeUnit::Microsecond => of::<TimestampMicrosecondType, _>(array, integers, |v| v),
            TimeUnit::Nanosecond => of::<TimestampNanosecondType, _>(array, integers, |v| v),
        },
        DataType::Duration(unit) => match unit {
            TimeUnit::Second => of::<DurationSecondType, _>(array, integers, |v| v),
            TimeUnit::Millisecond => of::<DurationMillisecondType, _>(array, integers, |v| v),
            TimeUnit::Microsecond => of::<DurationMicrosecondType, _>(array, integers, |v| v),
            TimeUnit::Nanosecond => of::<DurationNanosecondType, _>(array, integers, |v| v),
        },
        _ => {}
    }
}
