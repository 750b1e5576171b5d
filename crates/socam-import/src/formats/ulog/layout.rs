//! Definitions of ULog's messages, and where each number stands in the bytes of one.

use std::collections::HashMap;

use crate::formats::stream::{Fields, Problem};
use crate::source::Signal;

/// Structures within structures that are looked into.
const DEEPEST: usize = 16;
/// Longest array whose elements are signals.
const LONGEST_ARRAY: usize = 64;
/// Most signals of a topic.
const MOST_SIGNALS: usize = 1024;
/// Most fields that are looked at, so that structures of structures end.
const MOST_VISITS: usize = 1 << 14;
/// Longest message: its length has two bytes.
const LONGEST: usize = 1 << 16;

/// What a number is written as.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Int64,
    Uint64,
    Float,
    Double,
    Bool,
    Char,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "int8_t" => Self::Int8,
            "uint8_t" => Self::Uint8,
            "int16_t" => Self::Int16,
            "uint16_t" => Self::Uint16,
            "int32_t" => Self::Int32,
            "uint32_t" => Self::Uint32,
            "int64_t" => Self::Int64,
            "uint64_t" => Self::Uint64,
            "float" => Self::Float,
            "double" => Self::Double,
            "bool" => Self::Bool,
            "char" => Self::Char,
            _ => return None,
        })
    }

    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::Int8 | Self::Uint8 | Self::Bool | Self::Char => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float => 4,
            Self::Int64 | Self::Uint64 | Self::Double => 8,
        }
    }
}

/// A number in the bytes of a message.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    /// Its place in the message: `esc.0.esc_rpm`.
    pub(super) path: String,
    pub(super) kind: Kind,
    /// Byte at which it begins.
    pub(super) at: usize,
}

impl Field {
    /// The signal that its values become; times are in microseconds.
    pub(super) fn signal(&self) -> Signal {
        let is_time = self.kind == Kind::Uint64 && self.path.starts_with("timestamp");
        Signal::new(self.path.clone(), is_time.then(|| "us".to_owned()), Vec::new())
    }

    /// Appends the number that stands in a message.
    pub(super) fn push(&self, message: &[u8], to: &mut Signal) -> Option<()> {
        let mut fields = Fields(message.get(self.at..)?);
        match self.kind {
            Kind::Float => to.values.push(fields.f32()?.into()),
            Kind::Double => to.values.push(fields.f64()?),
            Kind::Int8 => to.push_integer((fields.u8()? as i8).into()),
            Kind::Int16 => to.push_integer((fields.u16()? as i16).into()),
            Kind::Int32 => to.push_integer((fields.u32()? as i32).into()),
            Kind::Int64 | Kind::Uint64 => to.push_integer(fields.u64()? as i64),
            Kind::Uint8 | Kind::Bool | Kind::Char => to.push_integer(fields.u8()?.into()),
            Kind::Uint16 => to.push_integer(fields.u16()?.into()),
            Kind::Uint32 => to.push_integer(fields.u32()?.into()),
        }
        Some(())
    }
}

/// Definitions by name: type, length of the array and name of each field.
#[derive(Default)]
pub(super) struct Formats(HashMap<String, Vec<(String, Option<usize>, String)>>);

impl Formats {
    /// Takes a definition: `name:type field;type[3] field;`.
    pub(super) fn add(&mut self, text: &str) {
        let Some((name, fields)) = text.split_once(':') else { return };
        let field = |text: &str| {
            let (kind, name) = text.trim().split_once(' ')?;
            let Some((kind, length)) = kind.split_once('[') else {
                return Some((kind.to_owned(), None, name.to_owned()));
            };
            let length = length.strip_suffix(']')?.parse().ok()?;
            Some((kind.to_owned(), Some(length), name.to_owned()))
        };
        self.0.insert(name.to_owned(), fields.split(';').filter_map(field).collect());
    }

