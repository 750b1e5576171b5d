//! Finds out what topics hold, from the messages of a second.

use std::collections::BTreeMap;

use socam_import::MessageNumber;
use socam_units::column;

use super::LOG_TIME;
use super::connection::{Connection, Message};
use crate::description::Description;
use crate::error::{Result, SourceError};
use crate::text::{CLOCK_RATIO, Form, Found, Role, SHORTEST_S, Signal, conclude};

/// Paths of the times that messages themselves state, as ROS and the schemas of Foxglove name them.
const STAMPS: [&str; 3] = ["header.stamp", "stamp", "timestamp"];
/// Most signals that are recorded.
const MOST_SIGNALS: usize = 300;

/// Messages that were heard before anything is recorded; they become its beginning.
pub struct Survey {
    pub(super) connection: Connection,
    pub(super) messages: Vec<Message>,
    /// Topics by their number of messages, the most frequent first.
    pub(super) order: Vec<usize>,
}

impl Survey {
    /// What was heard.
    ///
    /// # Errors
    /// When a topic had no message, or one without a number.
    pub fn new(connection: Connection, messages: Vec<Message>) -> Result<Self> {
        let names: Vec<&str> = connection.topics().collect();
        let counts: Vec<usize> =
            (0..names.len()).map(|topic| messages.iter().filter(|one| one.topic == topic).count()).collect();
        if let Some(silent) = counts.iter().position(|count| *count == 0) {
            let problem = format!("the topic `{}` has no messages: is it published?", names[silent]);
            return Err(SourceError::Foreign(problem));
        }
        let mut order: Vec<usize> = (0..names.len()).collect();
        order.sort_by_key(|topic| std::cmp::Reverse(counts[*topic]));
        Ok(Self { connection, messages, order })
    }

    fn name(&self, topic: usize) -> &str {
        self.connection.topics().nth(topic).unwrap_or_default()
    }

    /// The topic whose messages give the rows.
    #[must_use]
    pub fn rows(&self) -> &str {
        self.name(self.order.first().copied().unwrap_or_default())
    }

    /// The description of the topics, as far as they state it.
    ///
    /// # Errors
    /// When no topic holds a number beside its times.
    pub fn found(&self, take_guesses: bool) -> Result<Found> {
        let mut signals: BTreeMap<(usize, &str), Signal> = BTreeMap::new();
        for message in &self.messages {
            for (path, number) in &message.numbers {
                let MessageNumber::Value(value) = number else { continue };
                let signal = signals.entry((message.topic, path)).or_insert_with(|| Signal {
                    name: format!("{}/{path}", self.name(message.topic)),
                    column: column(path, None),
                    values: Vec::new(),
                    convention: self.connection.convention(message.topic, path),
                    role: Role::Channel { unit: None, guess: None },
                });
                signal.values.push((*value, message.arrival_ns as f64 * 1e-9));
            }
        }
        let mut signals: Vec<Signal> = signals.into_values().collect();
        let topics: Vec<String> = self.connection.topics().map(|name| format!("`{name}`")).collect();
        let topics = topics.join(", ");
        if signals.len() > MOST_SIGNALS {
            return Err(SourceError::Foreign(format!(
                "{topics} hold {} numbers; a recording has at most {MOST_SIGNALS}: name fewer topics",
                signals.len()
            )));
        }
        let clock = self.clock();
        signals.push(Signal {
            name: clock.into(),
            column: column(clock, Some("ns")),
            values: Vec::new(),
            convention: None,
            role: Role::Clock { unit: Some("ns"), is_measured: false, is_whole: true },
        });
        let nothing =
            || SourceError::Foreign(format!("{topics}: no message holds a number that can be recorded"));
        // Rows of several topics have no number of their own.
        let found =
            conclude(&Form::Topics, signals, take_guesses, self.order.len() == 1).ok_or_else(nothing)?;
        Ok(Found { lines: [self.messages.len(), 0], ..found })
    }

    /// The clock of the messages: the time that they state themselves, if all topics state it and it runs as this computer's does; else the
    /// server's.
    fn clock(&self) -> &'static str {
        let runs = |stamp: &str| {
            self.order.iter().all(|topic| {
                let of = |message: &&Message| message.topic == *topic;
                let times: Option<Vec<(i64, i64)>> = self
                    .messages
                    .iter()
                    .filter(of)
                    .map(|one| Some((one.stated_ns(stamp)?, one.arrival_ns)))
                    .collect();
                let Some([first, .., last]) = times.as_deref() else { return false };
                let (device_s, host_s) = ((last.0 - first.0) as f64 * 1e-9, (last.1 - first.1) as f64 * 1e-9);
                host_s < SHORTEST_S || CLOCK_RATIO.contains(&(device_s / host_s))
            })
        };
        STAMPS.into_iter().find(|stamp| runs(stamp)).unwrap_or(LOG_TIME)
    }

    /// Checks that a description is one of these topics.
    ///
    /// # Errors
    /// When a signal or the clock that it names is in no message.
    pub fn check(&self, description: &Description) -> Result<()> {
        if description.form != Form::Topics {
            let problem = "the description is not one of topics; its [lines] need form = \"foxglove\"";
            return Err(SourceError::Foreign(problem.into()));
        }
        let is_there = |signal: &str| {
            self.messages.iter().any(|message| {
                let path =
                    signal.strip_prefix(self.name(message.topic)).and_then(|rest| rest.strip_prefix('/'));
                path.is_some_and(|path| message.numbers.iter().any(|(name, _)| name == path))
            })
        };
        let named = description.channels.iter().map(|channel| &channel.signal);
        if let Some(missing) =
            named.chain(description.number.iter().map(|one| &one.0)).find(|one| !is_there(one))
        {
            let problem = format!("the description names `{missing}`, which no message of the topics holds");
            return Err(SourceError::Foreign(problem));
        }
        let clock = description.clock.as_ref().map(|clock| clock.signal.as_str());
        let states = |stamp: &str| self.messages.iter().all(|message| message.stated_ns(stamp).is_some());
        match clock.filter(|clock| !states(clock)) {
            Some(clock) => {
                let problem = format!(
                    "the description's clock is `{clock}`, which not all messages state; take {LOG_TIME}"
                );
                Err(SourceError::Foreign(problem))
            }
            None => Ok(()),
        }
    }
}

impl Message {
    /// A time that the message states, or the server's.
    pub(super) fn stated_ns(&self, stamp: &str) -> Option<i64> {
        if stamp == LOG_TIME {
            return Some(self.log_time_ns);
        }
        self.numbers.iter().find_map(|(path, number)| match number {
            MessageNumber::Time(time) if path == stamp => Some(*time),
            _ => None,
        })
    }
}
