//! Messages of a log by the definition of their type: each topic is a group, each number in its messages a signal.

mod flatten;
mod live;

use std::collections::BTreeMap;

use mcapdecode_core::{MessageDecoder, TopicDecoder};
use mcapdecode_protobuf::ProtobufDecoder;
use mcapdecode_ros2idl::Ros2IdlDecoder;
use mcapdecode_ros2msg::Ros2MsgDecoder;
use socam_recording::Warning;

use crate::source::{Group, Signal, Source, Wanted};
use flatten::{Number, Numbers};
pub use live::{LiveMessages, MessageNumber};

/// Types of ROS, beginnings of their fields, and the units that its convention (REP 103) gives them.
const CONVENTION: [(&str, &str, &str); 9] = [
    ("JointState", "position.", "by the convention of ROS \"rad\", or \"m\" of a prismatic joint"),
    ("JointState", "velocity.", "by the convention of ROS \"rad/s\", or \"m/s\" of a prismatic joint"),
    ("JointState", "effort.", "by the convention of ROS \"N m\", or \"N\" of a prismatic joint"),
    ("Wrench", "force.", "by the convention of ROS \"N\""),
    ("Wrench", "torque.", "by the convention of ROS \"N m\""),
    ("Twist", "linear.", "by the convention of ROS \"m/s\""),
    ("Twist", "angular.", "by the convention of ROS \"rad/s\""),
    ("Imu", "angular_velocity.", "by the convention of ROS \"rad/s\""),
    ("Imu", "linear_acceleration.", "by the convention of ROS \"m/s^2\""),
];
/// Most signals of a topic.
const MOST_SIGNALS: usize = 512;

/// Definition of a type of messages.
pub(super) struct Schema {
    pub(super) name: String,
    /// Language of the definition: `ros2msg`, `ros2idl`, `protobuf`.
    pub(super) encoding: String,
    pub(super) data: Vec<u8>,
}

/// A topic while its messages are read.
pub(super) struct Topic {
    name: String,
    decoder: Decoder,
    /// Type of the messages, without its package.
    kind: String,
    pub(super) rows: usize,
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

/// How messages are read; `None` where they are left aside.
pub(super) enum Decoder {
    Schema(Box<dyn TopicDecoder>),
    Json,
    None,
}

fn is_clock(path: &str) -> bool {
    matches!(path, "log_time" | "publish_time")
}

impl Decoder {
    /// Decoder of messages in an encoding, or the reason why there is none.
    pub(super) fn of(encoding: &str, schema: Option<&Schema>) -> Result<Self, String> {
        let schema = match (encoding, schema) {
            ("json", _) => return Ok(Self::Json),
            (_, None) => return Err(format!("its messages are {encoding} without a schema")),
            (_, Some(schema)) => schema,
        };
        let Schema { name, encoding: language, data } = schema;
        let built = match (encoding, language.as_str()) {
            ("cdr", "ros2msg") => Ros2MsgDecoder::new().build_topic_decoder(name, data),
            ("cdr", "ros2idl") => Ros2IdlDecoder::new().build_topic_decoder(name, data),
            ("protobuf", "protobuf") => ProtobufDecoder::new().build_topic_decoder(name, data),
            _ => return Err(format!("messages in {encoding} with a schema in {language} are not read")),
        };
        built.map(Self::Schema).map_err(|error| format!("its schema `{name}` cannot be read: {error}"))
    }

    /// The numbers of a message; `None` if it cannot be decoded.
    fn numbers(&self, data: &[u8]) -> Option<Numbers> {
        let mut numbers = Numbers::default();
        match self {
            Self::None => return None,
            Self::Json => numbers.json("", &serde_json::from_slice(data).ok()?),
            Self::Schema(decoder) => numbers.message(decoder.field_defs(), &decoder.decode(data).ok()?),
        }
        Some(numbers)
    }
}

impl Schema {
    /// The type without its package.
    fn kind(&self) -> &str {
        self.name.rsplit('/').next().unwrap_or_default()
    }
}

/// The unit that the convention of ROS gives to a number of a type, by its path, in words.
fn convention(kind: &str, path: &str) -> Option<&'static str> {
    // A stamped type holds the other in a field of its name.
    let (kind, field) = match kind.strip_suffix("Stamped") {
        Some(kind) => (kind, format!("{}.", kind.to_lowercase())),
        None => (kind, String::new()),
    };
    let path = path.strip_prefix(&field)?;
    CONVENTION.iter().find(|(of, begin, _)| *of == kind && path.starts_with(begin)).map(|(.., hint)| *hint)
}

/// The signals of all topics that hold numbers.
pub(super) fn finish(topics: impl Iterator<Item = Topic>, mut notes: Vec<Warning>) -> Source {
    let mut groups = Vec::new();
    for topic in topics {
        if topic.damaged > 0 {
            notes.push(Warning::Note(format!(
                "topic `{}`: {} messages cannot be decoded",
                topic.name, topic.damaged
            )));
        }
        if topic.columns.iter().any(|column| !is_clock(&column.path)) {
            groups.push(topic.finish());
        }
    }
    Source { groups, notes, ..Source::default() }.tidy()
}

impl Topic {
    pub(super) fn new(name: String, decoder: Decoder, schema: Option<&Schema>) -> Self {
        let kind = schema.map(Schema::kind).unwrap_or_default().to_owned();
        Self { name, decoder, kind, rows: 0, damaged: 0, columns: Vec::new(), places: BTreeMap::new() }
    }

    /// Puts the numbers of a message into a new row. Times are in ns since 1970.
    pub(super) fn message(&mut self, log_time: u64, publish_time: u64, data: &[u8], wanted: &Wanted) {
        if matches!(self.decoder, Decoder::None) {
            return;
        }
        let Some(numbers) = self.decoder.numbers(data) else {
            self.damaged += 1;
            return;
        };
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
        let hint = |path: &str| convention(&self.kind, path);
        let finish = |column: Column| Signal { hint: hint(&column.path), ..column.finish(self.rows) };
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
