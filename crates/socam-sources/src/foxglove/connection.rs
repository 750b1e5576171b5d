//! A client of a Foxglove WebSocket server, without input or output.

use std::collections::BTreeMap;

use serde_json::{Value as Json, json};
use socam_import::{LiveMessages, MessageNumber};
use tungstenite::Message as Frame;

use super::MESSAGE_DATA;
use super::channel::Channel;
use super::socket::Socket;
use crate::device::Chunk;
use crate::error::{Result, SourceError};

/// Topics that a message names.
const SHOWN: usize = 12;

/// A message of a topic that is subscribed to.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// The topic, by its place among those that were asked for.
    pub topic: usize,
    /// Time by the server, ns since 1970 or any other beginning.
    pub log_time_ns: i64,
    /// Time of arrival, ns of the host's clock.
    pub arrival_ns: i64,
    /// The time within which it arrived, ns.
    pub spread_ns: i64,
    /// Numbers in it, with their paths.
    pub numbers: Vec<(String, MessageNumber)>,
}

/// What a server said.
#[derive(Debug, Clone, PartialEq)]
pub enum Said {
    /// A message.
    Message(Message),
    /// Something in the place of a message.
    Damaged(&'static str),
    /// A note for people, and whether it is a warning.
    Note(String, bool),
}

/// A topic that is recorded.
struct Topic {
    name: String,
    channel: Option<u64>,
    messages: Option<LiveMessages>,
    /// Why it cannot be decoded.
    problem: Option<String>,
}

/// A connection to a server.
pub struct Connection {
    address: String,
    socket: Socket,
    channels: BTreeMap<u64, Channel>,
    topics: Vec<Topic>,
    /// Whether the server has said who it is.
    is_greeted: bool,
    /// Why the connection cannot be used.
    problem: Option<String>,
}

impl Connection {
    /// A connection to `HOST:PORT` that subscribes to topics.
    ///
    /// # Errors
    /// When the address is none.
    pub fn new(address: &str, topics: &[String]) -> Result<Self> {
        Ok(Self::with(Socket::client(address).map_err(SourceError::Foreign)?, address, topics))
    }

    /// A connection whose handshake is done, for tests and fuzzing: that of a real one depends on a random key.
    #[must_use]
    pub fn after_handshake(topics: &[String]) -> Self {
        Self::with(Socket::after_handshake(), "", topics)
    }

    fn with(socket: Socket, address: &str, topics: &[String]) -> Self {
        let topic =
            |name: &String| Topic { name: name.clone(), channel: None, messages: None, problem: None };
        Self {
            address: address.to_owned(),
            socket,
            channels: BTreeMap::new(),
            topics: topics.iter().map(topic).collect(),
            is_greeted: false,
            problem: None,
        }
    }

    /// Names of the topics that are subscribed to, or are to be.
    pub fn topics(&self) -> impl Iterator<Item = &str> {
        self.topics.iter().map(|topic| topic.name.as_str())
    }

    /// Takes bytes that arrived, and hands on what the server said.
    pub fn receive(&mut self, chunk: Chunk<'_>, mut take: impl FnMut(&mut Self, Said)) {
        let messages = match self.socket.receive(chunk.bytes) {
            Ok(messages) => messages,
            Err(problem) => {
                let begin = if self.is_greeted {
                    "the connection ended"
                } else {
                    "there is no Foxglove WebSocket server"
                };
                self.problem = Some(format!("{begin}: {problem}"));
                return;
            }
        };
        for message in messages {
            let said = match &message {
                Frame::Text(text) => match serde_json::from_str::<Json>(text) {
                    Ok(text) => self.text(&text),
                    Err(_) => vec![Said::Damaged("a text is no JSON")],
                },
                Frame::Binary(bytes) => self.data(bytes, chunk).into_iter().collect(),
                Frame::Ping(_) | Frame::Pong(_) | Frame::Close(_) | Frame::Frame(_) => Vec::new(),
            };
            said.into_iter().for_each(|said| take(self, said));
        }
    }

    /// Appends what is to be sent.
    ///
    /// # Errors
    /// When there is no connection any more.
    pub fn send(&mut self, out: &mut Vec<u8>) -> Result<()> {
        out.append(self.socket.outgoing());
        self.problem.take().map_or(Ok(()), |problem| Err(SourceError::Foreign(problem)))
    }

    /// Begins anew, since the link broke.
    pub(super) fn restart(&mut self) {
        if let Ok(socket) = Socket::client(&self.address) {
            self.socket = socket;
        }
        self.channels.clear();
        self.is_greeted = false;
        self.topics.iter_mut().for_each(|topic| topic.channel = None);
    }

    /// Whether every topic is subscribed to.
    ///
    /// # Errors
    /// When a topic is there and its messages cannot be read.
    pub fn is_subscribed(&self) -> Result<bool> {
        if let Some(topic) = self.topics.iter().find(|topic| topic.problem.is_some()) {
            let problem = topic.problem.as_deref().unwrap_or_default();
            return Err(SourceError::Foreign(format!(
                "the topic `{}` cannot be recorded: {problem}",
                topic.name
            )));
        }
        Ok(self.is_greeted
            && !self.topics.is_empty()
            && self.topics.iter().all(|topic| topic.channel.is_some()))
    }

