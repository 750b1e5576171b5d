//! Errors of recordings: one clear sentence each, with the place, what was expected and what to do.

use std::path::{Path, PathBuf};

use crate::line_problem::LineProblem;

/// The result of everything here that touches a recording.
pub type Result<T, E = RecordingError> = std::result::Result<T, E>;

/// Why a recording could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The operating system refused.
    #[error("cannot {action} `{}`: {}", .path.display(), io_reason(action, .source))]
    Io {
        /// The file.
        path: PathBuf,
        /// Action that failed: `read`, `create`, `write to`, ...
        action: &'static str,
        /// The system's own answer.
        source: std::io::Error,
    },
    /// A directory was named where a recording is needed.
    #[error("`{}` is a directory; name one recording (.mcap, .csv or .m) in it", .path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// A file of no bytes.
    #[error("`{}` is empty (0 bytes); a recording was expected, so record or export it again", .path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// A file that is none of the formats read here.
    #[error("`{}` {found}; expected an .mcap log, a .csv whose header starts with `t_s`, or a legacy .m log", .path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Likely kind of the file, as a verb phrase.
        found: String,
    },
    /// A table of steady states where a time series is needed.
    #[error("`{}` holds steady states (its first column is `point_1`); this needs a recording over time (first column `t_s`)", .path.display())]
    SteadyStates {
        /// The file.
        path: PathBuf,
    },
    /// A recording over time where a table of steady states is needed.
    #[error("`{}` is not a table of steady states; expected a .csv whose first column is `point_1`", .path.display())]
    NotSteadyStates {
        /// The file.
        path: PathBuf,
    },
    /// A line of a text file that cannot be used.
    #[error("`{}`, line {line}: {problem}", .path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
        /// Problem of the line.
        problem: LineProblem,
    },
    /// A place in a binary file that cannot be used.
    #[error("`{}`, byte {byte}: {problem}", .path.display())]
    Byte {
        /// The file.
        path: PathBuf,
        /// Offset from the file's start, from 0.
        byte: u64,
        /// Explanation: what is wrong there, what was expected and what to do.
        problem: String,
    },
    /// An MCAP log that this program's recorder did not write.
    #[error("`{}` is an MCAP log without `socam.Sample` messages (its topics: {topics}); `socam-host import` reads the numbers in them", .path.display())]
    ForeignMcap {
        /// The file.
        path: PathBuf,
        /// Topics found, comma separated.
        topics: String,
    },
    /// Only part of the readable samples of a damaged log can be copied unchanged.
    #[error("{copied} of the {samples} samples of `{}` can be copied, because its description of them is damaged; export it to a .csv", .path.display())]
    NotCopied {
        /// The log.
        path: PathBuf,
        /// Samples that can be copied.
        copied: u64,
        /// Samples that can be read.
        samples: u64,
    },
    /// Nothing recorded.
    #[error("`{}` holds no samples{}", .path.display(), if *.is_whole { "; record again" } else { " in this part; widen the selection after `@` (`socam-host info` prints the first and last times)" })]
    NoSamples {
        /// The file.
        path: PathBuf,
        /// Whether all of it was asked for.
        is_whole: bool,
    },
    /// A log without a sample that can be read, because it is damaged.
    #[error("`{}` holds no sample that can be read: {damage}; copy it again from its source", .path.display())]
    AllDamaged {
        /// The file.
        path: PathBuf,
        /// Explanation of the damage.
        damage: String,
    },
    /// A header without any usable channel.
    #[error("`{}` has no channel: no numeric column ends in a unit ({}); rename its columns like `motor_speed_rad_s`", .path.display(), suffixes())]
    NoChannels {
        /// The file.
        path: PathBuf,
    },
    /// A calibration was given for a recording that is in SI.
    #[error("`{}` is in SI already; only the legacy .m logs are in volts and take a calibration", path.display())]
    NothingToCalibrate {
        /// The file.
        path: PathBuf,
    },
    /// A calibration has more channels than a legacy log has inputs.
    #[error("the calibration has {channels} channels, and `{}` only {inputs} inputs", path.display())]
    TooManyInputs {
        /// The file.
        path: PathBuf,
        /// Channels of the calibration.
        channels: usize,
        /// Inputs of the log.
        inputs: usize,
    },
    /// A channel was asked for that the recording does not have.
    #[error("`{recording}` has no channel `{channel}`; it has {available}")]
    NoSuchChannel {
        /// Name of the recording.
        recording: String,
        /// Name of the requested channel.
        channel: String,
        /// Names of the available channels, comma separated.
        available: String,
    },
    /// The part after `@` of `RUN@FROM..TO` is no span of time.
    #[error(
        "`{text}`: {problem}; write RUN@FROM..TO in seconds or clock times, such as run.csv@2..7.5 or run.csv@14:03:20..14:05"
    )]
    Selection {
        /// The whole argument.
        text: String,
        /// Explanation of what is wrong.
        problem: &'static str,
    },
    /// A wildcard, or files joined by `+`, that name no recording.
    #[error("`{text}` {problem}")]
    Pattern {
        /// The text.
        text: String,
        /// Explanation of what is wrong.
        problem: String,
    },
    /// Columns given in memory that do not form a recording.
    #[error("recording `{name}`: {problem}")]
    Table {
        /// Name of the recording.
        name: String,
        /// Explanation of what does not fit.
        problem: String,
    },
    /// An import of a file that is a recording already.
    #[error("`{}` is an MCAP log already; use it as it is, or export it", .path.display())]
    AlreadyMcap {
        /// The file.
        path: PathBuf,
    },
    /// Times that a log cannot hold.
    #[error("`{}` runs from {start_s} s to {end_s} s; a log holds times up to 8e9 s: is `t_s` really in seconds?", .path.display())]
    TimeRange {
        /// The file.
        path: PathBuf,
        /// First time, s.
        start_s: f64,
        /// Last time, s.
        end_s: f64,
    },
    /// A recording that ended without a sample.
    #[error("nothing was recorded to `{}`: not one sample arrived; check the device", .path.display())]
    NothingRecorded {
        /// The file that would have been.
        path: PathBuf,
    },
    /// A recording that is in its file, and perhaps not on the disk.
    #[error(
        "`{}` cannot be synced to the disk ({source}): a loss of power may take its samples, so copy it to another disk",
        .path.display()
    )]
    NotSynced {
        /// The file that holds the samples.
        path: PathBuf,
        /// The system's own answer.
        source: std::io::Error,
    },
    /// A recording that could not go on.
    #[error("{cause}; the recording ends after {samples} samples, which can still be read")]
    Stopped {
        /// Samples handed to the log before.
        samples: u64,
        /// Why.
        cause: Box<RecordingError>,
    },
    /// A file that changed while it was being read.
    #[error("`{}` changed while it was read (expected {expected_rows} rows, found {found_rows}); let its writer finish and try again", .path.display())]
    Changed {
        /// The file.
        path: PathBuf,
        /// Rows found when it was opened.
        expected_rows: u64,
        /// Rows found now.
        found_rows: u64,
    },
}

