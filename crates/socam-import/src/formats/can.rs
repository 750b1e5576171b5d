//! Frames of a CAN bus: logs of candump, and Vector's ASC and BLF, decoded by a DBC. Each frame of a bus is a group with its own clock.

mod asc;
mod bits;
mod blf;
mod candump;
mod database;
mod live;
mod signals;

use std::path::{Path, PathBuf};

use socam_recording::Warning;

use super::FileFormat;
use crate::error::{ImportError, Result};
use crate::source::{Source, Wanted};
use database::Database;
pub use live::{CanSet, CanSignals};
use signals::Signals;

/// A frame with data.
#[derive(Debug, Clone, PartialEq)]
struct Frame<'b> {
    time_ns: i64,
    /// Name or number of the bus.
    bus: &'b str,
    /// The identifier, with [`database::EXTENDED`] where it has 29 bits.
    id: u32,
    bytes: &'b [u8],
}

/// Why a log ends before its end, or cannot be read.
enum Stop {
    /// What stands behind is missing: words for a note.
    Cut(String),
    /// The file as a whole is refused.
    Refused(ImportError),
}

impl From<ImportError> for Stop {
    fn from(error: ImportError) -> Self {
        Self::Refused(error)
    }
}

impl From<String> for Stop {
    fn from(problem: String) -> Self {
        Self::Cut(problem)
    }
}

/// Reads the signals that a DBC finds in the frames: `dbc`, or the only one beside the log.
pub(super) fn read(path: &Path, kind: FileFormat, dbc: Option<&Path>, wanted: &Wanted) -> Result<Source> {
    let (database, note) = match dbc {
        Some(dbc) => (Database::open(dbc)?, None),
        None => {
            let found = beside(path)?;
            let note = format!("frames are read by `{}`, the only DBC beside the log", found.display());
            (Database::open(&found)?, Some(Warning::Note(note)))
        }
    };
    let mut signals = Signals::new(&database, wanted);
    let read = match kind {
        FileFormat::Candump => candump::read(path, &mut signals),
        FileFormat::Asc => asc::read(path, &mut signals),
        _ => blf::read(path, &mut signals),
    };
    let mut notes = Vec::from_iter(note);
    match read {
        Ok(()) => {}
        Err(Stop::Refused(error)) => return Err(error),
        Err(Stop::Cut(problem)) if signals.frames == 0 => return Err(ImportError::damaged(path, problem)),
        Err(Stop::Cut(problem)) => {
            let what = format!("frames after {} are missing ({problem})", signals.frames);
            notes.push(Warning::Incomplete { what });
        }
    }
    let is_named = dbc.is_some();
    let mut source = signals.finish(path)?;
    notes.append(&mut source.notes);
    Ok(Source { notes, dbc: is_named.then(|| absolute(&database.path)), ..source })
}

/// A path that holds in any folder, where the system has one.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.into())
}

/// The only DBC in the folder of a log.
fn beside(path: &Path) -> Result<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).map_err(|error| ImportError::io(folder, error))?;
    let is_dbc = |path: &PathBuf| {
        path.extension().is_some_and(|end| end.eq_ignore_ascii_case("dbc")) && path.is_file()
    };
    let mut found: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_dbc).collect();
    found.sort();
    match found.as_slice() {
        [only] => Ok(only.clone()),
        [] => Err(ImportError::file(
            path,
            "holds frames of a CAN bus and not what they mean: put the DBC beside the log, or name it, as in a mapping ([can] dbc = \"FILE\")",
        )),
        several => Err(ImportError::file(
            path,
            format!(
                "holds frames of a CAN bus, and {} DBC lie beside it: name one of them, as in a mapping ([can] dbc = \"FILE\")",
                several.len()
            ),
        )),
    }
}
