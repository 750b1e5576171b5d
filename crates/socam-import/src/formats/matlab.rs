//! MATLAB `.mat` files up to version 7, read by their published description (MathWorks, "MAT-File Format").
//!
//! Of the two libraries in Rust, one panics at files that are cut off and reads only what MATLAB itself wrote; the other knows no
//! structures.

mod element;

use std::io::Read as _;
use std::path::Path;

use element::{Elements, Problem};

use super::tree::Arrays;
use crate::error::{ImportError, Result};
use crate::source::{Source, Wanted};

/// Bytes before the first variable.
const HEAD_BYTES: usize = 128;
/// Structures within structures that are looked into.
const DEEPEST: usize = 16;
/// Most bytes that a compressed variable may have.
const LARGEST: u64 = 1 << 32;

/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Classes of arrays.
const CELL: u32 = 1;
const STRUCTURE: u32 = 2;
const OBJECT: u32 = 3;
const CHARACTERS: u32 = 4;
const SPARSE: u32 = 5;
const NUMBERS: std::ops::RangeInclusive<u32> = 6..=15;

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let bytes = std::fs::read(path).map_err(|error| ImportError::io(path, error))?;
    let mut arrays = Arrays::new(wanted);
    match variables(&mut arrays, &bytes) {
        Ok(()) => {}
        // Variables before the cut are whole.
        Err(problem) if !arrays.is_empty() => {
            arrays.incomplete(format!("variables at its end are missing ({problem})"));
        }
        Err(problem) => {
            return Err(ImportError::damaged(path, problem));
        }
    }
    Ok(arrays.finish())
}

fn variables(arrays: &mut Arrays<'_>, bytes: &[u8]) -> Result<(), Problem> {
    let is_big_endian = match bytes.get(126..HEAD_BYTES) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err("its first 128 bytes are not those of a .mat file".into()),
    };
    let mut elements = Elements::new(bytes.get(HEAD_BYTES..).unwrap_or_default(), is_big_endian);
    while let Some((kind, content)) = elements.next()? {
        match kind {
            COMPRESSED => {
                let mut plain = Vec::new();
                let inflated = flate2::read::ZlibDecoder::new(content).take(LARGEST).read_to_end(&mut plain);
                inflated.map_err(|_| "a compressed variable is incomplete".to_owned())?;
                let mut inner = Elements::new(&plain, is_big_endian);
                if let Some((MATRIX, content)) = inner.next()? {
                    matrix(arrays, "", content, is_big_endian, 0)?;
                }
            }
            MATRIX => matrix(arrays, "", content, is_big_endian, 0)?,
            _ => {}
        }
    }
    Ok(())
}

/// Reads one array; fields of structures are arrays too. `path`: the name, where the array has none of its own.
fn matrix(
    arrays: &mut Arrays<'_>,
    path: &str,
    content: &[u8],
    is_big_endian: bool,
    depth: usize,
) -> Result<(), Problem> {
    let mut elements = Elements::new(content, is_big_endian);
    let Some(flags) = elements.integers()? else { return Ok(()) };
    let class = flags.first().map_or(0, |flags| *flags as u32 & 0xff);
    let is_complex = flags.first().is_some_and(|flags| *flags as u32 & 0x800 != 0);
    if class > *NUMBERS.end() {
        arrays
            .leave(path, "is of a class that is not read (a timetable or another object: save its columns)");
        return Ok(());
    }
    let dimensions = elements.integers()?.unwrap_or_default();
    let name = elements.text()?.unwrap_or_default();
    let path = if name.is_empty() { path.to_owned() } else { name };
    match class {
        CHARACTERS => arrays.leave(&path, "is text"),
        CELL => arrays.leave(&path, "is a list"),
        SPARSE => arrays.leave(&path, "is sparse"),
        STRUCTURE | OBJECT if dimensions.iter().any(|length| *length != 1) => {
            arrays.leave(&path, "is a list")
        }
        STRUCTURE | OBJECT if depth < DEEPEST => {
            if class == OBJECT {
                elements.next()?;
            }
            structure(arrays, &path, &mut elements, is_big_endian, depth)?;
        }
        _ if NUMBERS.contains(&class) && is_complex => arrays.leave(&path, "holds complex numbers"),
        _ if NUMBERS.contains(&class) => {
            let (rows, columns) = match dimensions.as_slice() {
                [1, length] => (usize::try_from(*length).unwrap_or(0), 1),
                [rows, columns] => {
                    (usize::try_from(*rows).unwrap_or(0), usize::try_from(*columns).unwrap_or(0))
                }
                _ => {
                    arrays.leave(&path, "has more than two dimensions");
                    return Ok(());
                }
            };
            let signals = if Arrays::is_by_rows(rows, columns) { rows } else { columns };
            if arrays.takes(&path, signals) {
                let values = elements.numbers()?;
                if values.len() != rows.saturating_mul(columns) {
                    return Err(format!(
                        "`{path}` has {} numbers for {rows} rows of {columns}",
                        values.len()
                    ));
                }
                arrays.add_matrix(&path, None, rows, columns, &values);
            }
        }
        _ => {}
    }
    Ok(())
}

fn structure(
    arrays: &mut Arrays<'_>,
    path: &str,
    elements: &mut Elements<'_>,
    is_big_endian: bool,
    depth: usize,
) -> Result<(), Problem> {
    let length = elements.integers()?.and_then(|length| length.first().copied()).unwrap_or(0);
    let Some((_, names)) = elements.next()? else { return Ok(()) };
    let length =
        usize::try_from(length).ok().filter(|length| *length > 0).ok_or("a structure without names")?;
    let names = names.chunks(length).map(|name| {
        let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
        String::from_utf8_lossy(name).into_owned()
    });
    for name in names {
        if let Some((MATRIX, content)) = elements.next()? {
            matrix(arrays, &format!("{path}.{name}"), content, is_big_endian, depth + 1)?;
        }
    }
    Ok(())
}
