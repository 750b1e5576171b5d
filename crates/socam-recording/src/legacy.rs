//! Logs of the thesis' program *Simple*: a `.m` file with the settings of the run and five columns in volts.

use std::path::{Path, PathBuf};

use crate::dataset::Table;
use crate::error::{LineProblem, RecordingError, Result, excerpt};
use crate::{Channel, Unit};

/// Columns of the program's log: four inputs, then the command.
const COLUMNS: usize = 5;

/// A log as it was written: all in volts.
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

/// How the four inputs become channels. The program's log does not say what was wired to which input.
///
/// The default takes input 0 as the input tachometer (6.9 V per 1000 rpm) and input 1 as the output tachometer (19.3 V per
/// 1000 rpm), after the thesis' table 2.7. Its torque sensors' sensitivities are contradictory (2.45 mV/N m and 2.44 V/N m both fail
/// against the recorded torques and the converter's range), so inputs 2 and 3 stay in volts until a calibration is given.
#[derive(Debug, Clone, PartialEq)]
pub struct LegacyCalibration {
    /// For each input: the channel it becomes, and its value at 0 V and gain per volt, both in the channel's unit.
    pub inputs: [LegacyInput; 4],
}

/// One input of the program's converter.
#[derive(Debug, Clone, PartialEq)]
pub struct LegacyInput {
    /// The channel.
    pub channel: Channel,
    /// Value at 0 V, in the channel's unit.
    pub offset: f64,
    /// Channel's unit per volt.
    pub gain_per_v: f64,
}

impl Default for LegacyCalibration {
    fn default() -> Self {
        let speed = |name: &str, v_per_krpm: f64| LegacyInput {
            channel: Channel::new(name, Unit::RadPerS),
            offset: 0.0,
            gain_per_v: 1000.0 / v_per_krpm * std::f64::consts::TAU / 60.0,
        };
        let volts =
            |name: &str| LegacyInput { channel: Channel::new(name, Unit::V), offset: 0.0, gain_per_v: 1.0 };
        Self {
            inputs: [
                speed("motor_speed", 6.9),
                speed("output_speed", 19.3),
                volts("torque_in"),
                volts("torque_out"),
            ],
        }
    }
}

impl LegacyLog {
    /// Reads a log, `data=[...]` or `data={...}`. The program never logged more than 10 000 rows, so all are held.
    ///
    /// # Errors
    /// When the file cannot be read, a setting or row is not made of numbers, or `samprate` or the data are missing.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| RecordingError::io(path, "read", e))?;
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
    pub(crate) fn into_table(self, calibration: &LegacyCalibration) -> (Vec<Channel>, Table) {
        let mut channels = vec![Channel::new("command", Unit::V)];
        let mut columns = vec![self.rows_v.iter().map(|row| row[4]).collect::<Vec<_>>()];
        for (index, input) in calibration.inputs.iter().enumerate() {
            channels.push(input.channel.clone());
            let value = |row: &[f64; COLUMNS]| input.offset + input.gain_per_v * row[index];
            columns.push(self.rows_v.iter().map(value).collect());
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
