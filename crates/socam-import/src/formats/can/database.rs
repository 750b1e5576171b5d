//! What the frames of a bus hold: a DBC.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use can_dbc::{
    ByteOrder, Dbc, ExtendedMultiplex, Message, MessageId, MultiplexIndicator, SignalExtendedValueType,
    ValueType,
};

use super::bits::{Kind, Place};
use crate::error::{ImportError, Result};

/// Longest DBC that is read, bytes.
const LONGEST: u64 = 1 << 26;
/// Bit that tells extended identifiers from short ones of the same number.
pub(super) const EXTENDED: u32 = 1 << 31;
/// Most signals of a frame, those under all values of its multiplexers: more than anybody describes.
const MOST_SIGNALS: usize = 1024;
/// Multiplexers that choose multiplexers that choose ...
const DEEPEST: usize = 8;

/// The frames that a DBC describes, by identifier with [`EXTENDED`].
pub(super) struct Database {
    pub(super) path: PathBuf,
    pub(super) frames: HashMap<u32, Frame>,
}

pub(super) struct Frame {
    pub(super) signals: Vec<Signal>,
    /// Signals that stand in the same frames.
    pub(super) sets: Vec<Set>,
    /// Number of signals that are not read.
    pub(super) left_aside: usize,
}

pub(super) struct Signal {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) kind: Kind,
    pub(super) place: Place,
}

/// Signals that stand in a frame under the same conditions.
pub(super) struct Set {
    /// Name of the frame, with the values of its multiplexers.
    pub(super) name: String,
    pub(super) conditions: Vec<Condition>,
    /// Indices of signals.
    pub(super) signals: Vec<usize>,
}

/// Values of a multiplexer at which signals are there.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Condition {
    /// Index of the multiplexer among the signals.
    multiplexer: usize,
    /// Each from its first to its last value.
    ranges: Vec<(u64, u64)>,
}

impl Database {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let length = path.metadata().map_err(|error| ImportError::io(path, error))?.len();
        if length > LONGEST {
            return Err(ImportError::file(
                path,
                format!("has {length} bytes, which is too long for a DBC; name another"),
            ));
        }
        let bytes = std::fs::read(path).map_err(|error| ImportError::io(path, error))?;
        let (text, ..) = crate::text::encoding(&bytes).decode(&bytes);
        let dbc = Dbc::try_from(&*text).map_err(|error| {
            let problem = format!(
                "is no DBC that can be read ({}); correct it, or name another",
                short(&error.to_string())
            );
            ImportError::file(path, problem)
        })?;
        let stated = Stated::of(&dbc);
        let frames = dbc.messages.iter().map(|message| (message.id.raw(), frame(&stated, message))).collect();
        Ok(Self { path: path.into(), frames })
    }
}

