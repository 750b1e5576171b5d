//! Recordings of a drivetrain bench: one [`Dataset`] type over every format, streamed, with units, times and gaps.
//!
//! * [`Dataset::open`] reads `.mcap`, `.csv` and the legacy `.m`, a part of one (`RUN@FROM..TO`), or several that follow one another.
//! * [`Recorder`] writes an MCAP log that survives a crash, and never makes the sampling thread wait.
//! * [`check`](fn@check::check) says whether a recording is fit for identification.
//! * [`Steady::open`] reads a table of steady states.
//! * [`ProfileFile`] and [`Calibration`] are the files that a bench needs: what to command, and how volts become SI.
//!
//! Values are SI and times are in seconds. A missing value is NaN in a column and `None` elsewhere, never zero. An error is one sentence
//! that names the file, the place and the remedy.
//!
//! ```
//! use socam_recording::{Channel, Dataset, Unit, check};
//!
//! // 2 s at 1 kHz, with one sample lost.
//! let time_s: Vec<f64> = (0..2000).filter(|k| *k != 700).map(|k| 1e-3 * f64::from(k)).collect();
//! let wave = |hz: f64| time_s.iter().map(|t| (std::f64::consts::TAU * hz * t).sin()).collect::<Vec<f64>>();
//! let channels = vec![Channel::new("motor_speed", Unit::RadPerS), Channel::new("torque", Unit::Nm)];
//! let columns = vec![wave(3.0), wave(5.0)];
//! let recording = Dataset::from_columns("run", channels, time_s, columns)?;
//! assert_eq!((recording.rows(), recording.segments().len()), (1999, 2));
//!
//! let found = check::check(&recording, &check::CheckOptions::default())?;
//! assert!(found.findings.iter().any(|finding| matches!(finding, check::Finding::Gaps { .. })));
//! # Ok::<(), socam_recording::RecordingError>(())
//! ```

mod beside;
mod calibration_file;
mod cell;
mod channel;
pub mod check;
mod checksum;
mod clock_time;
pub mod clocks;
mod convert;
mod csv_lines;
mod csv_read;
mod dataset;
mod disk;
mod error;
mod files;
mod format;
mod legacy;
mod line_problem;
mod log;
mod output_file;
mod part;
mod profile_file;
mod rows;
mod run_names;
mod segments;
mod selection;
mod settings;
mod statistics;
mod steady;
mod table;
mod warning;

pub use beside::temporary_beside;
pub use calibration_file::{CalibratedChannel, Calibration, MotorStd, Safety, SpeedGains, Winding};
pub use channel::Channel;
pub use checksum::{sha256, sha256_of_file};
pub use clock_time::Epoch;
pub use convert::{export_csv, import_mcap, write_csv};
pub use dataset::{Block, Blocks, Carry, Column, Dataset, Loaded, Shared, Steps};
pub use error::{RecordingError, Result};
#[cfg(target_arch = "wasm32")]
pub use files::hand_over;
pub use files::{read_regular, read_text};
pub use format::{Format, detect};
pub use legacy::LegacyLog;
pub use line_problem::LineProblem;
pub use log::attachments::{Attachment, read_attachments};
pub use log::contents::{AttachmentInfo, LogContents};
pub use log::names::{
    EVENT_TOPIC, MACHINE_KEY, METADATA_NAME, PROFILE, RECOVERED_NAME, SAMPLE_TOPIC, STATUS_TOPIC,
    SUMMARY_NAME,
};
pub use log::parse::record as parse_log_record;
pub use log::record::{Recorder, RecordingSummary};
pub use log::recover::{Recovered, recover};
pub use log::sample::{Event, SampleRow, Status};
pub use log::writer::RecordingHeader;
pub use output_file::OutputFile;
pub use profile_file::{ProfileCommand, ProfileFile, Waveform};
pub use run_names::expand;
pub use segments::{GAP_STEPS, Segment};
pub use selection::{Selection, Span, named_part, without_part};
pub use settings::{Fields, SettingsError, read as read_settings};
pub use socam_units::Unit;
pub use statistics::Statistics;
pub use steady::{Steady, SteadyRow};
pub use warning::{Cut, Warning};
