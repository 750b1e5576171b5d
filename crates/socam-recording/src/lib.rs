//! Recordings of a drivetrain bench: one [`Dataset`] type over every format, streamed, with units, times and gaps.
//!
//! * [`Dataset::open`] reads `.mcap`, `.csv` and the legacy `.m`, or a part of one (`RUN@FROM..TO`).
//! * [`Recorder`] writes an MCAP log that survives a crash, and never makes the sampling thread wait.
//! * [`Steady::open`] reads a table of steady states.
//!
//! Conventions: all values are SI, times are seconds, a missing value is a missing value (never zero), and an error is one
//! sentence that names the file, the place and the remedy. Nothing here prints.

mod beside;
mod calibration_edit;
mod calibration_file;
pub mod check;
mod convert;
mod csv_lines;
mod csv_read;
mod dataset;
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
mod segments;
mod selection;
mod settings;
mod statistics;
mod steady;
mod table;
mod unit;
mod warning;
mod welch;

pub use beside::temporary_beside;
pub use calibration_edit::{MeasuredMotor, MeasuredSensor, edit_calibration};
pub use calibration_file::{CalibratedChannel, Calibration, MotorStd, Safety, SpeedGains};
pub use convert::{export_csv, import_mcap, write_csv};
pub use dataset::{Block, Blocks, Carry, Column, Dataset, Loaded, Steps};
pub use error::{RecordingError, Result};
#[cfg(target_arch = "wasm32")]
pub use files::hand_over;
#[cfg(not(target_arch = "wasm32"))]
pub use files::{read_regular, read_text};
pub use format::{Format, detect};
pub use legacy::LegacyLog;
pub use line_problem::LineProblem;
pub use log::attachments::{Attachment, read_attachments};
pub use log::contents::{AttachmentInfo, LogContents};
pub use log::names::{
    EVENT_TOPIC, METADATA_NAME, PROFILE, RECOVERED_NAME, SAMPLE_TOPIC, STATUS_TOPIC, SUMMARY_NAME,
};
pub use log::record::{Recorder, RecordingSummary};
pub use log::recover::{Recovered, recover};
pub use log::sample::{Event, SampleRow, Status};
pub use log::writer::RecordingHeader;
pub use output_file::OutputFile;
pub use profile_file::{Course, ProfileFile};
pub use segments::{GAP_STEPS, Segment};
pub use selection::{Selection, Span};
pub use settings::SettingsError;
pub use statistics::Statistics;
pub use steady::{Steady, SteadyRow};
pub use unit::{Channel, Unit};
pub use warning::{Cut, Warning};
pub use welch::{Welch, without_mean};
