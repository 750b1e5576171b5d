//! Opens datasets: from files of every format, and from columns in memory.

use std::sync::Arc;

use super::data::Dataset;
use super::keep::{Keeping, Memory};
use super::source::Source;
use super::tally::Tally;
use crate::calibration_file::Calibration;
use crate::clock_time::Epoch;
use crate::error::{RecordingError, Result};
use crate::format::{self, Format};
use crate::selection::{Selection, Span};
use crate::statistics::Running;
use crate::table::Table;
use crate::{Channel, legacy};

impl Dataset {
    /// Opens `RUN` or `RUN@FROM..TO`, see [`Selection::parse`], of any format (detected by its content, not its extension).
    ///
    /// ```
    /// use socam_recording::Dataset;
    ///
    /// # let folder = tempfile::tempdir().unwrap();
    /// # let path = folder.path().join("run.csv");
    /// # let path = path.display();
    /// std::fs::write(path.to_string(), "t_s,speed_rad_s\n0,1.5\n0.1,\n0.2,1.7\n").unwrap();
    /// let data = Dataset::open(&format!("{path}@0..0.15"))?;
    /// assert_eq!((data.rows(), data.channels()[0].name.as_str()), (2, "speed"));
    /// assert_eq!(data.load(&["speed"])?.columns[0].get(1), None);
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the file cannot be read or does not hold a usable recording; each error is one sentence with the place.
    pub fn open(text: &str) -> Result<Self> {
        Self::open_selection(&Selection::parse(text)?)
    }

    /// Opens the selected part of a recording.
    ///
    /// ```
    /// use socam_recording::{Dataset, Selection};
    ///
    /// let absent = Dataset::open_selection(&Selection::whole("absent.csv")).unwrap_err();
    /// assert!(absent.to_string().contains("there is no such file"));
    /// ```
    ///
    /// # Errors
    /// The errors of [`Dataset::open`].
    pub fn open_selection(selection: &Selection) -> Result<Self> {
        Self::open_by(selection, |part| Self::open_wired(part, &legacy::Wiring::default()))
    }

    /// Opens the selected part of a legacy log and converts its volts to SI by a calibration, whose first channel is input 0.
    ///
    /// ```
    /// use socam_recording::{Calibration, Dataset, Selection};
    ///
    /// # let folder = tempfile::tempdir().unwrap();
    /// # let path = folder.path().join("run.csv");
    /// std::fs::write(&path, "t_s,speed_rad_s\n0,1.5\n0.1,1.6\n").unwrap();
    /// let refused = Dataset::open_calibrated(&Selection::whole(path), &Calibration::default()).unwrap_err();
    /// assert!(refused.to_string().contains("in SI already"));
    /// ```
    ///
    /// # Errors
    /// As [`Dataset::open`]; also when it is no legacy log (only those are in volts), or the calibration has more channels
    /// than the log has inputs.
    pub fn open_calibrated(selection: &Selection, calibration: &Calibration) -> Result<Self> {
        Self::open_by(selection, |part| Self::open_volts(part, calibration))
    }

    fn open_volts(selection: &Selection, calibration: &Calibration) -> Result<Self> {
        let path = &selection.path;
        if format::detect(path)? != Format::LegacyM {
            return Err(RecordingError::NothingToCalibrate { path: path.clone() });
        }
        let channels = calibration.channels.len();
        if channels > legacy::INPUTS {
            let inputs = legacy::INPUTS;
            return Err(RecordingError::TooManyInputs { path: path.clone(), channels, inputs });
        }
        Self::open_wired(selection, &calibration.into())
    }

    fn open_wired(selection: &Selection, wiring: &legacy::Wiring) -> Result<Self> {
        let path = &selection.path;
        match format::detect(path)? {
            Format::SteadyStates => Err(RecordingError::SteadyStates { path: path.clone() }),
            Format::LegacyM => {
                let log = legacy::LegacyLog::read(path)?;
                let (channels, table) = log.into_table(wiring);
                let mut dataset = Self::from_table(selection.name(), channels, table, selection)?;
                dataset.format = Format::LegacyM;
                Ok(dataset)
            }
            format @ (Format::Csv | Format::Mcap | Format::Memory) => {
                Self::scan(selection, format, Keeping::with_columns)
            }
        }
    }

