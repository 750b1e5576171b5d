//! Units in the spelling of other programs.

use crate::scale::{self, Scale};
use crate::table::Words;
use crate::{Conversion, Product, Unit};

/// Spellings that no rule covers, with their meanings.
const ALIASES: [(&str, &str); 7] = [
    ("1/min", "rpm"),
    ("min^-1", "rpm"),
    ("r/min", "rpm"),
    ("upm", "rpm"),
    ("ft lb", "lbf ft"),
    ("in lb", "lbf in"),
    ("-", "1"),
];

/// The conversion of a unit, in the spelling of any program, into that of a channel; `None` if it is unknown or no channel has it.
///
/// ```
/// use socam_units::{Unit, conversion};
///
/// let speed = conversion("°/s").expect("a unit");
/// assert_eq!((speed.unit, (180.0 * speed.factor * 1e6).round()), (Unit::RadPerS, 3_141_593.0));
/// assert_eq!(conversion("deg_per_s"), conversion("deg/s"));
/// assert_eq!((conversion("furlong"), conversion("Hz")), (None, None));
/// ```
#[must_use]
pub fn conversion(text: &str) -> Option<Conversion> {
    let plain = plain(text);
    let scale = read(&plain)?;
    // A strain in mV/V is a pure number of an unknown quantity.
    let is_named = Words::All.row(&plain).is_some();
    let unit = Unit::of(scale.product).filter(|unit| *unit != Unit::One || is_named || plain == "-")?;
    Some(Conversion { unit, factor: scale.factor, offset: scale.offset })
}

/// Seconds in a unit of time.
#[must_use]
pub fn seconds(text: &str) -> Option<f64> {
    read(&plain(text)).filter(|scale| scale.product == Product::SECOND).map(|scale| scale.factor)
}

/// Whether a unit is that of an encoder's counts.
#[must_use]
pub fn is_counts(text: &str) -> bool {
    matches!(
        plain(text).to_ascii_lowercase().as_str(),
        "counts" | "count" | "cts" | "ticks" | "inc" | "increments" | "lsb"
    )
}

fn read(plain: &str) -> Option<Scale> {
    let meant =
        ALIASES.iter().find(|(alias, _)| alias.eq_ignore_ascii_case(plain)).map_or(plain, |(_, meant)| meant);
    scale::read(meant, Words::All)
        .or_else(|| {
            // `degps` and `mps`: angles and lengths per second.
            let row = Words::All.row(plain.strip_suffix("ps")?)?;
            let moves = matches!(Unit::of(row.product), Some(Unit::Rad | Unit::M));
            moves.then(|| scale::read(&format!("{}/s", row.name), Words::All))?
        })
        .or_else(|| {
            // `Volt`, `SECOND`: words in whatever letters. Shorter names mean other units in other letters.
            const SHORTEST: usize = 4;
            let is_word = plain.len() >= SHORTEST && plain.bytes().all(|letter| letter.is_ascii_alphabetic());
            is_word.then(|| scale::read(&plain.to_ascii_lowercase(), Words::All))?
        })
}

/// A unit in the grammar of this crate: `°/s`, `[rad·s⁻¹]`, `deg_per_s` and `µm` become `deg/s`, `rad s^-1`, `deg/s` and `um`.
fn plain(text: &str) -> String {
    let mut inner = text.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        inner = inner.strip_prefix(open).and_then(|rest| rest.strip_suffix(close)).unwrap_or(inner).trim();
    }
    let mut plain = String::new();
    let mut letters = inner.chars().peekable();
    while let Some(c) = letters.next() {
        let behind_letter = plain.ends_with(|c: char| c.is_alphabetic());
        match c {
            '\u{b5}' | '\u{3bc}' => plain.push('u'),
            '\u{b7}' | '*' | '\u{22c5}' | '.' => plain.push(' '),
            '\u{b2}' => plain.push('2'),
            '\u{b3}' => plain.push('3'),
            '\u{b9}' => plain.push('1'),
            '\u{207b}' => plain.push_str("^-"),
            '\u{b0}' | '\u{ba}' => plain.push_str("deg"),
            '-' if behind_letter && letters.peek().is_some_and(char::is_ascii_digit) => plain.push_str("^-"),
            '-' if behind_letter => plain.push(' '),
            c => plain.push(c),
        }
    }
    let plain = quotient(&plain.replace('_', " _ "));
    plain
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .replace(" / ", "/")
        .replace(" /", "/")
        .replace("/ ", "/")
}

