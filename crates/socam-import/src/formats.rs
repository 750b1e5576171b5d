//! The formats, and how a file's is found.

#[cfg(feature = "formats-arrow")]
mod arrow;
#[cfg(feature = "formats-can")]
pub(crate) mod can;
mod detect;
pub(crate) mod fence;
mod frames;
#[cfg(feature = "formats-hdf5")]
mod hdf5;
pub(crate) mod json;
mod matlab;
#[cfg(feature = "formats-ros")]
mod mcap;
#[cfg(feature = "formats-mdf4")]
mod mdf;
#[cfg(feature = "formats-ros")]
pub(crate) mod messages;
#[cfg(feature = "formats-arrow")]
mod parquet;
#[cfg(feature = "formats-sqlite")]
mod rosbag;
mod stream;
mod tree;
mod ulog;
mod wpilog;

use std::path::Path;

use crate::error::{ImportError, Result};
use crate::source::{Source, Wanted};
use crate::{TextLayout, tdms, text};
pub use detect::detect;

/// A format that this crate reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
    /// Lines of numbers: CSV and its relatives.
    Text,
    /// LabVIEW measurement (`.lvm`).
    LabView,
    /// Trace of a PLC by CODESYS or ctrlX, variables one below the other.
    Trace,
    /// Export of TwinCAT's Scope View, a time before each variable.
    Scope,
    /// Table of an older oscilloscope of Tektronix, its header beside the values.
    Tektronix,
    /// JSON: records, columns, rows, or a log of SysId.
    Json,
    /// Log of candump, frames of a CAN bus in text.
    Candump,
    /// Vector's log of a CAN bus in text (`.asc`).
    Asc,
    /// Vector's binary log of a CAN bus (`.blf`).
    Blf,
    /// WPILOG of WPILib and AdvantageKit.
    Wpilog,
    /// ULog of PX4 (`.ulg`).
    Ulog,
    /// ASAM MDF 4 (`.mf4`).
    Mdf4,
    /// TDMS of National Instruments.
    Tdms,
    /// MATLAB `.mat` up to version 7.
    Mat,
    /// HDF5, and MATLAB `.mat` of version 7.3.
    Hdf5,
    /// Parquet.
    Parquet,
    /// An Arrow file, also called Feather, or a stream of Arrow messages.
    Arrow,
    /// MCAP of another program.
    Mcap,
    /// A bag of ROS 2 in SQLite (`.db3`).
    Rosbag,
}

impl FileFormat {
    /// The feature, of this crate and of `socam-host`, without which files of this format are not read; `None` if they always are.
    #[must_use]
    pub const fn feature(self) -> Option<&'static str> {
        match self {
            Self::Text | Self::LabView | Self::Trace | Self::Scope | Self::Tektronix | Self::Json => None,
            Self::Tdms | Self::Mat | Self::Wpilog | Self::Ulog => None,
            Self::Candump | Self::Asc | Self::Blf => Some("formats-can"),
            Self::Mdf4 => Some("formats-mdf4"),
            Self::Hdf5 => Some("formats-hdf5"),
            Self::Parquet | Self::Arrow => Some("formats-arrow"),
            Self::Mcap => Some("formats-ros"),
            Self::Rosbag => Some("formats-sqlite"),
        }
    }
}

impl std::fmt::Display for FileFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Text => "text",
            Self::LabView => "LabVIEW .lvm",
            Self::Trace => "CODESYS trace",
            Self::Scope => "TwinCAT scope",
            Self::Tektronix => "Tektronix",
            Self::Json => "JSON",
            Self::Candump => "candump",
            Self::Asc => "Vector ASC",
            Self::Blf => "Vector BLF",
            Self::Wpilog => "WPILOG",
            Self::Ulog => "ULog",
            Self::Mdf4 => "MDF4",
            Self::Tdms => "TDMS",
            Self::Mat => "MATLAB .mat",
            Self::Hdf5 => "HDF5",
            Self::Parquet => "Parquet",
            Self::Arrow => "Arrow",
            Self::Mcap => "MCAP",
            Self::Rosbag => "ROS 2 bag",
        })
    }
}

/// The error for a file whose format is left out of this build.
#[cfg(not(all(
    feature = "formats-arrow",
    feature = "formats-can",
    feature = "formats-hdf5",
    feature = "formats-mdf4",
    feature = "formats-ros",
    feature = "formats-sqlite"
)))]
fn not_built(path: &Path, kind: FileFormat) -> ImportError {
    let feature = kind.feature().unwrap_or("default");
    let problem = format!(
        "is {kind}, which this build does not read: build socam-host with its feature `{feature}`, or with all of them (`cargo install --path host`)"
    );
    ImportError::file(path, problem)
}

