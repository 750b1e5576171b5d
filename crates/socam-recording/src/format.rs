//! Detects the format of a file by its content.

use std::io::Read;
use std::path::Path;

use serde::Serialize;

use crate::error::{RecordingError, Result, excerpt};

/// A format of recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Format {
    /// An MCAP log.
    Mcap,
    /// A CSV table whose first column is `t_s`.
    Csv,
    /// The `.m` log of the thesis' program.
    LegacyM,
    /// A CSV table of steady states, whose first column is `point_1`.
    SteadyStates,
    /// Columns in memory.
    Memory,
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Mcap => "MCAP",
            Self::Csv => "CSV",
            Self::LegacyM => "legacy .m",
            Self::SteadyStates => "CSV of steady states",
            Self::Memory => "in memory",
        })
    }
}

const MCAP_MAGIC: &[u8] = mcap::MAGIC;

/// First bytes of files of other kinds, with their names for the error.
const FOREIGN: [(&[u8], &str); 10] = [
    (b"\xff\xfe", "is text in UTF-16 (save it as UTF-8)"),
    (b"\xfe\xff", "is text in UTF-16 (save it as UTF-8)"),
    (b"MATLAB 5.0 MAT-file", "is a MATLAB .mat file (`socam-host import` reads it)"),
    (b"\x89HDF", "is an HDF5 or MATLAB 7.3 file (`socam-host import` reads it)"),
    (b"PAR1", "is a Parquet file (`socam-host import` reads it)"),
    (b"PK\x03\x04", "is a zip archive or a spreadsheet (unpack it, or save it as .csv)"),
    (b"\x1f\x8b", "is compressed with gzip (decompress it first)"),
    (b"#ROSBAG", "is a ROS 1 bag (convert it with `mcap convert`)"),
    (b"SQLite format 3", "is an SQLite database, perhaps a ROS 2 bag (convert it with `mcap convert`)"),
    (b"MDF ", "is an MDF measurement file (`socam-host import` reads version 4)"),
];

/// Detects the format by a file's first bytes.
///
/// ```
/// use socam_recording::{Format, detect};
///
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("table.txt");
/// std::fs::write(&path, "t_s,speed_rad_s\n0,1\n").unwrap();
/// assert_eq!(detect(&path)?, Format::Csv);
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When it cannot be read, is a directory, a pipe or a device, is empty, or is in no known format.
pub fn detect(path: &Path) -> Result<Format> {
    let foreign = |found: String| RecordingError::Foreign { path: path.into(), found };
    // Opening a pipe would block until another process writes. A browser has no pipes.
    #[cfg(not(target_arch = "wasm32"))]
    {
        let there = path.metadata().map_err(|e| RecordingError::io(path, "open", e))?;
        if !there.is_file() && !there.is_dir() {
            return Err(foreign("is a pipe or a device, and recordings are read more than once".into()));
        }
    }
    let mut head = Vec::new();
    crate::files::open(path)
        .map_err(|e| RecordingError::io(path, "open", e))?
        .0
        .take(512)
        .read_to_end(&mut head)
        .map_err(|e| RecordingError::io(path, "read", e))?;
    if head.is_empty() {
        return Err(RecordingError::Empty { path: path.into() });
    }
    if head.starts_with(MCAP_MAGIC) {
        return Ok(Format::Mcap);
    }
    if MCAP_MAGIC.starts_with(&head) {
        return Err(foreign(format!(
            "is an MCAP log cut off after {} bytes, before anything was recorded",
            head.len()
        )));
    }
    if let Some((_, found)) = FOREIGN.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(foreign((*found).into()));
    }
    if head.contains(&0) {
        return Err(foreign("is a binary file of no format known here".into()));
    }
    detect_text(path, &head).ok_or_else(|| {
        let line = head.split(|b| *b == b'\n').next().unwrap_or_default();
        foreign(format!("starts with `{}`", excerpt(line)))
    })
}

fn detect_text(path: &Path, head: &[u8]) -> Option<Format> {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let line = text.split(|b| *b == b'\n' || *b == b'\r').find(|line| !line.trim_ascii().is_empty())?;
    let first = line.split(|b| *b == b',').next()?.trim_ascii();
    let first = first.strip_prefix(b"\"").unwrap_or(first);
    let first = first.strip_suffix(b"\"").unwrap_or(first);
    if first == b"point_1" {
        return Some(Format::SteadyStates);
    }
    if first == b"t_s" {
        return Some(Format::Csv);
    }
    if [b"samprate".as_slice(), b"data"]
        .iter()
        .any(|name| line.trim_ascii().starts_with(name) && line.contains(&b'='))
    {
        return Some(Format::LegacyM);
    }
    // The reader of the format that the file's name says explains a wrong header or line better.
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    match extension.as_str() {
        "csv" => Some(Format::Csv),
        "m" => Some(Format::LegacyM),
        _ => None,
    }
}
