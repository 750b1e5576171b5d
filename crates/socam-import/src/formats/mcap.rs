//! MCAP logs of other programs: each topic is a group, each number in its messages a signal.

mod flatten;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcapdecode_core::{MessageDecoder, TopicDecoder};
use mcapdecode_protobuf::ProtobufDecoder;
use mcapdecode_ros2idl::Ros2IdlDecoder;
use mcapdecode_ros2msg::Ros2MsgDecoder;

use socam_recording::{Warning, parse_log_record};

use crate::error::{ImportError, Result};
use crate::source::{Group, Signal, Source, Wanted};
use flatten::{Number, Numbers};

/// Longest record that is read, bytes.
const LONGEST_RECORD: usize = 1 << 28;
/// Fields of ROS' JointState and the units that its convention (REP 103) gives them.
const JOINT_STATE: [(&str, &str); 3] = [
    ("position.", "by the convention of ROS \"rad\", or \"m\" of a prismatic joint"),
    ("velocity.", "by the convention of ROS \"rad/s\", or \"m/s\" of a prismatic joint"),
    ("effort.", "by the convention of ROS \"N m\", or \"N\" of a prismatic joint"),
];
/// Most signals of a topic.
const MOST_SIGNALS: usize = 512;

pub(super) fn read(path: &Path, wanted: &Wanted) -> Result<Source> {
    let file = File::open(path).map_err(|error| ImportError::io(path, error))?;
    let mut log = Log { wanted, schemas: BTreeMap::new(), topics: BTreeMap::new(), notes: Vec::new() };
    let read = log.read(BufReader::with_capacity(1 << 18, file));
    let messages: usize = log.topics.values().map(|topic| topic.rows).sum();
    match read {
        Ok(()) => {}
        Err(problem) if messages > 0 => {
            log.notes.push(Warning::Incomplete {
                what: format!("messages after {messages} are missing ({problem})"),
            });
        }
        Err(problem) => {
            return Err(ImportError::damaged(path, problem));
        }
    }
    Ok(log.finish())
}

struct Log<'w> {
    wanted: &'w Wanted,
    /// Name, encoding and content of each schema.
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    topics: BTreeMap<u16, Topic>,
    notes: Vec<Warning>,
}

/// A topic while its messages are read.
struct Topic {
    name: String,
    decoder: Decoder,
    is_joint_state: bool,
    rows: usize,
    damaged: usize,
    columns: Vec<Column>,
    /// Index of each column by its path.
    places: BTreeMap<String, usize>,
}

#[derive(Default)]
struct Column {
    path: String,
    unit: Option<&'static str>,
    floats: Vec<f64>,
    integers: Vec<Option<i64>>,
    is_float: bool,
}

enum Decoder {
    Schema(Box<dyn TopicDecoder>),
    Json,
    None,
}

impl Log<'_> {
    fn read(&mut self, mut file: impl Read) -> Result<(), String> {
        let options = LinearReaderOptions::default()
            .with_prevalidate_chunk_crcs(true)
            .with_skip_end_magic(true)
            .with_record_length_limit(LONGEST_RECORD);
        let mut reader = LinearReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event.map_err(|error| error.to_string())? {
                // The reader asks for as many bytes as a damaged length says.
                LinearReadEvent::ReadRequest(need) if need > LONGEST_RECORD => {
                    return Err(format!("a record of {need} bytes is announced"));
                }
                LinearReadEvent::ReadRequest(need) => {
                    let read = file.read(reader.insert(need)).map_err(|error| error.to_string())?;
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => {
                    let record = parse_log_record(opcode, data).ok_or("a record is damaged")?;
                    self.record(record);
                }
            }
        }
        Ok(())
    }

    fn record(&mut self, record: Record<'_>) {
        match record {
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, (header.name, header.encoding, data.into_owned()));
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id);
                let decoder = decoder(&channel.message_encoding, schema);
                let decoder = decoder.unwrap_or_else(|why| {
                    self.notes.push(Warning::Note(format!("topic `{}` is left aside: {why}", channel.topic)));
                    Decoder::None
                });
                let is_joint_state = schema.is_some_and(|(name, ..)| name.ends_with("/JointState"));
                let topic = Topic {
                    is_joint_state,
                    name: channel.topic,
                    decoder,
                    rows: 0,
                    damaged: 0,
                    columns: Vec::new(),
                    places: BTreeMap::new(),
                };
                self.topics.entry(channel.id).or_insert(topic);
            }
            Record::Message { header, data } => {
                if let Some(topic) = self.topics.get_mut(&header.channel_id)
                    && topic.rows < self.wanted.most_rows
                {
                    topic.message(header.log_time, header.publish_time, &data, self.wanted);
                }
            }
            _ => {}
        }
    }

    fn finish(mut self) -> Source {
        let mut groups = Vec::new();
        for topic in self.topics.into_values() {
            if topic.damaged > 0 {
                self.notes.push(Warning::Note(format!(
                    "topic `{}`: {} messages cannot be decoded",
                    topic.name, topic.damaged
                )));
            }
            if topic.columns.iter().any(|column| !is_clock(&column.path)) {
                groups.push(topic.finish());
            }
        }
        Source { groups, notes: self.notes, text: None }.tidy()
    }
}

