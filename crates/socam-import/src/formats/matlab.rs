//! MATLAB `.mat` files up to version 7.

use std::path::Path;

use matrw::{MatVariable, MatlabType};

use super::tree::Arrays;
use crate::error::{ImportError, Result};
use crate::source::{Source, Wanted};

/// Beginning of a file of MATLAB.
const TEXT: &[u8] = b"MATLAB 5.0 MAT-file, ";

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let mut bytes = std::fs::read(path).map_err(|error| ImportError::io(path, error))?;
    // The library reads files of MATLAB alone, whose text goes on with a comma; SciPy, Octave and others write other words there.
    if let Some(text) = bytes.get_mut(..TEXT.len()) {
        text.copy_from_slice(TEXT);
    }
    let file = matrw::load_matfile_from_u8(&bytes)
        .map_err(|_| ImportError::file(path, "is damaged or cut off; copy it again from its source"))?;
    let mut variables: Vec<_> = file.iter().collect();
    variables.sort_by_key(|(name, _)| name.as_str());
    let mut arrays = Arrays::new(wanted);
    for (name, variable) in variables {
        collect(&mut arrays, name, variable);
    }
    Ok(arrays.finish())
}

fn collect(arrays: &mut Arrays<'_>, path: &str, variable: &MatVariable) {
    match variable {
        MatVariable::NumericArray(array) => match variable.numeric_type().and_then(numbers) {
            Some(values) if array.is_complex() => {
                arrays.leave(path, &format!("holds {} complex numbers", values.len()));
            }
            Some(values) => {
                let dimensions = variable.dim();
                let columns = match dimensions.as_slice() {
                    [1, _] => 1,
                    [_, columns] => *columns,
                    _ => return arrays.leave(path, "has more than two dimensions"),
                };
                arrays.add(path, None, columns, &values);
            }
            // Text.
            None => {}
        },
        MatVariable::Structure(structure) => {
            for field in structure.fieldnames() {
                if let Some(inner) = structure.get(&field) {
                    collect(arrays, &format!("{path}.{field}"), inner);
                }
            }
        }
        MatVariable::Compressed(_) => arrays.leave(path, "could not be decompressed"),
        MatVariable::CellArray(_) | MatVariable::StructureArray(_) => arrays.leave(path, "is a list"),
        _ => arrays
            .leave(path, "is of a class that is not read (a timetable or another object: save its columns)"),
    }
}

fn numbers(values: &MatlabType) -> Option<Vec<f64>> {
    Some(match values {
        MatlabType::F64(values) => values.clone(),
        MatlabType::F32(values) => values.iter().map(|v| f64::from(*v)).collect(),
        MatlabType::U8(values) => values.iter().map(|v| f64::from(*v)).collect(),
        MatlabType::I8(values) => values.iter().map(|v| f64::from(*v)).collect(),
        MatlabType::U16(values) => values.iter().map(|v| f64::from(*v)).collect(),
        MatlabType::I16(values) => values.iter().map(|v| f64::from(*v)).collect(),
        MatlabType::U32(values) => values.iter().map(|v| f64::from(*v)).collect(),
        MatlabType::I32(values) => values.iter().map(|v| f64::from(*v)).collect(),
        MatlabType::U64(values) => values.iter().map(|v| *v as f64).collect(),
        MatlabType::I64(values) => values.iter().map(|v| *v as f64).collect(),
        MatlabType::BOOL(values) => values.iter().map(|v| f64::from(u8::from(*v))).collect(),
        MatlabType::UTF8(_) | MatlabType::UTF16(_) => return None,
    })
}