/// Quotients in words: `deg _ per _ s` is `deg/s`, and so is `deg _ s`, the form in names of columns. If there are several slashes, all
/// factors after the first one divide.
fn quotient(text: &str) -> String {
    let mut words: Vec<&str> = text.split(' ').collect();
    let under = words.iter().filter(|word| **word == "_").count();
    words.retain(|word| *word != "_" && !word.is_empty());
    let has_slash = words.iter().any(|word| word.contains('/') || *word == "per");
    if under > 0 && !has_slash && words.len() > 1 && matches!(words.last(), Some(&("s" | "s2"))) {
        words.insert(words.len() - 1, "/");
    }
    let text = words.iter().map(|word| if *word == "per" { "/" } else { word }).collect::<Vec<_>>().join(" ");
    match text.split_once('/') {
        Some((above, below)) if !below.contains('(') => format!("{above}/{}", below.replace('/', " ")),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn units_of_other_programs_become_si() {
        for (text, unit, factor) in [
            ("rpm", Unit::RadPerS, TAU / 60.0),
            ("U/min", Unit::RadPerS, TAU / 60.0),
            ("Upm", Unit::RadPerS, TAU / 60.0),
            ("1/min", Unit::RadPerS, TAU / 60.0),
            ("min-1", Unit::RadPerS, TAU / 60.0),
            ("min\u{207b}\u{b9}", Unit::RadPerS, TAU / 60.0),
            ("rev/s", Unit::RadPerS, TAU),
            ("rot_per_s", Unit::RadPerS, TAU),
            ("deg/s", Unit::RadPerS, PI / 180.0),
            ("degps", Unit::RadPerS, PI / 180.0),
            ("deg_per_s", Unit::RadPerS, PI / 180.0),
            ("\u{b0}/s\u{b2}", Unit::RadPerS2, PI / 180.0),
            ("deg/s/s", Unit::RadPerS2, PI / 180.0),
            ("rad\u{b7}s\u{207b}\u{b9}", Unit::RadPerS, 1.0),
            ("rad s-2", Unit::RadPerS2, 1.0),
            ("rad_s", Unit::RadPerS, 1.0),
            ("rad_s2", Unit::RadPerS2, 1.0),
            ("rad_per_s2", Unit::RadPerS2, 1.0),
            ("\u{b0}", Unit::Rad, PI / 180.0),
            ("[mm/s]", Unit::MPerS, 1e-3),
            ("m / s", Unit::MPerS, 1.0),
            ("km/h", Unit::MPerS, 1.0 / 3.6),
            ("m/s^2", Unit::MPerS2, 1.0),
            ("\u{b5}m", Unit::M, 1e-6),
            ("N\u{b7}m", Unit::Nm, 1.0),
            ("N-m", Unit::Nm, 1.0),
            ("N.m", Unit::Nm, 1.0),
            ("mN m", Unit::Nm, 1e-3),
            ("kN m", Unit::Nm, 1e3),
            ("lbf*ft", Unit::Nm, 1.355_817_948_331_400_4),
            ("lbf-ft", Unit::Nm, 1.355_817_948_331_400_4),
            ("in lb", Unit::Nm, 0.112_984_829_027_616_7),
            ("kgf.cm", Unit::Nm, 0.098_066_5),
            ("volts", Unit::V, 1.0),
            ("%", Unit::One, 0.01),
            ("-", Unit::One, 1.0),
        ] {
            let found = conversion(text).unwrap_or_else(|| panic!("`{text}` is not known"));
            assert!(found.unit == unit && (found.factor / factor - 1.0).abs() < 1e-12, "{text}: {found:?}");
        }
        let celsius = conversion("\u{b0}C").map(|c| (c.unit, c.factor, c.offset));
        assert_eq!(celsius, Some((Unit::K, 1.0, 273.15)));
        // `nm` is a nanometre or a torque written carelessly, which cannot be decided. The others are not units of channels.
        for text in ["nm", "Hz", "g", "", "rad s", "N/m", "mV/V", "min/s", "W", "J", "counts/s", "s", "1/s"] {
            assert_eq!(conversion(text), None, "{text}");
        }
    }

    #[test]
    fn times_and_counts_are_told_apart() {
        for (text, factor) in [("s", 1.0), ("[ms]", 1e-3), ("\u{b5}s", 1e-6), ("min", 60.0), ("h", 3600.0)] {
            assert_eq!(seconds(text), Some(factor), "{text}");
        }
        assert_eq!((seconds("rpm"), seconds("m"), seconds("")), (None, None, None));
        assert!(is_counts("Counts") && is_counts("[ticks]") && !is_counts("rpm"));
    }
}