    /// Chooses the only topic of the server that can be recorded, once it has said what it has.
    ///
    /// # Errors
    /// When there are others, which are named.
    pub fn choose(&mut self) -> Result<()> {
        if !self.is_greeted {
            return Ok(());
        }
        let readable: Vec<&Channel> =
            self.channels.values().filter(|channel| channel.decoder().is_ok()).collect();
        let &[only] = &readable[..] else {
            let problem = format!("name the topics to record, as in ?topics=/joint_states; {}", self.has());
            return Err(SourceError::Foreign(problem));
        };
        let name = only.topic.clone();
        self.topics.push(Topic { name, channel: None, messages: None, problem: None });
        self.subscribe();
        Ok(())
    }

    /// Why topics are not subscribed to yet, in words.
    #[must_use]
    pub fn missing(&self) -> String {
        if !self.is_greeted {
            return "it does not say that it is a Foxglove WebSocket server".into();
        }
        let missing: Vec<String> = self
            .topics
            .iter()
            .filter(|topic| topic.channel.is_none())
            .map(|topic| format!("`{}`", topic.name))
            .collect();
        format!("it has no topic {}; {}", missing.join(", "), self.has())
    }

    /// The topics that the server has, in words.
    fn has(&self) -> String {
        if self.channels.is_empty() {
            return "it has none".into();
        }
        let shown = |channel: &Channel| {
            let aside = if channel.decoder().is_ok() { "" } else { ", not readable" };
            format!("`{}` ({} in {}{aside})", channel.topic, channel.schema_name, channel.encoding)
        };
        let topics: Vec<String> = self.channels.values().take(SHOWN).map(shown).collect();
        let more = self.channels.len().saturating_sub(SHOWN);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("it has {}{more}", topics.join(", "))
    }

    /// The unit that a convention gives to a number of a topic.
    pub(super) fn convention(&self, topic: usize, path: &str) -> Option<&'static str> {
        self.topics.get(topic)?.messages.as_ref()?.convention(path)
    }

    fn text(&mut self, text: &Json) -> Vec<Said> {
        match text["op"].as_str() {
            Some("serverInfo") => {
                self.is_greeted = true;
                let name: String =
                    text["name"].as_str().unwrap_or("without a name").chars().take(200).collect();
                vec![Said::Note(format!("the server is {name}"), false)]
            }
            Some("advertise") => {
                let channels = text["channels"].as_array().map(Vec::as_slice).unwrap_or_default();
                self.channels.extend(channels.iter().filter_map(Channel::read));
                self.subscribe();
                Vec::new()
            }
            Some("unadvertise") => {
                let ids = text["channelIds"].as_array().map(Vec::as_slice).unwrap_or_default();
                ids.iter().filter_map(Json::as_u64).filter_map(|id| self.withdrawn(id)).collect()
            }
            Some("status") => {
                let text_of: String =
                    text["message"].as_str().unwrap_or_default().chars().take(300).collect();
                vec![Said::Note(format!("the server says: {text_of}"), text["level"].as_u64() != Some(0))]
            }
            Some(_) => Vec::new(),
            None => vec![Said::Damaged("a text has no `op`")],
        }
    }

    fn withdrawn(&mut self, id: u64) -> Option<Said> {
        self.channels.remove(&id);
        let topic = self.topics.iter_mut().find(|topic| topic.channel == Some(id))?;
        topic.channel = None;
        Some(Said::Note(format!("the server withdrew the topic `{}`", topic.name), true))
    }

    /// Subscribes to the topics that are there by now.
    fn subscribe(&mut self) {
        let mut subscriptions = Vec::new();
        for (place, topic) in self.topics.iter_mut().enumerate().filter(|(_, topic)| topic.channel.is_none())
        {
            let Some((id, channel)) = self.channels.iter().find(|(_, channel)| channel.topic == topic.name)
            else {
                continue;
            };
            match channel.decoder() {
                Ok(messages) => {
                    topic.messages = Some(messages);
                    topic.channel = Some(*id);
                    subscriptions.push(json!({ "id": place, "channelId": id }));
                }
                Err(problem) => topic.problem = Some(problem),
            }
        }
        if !subscriptions.is_empty() {
            let text = json!({ "op": "subscribe", "subscriptions": subscriptions });
            self.socket.send(Frame::text(text.to_string()));
        }
    }

    fn data(&self, bytes: &[u8], chunk: Chunk<'_>) -> Option<Said> {
        let Some((&MESSAGE_DATA, rest)) = bytes.split_first() else { return None };
        let Some(((id, time), data)) = head(rest) else {
            return Some(Said::Damaged("a message is too short"));
        };
        let topic = usize::try_from(id).ok().filter(|topic| *topic < self.topics.len())?;
        let Some(numbers) = self.topics[topic].messages.as_ref().and_then(|messages| messages.numbers(data))
        else {
            return Some(Said::Damaged("a message cannot be decoded by its schema"));
        };
        Some(Said::Message(Message {
            topic,
            log_time_ns: i64::try_from(time).unwrap_or(i64::MAX),
            arrival_ns: chunk.until_ns,
            spread_ns: chunk.until_ns.saturating_sub(chunk.from_ns),
            numbers,
        }))
    }
}

/// Subscription and time of a message, and its data.
fn head(bytes: &[u8]) -> Option<((u32, u64), &[u8])> {
    let (id, rest) = bytes.split_first_chunk::<4>()?;
    let (time, data) = rest.split_first_chunk::<8>()?;
    Some(((u32::from_le_bytes(*id), u64::from_le_bytes(*time)), data))
}
