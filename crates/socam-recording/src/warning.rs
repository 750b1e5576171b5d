//! Warnings of a recording: what was not read, and where it is cut off.

use socam_units::{Column, Meaning, Unit};

/// The end of a recording that is cut off, and what is missing.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Cut {
    /// The byte after the last whole record.
    pub byte: u64,
    /// Bytes after it that could not be used.
    pub unused_bytes: u64,
    /// Description of the missing part.
    pub missing: String,
}

/// A warning from opening a recording: something is not read or missing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// A column of text.
    #[error("column `{column}` is text and is left aside")]
    TextColumn {
        /// The column's name.
        column: String,
    },
    /// A column whose name has no unit.
    #[error("column `{column}` names no unit and is left aside (end its name in one of {suffixes}, or in another unit such as _rpm, _deg or _mNm; numbers of anything else end in _1, and the model's channel says unit = \"...\")", suffixes = Unit::ALL.map(Unit::suffix).join(" "))]
    ColumnWithoutUnit {
        /// The column's name.
        column: String,
    },
    /// A column of times that is not the clock.
    #[error("column `{column}` holds times, is not the clock of this table, and is left aside")]
    SecondTime {
        /// The column's name.
        column: String,
    },
    /// A column that is read by the suffix of its name, where a longer end may be the unit.
    #[error("column `{column}` is read in {unit}, as its name ends in {suffix}; if it is in {also}, rename it, or import it with a mapping", unit = unit.symbol(), suffix = unit.suffix())]
    DoubtfulUnit {
        /// The column's name.
        column: String,
        /// The unit by the suffix.
        unit: Unit,
        /// The unit by the longer end.
        also: String,
    },
    /// A column that has a unit but not one value.
    #[error("column `{column}` holds no value and is left aside")]
    EmptyColumn {
        /// The column's name.
        column: String,
    },
    /// A recording that is cut off.
    #[error("the recording is cut off: {missing}")]
    CutOff {
        /// Description of the missing part.
        missing: String,
    },
    /// A part of a log that does not fit its checksum.
    #[error("{bytes} damaged bytes at byte {byte} are left out; the samples in them are missing")]
    Damaged {
        /// First byte of the part.
        byte: u64,
        /// Length of the part, bytes.
        bytes: u64,
    },
    /// Samples that never reached the recording.
    #[error("{samples} samples were lost while recording (by their sequence numbers)")]
    LostSamples {
        /// Number of samples.
        samples: u64,
    },
    /// Samples that are absent from a damaged log, of which nothing says whether they were recorded.
    #[error(
        "{samples} samples are missing (by their sequence numbers): they are in the damaged parts, or were lost while recording"
    )]
    AbsentSamples {
        /// Number of samples.
        samples: u64,
    },
    /// A log with fewer samples than its summary says.
    #[error(
        "the log says that {written} samples were written, and only {read} can be read: the file is damaged; copy it again from its source"
    )]
    MissingSamples {
        /// Number that was written, by the summary.
        written: u64,
        /// Number that can be read.
        read: u64,
    },
    /// A file of another program that is damaged or cut off.
    #[error("the file is damaged or cut off: {what}")]
    Incomplete {
        /// Description of what is missing.
        what: String,
    },
    /// A warning about one of several files that are joined.
    #[error("`{file}`: {warning}")]
    InFile {
        /// The file.
        file: String,
        /// The warning.
        warning: Box<Self>,
    },
    /// Any other note of a reader.
    #[error("{0}")]
    Note(String),
}

impl Warning {
    /// Samples that were lost while recording, as far as this warning says.
    #[must_use]
    pub fn lost_samples(&self) -> u64 {
        match self {
            Self::LostSamples { samples } => *samples,
            Self::InFile { warning, .. } => warning.lost_samples(),
            _ => 0,
        }
    }

    /// Whether a part of the file is damaged.
    #[must_use]
    pub fn is_damage(&self) -> bool {
        match self {
            Self::Damaged { .. } => true,
            Self::InFile { warning, .. } => warning.is_damage(),
            _ => false,
        }
    }

    /// Warning about a column that does not become a channel because of the meaning of its numbers.
    #[must_use]
    pub fn left_aside(column: String, meaning: Meaning) -> Self {
        match meaning {
            Meaning::Time(_) => Self::SecondTime { column },
            _ => Self::ColumnWithoutUnit { column },
        }
    }

    /// Warning about a column name whose ending may mean something other than what was assumed.
    #[must_use]
    pub fn of_doubt(title: &str, column: &Column) -> Option<Self> {
        match (&column.doubt, column.meaning) {
            (Some(also), Meaning::Values(conversion)) => Some(Self::DoubtfulUnit {
                column: title.to_owned(),
                unit: conversion.unit,
                also: also.clone(),
            }),
            _ => None,
        }
    }

    /// Description of the damage in a few words; `None` if this warning is not about damage.
    pub(crate) fn damage(&self) -> Option<String> {
        match self {
            Self::Damaged { byte, bytes } => Some(format!("{bytes} bytes at byte {byte} are damaged")),
            Self::MissingSamples { written, read } => {
                Some(format!("of {written} samples that were written {read} can be read"))
            }
            Self::Incomplete { what } => Some(what.clone()),
            Self::InFile { file, warning } => warning.damage().map(|damage| format!("`{file}`: {damage}")),
            _ => None,
        }
    }
}

/// Description of the damage that the warnings report; `None` if the file is undamaged.
pub(crate) fn damage<'w>(warnings: impl IntoIterator<Item = &'w Warning>) -> Option<String> {
    let parts: Vec<String> = warnings.into_iter().filter_map(Warning::damage).collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}
