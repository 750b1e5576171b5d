//! An ODrive by its protocol of text over USB or a serial line. It is asked for each sample.

use std::f64::consts::TAU;

use socam_recording::Channel;
use socam_units::Unit;

use crate::asking::Asking;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::error::Result;
use crate::text::lines::Lines;

/// Names of the measured current by the version of the firmware: 0.5, then 0.6.
const CURRENTS: [&str; 2] = ["motor.current_control.Iq_measured", "motor.foc.Iq_measured"];
/// Answers to one question: position and speed, current, voltage, error.
const ANSWERS: usize = 4;

/// A drive that is asked; it is never commanded.
#[derive(Debug)]
pub struct Odrive {
    axis: u8,
    channels: Vec<Channel>,
    current: usize,
    question: Vec<u8>,
    asking: Asking,
    lines: Lines,
    /// Answers to the present question.
    answers: Vec<Answer>,
    error: f64,
}

/// A line of an ODrive.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Answer {
    Pair(f64, f64),
    One(f64),
    /// It does not know what it was asked for.
    Unknown,
}

impl Answer {
    fn of(line: &str) -> Option<Self> {
        if line.trim_start().starts_with("invalid") || line.trim_start().starts_with("unknown") {
            return Some(Self::Unknown);
        }
        let mut words = line.split_whitespace().map(str::parse::<f64>);
        let first = words.next()?.ok().filter(|number| number.is_finite())?;
        match (words.next(), words.next()) {
            (None, _) => Some(Self::One(first)),
            (Some(Ok(second)), None) if second.is_finite() => Some(Self::Pair(first, second)),
            _ => None,
        }
    }

    fn one(self) -> Option<f64> {
        if let Self::One(number) = self { Some(number) } else { None }
    }
}

impl Odrive {
    /// An axis (0 or 1) of a drive, asked at this interval.
    ///
    /// # Errors
    /// When no drive has this axis.
    pub fn new(axis: u8, period_ns: i64) -> Result<Self> {
        if axis > 1 {
            let problem =
                format!("{axis} is no axis of an ODrive; expected 0 or 1, as in odrive:/dev/ttyACM0?axis=0");
            return Err(crate::SourceError::Foreign(problem));
        }
        let channels = [
            ("position", Unit::Rad),
            ("speed", Unit::RadPerS),
            ("current", Unit::A),
            ("voltage", Unit::V),
            ("error", Unit::One),
        ];
        Ok(Self {
            axis,
            channels: channels.iter().map(|(name, unit)| Channel::new(*name, *unit)).collect(),
            current: 0,
            question: question(axis, 0),
            asking: Asking::new(period_ns),
            lines: Lines::answers(),
            answers: Vec::new(),
            error: 0.0,
        })
    }

    fn row(&mut self) -> Result<Vec<f64>, &'static str> {
        let answers = std::mem::take(&mut self.answers);
        let [Answer::Pair(turns, turns_s), current, voltage, error] = answers[..] else {
            return Err("answers came in another order");
        };
        if current == Answer::Unknown {
            // A firmware of the other generation.
            self.current = 1 - self.current;
            self.question = question(self.axis, self.current);
        }
        let (Some(voltage), Some(error)) = (voltage.one(), error.one()) else {
            return Err("answers came in another order");
        };
        Ok(vec![turns * TAU, turns_s * TAU, current.one().unwrap_or(f64::NAN), voltage, error])
    }
}

/// The lines that ask for everything; a drive answers each by a line.
fn question(axis: u8, current: usize) -> Vec<u8> {
    let current = CURRENTS[current];
    format!("f {axis}\nr axis{axis}.{current}\nr vbus_voltage\nr axis{axis}.error\n").into_bytes()
}

impl Device for Odrive {
    fn kind(&self) -> String {
        format!("axis {} of an ODrive, which is only asked", self.axis)
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        Numbering::Arrival
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        self.asking.take_missing(heard);
        let mut lines = std::mem::take(&mut self.lines);
        lines.push(chunk, |line, arrival_ns| {
            let Some(answer) = line.ok().and_then(Answer::of) else {
                self.answers.clear();
                heard.push(Heard::Damaged("a line is no answer of an ODrive"));
                return;
            };
            // A pair begins the answers to a question; what came before it belongs to another.
            if matches!(answer, Answer::Pair(..)) {
                self.answers.clear();
            }
            self.answers.push(answer);
            if self.answers.len() < ANSWERS {
                return;
            }
            match self.row() {
                Ok(values) => {
                    if values[4] != self.error {
                        self.error = values[4];
                        heard
                            .push(Heard::Fault(format!("the ODrive reports error {:#x}", self.error as u64)));
                    }
                    heard.push(self.asking.answered(arrival_ns, values));
                }
                Err(problem) => heard.push(Heard::Damaged(problem)),
            }
        });
        self.lines = lines;
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        let was_asked = out.len();
        let next_ns = self.asking.poll(now_ns, &self.question, out);
        if out.len() > was_asked {
            self.answers.clear();
        }
        Ok(Some(next_ns))
    }

    fn awaits(&self) -> bool {
        self.asking.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        if self.lines.interrupt() {
            heard.push(Heard::Damaged("the link broke within it"));
        }
        self.answers.clear();
        self.asking.forget();
    }
}
