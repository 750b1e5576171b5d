//! Topics of a Foxglove WebSocket server as a device.

use std::collections::HashMap;

use socam_import::MessageNumber;
use socam_recording::Channel;

use super::LOG_TIME;
use super::connection::{Connection, Message, Said};
use super::survey::Survey;
use crate::aligner::{Aligner, Kind};
use crate::description::Description;
use crate::device::{Chunk, Device, Heard, Numbering, Row};
use crate::error::{Result, SourceError};
use crate::silence::Silence;
use crate::text::Unwrap;

/// Interval at which it is looked whether there are messages, ns.
const LOOK_NS: i64 = 1_000_000_000;

/// Topics that are subscribed to.
pub struct Topics {
    connection: Connection,
    description: Description,
    channels: Vec<Channel>,
    clock: String,
    /// Kinds of messages, the most frequent first, each with its channels.
    kinds: Vec<TopicColumns>,
    /// Kind of each topic.
    kind_of: Vec<usize>,
    aligner: Option<Aligner>,
    unwraps: Vec<Unwrap>,
    /// The first time, to which all others are relative, so that no digits are lost.
    origin_ns: Option<i64>,
    early: Vec<Message>,
    /// Since the last message that gives a row.
    silence: Silence,
}

/// Channels that a topic holds.
struct TopicColumns {
    /// Place of each in the recording.
    places: Vec<usize>,
    /// Its place among those of the topic, by its path.
    by_path: HashMap<String, usize>,
    /// Path of the number of the row.
    number: Option<String>,
}

impl Topics {
    /// The device of a survey, whose messages become its beginning.
    #[must_use]
    pub fn new(survey: Survey, description: Description) -> Self {
        let Survey { connection, messages, order } = survey;
        let names: Vec<String> = connection.topics().map(str::to_owned).collect();
        let kinds: Vec<TopicColumns> =
            order.iter().map(|topic| TopicColumns::new(&description, &names, *topic)).collect();
        let clock = description.clock.as_ref().map_or(LOG_TIME, |clock| clock.signal.as_str()).to_owned();
        let step_s = |topic: usize| {
            let of: Vec<&Message> = messages.iter().filter(|one| one.topic == topic).collect();
            let time =
                |message: &Message| message.stated_ns(&clock).unwrap_or(message.log_time_ns) as f64 * 1e-9;
            match of[..] {
                [first, .., last] => (time(last) - time(first)) / (of.len() - 1) as f64,
                _ => 1.0,
            }
            .max(1e-6)
        };
        let aligned = || {
            order
                .iter()
                .zip(&kinds)
                .map(|(topic, kind)| Kind { step_s: step_s(*topic), width: kind.places.len() })
        };
        let aligner = (order.len() > 1).then(|| Aligner::new(aligned().collect()));
        let place = |topic: usize| order.iter().position(|one| *one == topic).unwrap_or_default();
        Self {
            kind_of: (0..names.len()).map(place).collect(),
            channels: description.channels(),
            unwraps: vec![Unwrap::default(); description.channels.len()],
            connection,
            description,
            clock,
            kinds,
            aligner,
            origin_ns: None,
            early: messages,
            silence: Silence::default(),
        }
    }

