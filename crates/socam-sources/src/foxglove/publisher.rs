//! A server's side of one client that looks at a running recording. A client can subscribe, and nothing else.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::{Value as Json, json};
use socam_recording::Channel;
use tungstenite::Message as Frame;

use super::MESSAGE_DATA;
use super::socket::Socket;
use crate::error::{Result, SourceError};

/// Number and name of the topic of samples.
const SAMPLES: u64 = 1;
const SAMPLE_TOPIC: &str = "/socam/sample";
/// Number and name of the topic of events, which are messages of Foxglove's log panel.
const EVENTS: u64 = 2;
const EVENT_TOPIC: &str = "/socam/event";
/// Most subscriptions of a client.
const MOST_SUBSCRIPTIONS: usize = 16;

/// Samples and events as JSON, and their schemas.
#[derive(Debug, Clone)]
pub struct SampleWriter {
    /// Names of the members, unit included, as JSON strings.
    members: Vec<String>,
    /// What a client is told first.
    greeting: [String; 2],
}

impl SampleWriter {
    /// Samples of these channels, of a server with a name. `session` tells recordings apart.
    #[must_use]
    pub fn new(channels: &[Channel], name: &str, session: &str) -> Self {
        let columns: Vec<String> = channels.iter().map(Channel::column_name).collect();
        let time = json!({ "type": "object", "title": "time", "properties": { "sec": { "type": "integer" }, "nsec": { "type": "integer" } } });
        let mut properties = serde_json::Map::from_iter([("timestamp".to_owned(), time.clone())]);
        properties.extend(columns.iter().map(|column| (column.clone(), json!({ "type": "number" }))));
        let sample = json!({ "type": "object", "title": "socam.sample", "properties": properties });
        let text = json!({ "type": "string" });
        let event = json!({ "type": "object", "title": "foxglove.Log", "properties": {
            "timestamp": time, "level": { "type": "integer" }, "message": text, "name": text, "file": text, "line": { "type": "integer" } } });
        let channel = |id: u64, topic: &str, name: &str, schema: &Json| json!({ "id": id, "topic": topic, "encoding": "json", "schemaName": name, "schemaEncoding": "jsonschema", "schema": schema.to_string() });
        let channels = [
            channel(SAMPLES, SAMPLE_TOPIC, "socam.sample", &sample),
            channel(EVENTS, EVENT_TOPIC, "foxglove.Log", &event),
        ];
        // No capability: no client can publish, set or call anything.
        let info = json!({ "op": "serverInfo", "name": name, "capabilities": [], "sessionId": session });
        let advertise = json!({ "op": "advertise", "channels": channels });
        Self {
            members: columns.iter().map(|column| Json::from(column.as_str()).to_string()).collect(),
            greeting: [info.to_string(), advertise.to_string()],
        }
    }

    /// A sample: a time, ns since 1970, and values by channel; missing ones are left out.
    #[must_use]
    pub fn sample(&self, unix_ns: u64, values: &[f64]) -> String {
        let mut text = format!("{{\"timestamp\":{}", time(unix_ns));
        for (member, value) in self.members.iter().zip(values).filter(|(_, value)| value.is_finite()) {
            // Writing to a string cannot fail.
            let _ = write!(text, ",{member}:{value:?}");
        }
        text.push('}');
        text
    }

    /// An event of a kind, as a message of a log: faults are errors, alarms warnings.
    #[must_use]
    pub fn event(&self, unix_ns: u64, kind: &str, text: &str) -> String {
        let level = match kind {
            "fault" => 4,
            "alarm" => 3,
            _ => 2,
        };
        let seconds = time(unix_ns);
        let [kind, text] = [kind, text].map(|text| Json::from(text).to_string());
        format!(
            "{{\"timestamp\":{seconds},\"level\":{level},\"message\":{text},\"name\":{kind},\"file\":\"\",\"line\":0}}"
        )
    }
}

fn time(unix_ns: u64) -> String {
    format!("{{\"sec\":{},\"nsec\":{}}}", unix_ns / 1_000_000_000, unix_ns % 1_000_000_000)
}

/// One client of the server.
pub struct Publisher {
    socket: Socket,
    greeting: Option<[String; 2]>,
    /// Channel of each subscription.
    subscriptions: BTreeMap<u32, u64>,
}

impl Publisher {
    /// A client that has connected.
    #[must_use]
    pub fn new(writer: &SampleWriter) -> Self {
        Self {
            socket: Socket::server(),
            greeting: Some(writer.greeting.clone()),
            subscriptions: BTreeMap::new(),
        }
    }

    /// Takes bytes of the client.
    ///
    /// # Errors
    /// When it does not speak the protocol, or has closed the connection.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<()> {
        let messages = self.socket.receive(bytes).map_err(SourceError::Foreign)?;
        if self.socket.is_open() {
            for text in self.greeting.take().into_iter().flatten() {
                self.socket.send(Frame::text(text));
            }
        }
        for message in messages {
            match message {
                Frame::Text(text) => {
                    if let Ok(request) = serde_json::from_str::<Json>(&text) {
                        self.request(&request);
                    }
                }
                Frame::Close(_) => return Err(SourceError::Foreign("the client has left".into())),
                // What a client publishes has no place here.
                _ => {}
            }
        }
        Ok(())
    }

    fn request(&mut self, request: &Json) {
        let list = |key: &str| request[key].as_array().cloned().unwrap_or_default();
        let number = |json: &Json| json.as_u64().and_then(|id| u32::try_from(id).ok());
        match request["op"].as_str() {
            Some("subscribe") => {
                for one in list("subscriptions") {
                    let known = one["channelId"].as_u64().filter(|id| matches!(*id, SAMPLES | EVENTS));
                    if let (Some(id), Some(channel)) = (number(&one["id"]), known)
                        && self.subscriptions.len() < MOST_SUBSCRIPTIONS
                    {
                        self.subscriptions.entry(id).or_insert(channel);
                    }
                }
            }
            Some("unsubscribe") => {
                for id in list("subscriptionIds").iter().filter_map(number) {
                    self.subscriptions.remove(&id);
                }
            }
            _ => {}
        }
    }

    /// Whether the client wants samples.
    #[must_use]
    pub fn wants_samples(&self) -> bool {
        self.subscriptions.values().any(|channel| *channel == SAMPLES)
    }

    /// Queues a sample of [`SampleWriter::sample`].
    pub fn sample(&mut self, unix_ns: u64, json: &str) {
        self.publish(SAMPLES, unix_ns, json);
    }

    /// Queues an event of [`SampleWriter::event`].
    pub fn event(&mut self, unix_ns: u64, json: &str) {
        self.publish(EVENTS, unix_ns, json);
    }

    /// Queues a warning, which Foxglove shows among the problems of its connection.
    pub fn warn(&mut self, text: &str) {
        let status = json!({ "op": "status", "level": 1, "message": text });
        self.socket.send(Frame::text(status.to_string()));
    }

    fn publish(&mut self, channel: u64, unix_ns: u64, json: &str) {
        let of_channel = self.subscriptions.iter().filter(|(_, of)| **of == channel);
        let ids: Vec<u32> = of_channel.map(|(id, _)| *id).collect();
        for id in ids {
            let head = [&[MESSAGE_DATA][..], &id.to_le_bytes(), &unix_ns.to_le_bytes()];
            self.socket.send(Frame::binary([&head.concat(), json.as_bytes()].concat()));
        }
    }

    /// Bytes that wait to be sent.
    pub fn outgoing(&mut self) -> &mut Vec<u8> {
        self.socket.outgoing()
    }
}
