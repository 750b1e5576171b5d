//! An ODrive by its protocol of text over USB or a serial line. It is asked for each sample, and commanded by [`crate::Commanded`] alone.

mod settings;

use std::f64::consts::TAU;

use socam_recording::Channel;
use socam_units::Unit;

use crate::asking::Asking;
use crate::device::{Chunk, Device, Heard, Numbering};
use crate::drive::{Drive, Limits, Order, Readiness, Standing, Watched};
use crate::error::Result;
use crate::text::lines::Lines;
pub(crate) use settings::Generation;
use settings::Settings;

/// Answers to one question: position and speed, current, voltage, error.
const ANSWERS: usize = 4;
/// States of an axis: idle, and obeying.
const IDLE: f64 = 1.0;
const CLOSED_LOOP: f64 = 8.0;

/// A drive that is asked. As a [`Drive`] it obeys orders.
#[derive(Debug)]
pub struct Odrive {
    axis: u8,
    channels: Vec<Channel>,
    generation: Generation,
    question: Vec<u8>,
    asking: Asking,
    lines: Lines,
    /// Answers to the present question.
    answers: Vec<Answer>,
    error: f64,
    /// Present order, and the state of the axis where it was asked for.
    order: Order,
    state: Option<f64>,
    /// Whether a speed or torque has left already.
    is_begun: bool,
    /// Settings of a run that commands it.
    settings: Option<Settings>,
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
        let mut drive = Self {
            axis,
            channels: channels.iter().map(|(name, unit)| Channel::new(*name, *unit)).collect(),
            generation: Generation::Early,
            question: Vec::new(),
            asking: Asking::new(period_ns),
            lines: Lines::answers(),
            answers: Vec::new(),
            error: 0.0,
            order: Order::Ask,
            state: None,
            is_begun: false,
            settings: None,
        };
        drive.question = drive.bytes(Order::Ask);
        Ok(drive)
    }

    /// Number of answers to the present question.
    fn expected(&self) -> usize {
        ANSWERS + self.more().len()
    }

    /// What is asked for beside a sample.
    fn more(&self) -> Vec<String> {
        self.settings.as_ref().map_or_else(Vec::new, |settings| settings.asked(self.axis, self.generation))
    }

    /// The command is set before the axis obeys, which is requested once: an axis that switches itself off stays off.
    fn request(&self) -> String {
        let axis = self.axis;
        if self.is_begun { String::new() } else { format!("w axis{axis}.requested_state {CLOSED_LOOP}\n") }
    }

    fn row(&mut self) -> Result<Vec<f64>, &'static str> {
        let answers = std::mem::take(&mut self.answers);
        let [Answer::Pair(turns, turns_s), current, voltage, error, more @ ..] = &answers[..] else {
            return Err("answers came in another order");
        };
        let Some(voltage) = voltage.one() else {
            return Err("answers came in another order");
        };
        if *current == Answer::Unknown {
            // A firmware of the other generation.
            self.generation = self.generation.other();
        } else if let Some(settings) = &mut self.settings {
            let more: Vec<Option<f64>> = more.iter().map(|answer| answer.one()).collect();
            self.state = more.first().copied().flatten();
            settings.heard(more.get(1..).unwrap_or_default());
        }
        self.question = self.bytes(self.order);
        let [current, error] = [current, error].map(|answer| answer.one().unwrap_or(f64::NAN));
        Ok(vec![turns * TAU, turns_s * TAU, current, voltage, error])
    }
}

impl Drive for Odrive {
    fn watched(&self) -> Watched {
        // Positions of an ODrive may begin anew after a turn.
        Watched { speed: 1, effort: 2, position: None }
    }

    fn limit(&mut self, limits: Limits) {
        self.settings = Some(Settings::new(limits));
        self.question = self.bytes(self.order);
    }

    fn order(&mut self, order: Order) {
        self.order = order;
        self.question = self.bytes(order);
    }

    /// The lines of an order, and those that ask; a drive answers each of the latter by a line.
    fn bytes(&self, order: Order) -> Vec<u8> {
        let axis = self.axis;
        let mut lines = match (order, &self.settings) {
            (Order::Speed(speed_rad_s), Some(_)) => {
                format!("v {axis} {:.6} 0\nu {axis}\n{}", speed_rad_s / TAU, self.request())
            }
            (Order::Torque(torque_nm), Some(_)) => {
                format!("c {axis} {torque_nm:.6}\nu {axis}\n{}", self.request())
            }
            (Order::Stop, _) => format!("w axis{axis}.requested_state {IDLE}\n"),
            (Order::Prepare, Some(settings)) => settings.writes(axis, self.generation),
            (Order::Release, Some(settings)) => settings.undo(axis, self.generation),
            (Order::Ask | Order::Speed(_) | Order::Torque(_) | Order::Prepare | Order::Release, _) => {
                String::new()
            }
        };
        let [current, error] = [self.generation.current(), self.generation.error()];
        lines.push_str(&format!("f {axis}\nr axis{axis}.{current}\nr vbus_voltage\nr axis{axis}.{error}\n"));
        for name in self.more() {
            lines.push_str(&format!("r {name}\n"));
        }
        lines.into_bytes()
    }

    fn standing(&self) -> Standing {
        if self.error != 0.0 {
            return Standing::Fault(self.generation.fault_text(self.error as u64));
        }
        match self.state {
            Some(IDLE) => Standing::Stopped,
            Some(CLOSED_LOOP) => Standing::Obeying,
            Some(state) => Standing::Other(format!("in state {state}")),
            None => Standing::Other("silent about its state".into()),
        }
    }

    fn readiness(&self) -> Readiness {
        self.settings.as_ref().map_or(Readiness::Pending, Settings::readiness)
    }

    fn promises(&self) -> [Vec<String>; 2] {
        self.settings.as_ref().map_or_else(Default::default, Settings::promises)
    }
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
            if self.answers.len() < self.expected() {
                return;
            }
            match self.row() {
                Ok(values) => {
                    let error = if values[4].is_finite() { values[4] } else { self.error };
                    if error != self.error {
                        self.error = error;
                        heard.push(Heard::Fault(self.generation.fault_text(error as u64)));
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
            self.is_begun |= matches!(self.order, Order::Speed(_) | Order::Torque(_));
        }
        Ok(Some(next_ns))
    }

    fn awaits(&self) -> bool {
        self.asking.awaits()
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        self.answers.clear();
        self.asking.interrupted(self.lines.interrupt(), heard);
    }
}