fn is_clock(path: &str) -> bool {
    matches!(path, "log_time" | "publish_time")
}

/// Decoder of a topic's messages, or the reason why there is none.
fn decoder(encoding: &str, schema: Option<&(String, String, Vec<u8>)>) -> Result<Decoder, String> {
    let (name, schema_encoding, data) = match (encoding, schema) {
        ("json", _) => return Ok(Decoder::Json),
        (_, None) => return Err(format!("its messages are {encoding} without a schema")),
        (_, Some((name, encoding, data))) => (name, encoding.as_str(), data),
    };
    let built = match (encoding, schema_encoding) {
        ("cdr", "ros2msg") => Ros2MsgDecoder::new().build_topic_decoder(name, data),
        ("cdr", "ros2idl") => Ros2IdlDecoder::new().build_topic_decoder(name, data),
        ("protobuf", "protobuf") => ProtobufDecoder::new().build_topic_decoder(name, data),
        _ => return Err(format!("messages in {encoding} with a schema in {schema_encoding} are not read")),
    };
    built.map(Decoder::Schema).map_err(|error| format!("its schema `{name}` cannot be read: {error}"))
}

impl Topic {
    fn message(&mut self, log_time: u64, publish_time: u64, data: &[u8], wanted: &Wanted) {
        let mut numbers = Numbers::default();
        let decoded = match &self.decoder {
            Decoder::None => return,
            Decoder::Json => serde_json::from_slice(data).map(|value| numbers.json("", &value)).is_ok(),
            Decoder::Schema(decoder) => {
                decoder.decode(data).map(|value| numbers.message(decoder.field_defs(), &value)).is_ok()
            }
        };
        if !decoded {
            self.damaged += 1;
            return;
        }
        let stamp = |time: u64| Number::Time(i64::try_from(time).unwrap_or(i64::MAX));
        self.put("log_time", stamp(log_time), wanted);
        if publish_time != log_time {
            self.put("publish_time", stamp(publish_time), wanted);
        }
        for (path, number) in numbers.0 {
            self.put(&path, number, wanted);
        }
        self.rows += 1;
    }

    /// Puts a number in the row that is being read.
    fn put(&mut self, path: &str, number: Number, wanted: &Wanted) {
        let place = match self.places.get(path) {
            Some(place) => *place,
            None => {
                let is_wanted = is_clock(path) || wanted.takes(&self.name, path);
                if !is_wanted || self.columns.len() >= MOST_SIGNALS {
                    return;
                }
                self.places.insert(path.to_owned(), self.columns.len());
                let unit = matches!(number, Number::Time(_)).then_some("ns");
                self.columns.push(Column { path: path.to_owned(), unit, ..Column::default() });
                self.columns.len() - 1
            }
        };
        self.columns[place].put(self.rows, number);
    }

    fn finish(self) -> Group {
        let rows = self.rows;
        let hint = |path: &str| {
            let field = JOINT_STATE.iter().find(|(field, _)| self.is_joint_state && path.starts_with(field));
            field.map(|(_, unit)| *unit)
        };
        let finish = |column: Column| Signal { hint: hint(&column.path), ..column.finish(rows) };
        let signals = self.columns.into_iter().map(finish).collect();
        Group { name: self.name, signals, time: Some(0), is_by_arrival: true }
    }
}

impl Column {
    fn put(&mut self, row: usize, number: Number) {
        let (float, integer) = match number {
            Number::Float(value) => {
                self.is_float = true;
                (value, None)
            }
            Number::Integer(value) | Number::Time(value) => (value as f64, Some(value)),
        };
        self.floats.resize(row, f64::NAN);
        self.integers.resize(row, None);
        self.floats.push(float);
        self.integers.push(integer);
    }

    fn finish(mut self, rows: usize) -> Signal {
        self.floats.resize(rows, f64::NAN);
        self.integers.resize(rows, None);
        let unit = self.unit.map(str::to_owned);
        if self.is_float {
            Signal::new(self.path, unit, self.floats)
        } else {
            Signal::of_integers(self.path, unit, self.integers.iter().copied())
        }
    }
}
