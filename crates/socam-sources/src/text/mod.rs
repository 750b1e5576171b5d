//! Messages that a description explains: lines of text with numbers, and frames of bytes.

mod form;
mod frames;
pub(crate) mod lines;
mod probe;
mod signal;
mod unwrap;
mod value;
mod write;

use std::borrow::Cow;
use std::sync::Arc;

use socam_recording::Channel;

use crate::description::Description;
use crate::device::{Chunk, Device, Heard, Numbering, Row};
pub use form::Form;
use form::Line;
pub(crate) use form::read_form;
use frames::Frames;
pub use frames::{Checksum, Layout, Number};
pub use lines::Bounds;
use lines::Lines;
#[cfg(feature = "foxglove")]
pub(crate) use probe::conclude;
pub use probe::{Found, probe};
#[cfg(feature = "foxglove")]
pub(crate) use signal::{CLOCK_RATIO, Role, SHORTEST_S, Signal};
pub(crate) use unwrap::Unwrap;
use value::Value;

/// Most lines of talk that are handed on.
const MOST_TALK: usize = 100;

/// A device that sends lines of text.
#[derive(Debug)]
pub struct TextDevice {
    description: Description,
    form: Arc<Form>,
    channels: Vec<Channel>,
    lines: Lines,
    frames: Frames,
    /// Place of each signal in a row: the channels, then the clock, then the number.
    signals: Vec<String>,
    /// One value per signal, for lines that hold one signal each.
    pending: Pending,
    unwraps: Vec<Unwrap>,
    talk: usize,
}

/// When a line arrived, and how exactly that is known.
#[derive(Debug, Clone, Copy, Default)]
struct Arrival {
    at_ns: i64,
    spread_ns: i64,
}

/// A row of which some lines have arrived.
#[derive(Debug, Default)]
struct Pending {
    values: Vec<Option<Value>>,
    at: Arrival,
    is_begun: bool,
}

impl TextDevice {
    /// A device that sends what a description says, over a link with these bounds of lines.
    #[must_use]
    pub fn new(description: Description, bounds: Bounds) -> Self {
        let mut signals: Vec<String> =
            description.channels.iter().map(|channel| channel.signal.clone()).collect();
        signals.extend(description.clock.iter().map(|clock| clock.signal.clone()));
        signals.extend(description.number.iter().map(|number| number.0.clone()));
        Self {
            form: Arc::new(description.form.clone()),
            channels: description.channels(),
            lines: Lines::new(bounds),
            frames: Frames::default(),
            pending: Pending { values: vec![None; signals.len()], ..Pending::default() },
            unwraps: vec![Unwrap::default(); description.channels.len()],
            signals,
            description,
            talk: 0,
        }
    }

    /// Range of the device's clock, s.
    #[must_use]
    pub fn clock_wrap_s(&self) -> Option<f64> {
        let clock = self.description.clock.as_ref()?;
        Some(clock.wrap? * clock.unit_s)
    }

    fn line(&mut self, line: Result<&str, &'static str>, at: Arrival, heard: &mut Vec<Heard>) {
        let form = Arc::clone(&self.form);
        let read = line.and_then(|line| Ok((line, form.read(line)?)));
        match read {
            Ok((_, Line::Values(values))) => self.take(&values, at, heard),
            Ok((line, Line::Talk)) => {
                self.talk += 1;
                if self.talk <= MOST_TALK {
                    heard.push(Heard::Talk(line.chars().take(200).collect()));
                }
            }
            Ok((_, Line::Header)) => {}
            Err(problem) => {
                self.pending.forget();
                heard.push(Heard::Damaged(problem));
            }
        }
    }

    fn receive_frames(&mut self, chunk: Chunk<'_>, layout: &Layout, heard: &mut Vec<Heard>) {
        let spread_ns = chunk.until_ns - chunk.from_ns;
        for (index, byte) in chunk.bytes.iter().enumerate() {
            match self.frames.push(*byte, layout) {
                None => {}
                Some(Err(problem)) => heard.push(Heard::Damaged(problem)),
                Some(Ok(values)) => {
                    let at = Arrival { at_ns: chunk.arrival_ns(index), spread_ns };
                    let values: Vec<_> =
                        values.into_iter().map(|(name, value)| (Cow::Owned(name), value)).collect();
                    self.take(&values, at, heard);
                }
            }
        }
    }