    fn message(&mut self, message: &Message, heard: &mut Vec<Heard>) {
        let Some(time_ns) = message.stated_ns(&self.clock) else {
            heard.push(Heard::Damaged("a message does not state its time"));
            return;
        };
        let kind = self.kind_of[message.topic];
        let columns = &self.kinds[kind];
        let mut values = vec![f64::NAN; columns.places.len()];
        let mut number = None;
        for (path, value) in &message.numbers {
            let MessageNumber::Value(value) = value else { continue };
            if let Some(place) = columns.by_path.get(path) {
                let index = columns.places[*place];
                values[*place] = self.unwraps[index].si(&self.description.channels[index], *value);
            } else if columns.number.as_deref() == Some(path) {
                number = (*value >= 0.0).then_some(*value as u64);
            }
        }
        if kind == 0 {
            self.silence.heard(message.arrival_ns);
        }
        let time_s = time_ns.saturating_sub(*self.origin_ns.get_or_insert(time_ns)) as f64 * 1e-9;
        let row = |time_s, number, arrival_ns, spread_ns, values| {
            Heard::Row(Row { device_s: Some(time_s), number, arrival_ns, spread_ns, values })
        };
        let Some(aligner) = &mut self.aligner else {
            if columns.number.is_some() && number.is_none() {
                heard.push(Heard::Damaged("its number is missing"));
                return;
            }
            let mut whole = vec![f64::NAN; self.channels.len()];
            columns.places.iter().zip(values).for_each(|(place, value)| whole[*place] = value);
            heard.push(row(time_s, number, message.arrival_ns, message.spread_ns, whole));
            return;
        };
        let kinds = &self.kinds;
        aligner.push(kind, time_s, values, message.arrival_ns, |time_s, values, arrival_ns| {
            let mut whole = vec![f64::NAN; values.len()];
            let places = kinds.iter().flat_map(|kind| &kind.places);
            places.zip(values).for_each(|(place, value)| whole[*place] = value);
            heard.push(row(time_s, None, arrival_ns, 0, whole));
        });
    }
}

impl TopicColumns {
    fn new(description: &Description, names: &[String], topic: usize) -> Self {
        // A topic may begin like another: its own signals are those whose longest topic it is.
        let own = |signal: &str| {
            let is_of =
                |name: &&String| signal.strip_prefix(name.as_str()).is_some_and(|rest| rest.starts_with('/'));
            let longest = names.iter().filter(is_of).max_by_key(|name| name.len())?;
            (*longest == names[topic]).then(|| signal[longest.len() + 1..].to_owned())
        };
        let mut columns = Self { places: Vec::new(), by_path: HashMap::new(), number: None };
        for (place, channel) in description.channels.iter().enumerate() {
            if let Some(path) = own(&channel.signal) {
                columns.by_path.insert(path, columns.places.len());
                columns.places.push(place);
            }
        }
        columns.number = description.number.as_ref().filter(|_| names.len() == 1).and_then(|one| own(&one.0));
        columns
    }
}

impl Device for Topics {
    fn kind(&self) -> String {
        let topics: Vec<&str> = self.connection.topics().collect();
        format!("the topics {} of a Foxglove WebSocket server, which are only listened to", topics.join(", "))
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn numbering(&self) -> Numbering {
        match &self.description.number {
            Some((_, wrap)) if self.aligner.is_none() => Numbering::Numbered(*wrap),
            _ => Numbering::Clock,
        }
    }

    fn receive(&mut self, chunk: Chunk<'_>, heard: &mut Vec<Heard>) {
        for message in std::mem::take(&mut self.early) {
            self.message(&message, heard);
        }
        let mut said = Vec::new();
        self.connection.receive(chunk, |_, one| said.push(one));
        for one in said {
            match one {
                Said::Message(message) => self.message(&message, heard),
                Said::Damaged(problem) => heard.push(Heard::Damaged(problem)),
                Said::Note(text, true) => heard.push(Heard::Fault(text)),
                Said::Note(text, false) => heard.push(Heard::Talk(text)),
            }
        }
    }

    fn poll(&mut self, now_ns: i64, out: &mut Vec<u8>) -> Result<Option<i64>> {
        if self.silence.is_too_long(now_ns) {
            let problem = format!(
                "the topic that gives the rows has had no message for {} s: is it still published?",
                Silence::MOST_S
            );
            return Err(SourceError::Foreign(problem));
        }
        self.connection.send(out)?;
        Ok(Some(now_ns + LOOK_NS))
    }

    fn interrupted(&mut self, _heard: &mut Vec<Heard>) {
        self.connection.restart();
        self.silence = Silence::default();
    }
}
