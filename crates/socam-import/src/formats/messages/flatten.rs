//! Numbers in a message, each with its path: `pose.position.x`, `velocity.2`, `velocity.elbow`.

use mcapdecode_core::{DataTypeDef, FieldDefs, Value};

/// Longest list whose elements are signals.
const LONGEST_LIST: usize = 64;
/// Structures within structures that are looked into.
const DEEPEST: usize = 16;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Float(f64),
    Integer(i64),
    /// Nanoseconds since 1970.
    Time(i64),
}

/// Paths and numbers of one message.
#[derive(Default)]
pub(super) struct Numbers(pub(super) Vec<(String, Number)>);

/// Names of the seconds and nanoseconds of a time.
const TIMES: [(&str, &str); 4] =
    [("sec", "nanosec"), ("sec", "nsec"), ("seconds", "nanos"), ("secs", "nsecs")];

fn below(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

impl Numbers {
    fn put(&mut self, path: &str, number: Number) {
        self.0.push((path.to_owned(), number));
    }

    /// A message by its schema.
    pub(super) fn message(&mut self, fields: &FieldDefs, value: &Value) {
        self.structure("", fields, value, 0);
    }

    fn structure(&mut self, path: &str, fields: &FieldDefs, value: &Value, depth: usize) {
        let Value::Struct(values) = value else { return };
        if depth > DEEPEST {
            return;
        }
        let named = || fields.iter().map(|field| field.name.as_str()).zip(values);
        if let Some(time) = time(named().map(|(name, value)| (name, integer(value)))) {
            return self.put(path, Number::Time(time));
        }
        // A list of names beside lists of numbers, as in ROS' JointState.
        let names =
            named().find(|(name, _)| *name == "name" || *name == "names").and_then(|(_, value)| texts(value));
        for (field, value) in fields.iter().zip(values) {
            let path = below(path, &field.name);
            self.value(&path, &field.element.data_type, value, names.as_deref(), depth);
        }
    }

    fn value(
        &mut self,
        path: &str,
        kind: &DataTypeDef,
        value: &Value,
        names: Option<&[String]>,
        depth: usize,
    ) {
        let inner = match kind {
            DataTypeDef::Struct(inner) => return self.structure(path, &inner.fields, value, depth + 1),
            DataTypeDef::List(inner) | DataTypeDef::BoundedList(inner, _) | DataTypeDef::Array(inner, _) => {
                inner
            }
            _ => {
                if let Some(number) = number(value) {
                    self.put(path, number);
                }
                return;
            }
        };
        let (Value::List(values) | Value::Array(values)) = value else { return };
        if values.len() > LONGEST_LIST {
            return;
        }
        let names = names.filter(|names| names.len() == values.len());
        for (index, value) in values.iter().enumerate() {
            let path = match names {
                Some(names) => format!("{path}.{}", names[index]),
                None => format!("{path}.{index}"),
            };
            self.value(&path, &inner.data_type, value, None, depth + 1);
        }
    }

    /// A message in JSON.
    pub(super) fn json(&mut self, path: &str, value: &serde_json::Value) {
        self.json_at(path, value, None, 0);
    }

    fn json_at(&mut self, path: &str, value: &serde_json::Value, names: Option<&[String]>, depth: usize) {
        use serde_json::Value as Json;
        if depth > DEEPEST {
            return;
        }
        match value {
            Json::Number(number) => match number.as_i64() {
                Some(integer) => self.put(path, Number::Integer(integer)),
                None => self.put(path, Number::Float(number.as_f64().unwrap_or(f64::NAN))),
            },
            Json::Bool(flag) => self.put(path, Number::Integer(i64::from(*flag))),
            Json::Object(fields) => {
                let whole = fields.iter().map(|(name, value)| (name.as_str(), value.as_i64()));
                if let Some(time) = time(whole) {
                    return self.put(path, Number::Time(time));
                }
                let names = fields.get("name").or_else(|| fields.get("names")).and_then(json_texts);
                for (name, value) in fields {
                    self.json_at(&below(path, name), value, names.as_deref(), depth + 1);
                }
            }
            Json::Array(values) if values.len() <= LONGEST_LIST => {
                let names = names.filter(|names| names.len() == values.len());
                for (index, value) in values.iter().enumerate() {
                    let path = match names {
                        Some(names) => format!("{path}.{}", names[index]),
                        None => format!("{path}.{index}"),
                    };
                    self.json_at(&path, value, None, depth + 1);
                }
            }
            Json::Array(_) | Json::String(_) | Json::Null => {}
        }
    }
}

/// Nanoseconds, where the fields are just seconds and nanoseconds.
fn time<'f>(fields: impl Iterator<Item = (&'f str, Option<i64>)>) -> Option<i64> {
    let fields: Vec<_> = fields.take(3).collect();
    let [(first, Some(seconds)), (second, Some(nanoseconds))] = fields.as_slice() else { return None };
    let (names, seconds, nanoseconds) = if first.starts_with("sec") {
        ((*first, *second), *seconds, *nanoseconds)
    } else {
        ((*second, *first), *nanoseconds, *seconds)
    };
    TIMES.contains(&names).then(|| seconds.saturating_mul(1_000_000_000).saturating_add(nanoseconds))
}

fn number(value: &Value) -> Option<Number> {
    match value {
        Value::F32(value) => Some(Number::Float(f64::from(*value))),
        Value::F64(value) => Some(Number::Float(*value)),
        Value::Bool(value) => Some(Number::Integer(i64::from(*value))),
        other => integer(other).map(Number::Integer),
    }
}

fn integer(value: &Value) -> Option<i64> {
    Some(match value {
        Value::I8(value) => (*value).into(),
        Value::I16(value) => (*value).into(),
        Value::I32(value) => (*value).into(),
        Value::I64(value) => *value,
        Value::U8(value) => (*value).into(),
        Value::U16(value) => (*value).into(),
        Value::U32(value) => (*value).into(),
        Value::U64(value) => i64::try_from(*value).ok()?,
        _ => return None,
    })
}

fn texts(value: &Value) -> Option<Vec<String>> {
    let (Value::List(values) | Value::Array(values)) = value else { return None };
    values.iter().map(|value| value.try_str().ok().flatten().map(str::to_owned)).collect()
}

fn json_texts(value: &serde_json::Value) -> Option<Vec<String>> {
    value.as_array()?.iter().map(|value| value.as_str().map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_beside_names_are_named() {
        let text = r#"{"stamp": {"sec": 2, "nanosec": 5}, "name": ["hip", "knee"], "velocity": [1.5, 2], "ok": true, "map": {"x": [3.5]}}"#;
        let mut numbers = Numbers::default();
        numbers.json("", &serde_json::from_str(text).unwrap());
        numbers.0.sort_by(|a, b| a.0.cmp(&b.0));
        let expected = [
            ("map.x.0", Number::Float(3.5)),
            ("ok", Number::Integer(1)),
            ("stamp", Number::Time(2_000_000_005)),
            ("velocity.hip", Number::Float(1.5)),
            ("velocity.knee", Number::Integer(2)),
        ];
        assert_eq!(numbers.0, expected.map(|(path, number)| (path.to_owned(), number)));
    }
}
