//! Settings of a motor's controller as names and values, whatever file holds them.

use serde_json::Value;

use crate::error::{Result, RobotError};
use crate::joint::Sourced;

/// One setting.
struct Setting {
    name: String,
    value: String,
    /// Number of its line, from 1, where the file has one setting a line.
    line: Option<u32>,
}

/// All settings of a file.
pub(crate) struct Settings {
    all: Vec<Setting>,
}

impl Settings {
    /// Lines of a name and a value, as `moteus_tool --dump-config` prints them, or of `conf set`.
    pub(crate) fn lines(text: &str) -> Result<Self> {
        let mut all = Vec::new();
        for (line, written) in (1..).zip(text.lines()) {
            let written = written.trim().trim_start_matches('\u{feff}');
            let setting = written.strip_prefix("conf set ").unwrap_or(written);
            let is_nothing = setting.is_empty() || setting.starts_with('#') || setting == "OK";
            if is_nothing || setting.starts_with("conf ") {
                continue;
            }
            let [name, value] = setting.split_whitespace().collect::<Vec<_>>()[..] else {
                let problem = format!(
                    "holds `{}`, where a setting and its value were expected, such as `motor.poles 14`",
                    shortened(setting)
                );
                return Err(RobotError::Line { line, problem });
            };
            all.push(Setting { name: name.to_owned(), value: value.to_owned(), line: Some(line) });
        }
        Ok(Self { all })
    }

    /// An object of JSON, in one another (`{"axis0": {"motor": ...`) or flat (`{"axis0.config.motor...": ...`).
    pub(crate) fn json(text: &str) -> Result<Self> {
        let value: Value = serde_json::from_str(&without_infinity(text)).map_err(|error| {
            let line = u32::try_from(error.line()).unwrap_or(u32::MAX);
            RobotError::Line { line, problem: format!("is no JSON: {error}") }
        })?;
        let mut all = Vec::new();
        flatten(&value, "", &mut all);
        Ok(Self { all })
    }

    pub(crate) fn count(&self) -> usize {
        self.all.len()
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.all.iter().any(|setting| setting.name == name)
    }

    /// The number of a setting, with its place; `None` where it is not there, or is set to nothing (`nan`, infinity).
    pub(crate) fn number(&self, name: &str) -> Result<Option<Sourced>> {
        // The last one holds, as in the controller.
        let Some(setting) = self.all.iter().rev().find(|setting| setting.name == name) else {
            return Ok(None);
        };
        let Ok(value) = setting.value.parse::<f64>() else {
            let problem = format!("`{name}` is `{}`, where a number was expected", shortened(&setting.value));
            return Err(setting.line.map_or_else(
                || RobotError::Whole(problem.clone()),
                |line| RobotError::Line { line, problem: problem.clone() },
            ));
        };
        let source = setting.line.map_or_else(|| name.to_owned(), |line| format!("line {line}, {name}"));
        Ok(value.is_finite().then_some(Sourced { value, source }))
    }

    /// The first of several settings that is there, above zero.
    pub(crate) fn positive(&self, names: &[&str]) -> Result<Option<Sourced>> {
        for name in names {
            if let Some(found) = self.number(name)?.filter(|found| found.value > 0.0) {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }
}

fn flatten(value: &Value, name: &str, all: &mut Vec<Setting>) {
    match value {
        Value::Object(members) => {
            for (key, inner) in members {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                flatten(inner, &name, all);
            }
        }
        Value::Array(_) => {}
        scalar => {
            let value = match scalar {
                Value::String(text) => text.clone(),
                Value::Bool(set) => u8::from(*set).to_string(),
                Value::Null => "nan".to_owned(),
                other => other.to_string(),
            };
            all.push(Setting { name: name.to_owned(), value, line: None });
        }
    }
}

/// The text with `null` for the infinities and NaN that Python writes into JSON, which has none.
fn without_infinity(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let (mut rest, mut in_string) = (text.trim_start_matches('\u{feff}'), false);
    while let Some(next) = rest.chars().next() {
        let token = ["-Infinity", "Infinity", "NaN"].iter().find(|token| rest.starts_with(**token));
        if let Some(token) = token.filter(|_| !in_string) {
            plain.push_str("null");
            rest = &rest[token.len()..];
            continue;
        }
        let escaped = if in_string && next == '\\' { rest[1..].chars().next() } else { None };
        in_string ^= next == '"';
        plain.push(next);
        plain.extend(escaped);
        rest = &rest[next.len_utf8() + escaped.map_or(0, char::len_utf8)..];
    }
    plain
}

/// The beginning of a text, for a message.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 40;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}