impl RecordingError {
    /// Whether the file is in a form of other programs, which may be imported.
    #[must_use]
    pub fn is_foreign(&self) -> bool {
        match self {
            Self::Foreign { .. } | Self::ForeignMcap { .. } | Self::NoChannels { .. } => true,
            Self::Line { problem: LineProblem::WrongHeader { .. }, .. } => true,
            Self::Line { problem: LineProblem::NotText, line, .. } => *line == 1,
            _ => false,
        }
    }

    /// Creates an error of the operating system; a folder gets an error of its own, because its remedy differs.
    pub(crate) fn io(path: &Path, action: &'static str, source: std::io::Error) -> Self {
        if source.kind() == std::io::ErrorKind::IsADirectory {
            return Self::Directory { path: path.into() };
        }
        Self::Io { path: path.into(), action, source }
    }

    /// Adds the number of samples that were recorded before the error.
    pub(crate) fn after(self, samples: u64) -> Self {
        Self::Stopped { samples, cause: Box::new(self) }
    }

    /// A bad line of a text file.
    pub(crate) fn line(path: &Path, line: u64, problem: LineProblem) -> Self {
        Self::Line { path: path.into(), line, problem }
    }
}

/// The system's error in words, with a remedy if one is known.
fn io_reason(action: &str, source: &std::io::Error) -> String {
    use std::io::ErrorKind as K;
    match source.kind() {
        K::NotFound if action == "create" => "its folder does not exist; check the path".into(),
        K::NotFound => "there is no such file; check the path".into(),
        K::PermissionDenied => "permission denied; change the file's rights or choose another place".into(),
        K::StorageFull | K::QuotaExceeded => {
            "the disk is full; free some space or choose another place".into()
        }
        K::AlreadyExists => "it exists already; choose another name or remove it first".into(),
        K::ReadOnlyFilesystem => "the file system is read-only; choose another place".into(),
        K::NotADirectory => "a part of its path is a file; check the path".into(),
        _ => source.to_string(),
    }
}

fn suffixes() -> String {
    crate::Unit::ALL.map(crate::Unit::suffix).join(" ")
}

/// Shortens what a file held to something that fits in a sentence.
pub(crate) fn excerpt(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let mut short: String =
        text.trim().chars().map(|c| if c.is_control() { '?' } else { c }).take(40).collect();
    if text.trim().chars().count() > 40 {
        short.push_str("...");
    }
    short
}
