//! Units as other programs write them, and their conversion into the units of a recording.

use std::f64::consts::{PI, TAU};

use socam_recording::Unit;

/// How a value becomes SI: `factor * value + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Unit of the result.
    pub unit: Unit,
    /// SI units in one unit.
    pub factor: f64,
    /// SI value of zero.
    pub offset: f64,
}

const ANGLES: [(&str, f64); 13] = [
    ("rad", 1.0),
    ("mrad", 1e-3),
    ("urad", 1e-6),
    ("deg", PI / 180.0),
    ("degree", PI / 180.0),
    ("degrees", PI / 180.0),
    ("arcmin", PI / 10_800.0),
    ("arcsec", PI / 648_000.0),
    ("gon", PI / 200.0),
    ("rev", TAU),
    ("turn", TAU),
    ("turns", TAU),
    ("U", TAU),
];

const LENGTHS: [(&str, f64); 7] =
    [("m", 1.0), ("km", 1e3), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("in", 0.0254), ("ft", 0.3048)];

const POUND_FORCE_N: f64 = 4.448_221_615_260_5;
const KILOPOND_N: f64 = 9.806_65;

const OTHERS: [(&str, Unit, f64, f64); 45] = [
    ("rpm", Unit::RadPerS, TAU / 60.0, 0.0),
    ("RPM", Unit::RadPerS, TAU / 60.0, 0.0),
    ("krpm", Unit::RadPerS, TAU / 0.06, 0.0),
    ("1/min", Unit::RadPerS, TAU / 60.0, 0.0),
    ("min-1", Unit::RadPerS, TAU / 60.0, 0.0),
    ("r/min", Unit::RadPerS, TAU / 60.0, 0.0),
    ("Nm", Unit::Nm, 1.0, 0.0),
    ("N m", Unit::Nm, 1.0, 0.0),
    ("N-m", Unit::Nm, 1.0, 0.0),
    ("NM", Unit::Nm, 1.0, 0.0),
    ("kNm", Unit::Nm, 1e3, 0.0),
    ("kN m", Unit::Nm, 1e3, 0.0),
    ("mNm", Unit::Nm, 1e-3, 0.0),
    ("mN m", Unit::Nm, 1e-3, 0.0),
    ("uNm", Unit::Nm, 1e-6, 0.0),
    ("Ncm", Unit::Nm, 1e-2, 0.0),
    ("N cm", Unit::Nm, 1e-2, 0.0),
    ("cNm", Unit::Nm, 1e-2, 0.0),
    ("Nmm", Unit::Nm, 1e-3, 0.0),
    ("N mm", Unit::Nm, 1e-3, 0.0),
    ("lbf ft", Unit::Nm, POUND_FORCE_N * 0.3048, 0.0),
    ("ft lb", Unit::Nm, POUND_FORCE_N * 0.3048, 0.0),
    ("lbf in", Unit::Nm, POUND_FORCE_N * 0.0254, 0.0),
    ("in lb", Unit::Nm, POUND_FORCE_N * 0.0254, 0.0),
    ("ozf in", Unit::Nm, POUND_FORCE_N * 0.0254 / 16.0, 0.0),
    ("kgf cm", Unit::Nm, KILOPOND_N * 0.01, 0.0),
    ("N", Unit::N, 1.0, 0.0),
    ("kN", Unit::N, 1e3, 0.0),
    ("mN", Unit::N, 1e-3, 0.0),
    ("lbf", Unit::N, POUND_FORCE_N, 0.0),
    ("kgf", Unit::N, KILOPOND_N, 0.0),
    ("V", Unit::V, 1.0, 0.0),
    ("volt", Unit::V, 1.0, 0.0),
    ("mV", Unit::V, 1e-3, 0.0),
    ("kV", Unit::V, 1e3, 0.0),
    ("A", Unit::A, 1.0, 0.0),
    ("amp", Unit::A, 1.0, 0.0),
    ("mA", Unit::A, 1e-3, 0.0),
    ("uA", Unit::A, 1e-6, 0.0),
    ("K", Unit::K, 1.0, 0.0),
    ("degC", Unit::K, 1.0, 273.15),
    ("degF", Unit::K, 5.0 / 9.0, 459.67 * 5.0 / 9.0),
    ("1", Unit::One, 1.0, 0.0),
    ("-", Unit::One, 1.0, 0.0),
    ("%", Unit::One, 0.01, 0.0),
];