    /// The numbers of a topic's messages.
    pub(super) fn fields(&self, topic: &str) -> Result<Vec<Field>, Problem> {
        let mut walk = Walk { formats: self, found: Vec::new(), at: 0, visits: 0 };
        walk.format("", topic, 0)?;
        Ok(walk.found)
    }
}

/// A walk through a definition and those that it names.
struct Walk<'f> {
    formats: &'f Formats,
    found: Vec<Field>,
    at: usize,
    visits: usize,
}

impl Walk<'_> {
    fn format(&mut self, path: &str, name: &str, depth: usize) -> Result<(), Problem> {
        let formats = self.formats;
        let fields = formats.0.get(name).ok_or_else(|| format!("its file does not define `{name}`"))?;
        if depth > DEEPEST {
            return Err(format!("`{name}` stands more than {DEEPEST} structures deep"));
        }
        for (kind, length, field) in fields {
            let below = if path.is_empty() { field.clone() } else { format!("{path}.{field}") };
            let is_padding = field.starts_with("_padding");
            match (Kind::of(kind), length) {
                (Some(kind), _) if is_padding || kind == Kind::Char => {
                    self.pass(kind.bytes().saturating_mul(length.unwrap_or(1)))?;
                }
                (Some(kind), Some(length)) if *length > LONGEST_ARRAY => {
                    self.pass(kind.bytes().saturating_mul(*length))?;
                }
                (Some(kind), None) => self.number(below, kind)?,
                (Some(kind), Some(length)) => {
                    (0..*length).try_for_each(|index| self.number(format!("{below}.{index}"), kind))?;
                }
                (None, None) => self.format(&below, kind, depth + 1)?,
                (None, Some(length)) => {
                    for index in 0..*length {
                        self.pass(0)?;
                        self.format(&format!("{below}.{index}"), kind, depth + 1)?;
                    }
                }
            }
        }
        self.pass(0)
    }

    /// Passes over bytes; says where there are too many.
    fn pass(&mut self, bytes: usize) -> Result<(), Problem> {
        self.at = self.at.saturating_add(bytes);
        self.visits += 1;
        if self.at > LONGEST || self.visits > MOST_VISITS {
            return Err(format!("its definition has more than {LONGEST} bytes or {MOST_VISITS} fields"));
        }
        Ok(())
    }

    fn number(&mut self, path: String, kind: Kind) -> Result<(), Problem> {
        if self.found.len() < MOST_SIGNALS {
            self.found.push(Field { path, kind, at: self.at });
        }
        self.pass(kind.bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_nested_definitions_have_their_place() {
        let mut formats = Formats::default();
        formats.add("esc:uint64_t timestamp;report[2] esc;uint8_t[3] _padding0;char[5] name;float[2] xy;");
        formats.add("report:int16_t rpm;uint8_t[2] _padding0;float voltage;");
        let fields = formats.fields("esc").unwrap();
        let places: Vec<(&str, usize)> = fields.iter().map(|field| (field.path.as_str(), field.at)).collect();
        let expected = [
            ("timestamp", 0),
            ("esc.0.rpm", 8),
            ("esc.0.voltage", 12),
            ("esc.1.rpm", 16),
            ("esc.1.voltage", 20),
            ("xy.0", 32),
            ("xy.1", 36),
        ];
        assert_eq!(places, expected);
    }

    #[test]
    fn endless_definitions_end() {
        let mut formats = Formats::default();
        formats.add("ring:ring next;");
        formats.add("wide:uint8_t[99999999999] x;");
        formats.add("many:empty[99999999999] x;");
        formats.add("empty:");
        assert!(formats.fields("ring").unwrap_err().contains("more than 16 structures deep"));
        for name in ["wide", "many"] {
            assert!(formats.fields(name).unwrap_err().contains("more than 65536 bytes"), "{name}");
        }
        assert_eq!(formats.fields("none").unwrap_err(), "its file does not define `none`");
    }
}
