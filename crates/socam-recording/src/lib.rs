//! Recordings of a drivetrain bench: one [`Dataset`] type over every format, streamed, with units, times and gaps.
//!
//! * [`Dataset::open`] reads `.mcap`, `.csv` and the legacy `.m`, or a part of one (`RUN@FROM..TO`).
//! * [`Steady::open`] reads a table of steady states.
//!
//! Conventions: all values are SI, times are seconds, a missing value is a missing value (never zero), and an error is one
//! sentence that names the file, the place and the remedy. Nothing here prints.

mod csv_read;
mod dataset;
mod error;
mod format;
mod legacy;
mod segments;
mod selection;
mod statistics;
mod steady;
mod unit;

pub use dataset::{Block, Blocks, Column, Cut, Dataset, Loaded, Warning};
pub use error::{LineProblem, RecordingError, Result};
pub use format::{Format, detect};
pub use legacy::{LegacyCalibration, LegacyInput, LegacyLog};
pub use segments::{GAP_STEPS, Segment};
pub use selection::{Selection, Span};
pub use statistics::Statistics;
pub use steady::{Steady, SteadyRow};
pub use unit::{Channel, Unit};
