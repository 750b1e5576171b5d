//! Common parts of the names of signals, and guesses of a signal's unit.

use std::collections::HashSet;

use socam_units::{Column, Meaning, plain_name};

use super::Proposed;
use crate::mapping::is_name;
use crate::source::{Group, Signal};

/// Length of what the names of all signals of a group begin with, up to a dot.
pub(super) fn common_prefix(group: &Group) -> usize {
    let mut names = group.signals.iter().map(|signal| signal.name.as_str());
    let Some(first) = names.next() else { return 0 };
    let length = names.fold(first.len(), |length, name| {
        first.bytes().zip(name.bytes()).take(length).take_while(|(a, b)| a == b).count()
    });
    first.get(..length).and_then(|prefix| prefix.rfind('.')).map_or(0, |dot| dot + 1)
}

/// Makes the channels' names keys of a mapping: of letters, digits, underscores and dots, and each of them once.
pub(super) fn make_keys(channels: &mut [Proposed]) {
    let mut taken = HashSet::new();
    for channel in channels {
        let name = if is_name(&channel.name) { channel.name.clone() } else { plain_name(&channel.name) };
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let mut free = std::iter::once(name.clone()).chain(numbered);
        channel.name = free.find(|name| taken.insert(name.clone())).unwrap_or_default();
    }
}

/// Words in names, and the units that such signals usually have.
const WORDS: [(&[&str], &str); 9] = [
    (&["torque", "moment", "drehmoment", "couple", "effort"], "\"N m\" or \"mN m\""),
    (
        &["speed", "velocity", "vel", "omega", "drehzahl", "rpm", "rate", "vitesse"],
        "\"rpm\", \"rad/s\" or \"deg/s\"",
    ),
    (
        &["angle", "position", "pos", "winkel", "enc", "encoder", "theta", "phi"],
        "\"deg\", \"rad\", \"mm\", or \"counts\" with counts_per_turn",
    ),
    (&["current", "strom", "amp", "amps", "iq", "id"], "\"A\""),
    (&["voltage", "spannung", "volt", "volts", "ch", "channel"], "\"V\""),
    (&["duty", "pwm"], "\"%\" or \"1\""),
    (&["force", "kraft", "load"], "\"N\""),
    (&["temp", "temperature", "temperatur"], "\"degC\""),
    (&["acc", "accel", "acceleration"], "\"m/s2\" or \"rad/s2\""),
];

/// Guess of a column's unit, with the evidence, in words that follow `unit = "?"`.
pub(super) fn guess(column: &Column, signal: &Signal) -> String {
    match (column.meaning, &column.unit) {
        (Meaning::Values(_), _) => return String::new(),
        (Meaning::Counts, _) => {
            return ", which is in counts: counts_per_turn or counts_per_m is needed".into();
        }
        (_, Some(text)) => return format!(", which the file calls \"{text}\": not known here"),
        (_, None) => {}
    }
    if let Some(hint) = signal.hint {
        return format!(", {hint}");
    }
    let usual = usual_units(column).map_or(String::new(), |units| format!(", perhaps {units}"));
    format!("{usual}{}", shape(signal))
}

/// Units that signals with a word of this name usually have, in quotes, the likeliest first.
fn usual_units(column: &Column) -> Option<&'static str> {
    let small = plain_name(&column.name);
    let words: Vec<&str> =
        small.split('_').map(|word| word.trim_end_matches(|c: char| c.is_ascii_digit())).collect();
    // `rSpeedActual` of a PLC holds a word as well; shorter ones are in many words.
    const LONG: usize = 5;
    let is_in = |word: &&str| words.contains(word) || (word.len() >= LONG && small.contains(*word));
    WORDS.iter().find(|(known, _)| known.iter().any(is_in)).map(|(_, units)| *units)
}

/// The likeliest unit of a column whose unit is not stated.
pub(crate) fn likeliest(column: &Column) -> Option<&'static str> {
    match (column.meaning, &column.unit) {
        (Meaning::Values(_) | Meaning::Counts, _) | (_, Some(_)) => None,
        (_, None) => usual_units(column)?.split('"').nth(1),
    }
}

/// Evidence from the numbers of a signal: counts, or turns in degrees.
fn shape(signal: &Signal) -> String {
    let held: Vec<f64> = signal.absolute().filter(|value| value.is_finite()).collect();
    if held.is_empty() {
        return String::new();
    }
    let (low, high) =
        held.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let is_whole = held.iter().all(|value| value.fract() == 0.0) && high - low > 100.0;
    let jump = held.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    for (range, what) in [(360.0, "degrees"), (std::f64::consts::TAU, "radians")] {
        if jump > 0.9 * range && high - low <= range * 1.001 && !is_whole {
            return format!(" (it jumps by a turn in {what}: wrap = {range})");
        }
    }
    if is_whole {
        let power = (high - low).max(1.0).log2().ceil().exp2();
        let wraps = jump > 0.5 * power;
        let wrap = if wraps { format!(", and they jump: wrap = {power}?") } else { String::new() };
        return format!(" (whole numbers from {low} to {high}: counts{wrap})");
    }
    String::new()
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_units::column;

    #[test]
    fn numbers_that_look_like_counts_and_turns_are_said() {
        let signal = |values: Vec<f64>| Signal::new("x", None, values);
        let guess = |name: &str, unit: Option<&str>, signal: &Signal| guess(&column(name, unit), signal);
        let counts = signal((0..300).map(|k| f64::from(k * 300 % 65_536)).collect());
        assert!(
            guess("encoder", None, &counts).contains("counts, and they jump: wrap = 65536?"),
            "{}",
            guess("encoder", None, &counts)
        );
        let turns = signal((0..300).map(|k| (f64::from(k) * 7.3) % 360.0).collect());
        assert!(guess("phi", None, &turns).contains("wrap = 360"));
        assert_eq!(guess("torque", None, &signal(vec![0.5, 0.25])), ", perhaps \"N m\" or \"mN m\"");
        assert_eq!(guess("torque", Some("Nm"), &signal(vec![0.5])), "");
    }
}
