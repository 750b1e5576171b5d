//! Logs of the thesis' program *Simple*: a `.m` file with the settings of the run and five columns in volts.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use socam_core::scaling::Sensor;

use crate::calibration_file::Calibration;
use crate::error::{RecordingError, Result, excerpt};
use crate::files;
use crate::line_problem::LineProblem;
use crate::table::Table;
use crate::{Channel, Unit};

/// Columns of the program's log: four inputs, then the command.
const COLUMNS: usize = 5;

/// A log as written, all in volts.
#[derive(Debug, Clone, PartialEq)]
pub struct LegacyLog {
    /// `samprate`: the step between rows, s (despite its name; a value above 1 is taken as a rate in Hz).
    pub sample_time_s: f64,
    /// `amplitude` of the commanded sine, V.
    pub amplitude_v: Option<f64>,
    /// `frequency` of the commanded sine, Hz.
    pub frequency_hz: Option<f64>,
    /// `offset` of the command, V.
    pub offset_v: Option<f64>,
    /// Rows of inputs 0 to 3 and the command, V.
    pub rows_v: Vec<[f64; COLUMNS]>,
}

/// Inputs of the program's converter.
pub(crate) const INPUTS: usize = COLUMNS - 1;

/// The channel of each input, in order; further inputs are ignored. The program's log does not say which sensor was connected to
/// which input.
///
/// The default takes input 0 as the input tachometer and input 1 as the output tachometer. The thesis' sensitivities of the torque
/// sensors are contradictory (see [`Sensor::TORQUE_IN`]), so inputs 2 and 3 stay in volts until a calibration is given.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wiring(Vec<(Channel, Sensor)>);

impl Default for Wiring {
    fn default() -> Self {
        let volts = Sensor { volts_per_unit: 1.0, offset_v: 0.0 };
        Self(vec![
            (Channel::new("motor_speed", Unit::RadPerS), Sensor::MOTOR_SPEED),
            (Channel::new("output_speed", Unit::RadPerS), Sensor::OUTPUT_SPEED),
            (Channel::new("torque_in", Unit::V), volts),
            (Channel::new("torque_out", Unit::V), volts),
        ])
    }
}

impl From<&Calibration> for Wiring {
    fn from(calibration: &Calibration) -> Self {
        Self(calibration.channels.iter().map(|input| (input.channel.clone(), input.sensor)).collect())
    }
}

impl LegacyLog {
    /// Reads a log, `data=[...]` or `data={...}`. The program never logged more than 10 000 rows, so all are kept in memory.
    ///
    /// ```
    /// use socam_recording::LegacyLog;
    ///
    /// # let folder = tempfile::tempdir().unwrap();
    /// # let path = folder.path().join("run.m");
    /// std::fs::write(&path, "samprate=0.01;\namplitude=1.5;\ndata=[\n0.1 0.2 0.3 0.4 1.5\n0.1 0.2 0.3 0.4 1.5\n];\n").unwrap();
    /// let log = LegacyLog::read(&path)?;
    /// assert_eq!((log.sample_time_s, log.amplitude_v, log.rows_v.len()), (0.01, Some(1.5), 2));
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the file cannot be read, a setting or row is not made of numbers, or `samprate` or the data are missing.
    pub fn read(path: &Path) -> Result<Self> {
        let read = || -> io::Result<Vec<u8>> {
            let mut bytes = Vec::new();
            files::open(path)?.0.read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        let bytes = read().map_err(|e| RecordingError::io(path, "read", e))?;
        let mut parser = Parser {
            path: path.into(),
            line: 0,
            settings: [None; 4],
            state: State::Settings,
            rows_v: Vec::new(),
        };
        for line in bytes.split(|b| *b == b'\n') {
            parser.line += 1;
            parser.take(line)?;
        }
        parser.finish()
    }

    /// Channels and values, times counted from 0 in steps of the sample time.
    pub(crate) fn into_table(self, wiring: &Wiring) -> (Vec<Channel>, Table) {
        let mut channels = vec![Channel::new("command", Unit::V)];
        let mut columns = vec![self.rows_v.iter().map(|row| row[INPUTS]).collect::<Vec<_>>()];
        for (index, (channel, sensor)) in wiring.0.iter().take(INPUTS).enumerate() {
            channels.push(channel.clone());
            columns.push(self.rows_v.iter().map(|row| sensor.value(row[index])).collect());
        }
        let time_s = (0..self.rows_v.len()).map(|row| row as f64 * self.sample_time_s).collect();
        (channels, Table { time_s, columns })
    }
}

const SETTINGS: [&str; 4] = ["samprate", "amplitude", "frequency", "offset"];

#[derive(Clone, Copy, PartialEq)]
enum State {
    Settings,
    Data,
    Done,
}

struct Parser {
    path: PathBuf,
    line: u64,
    settings: [Option<f64>; 4],
    state: State,
    rows_v: Vec<[f64; COLUMNS]>,
}

impl Parser {
    fn take(&mut self, line: &[u8]) -> Result<()> {
        let Ok(text) = std::str::from_utf8(line) else {
            return Err(RecordingError::line(&self.path, self.line, LineProblem::NotText));
        };
        let text = text.split('%').next().unwrap_or_default().trim();
        if text.is_empty() {
            return Ok(());
        }
        match self.state {
            State::Settings => self.setting(text),
            State::Data => self.data(text),
            State::Done => self.unexpected(text, "nothing after the data's closing bracket"),
        }
    }