    /// Takes the values of a line: a row, or a part of one where each signal has a line of its own.
    fn take(&mut self, values: &[(Cow<'_, str>, Value)], at: Arrival, heard: &mut Vec<Heard>) {
        let place = |name: &str| self.signals.iter().position(|signal| signal == name);
        let known: Vec<(usize, Value)> =
            values.iter().filter_map(|(name, value)| Some((place(name)?, *value))).collect();
        if known.is_empty() {
            return;
        }
        // A signal that comes again begins the next row.
        if known.iter().any(|(place, _)| self.pending.values[*place].is_some()) {
            self.emit(heard);
        }
        if !self.pending.is_begun {
            self.pending.is_begun = true;
            self.pending.at = at;
        }
        for (place, value) in known {
            self.pending.values[place] = Some(value);
        }
        if values.len() > 1
            || matches!(*self.form, Form::Frames(_))
            || self.pending.values.iter().all(Option::is_some)
        {
            self.emit(heard);
        }
    }

    fn emit(&mut self, heard: &mut Vec<Heard>) {
        let at = self.pending.at;
        let values = std::mem::replace(&mut self.pending.values, vec![None; self.signals.len()]);
        self.pending.is_begun = false;
        match self.row(&values, at) {
            Ok(row) => heard.push(Heard::Row(row)),
            Err(problem) => heard.push(Heard::Damaged(problem)),
        }
    }

    fn row(&mut self, values: &[Option<Value>], at: Arrival) -> Result<Row, &'static str> {
        let (channels, rest) = values.split_at(self.channels.len());
        let mut rest = rest.iter();
        let number = |value: &Option<Value>| match value {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        };
        let device_s = match &self.description.clock {
            Some(clock) => {
                let ticks = rest.next().and_then(number).ok_or("its clock is missing")?;
                Some(ticks * clock.unit_s)
            }
            None => None,
        };
        let counted = match &self.description.number {
            Some(_) => {
                let count = rest.next().and_then(number).ok_or("its number is missing")?;
                let is_whole = count >= 0.0 && count.fract() == 0.0 && count < 9e15;
                Some(if is_whole { count as u64 } else { return Err("its number is no whole number") })
            }
            None => None,
        };
        // All is checked before the state of a signal that wraps changes.
        if channels.contains(&Some(Value::Text)) {
            return Err("text stands in the place of a number");
        }
        let mut row = Vec::with_capacity(channels.len());
        for ((channel, value), unwrap) in
            self.description.channels.iter().zip(channels).zip(&mut self.unwraps)
        {
            row.push(number(value).map_or(f64::NAN, |number| unwrap.si(channel, number)));
        }
        Ok(Row { device_s, number: counted, arrival_ns: at.at_ns, spread_ns: at.spread_ns, values: row })
    }
}

impl Pending {
    fn forget(&mut self) {
        self.is_begun = false;
        self.values.fill(None);
    }
}

impl Device for TextDevice {
    fn kind(&self) -> String {
        format!("a device that sends {}", self.description.form.words())
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        match (&self.description.number, &self.description.clock) {
            (Some((_, wrap)), _) => Numbering::Numbered(*wrap),
            (None, Some(_)) => Numbering::Clock,
            (None, None) => Numbering::Arrival,
        }
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        if let Form::Frames(layout) = &*Arc::clone(&self.form) {
            return self.receive_frames(chunk, layout, heard);
        }
        let mut lines = std::mem::take(&mut self.lines);
        let spread_ns = chunk.until_ns - chunk.from_ns;
        lines.push(chunk, |line, at_ns| self.line(line, Arrival { at_ns, spread_ns }, heard));
        self.lines = lines;
    }

    fn interrupted(&mut self, heard: &mut Vec<Heard>) {
        if self.lines.interrupt() || self.frames.interrupt() {
            heard.push(Heard::Damaged("the link broke within it"));
        }
        self.pending.forget();
    }
}

#[cfg(test)]
mod tests;