/// Units of time, in seconds.
const TIMES: [(&str, f64); 15] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("secs", 1.0),
    ("second", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("msec", 1e-3),
    ("millisecond", 1e-3),
    ("milliseconds", 1e-3),
    ("us", 1e-6),
    ("usec", 1e-6),
    ("microseconds", 1e-6),
    ("ns", 1e-9),
    ("min", 60.0),
    ("h", 3600.0),
];

/// The spelling in which units are listed: `°/s`, `[rad·s⁻¹]` and `µm` become `deg/s`, `rad s-1` and `um`.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for c in text.trim().trim_matches(['[', ']', '(', ')', '{', '}']).trim().chars() {
        match c {
            '\u{b5}' | '\u{3bc}' => plain.push('u'),
            '\u{b7}' | '*' | '\u{22c5}' | '.' | '_' => plain.push(' '),
            '\u{b2}' => plain.push('2'),
            '\u{207b}' => plain.push('-'),
            '\u{b9}' => plain.push('1'),
            '^' => {}
            '\u{b0}' | '\u{ba}' => plain.push_str("deg"),
            c => plain.push(c),
        }
    }
    plain.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Seconds in a unit of time.
#[must_use]
pub fn seconds(text: &str) -> Option<f64> {
    let plain = plain(text);
    TIMES.iter().find(|(name, _)| *name == plain).map(|(_, seconds)| *seconds)
}

/// The conversion of a unit, `None` for one that is not known.
///
/// ```
/// use socam_import::unit::parse;
/// use socam_recording::Unit;
///
/// let speed = parse("°/s").expect("a unit");
/// assert_eq!((speed.unit, (180.0 * speed.factor * 1e6).round()), (Unit::RadPerS, 3_141_593.0));
/// assert_eq!(parse("furlong"), None);
/// ```
#[must_use]
pub fn parse(text: &str) -> Option<Conversion> {
    let plain = plain(text);
    let of = |unit, factor| Some(Conversion { unit, factor, offset: 0.0 });
    if let Some((_, unit, factor, offset)) = OTHERS.iter().find(|(name, ..)| *name == plain) {
        return Some(Conversion { unit: *unit, factor: *factor, offset: *offset });
    }
    let (base, rate) = split_rate(&plain);
    let angle = ANGLES.iter().find(|(name, _)| *name == base);
    let length = LENGTHS.iter().find(|(name, _)| *name == base);
    match (rate, angle, length) {
        (Rate::None, Some((_, factor)), _) => of(Unit::Rad, *factor),
        (Rate::First(per), Some((_, factor)), _) => of(Unit::RadPerS, factor / per),
        (Rate::Second, Some((_, factor)), _) => of(Unit::RadPerS2, *factor),
        (Rate::None, _, Some((_, factor))) => of(Unit::M, *factor),
        (Rate::First(per), _, Some((_, factor))) => of(Unit::MPerS, factor / per),
        (Rate::Second, _, Some((_, factor))) => of(Unit::MPerS2, *factor),
        _ => None,
    }
}

/// Whether a unit is one of numbers that an encoder counts.
#[must_use]
pub fn is_counts(text: &str) -> bool {
    matches!(plain(text).as_str(), "counts" | "count" | "cts" | "ticks" | "inc" | "increments" | "lsb")
}

/// How often a quantity is differentiated, and per how many seconds.
enum Rate {
    None,
    First(f64),
    Second,
}

fn split_rate(plain: &str) -> (&str, Rate) {
    let ends: [(&str, Rate); 12] = [
        ("/s2", Rate::Second),
        ("/s/s", Rate::Second),
        (" s-2", Rate::Second),
        (" s2", Rate::Second),
        ("/s", Rate::First(1.0)),
        ("/sec", Rate::First(1.0)),
        (" s-1", Rate::First(1.0)),
        (" s", Rate::First(1.0)),
        ("/min", Rate::First(60.0)),
        (" min-1", Rate::First(60.0)),
        ("/h", Rate::First(3600.0)),
        ("ps", Rate::First(1.0)),
    ];
    for (end, rate) in ends {
        if let Some(base) = plain.strip_suffix(end).filter(|base| !base.is_empty()) {
            return (base.trim_end(), rate);
        }
    }
    (plain, Rate::None)
}

