//! Names of channels, and what the unit of a signal may be.

use crate::source::{Group, Signal};
use crate::unit;

/// A name of a channel: small letters, digits and underscores.
pub(super) fn channel(name: &str) -> String {
    let mut plain = String::new();
    for c in name.chars() {
        match c {
            'a'..='z' | '0'..='9' => plain.push(c),
            'A'..='Z' => plain.push(c.to_ascii_lowercase()),
            '\u{e4}' | '\u{c4}' => plain.push_str("ae"),
            '\u{f6}' | '\u{d6}' => plain.push_str("oe"),
            '\u{fc}' | '\u{dc}' => plain.push_str("ue"),
            '\u{df}' => plain.push_str("ss"),
            _ if !plain.ends_with('_') => plain.push('_'),
            _ => {}
        }
    }
    let plain = plain.trim_matches('_');
    if plain.is_empty() { "signal".into() } else { plain.to_owned() }
}

/// Length of what the names of all signals of a group begin with, up to a dot.
pub(super) fn common_prefix(group: &Group) -> usize {
    let mut names = group.signals.iter().map(|signal| signal.name.as_str());
    let Some(first) = names.next() else { return 0 };
    let length = names.fold(first.len(), |length, name| {
        first.bytes().zip(name.bytes()).take(length).take_while(|(a, b)| a == b).count()
    });
    first.get(..length).and_then(|prefix| prefix.rfind('.')).map_or(0, |dot| dot + 1)
}

/// A name that is not taken: with the group before it, or a number behind it.
pub(super) fn unique(name: &str, group: &str, is_taken: impl Fn(&String) -> bool) -> String {
    let with_group = if group.is_empty() { name.to_owned() } else { format!("{}_{name}", channel(group)) };
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    [name.to_owned(), with_group].into_iter().chain(numbered).find(|name| !is_taken(name)).unwrap_or_default()
}

/// Words in names, and the units that such signals usually have.
const WORDS: [(&[&str], &str); 8] = [
    (&["torque", "moment", "drehmoment", "couple", "effort"], "\"N m\" or \"mN m\""),
    (
        &["speed", "velocity", "vel", "omega", "drehzahl", "rpm", "rate", "vitesse"],
        "\"rpm\", \"rad/s\" or \"deg/s\"",
    ),
    (
        &["angle", "position", "pos", "winkel", "enc", "encoder", "theta", "phi"],
        "\"deg\", \"rad\", \"mm\", or \"counts\" with counts_per_turn",
    ),
    (&["current", "strom", "amp", "iq", "id"], "\"A\""),
    (&["voltage", "spannung", "volt", "duty", "pwm"], "\"V\""),
    (&["force", "kraft", "load"], "\"N\""),
    (&["temp", "temperature", "temperatur"], "\"degC\""),
    (&["acc", "accel", "acceleration"], "\"m/s2\" or \"rad/s2\""),
];

/// What the unit may be and what speaks for it, in words that follow `unit = "?"`.
pub(super) fn guess(name: &str, stated: Option<&str>, signal: &Signal) -> String {
    match stated {
        Some(text) if unit::parse(text).is_some() => return String::new(),
        Some(text) if unit::is_counts(text) => {
            return ", which is in counts: counts_per_turn or counts_per_m is needed".into();
        }
        Some(text) => return format!(", which the file calls \"{text}\": not known here"),
        None => {}
    }
    if let Some(hint) = signal.hint {
        return format!(", {hint}");
    }
    // socam's own columns end in such letters.
    let letter =
        name.rsplit_once('_').map(|(_, end)| end).filter(|end| end.len() == 1 && unit::parse(end).is_some());
    if let Some(letter) = letter {
        return format!(", perhaps \"{letter}\", unless the end of its name is an index");
    }
    let small = channel(name);
    let words: Vec<&str> =
        small.split('_').map(|word| word.trim_end_matches(|c: char| c.is_ascii_digit())).collect();
    let usual = WORDS.iter().find(|(known, _)| known.iter().any(|word| words.contains(word)));
    let usual = usual.map_or(String::new(), |(_, units)| format!(", perhaps {units}"));
    format!("{usual}{}", shape(signal))
}

/// What the numbers look like: counts, or turns in degrees.
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

    #[test]
    fn names_become_names_of_channels() {
        for (name, plain) in [
            ("Motor Speed", "motor_speed"),
            ("velocity.hip", "velocity_hip"),
            ("Geschw\u{e4}he", "geschwaehe"),
            ("\u{3c9}", "signal"),
        ] {
            assert_eq!(channel(name), plain);
        }
        assert_eq!(unique("speed", "Load side", |name| name == "speed"), "load_side_speed");
    }

    #[test]
    fn numbers_that_look_like_counts_and_turns_are_said() {
        let signal = |values: Vec<f64>| Signal::new("x", None, values);
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