    fn setting(&mut self, text: &str) -> Result<()> {
        let expected = "`samprate=`, `amplitude=`, `frequency=`, `offset=` or `data=[`";
        let Some((name, value)) = text.split_once('=') else {
            return self.unexpected(text, expected);
        };
        let value = value.trim();
        if name.trim() == "data" {
            let Some(rest) = value.strip_prefix(['[', '{']) else {
                return self.unexpected(text, "`data=[` or `data={`");
            };
            self.state = State::Data;
            return self.data(rest);
        }
        let Some(index) = SETTINGS.iter().position(|setting| *setting == name.trim()) else {
            return self.unexpected(text, expected);
        };
        match finite(value.trim_end_matches(';')) {
            Some(value) => self.settings[index] = Some(value),
            None => return self.unexpected(text, "a finite number after `=`"),
        }
        Ok(())
    }

    fn data(&mut self, text: &str) -> Result<()> {
        let (rows, closed) = match text.find([']', '}']) {
            Some(end) => (&text[..end], true),
            None => (text, false),
        };
        for row in rows.split(';').filter(|row| !row.trim().is_empty()) {
            let values: Option<Vec<f64>> = row
                .split(|c: char| c.is_whitespace() || c == ',')
                .filter(|cell| !cell.is_empty())
                .map(finite)
                .collect();
            match values.and_then(|values| values.try_into().ok()) {
                Some(row_v) => self.rows_v.push(row_v),
                None => {
                    return self.unexpected(row, "five finite numbers: four inputs and the command, V");
                }
            }
        }
        if closed {
            self.state = State::Done;
        }
        Ok(())
    }

    fn finish(self) -> Result<LegacyLog> {
        if self.state != State::Done {
            return self
                .unexpected("the end of the file", "the data's closing `];` or `};` (the log is cut off)");
        }
        let [samprate, amplitude_v, frequency_hz, offset_v] = self.settings;
        let sample_time_s = match samprate {
            Some(step_s) if step_s > 0.0 && step_s <= 1.0 => step_s,
            Some(rate_hz) if rate_hz > 1.0 => 1.0 / rate_hz,
            _ => {
                return self.unexpected("no such line", "`samprate=` with the step in seconds, above 0");
            }
        };
        Ok(LegacyLog { sample_time_s, amplitude_v, frequency_hz, offset_v, rows_v: self.rows_v })
    }

    fn unexpected<T>(&self, found: &str, expected: &'static str) -> Result<T> {
        let problem = LineProblem::Unexpected { found: excerpt(found.as_bytes()), expected };
        Err(RecordingError::line(&self.path, self.line, problem))
    }
}

fn finite(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log() -> LegacyLog {
        let rows_v = vec![[6.9, 1.93, 0.5, -1.0, 1.2]];
        LegacyLog { sample_time_s: 0.01, amplitude_v: None, frequency_hz: None, offset_v: None, rows_v }
    }

    #[test]
    fn volts_become_si_by_the_thesis_and_torques_by_a_calibration() {
        let (channels, table) = log().into_table(&Wiring::default());
        let names: Vec<_> = channels.iter().map(Channel::column_name).collect();
        assert_eq!(
            names,
            ["command_V", "motor_speed_rad_s", "output_speed_rad_s", "torque_in_V", "torque_out_V"]
        );
        let krpm = 1000.0 * std::f64::consts::TAU / 60.0;
        let expected = [1.2, krpm, 0.1 * krpm, 0.5, -1.0];
        assert!(table.columns.iter().zip(expected).all(|(c, v)| (c[0] - v).abs() < 1e-9), "{table:?}");

        let mut calibration = Calibration::default();
        calibration.channels[2].sensor.offset_v = 0.1;
        let (channels, table) = log().into_table(&Wiring::from(&calibration));
        assert_eq!(channels[3].column_name(), "torque_in_Nm");
        assert!((table.columns[3][0] - 0.2).abs() < 1e-12);
        assert!((table.columns[4][0] + 4.0).abs() < 1e-12);

        calibration.channels.truncate(1);
        assert_eq!(log().into_table(&Wiring::from(&calibration)).0.len(), 2);
    }
}
