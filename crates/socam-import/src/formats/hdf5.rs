//! HDF5, and MATLAB `.mat` files of version 7.3, which are HDF5.

use std::path::Path;

use hdf5_pure::{AttrValue, DType, Dataset, Error, File, Group};

use super::tree::Arrays;
use crate::error::{ImportError, Result};
use crate::source::{Source, Wanted};

/// Groups within groups that are looked into.
const DEEPEST: usize = 16;

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let damaged = |error: Error| ImportError::damaged(path, error);
    let file = File::open_streaming(path).map_err(damaged)?;
    let mut arrays = Arrays::new(wanted);
    // MATLAB writes matrices with rows and columns exchanged, and says its class at each.
    walk(&mut arrays, "", &file.root(), 0).map_err(damaged)?;
    Ok(arrays.finish())
}

fn walk(arrays: &mut Arrays<'_>, path: &str, group: &Group, depth: usize) -> Result<(), Error> {
    let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    let mut names = group.datasets()?;
    names.sort_unstable();
    for name in names {
        dataset(arrays, &below(&name), &group.dataset(&name)?)?;
    }
    if depth == DEEPEST {
        return Ok(());
    }
    let mut names = group.groups()?;
    names.sort_unstable();
    // Groups whose names begin with `#` are skipped: MATLAB keeps objects and cells in them.
    for name in names.iter().filter(|name| !name.starts_with('#')) {
        walk(arrays, &below(name), &group.group(name)?, depth + 1)?;
    }
    Ok(())
}

fn dataset(arrays: &mut Arrays<'_>, path: &str, dataset: &Dataset) -> Result<(), Error> {
    let is_number = matches!(
        dataset.dtype()?,
        DType::F32
            | DType::F64
            | DType::I8
            | DType::I16
            | DType::I32
            | DType::I64
            | DType::U8
            | DType::U16
            | DType::U32
            | DType::U64
    );
    let attributes = dataset.attrs()?;
    let text = |name: &str| match attributes.get(name) {
        Some(
            AttrValue::String(text)
            | AttrValue::AsciiString(text)
            | AttrValue::VarLenString(text)
            | AttrValue::VarLenAsciiString(text),
        ) => Some(text.clone()),
        _ => None,
    };
    let class = text("MATLAB_class");
    let is_matlab = class.is_some();
    if !is_number || matches!(class.as_deref(), Some("char" | "cell" | "string")) {
        arrays.leave(path, "holds no numbers");
        return Ok(());
    }
    let shape = dataset.shape()?;
    let (rows, columns, is_transposed) = match shape.as_slice() {
        [] => (1, 1, false),
        [rows] => (*rows, 1, false),
        [1, rows] | [rows, 1] => (*rows, 1, false),
        [columns, rows] if is_matlab => (*rows, *columns, false),
        [rows, columns] if Arrays::is_by_rows(*rows as usize, *columns as usize) => (*columns, *rows, false),
        [rows, columns] => (*rows, *columns, true),
        _ => {
            arrays.leave(path, "has more than two dimensions");
            return Ok(());
        }
    };
    let (rows, columns) = (rows as usize, columns as usize);
    let signals = if Arrays::is_by_rows(rows, columns) { rows } else { columns };
    if !arrays.takes(path, signals) {
        return Ok(());
    }
    let mut values = dataset.read_f64()?;
    if is_transposed {
        values = transposed(&values, rows, columns);
    }
    let unit = text("unit").or_else(|| text("units"));
    arrays.add_matrix(path, unit.as_deref(), rows, columns, &values);
    Ok(())
}

/// Row by row to column by column.
fn transposed(values: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    (0..columns).flat_map(|column| (0..rows).map(move |row| values[row * columns + column])).collect()
}
