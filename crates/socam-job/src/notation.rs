//! How values of options are written: on the command line, and as keywords.
//!
//! The serialised form of an option is the text, number or switch that is typed on the command line. As keywords, lists and mappings are
//! taken too: `band=(1.0, 50.0)` for `1..50`, `fixed={"k3": 52485.0}` for `k3=52485`.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};
use serde_json::Value;
use socam_frequency::rational::Orders;
use socam_identify::Band;

/// A time with a unit, s.
pub fn seconds(text: &str) -> Result<f64, String> {
    let end = text.rfind(|c: char| !c.is_ascii_alphabetic()).map_or(0, |last| last + 1);
    let (number, unit) = text.split_at(end);
    let factor = match unit {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(format!("`{unit}` is no unit of time; expected s, ms, min or h")),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value * factor),
        Ok(value) => Err(format!("{value} is no duration; it must be greater than 0")),
        Err(_) => Err("expected a time, as in 10s, 1.5min or 500ms".into()),
    }
}

/// A time within which a task shall end, s; zero means no end.
pub(crate) fn budget(text: &str) -> Result<f64, String> {
    if text.parse() == Ok(0.0) { Ok(0.0) } else { seconds(text) }
}

/// A number to five significant digits.
#[must_use]
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.4e}");
    }
    let decimals = (4 - size.log10().floor() as i32).max(0) as usize;
    format!("{value:.decimals$}")
}

/// A positive number.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0);
    number.ok_or_else(|| "expected a positive number".into())
}

/// The text, checked to be a `T`; it is parsed again when the task runs.
pub(crate) fn text_of<T: std::str::FromStr<Err: std::fmt::Display>>(text: &str) -> Result<String, String> {
    text.parse::<T>().map(|_| text.to_owned()).map_err(|error| error.to_string())
}

/// A text unchanged, or the numbers of a list joined.
fn joined(value: &Value, separator: &str) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(parts) => {
            parts.iter().map(|part| joined(part, separator)).collect::<Vec<_>>().join(separator)
        }
        other => other.to_string(),
    }
}

/// An option that is written as a text, and as a keyword also as a list of its numbers.
macro_rules! written {
    ($name:ident: $type:ty, $separator:literal, $read:expr, $write:expr) => {
        pub(crate) mod $name {
            use super::*;

            pub(crate) fn read(text: &str) -> Result<$type, String> {
                let read: fn(&str) -> Result<$type, String> = $read;
                read(text)
            }

            pub(crate) fn serialize<S: Serializer>(value: &Option<$type>, to: S) -> Result<S::Ok, S::Error> {
                let write: fn(&$type) -> String = $write;
                match value {
                    Some(value) => to.serialize_str(&write(value)),
                    None => to.serialize_none(),
                }
            }

            pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<$type>, D::Error> {
                match Value::deserialize(from)? {
                    Value::Null => Ok(None),
                    value => read(&joined(&value, $separator)).map(Some).map_err(D::Error::custom),
                }
            }
        }
    };
}

/// Two texts around a separator.
fn halves<A: std::str::FromStr, B: std::str::FromStr>(text: &str, separator: &str) -> Option<(A, B)> {
    let (a, b) = text.split_once(separator)?;
    Some((a.trim().parse().ok()?, b.trim().parse().ok()?))
}

written!(band: Band, "..", |text| {
    let expected = "expected LOW..HIGH in Hz, as in 2..80";
    let (low, high) = halves(text, "..").ok_or(expected)?;
    Band::new(low, high).map_err(|error| error.to_string())
}, |band| format!("{}..{}", band.low_hz(), band.high_hz()));

written!(low_pass: (f64, usize), ":", |text| {
    let (corner, order) = text.split_once(':').unwrap_or((text, "4"));
    let order = order.parse().map_err(|_| "expected HZ[:ORDER], as in 60:4")?;
    Ok((positive(corner)?, order))
}, |(corner, order)| format!("{corner}:{order}"));

written!(orders: Orders, "/", |text| {
    let expected = "expected NUMERATOR/DENOMINATOR, as in 5/6";
    let (numerator, denominator) = halves(text, "/").ok_or(expected)?;
    Ok(Orders { numerator, denominator })
}, |orders| format!("{}/{}", orders.numerator, orders.denominator));

/// A share that the command line takes in percent: `1` or `1%`. As a keyword a number is the share itself.
pub(crate) mod percent {
    use super::*;

    pub(crate) fn read(text: &str) -> Result<f64, String> {
        let number = text.trim_end_matches('%').trim().parse::<f64>();
        number.map(|percent| percent / 100.0).map_err(|_| "expected a number in percent".into())
    }

    pub(crate) fn serialize<S: Serializer>(share: &f64, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&format!("{}%", 100.0 * share))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        match Value::deserialize(from)? {
            Value::String(text) => read(&text).map_err(D::Error::custom),
            other => f64::deserialize(other).map_err(D::Error::custom),
        }
    }
}

/// One of several words.
pub(crate) mod choice {
    use super::*;
    use clap::ValueEnum;

    pub(crate) fn serialize<T: ValueEnum, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
        let word = value.to_possible_value();
        to.serialize_str(word.as_ref().map_or("", |word| word.get_name()))
    }

    pub(crate) fn deserialize<'de, T: ValueEnum, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
        let text = String::deserialize(from)?;
        T::from_str(&text, false).map_err(|_| {
            let words = T::value_variants().iter().filter_map(ValueEnum::to_possible_value);
            let words: Vec<String> = words.map(|word| word.get_name().to_owned()).collect();
            let listed = match words.split_last() {
                Some((last, before)) if !before.is_empty() => format!("{} nor {last}", before.join(", ")),
                _ => words.join(", "),
            };
            D::Error::custom(format!("`{text}` is neither {listed}"))
        })
    }
}

/// Texts, as a keyword also one text, or a mapping of names to values: `NAME=VALUE`.
pub(crate) fn texts<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    let value = match Value::deserialize(from)? {
        Value::Object(pairs) => {
            return Ok(pairs.iter().map(|(name, value)| format!("{name}={}", joined(value, ","))).collect());
        }
        Value::String(one) => vec![Value::String(one)],
        Value::Array(all) => all,
        other => {
            return Err(D::Error::custom(format!(
                "invalid type: {other}, expected text, a list or a mapping"
            )));
        }
    };
    value.into_iter().map(String::deserialize).collect::<Result<_, _>>().map_err(D::Error::custom)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read() {
        for (text, expected) in
            [("10s", 10.0), ("10", 10.0), ("1.5min", 90.0), ("500ms", 0.5), ("1e-1s", 0.1), ("1e1", 10.0)]
        {
            assert!((seconds(text).unwrap() - expected).abs() < 1e-12, "{text}");
        }
        assert_eq!([budget("0"), budget("0.0"), budget("2min")], [Ok(0.0), Ok(0.0), Ok(120.0)]);
        for text in ["-1s", "0s", "ten", "5 years", "", "nan", "inf"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_band_is_two_numbers_in_order() {
        let band = band::read("2..80.5").unwrap();
        assert_eq!((band.low_hz(), band.high_hz()), (2.0, 80.5));
        for text in ["", "2", "2-80", "2..x", "..80", "80..2", "5..5", "-1..5"] {
            assert!(band::read(text).is_err(), "{text}");
        }
    }
}
