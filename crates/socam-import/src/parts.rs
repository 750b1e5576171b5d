//! Parts of the readers for streams that are read while they run: cells of a line, values of a record, names, units and layouts.

use serde_json::{Map, Value};
use socam_units::Column;

use crate::text::{Cell, TextLayout, cell, sniff};

/// Content of a cell of a line, or of a member of a JSON record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Content {
    /// A finite number.
    Number(f64),
    /// Nothing, or a word for "no value".
    Missing,
    /// Text, a date, a list or an object.
    Other,
}

/// The content of a cell of a line of text.
#[must_use]
pub fn content(text: &str, decimal_comma: bool) -> Content {
    match cell(text, decimal_comma, None) {
        Cell::Number(number) => Content::Number(number),
        Cell::Missing => Content::Missing,
        Cell::Date(_) | Cell::Text => Content::Other,
    }
}

/// Calls `take` with each value of a JSON record, by the names that records of files have: `a.b` for a member of a member.
pub fn record(members: &Map<String, Value>, take: &mut dyn FnMut(String, Content)) {
    crate::formats::json::flatten("", members, &mut |name, value| {
        let content = match value {
            Value::Null => Content::Missing,
            Value::Bool(value) => Content::Number(f64::from(u8::from(*value))),
            Value::Number(number) => {
                number.as_f64().filter(|number| number.is_finite()).map_or(Content::Other, Content::Number)
            }
            Value::String(text) => content(text, false),
            Value::Array(_) | Value::Object(_) => Content::Other,
        };
        take(name, content);
    });
}

/// The layout of lines of text with numbers; `None` where nothing looks like a table of numbers.
#[must_use]
pub fn layout(text: &str) -> Option<TextLayout> {
    sniff("utf-8", text, false)
}

/// Whether a column seems to hold times, by its unit or its name.
#[must_use]
pub fn is_time_like(column: &Column) -> bool {
    crate::time_names::is_time_like(column)
}

/// The unit that a column without one most likely has, by its name.
#[must_use]
pub fn likeliest_unit(column: &Column) -> Option<&'static str> {
    crate::propose::likeliest(column)
}