/// What a mapping or an option says of a file, beside what the file itself says.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hints<'h> {
    /// How the lines of a text file are read, instead of what is found.
    pub layout: Option<&'h TextLayout>,
    /// Form of dates, as in `strptime`.
    pub date: Option<&'h str>,
    /// What the frames of a CAN bus hold, instead of the only DBC beside the log.
    pub dbc: Option<&'h Path>,
}

/// Reads signals of a file of any format.
///
/// Values are kept in memory, 8 bytes each; `wanted` names those that are.
///
/// # Errors
/// When the file cannot be read, or is damaged before its first value. What is left aside is in [`Source::notes`].
pub fn read(path: &Path, hints: Hints<'_>, wanted: &Wanted) -> Result<Source> {
    let kind = detect(path)?;
    let read = || match kind {
        FileFormat::Text => text::read(path, hints.layout, hints.date, wanted),
        FileFormat::LabView => text::read_labview(path, wanted),
        FileFormat::Trace => text::read_trace(path, wanted),
        FileFormat::Scope => text::read_scope(path, wanted),
        FileFormat::Tektronix => text::read_tektronix(path, wanted),
        FileFormat::Json => json::read(path, wanted),
        FileFormat::Wpilog => wpilog::read(path, wanted),
        FileFormat::Ulog => ulog::read(path, wanted),
        #[cfg(feature = "formats-can")]
        FileFormat::Candump | FileFormat::Asc | FileFormat::Blf => can::read(path, kind, hints.dbc, wanted),
        FileFormat::Tdms => tdms::read(path, wanted),
        FileFormat::Mat => matlab::read(path, wanted),
        #[cfg(feature = "formats-mdf4")]
        FileFormat::Mdf4 => mdf::read(path, wanted),
        #[cfg(feature = "formats-hdf5")]
        FileFormat::Hdf5 => hdf5::read(path, wanted),
        #[cfg(feature = "formats-arrow")]
        FileFormat::Parquet => parquet::read(path, wanted),
        #[cfg(feature = "formats-arrow")]
        FileFormat::Arrow => arrow::read(path, wanted),
        #[cfg(feature = "formats-ros")]
        FileFormat::Mcap => mcap::read(path, wanted),
        #[cfg(feature = "formats-sqlite")]
        FileFormat::Rosbag => rosbag::read(path, wanted),
        #[cfg(not(all(
            feature = "formats-arrow",
            feature = "formats-can",
            feature = "formats-hdf5",
            feature = "formats-mdf4",
            feature = "formats-ros",
            feature = "formats-sqlite"
        )))]
        _ => Err(not_built(path, kind)),
    };
    let source = fence::fenced(read).unwrap_or_else(|| {
        let problem = format!("its {kind} cannot be read");
        Err(ImportError::damaged(path, problem))
    })?;
    if source.signals() == 0 && wanted.signals.is_none() {
        let notes: Vec<String> = source.notes.iter().map(ToString::to_string).collect();
        let notes = notes.join("; ");
        let notes = if notes.is_empty() { String::new() } else { format!(" ({notes})") };
        return Err(ImportError::file(path, format!("holds no column of numbers{notes}")));
    }
    Ok(source)
}

#[cfg(test)]
mod tests {
    use super::FileFormat;
    use super::detect::MAGIC;

    #[test]
    fn the_table_of_docs_import_has_every_format_with_its_feature() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
        let (document, host) = (read("docs/import.md"), read("host/Cargo.toml"));
        let rows: Vec<Vec<&str>> = document
            .lines()
            .filter_map(|line| line.strip_prefix("| "))
            .map(|row| row.split(" | ").collect())
            .collect();
        let plain = |text: &str| text.replace([' ', '`'], "");
        for kind in MAGIC.iter().map(|(_, kind)| *kind).chain([
            FileFormat::Text,
            FileFormat::LabView,
            FileFormat::Trace,
            FileFormat::Scope,
            FileFormat::Tektronix,
            FileFormat::Json,
            FileFormat::Candump,
            FileFormat::Asc,
        ]) {
            let feature = kind.feature();
            let cell = feature.map_or("none |".to_owned(), |feature| format!("`{feature}` |"));
            assert!(
                rows.iter()
                    .any(|row| plain(row[0]).starts_with(&plain(&kind.to_string()))
                        && row.last() == Some(&&*cell)),
                "docs/import.md must have a row that begins with `{kind}` and ends with {cell}"
            );
            assert!(
                feature
                    .is_none_or(|feature| host.contains(&format!("{feature} = [\"socam-import/{feature}\""))),
                "host/Cargo.toml must hand the feature {feature:?} to socam-import"
            );
        }
    }
}