    /// A dataset from columns in memory (NaN for a missing value), for simulations and tests.
    ///
    /// ```
    /// use socam_recording::{Channel, Dataset, Unit};
    ///
    /// let torque = || vec![Channel::new("torque", Unit::Nm)];
    /// let data = Dataset::from_columns("run", torque(), vec![0.0, 0.1], vec![vec![1.0, f64::NAN]])?;
    /// assert_eq!(data.statistics()[0].missing, 1);
    /// assert!(Dataset::from_columns("run", torque(), vec![0.1, 0.1], vec![vec![1.0, 2.0]]).is_err());
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When lengths differ, times do not increase strictly or are not finite, a value is infinite, or there is no row.
    pub fn from_columns(
        name: impl Into<String>,
        channels: Vec<Channel>,
        time_s: Vec<f64>,
        columns: Vec<Vec<f64>>,
    ) -> Result<Self> {
        Self::from_columns_within(&Selection::whole(name.into()), channels, time_s, columns)
    }

    /// The selected part of columns in memory.
    ///
    /// # Errors
    /// The errors of [`Dataset::from_columns`], and an error when no row is selected.
    pub fn from_columns_within(
        selection: &Selection,
        channels: Vec<Channel>,
        time_s: Vec<f64>,
        columns: Vec<Vec<f64>>,
    ) -> Result<Self> {
        let name = selection.name();
        let problem = |problem: String| Err(RecordingError::Table { name: name.clone(), problem });
        if channels.len() != columns.len() {
            return problem(format!("{} columns for {} channels", columns.len(), channels.len()));
        }
        if time_s.is_empty() {
            return problem("it has no row; give at least one".into());
        }
        for (channel, column) in channels.iter().zip(&columns) {
            if column.len() != time_s.len() {
                return problem(format!(
                    "channel `{}` has {} values for {} times",
                    channel.name,
                    column.len(),
                    time_s.len()
                ));
            }
            if column.iter().any(|value| value.is_infinite()) {
                return problem(format!("channel `{}` holds an infinity", channel.name));
            }
        }
        Self::from_table(name, channels, Table { time_s, columns }, selection)
    }

    /// A dataset of the selected part of a table in memory.
    ///
    /// # Errors
    /// [`RecordingError::Table`] when a time is not finite or does not increase; [`RecordingError::NoSamples`] when no row is selected.
    pub(super) fn from_table(
        name: String,
        channels: Vec<Channel>,
        mut table: Table,
        selection: &Selection,
    ) -> Result<Self> {
        check_times(&name, &table.time_s)?;
        table.retain_span(selection.span);
        let mut tally = Tally::new(channels.len());
        tally.append(&table);
        let (segments, sample_time_s) = tally.finder.finish();
        if segments.is_empty() {
            return Err(RecordingError::NoSamples {
                path: selection.path.clone(),
                is_whole: selection.span == Span::ALL,
            });
        }
        let epoch = Epoch::of_times(segments[0].start_s);
        Ok(Self {
            name,
            format: Format::Memory,
            channels,
            statistics: tally.running.into_iter().map(Running::finish).collect(),
            segments,
            sample_time_s,
            rows: table.rows() as u64,
            parts: 1,
            uneven: false,
            lost_samples: 0,
            cut: None,
            epoch,
            contents: None,
            warnings: Vec::new(),
            source: Source::Memory(Arc::new(Memory::existing(table))),
        })
    }
}

/// Refuses times that are not finite or do not increase from row to row. Rows count from 0.
fn check_times(name: &str, time_s: &[f64]) -> Result<()> {
    let problem = |problem: String| Err(RecordingError::Table { name: name.to_owned(), problem });
    if let Some(row) = time_s.iter().position(|time| !time.is_finite()) {
        return problem(format!("the time of row {row} is {} s; times must be finite", time_s[row]));
    }
    match time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(row) => problem(format!(
            "time goes from {} s to {} s at row {}; it must increase from row to row",
            time_s[row],
            time_s[row + 1],
            row + 1
        )),
        None => Ok(()),
    }
}