/// What a DBC states of signals apart from their messages, by message and name.
struct Stated<'d> {
    kinds: HashMap<(MessageId, &'d str), SignalExtendedValueType>,
    multiplexed: HashMap<(MessageId, &'d str), &'d ExtendedMultiplex>,
}

impl<'d> Stated<'d> {
    fn of(dbc: &'d Dbc) -> Self {
        let kinds = dbc.signal_extended_value_type_list.iter();
        let multiplexed = dbc.extended_multiplex.iter();
        Self {
            kinds: kinds
                .map(|kind| ((kind.message_id, kind.signal_name.as_str()), kind.signal_extended_value_type))
                .collect(),
            multiplexed: multiplexed.map(|one| ((one.message_id, one.signal_name.as_str()), one)).collect(),
        }
    }
}

/// The parser's drawing of a place in one line: where, and what was expected.
fn short(error: &str) -> String {
    let place = error.split_once("--> ").and_then(|(_, rest)| rest.lines().next());
    let expected = error.rsplit_once(" = ").map(|(_, expected)| expected);
    match (place.and_then(|place| place.trim().split_once(':')), expected) {
        (Some((line, column)), Some(expected)) => {
            format!("line {line}, column {column}: {}", expected.trim())
        }
        _ => error.replace('\n', " "),
    }
}

fn frame(stated: &Stated<'_>, message: &Message) -> Frame {
    // Places that no frame has are dropped with their signals.
    let usable = |signal: &&can_dbc::Signal| (1..=64).contains(&signal.size) && signal.start_bit < 8 * 64;
    let signals: Vec<&can_dbc::Signal> = message.signals.iter().filter(usable).take(MOST_SIGNALS).collect();
    let chosen = Chosen {
        stated,
        id: message.id,
        places: signals.iter().zip(0..).map(|(signal, at)| (signal.name.as_str(), at)).collect(),
        first: signals.iter().position(|one| one.multiplexer_indicator == MultiplexIndicator::Multiplexor),
        signals,
    };
    let mut places: BTreeMap<Vec<Condition>, usize> = BTreeMap::new();
    let mut sets: Vec<Set> = Vec::new();
    for index in 0..chosen.signals.len() {
        let conditions = chosen.conditions(index, 0);
        let place = *places.entry(conditions).or_insert_with_key(|conditions| {
            let name = set_name(message, &chosen.signals, conditions);
            sets.push(Set { name, conditions: conditions.clone(), signals: Vec::new() });
            sets.len() - 1
        });
        sets[place].signals.push(index);
    }
    let signals = chosen.signals.iter().map(|signal| self::signal(stated, message.id, signal)).collect();
    Frame { signals, sets, left_aside: message.signals.len() - chosen.signals.len() }
}

fn signal(stated: &Stated<'_>, id: MessageId, signal: &can_dbc::Signal) -> Signal {
    let kind = match stated.kinds.get(&(id, signal.name.as_str())) {
        Some(SignalExtendedValueType::IEEEfloat32Bit) if signal.size == 32 => Kind::Float,
        Some(SignalExtendedValueType::IEEEdouble64bit) if signal.size == 64 => Kind::Double,
        _ if signal.value_type == ValueType::Signed => Kind::Signed,
        _ => Kind::Unsigned,
    };
    Signal {
        name: signal.name.clone(),
        unit: signal.unit.clone(),
        factor: signal.factor,
        offset: signal.offset,
        kind,
        place: Place {
            start: signal.start_bit as usize,
            bits: signal.size as usize,
            is_big_endian: signal.byte_order == ByteOrder::BigEndian,
        },
    }
}

/// Signals of a message, some of which others choose.
struct Chosen<'d> {
    stated: &'d Stated<'d>,
    id: MessageId,
    signals: Vec<&'d can_dbc::Signal>,
    /// Index of each signal by its name.
    places: HashMap<&'d str, usize>,
    /// Index of the multiplexer of those that name none.
    first: Option<usize>,
}

impl Chosen<'_> {
    /// When a signal is in the frame: the values of its multiplexer, and of the multiplexer of that.
    fn conditions(&self, index: usize, depth: usize) -> Vec<Condition> {
        let signal = self.signals[index];
        let own = match signal.multiplexer_indicator {
            MultiplexIndicator::MultiplexedSignal(value)
            | MultiplexIndicator::MultiplexorAndMultiplexedSignal(value) => value,
            MultiplexIndicator::Plain | MultiplexIndicator::Multiplexor => return Vec::new(),
        };
        let (multiplexer, ranges) = match self.stated.multiplexed.get(&(self.id, signal.name.as_str())) {
            Some(one) => (
                self.places.get(one.multiplexor_signal_name.as_str()).copied(),
                one.mappings.iter().map(|range| (range.min_value, range.max_value)).collect(),
            ),
            None => (self.first, vec![(own, own)]),
        };
        let Some(multiplexer) = multiplexer.filter(|_| depth < DEEPEST) else { return Vec::new() };
        let mut all = self.conditions(multiplexer, depth + 1);
        all.push(Condition { multiplexer, ranges });
        all
    }
}

/// Name of signals under conditions: `Motor Mode=1`.
fn set_name(message: &can_dbc::Message, signals: &[&can_dbc::Signal], conditions: &[Condition]) -> String {
    let mut name = message.name.clone();
    for condition in conditions {
        let range = |(first, last): &(u64, u64)| {
            if first == last { first.to_string() } else { format!("{first}-{last}") }
        };
        let ranges: Vec<String> = condition.ranges.iter().map(range).collect();
        name.push_str(&format!(" {}={}", signals[condition.multiplexer].name, ranges.join(",")));
    }
    name
}

impl Frame {
    /// Whether a set's signals are in a frame.
    pub(super) fn holds(&self, set: &Set, bytes: &[u8]) -> bool {
        set.conditions.iter().all(|condition| {
            let value = self.signals[condition.multiplexer].place.whole(bytes);
            value.is_some_and(|value| {
                condition.ranges.iter().any(|(first, last)| (*first..=*last).contains(&value))
            })
        })
    }
}

impl Signal {
    /// The physical value; `None` where the frame is too short.
    pub(super) fn value(&self, bytes: &[u8]) -> Option<f64> {
        Some(self.place.number(self.kind, bytes)? * self.factor + self.offset)
    }
}