/// A name without its unit, and the unit: `Speed [rpm]`, `Speed (rpm)`, `Speed / rpm`, `Speed, rpm`, `speed_rpm`.
///
/// ```
/// use socam_import::unit::in_name;
///
/// assert_eq!(in_name("Motor speed [1/min]"), ("Motor speed".into(), Some("1/min".into())));
/// assert_eq!(in_name("torque_in_Nm"), ("torque_in".into(), Some("Nm".into())));
/// assert_eq!(in_name("torque"), ("torque".into(), None));
/// ```
#[must_use]
pub fn in_name(name: &str) -> (String, Option<String>) {
    let name = name.trim();
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')] {
        let inner = name.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        if let Some((bare, unit)) = inner.filter(|(bare, _)| !bare.trim().is_empty()) {
            return (bare.trim().to_owned(), Some(unit.trim().to_owned()));
        }
    }
    let is_unit = |text: &str| parse(text).is_some() || seconds(text).is_some() || is_counts(text);
    for (bare, unit) in ends(name) {
        if is_unit(unit) {
            return (bare.to_owned(), Some(unit.to_owned()));
        }
    }
    (name.to_owned(), None)
}

/// Splits of a name into its beginning and what may be a unit, longest end first.
fn ends(name: &str) -> impl Iterator<Item = (&str, &str)> {
    let spaced = [" / ", ", ", " in "].into_iter().filter_map(move |mark| name.split_once(mark));
    let under = name.match_indices(['_', ' ']).map(move |(at, mark)| (&name[..at], &name[at + mark.len()..]));
    // `torque_in`, `x_min`, `run_1` and `u_m` (of the motor) end in words, numbers and indices; seconds are the exception.
    let is_word =
        |unit: &str| matches!(unit, "in" | "min" | "turn" | "turns") || (unit.len() == 1 && unit != "s");
    spaced.chain(under).filter(move |(bare, unit)| !bare.is_empty() && !unit.is_empty() && !is_word(unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_other_programs_become_si() {
        for (text, unit, factor) in [
            ("rpm", Unit::RadPerS, TAU / 60.0),
            ("U/min", Unit::RadPerS, TAU / 60.0),
            ("rev/s", Unit::RadPerS, TAU),
            ("deg/s", Unit::RadPerS, PI / 180.0),
            ("\u{b0}/s\u{b2}", Unit::RadPerS2, PI / 180.0),
            ("rad\u{b7}s\u{207b}\u{b9}", Unit::RadPerS, 1.0),
            ("rad_s", Unit::RadPerS, 1.0),
            ("rad_s2", Unit::RadPerS2, 1.0),
            ("\u{b0}", Unit::Rad, PI / 180.0),
            ("[mm/s]", Unit::MPerS, 1e-3),
            ("m/s^2", Unit::MPerS2, 1.0),
            ("\u{b5}m", Unit::M, 1e-6),
            ("N\u{b7}m", Unit::Nm, 1.0),
            ("mN m", Unit::Nm, 1e-3),
            ("lbf*ft", Unit::Nm, 1.355_817_948_331_400_4),
            ("%", Unit::One, 0.01),
        ] {
            let found = parse(text).unwrap_or_else(|| panic!("`{text}` is not known"));
            assert!(found.unit == unit && (found.factor / factor - 1.0).abs() < 1e-12, "{text}: {found:?}");
        }
        assert_eq!(parse("\u{b0}C").map(|c| (c.unit, c.factor, c.offset)), Some((Unit::K, 1.0, 273.15)));
        // A nanometre, or a torque written carelessly: nobody knows.
        assert_eq!((parse("nm"), parse("Hz"), parse("g"), parse("")), (None, None, None, None));
    }

    #[test]
    fn a_name_may_end_in_its_unit() {
        for (name, bare, unit) in [
            ("Time (s)", "Time", Some("s")),
            ("Zeit / ms", "Zeit", Some("ms")),
            ("n_Mot, rpm", "n_Mot", Some("rpm")),
            ("pos_deg", "pos", Some("deg")),
            ("motor_speed_rad_s", "motor_speed", Some("rad_s")),
            ("torque_in", "torque_in", None),
            ("u_m", "u_m", None),
            ("t_s", "t", Some("s")),
            ("kp_1", "kp_1", None),
            ("Drehmoment [Nm]", "Drehmoment", Some("Nm")),
            ("x [furlong]", "x", Some("furlong")),
        ] {
            assert_eq!(in_name(name), (bare.to_owned(), unit.map(str::to_owned)), "{name}");
        }
    }
}
