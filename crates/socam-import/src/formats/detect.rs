//! The format of a file, found by its first bytes.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::{FileFormat, frames, json};
use crate::error::{ImportError, Result};
use crate::text;

/// First bytes of formats.
pub(super) const MAGIC: [(&[u8], FileFormat); 13] = [
    (b"MDF     4", FileFormat::Mdf4),
    (b"UnFinMF ", FileFormat::Mdf4),
    (b"TDSm", FileFormat::Tdms),
    (b"MATLAB 5.0 MAT-file", FileFormat::Mat),
    (b"MATLAB 7.3 MAT-file", FileFormat::Hdf5),
    (b"\x89HDF\r\n\x1a\n", FileFormat::Hdf5),
    (b"PAR1", FileFormat::Parquet),
    (b"ARROW1", FileFormat::Arrow),
    (b"\x89MCAP0\r\n", FileFormat::Mcap),
    (b"LOGG", FileFormat::Blf),
    (b"WPILOG", FileFormat::Wpilog),
    (b"ULog\x01\x12\x35", FileFormat::Ulog),
    (b"SQLite format 3\0", FileFormat::Rosbag),
];

/// First bytes of formats that are not read, with what to do.
const REFUSED: [(&[u8], &str); 8] = [
    (b"MDF     ", "is MDF of a version before 4; convert it to MDF 4 with the program that wrote it"),
    (b"#ROSBAG", "is a ROS 1 bag; convert it with `mcap convert`"),
    (b"PK\x03\x04", "is a zip archive or a spreadsheet; unpack it, or save the sheet as .csv"),
    (b"\xd0\xcf\x11\xe0", "is an old spreadsheet or document; save the sheet as .csv"),
    (b"\x1f\x8b", "is compressed with gzip; decompress it first"),
    (b"\x28\xb5\x2f\xfd", "is compressed with zstd; decompress it first"),
    (b"BZh", "is compressed with bzip2; decompress it first"),
    (b"7z\xbc\xaf", "is a 7z archive; unpack it"),
];

/// Finds the format of a file by its first bytes.
///
/// # Errors
/// When it cannot be read, is empty, or is in a format that is not read.
pub fn detect(path: &Path) -> Result<FileFormat> {
    let is_file = path.metadata().map_err(|error| ImportError::io(path, error))?.is_file();
    if !is_file {
        return Err(ImportError::file(path, "is a folder, a pipe or a device; name a file"));
    }
    let mut head = Vec::new();
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    file.take(4096).read_to_end(&mut head).map_err(|error| ImportError::io(path, error))?;
    if head.is_empty() {
        return Err(ImportError::file(path, "is empty; record again"));
    }
    if let Some((_, kind)) = MAGIC.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Ok(*kind);
    }
    if let Some((_, problem)) = REFUSED.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(ImportError::file(path, *problem));
    }
    if head.starts_with(&[0xff, 0xff, 0xff, 0xff]) && head.len() > 8 {
        return Ok(FileFormat::Arrow);
    }
    let is_utf16 = head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff");
    if head.contains(&0) && !is_utf16 {
        return Err(ImportError::file(path, "is a binary file of no format known here"));
    }
    let text = String::from_utf8_lossy(&head);
    Ok(match () {
        () if text.trim_start_matches('\u{feff}').starts_with("LabVIEW Measurement") => FileFormat::LabView,
        () if json::is_json(&text) => FileFormat::Json,
        () if text::is_tektronix(&text) => FileFormat::Tektronix,
        () if frames::is_candump(&text) => FileFormat::Candump,
        () if frames::is_asc(&text) => FileFormat::Asc,
        () if text::is_scope(&text) => FileFormat::Scope,
        () if text::is_trace(&text) => FileFormat::Trace,
        () => FileFormat::Text,
    })
}
