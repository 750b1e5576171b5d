//! Units of a model file and their conversion to SI.
//!
//! A unit is written as factors with integer powers, then an optional slash and the divisors:
//! `kg m2`, `N m s/rad`, `N mm/deg`, `rpm`, `1/rad2`. Other usual spellings are read too: `kg m^2`, `kg·m²`, `N*m`,
//! `Nm/rad`, `N/(m/s)`. Angles have no dimension: `N m s` and `N m s/rad` have the same one, and degrees and turns differ from
//! radians by a factor only.

/// Exponents of kg, m, s and A. A volt is a watt per ampere: a torque constant in N m/A and a back-EMF in V s/rad have one dimension.
pub type Dimension = [i8; 4];

/// A parsed unit: its factor to SI and its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Size of this unit in SI units.
    pub factor: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

const BASES: &[(&str, f64, Dimension)] = &[
    ("1", 1.0, [0, 0, 0, 0]),
    ("kg", 1.0, [1, 0, 0, 0]),
    ("g", 1e-3, [1, 0, 0, 0]),
    ("m", 1.0, [0, 1, 0, 0]),
    ("cm", 1e-2, [0, 1, 0, 0]),
    ("mm", 1e-3, [0, 1, 0, 0]),
    ("um", 1e-6, [0, 1, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0]),
    ("ms", 1e-3, [0, 0, 1, 0]),
    ("us", 1e-6, [0, 0, 1, 0]),
    ("min", 60.0, [0, 0, 1, 0]),
    ("Hz", 1.0, [0, 0, -1, 0]),
    ("kHz", 1e3, [0, 0, -1, 0]),
    ("rad", 1.0, [0, 0, 0, 0]),
    ("mrad", 1e-3, [0, 0, 0, 0]),
    ("deg", std::f64::consts::PI / 180.0, [0, 0, 0, 0]),
    ("turn", std::f64::consts::TAU, [0, 0, 0, 0]),
    ("rev", std::f64::consts::TAU, [0, 0, 0, 0]),
    ("rpm", std::f64::consts::TAU / 60.0, [0, 0, -1, 0]),
    ("krpm", std::f64::consts::TAU / 0.06, [0, 0, -1, 0]),
    ("N", 1.0, [1, 1, -2, 0]),
    ("kN", 1e3, [1, 1, -2, 0]),
    ("mN", 1e-3, [1, 1, -2, 0]),
    ("A", 1.0, [0, 0, 0, 1]),
    ("mA", 1e-3, [0, 0, 0, 1]),
    ("V", 1.0, [1, 2, -3, -1]),
    ("mV", 1e-3, [1, 2, -3, -1]),
    ("ohm", 1.0, [1, 2, -3, -2]),
    ("mohm", 1e-3, [1, 2, -3, -2]),
    ("H", 1.0, [1, 2, -2, -2]),
    ("mH", 1e-3, [1, 2, -2, -2]),
    ("uH", 1e-6, [1, 2, -2, -2]),
    ("%", 1e-2, [0, 0, 0, 0]),
];

/// Products that are usually written without a blank, and their factors. They are listed because a general rule is ambiguous: `mNm` can be
/// split into factors in several ways.
const RUN_TOGETHER: &[(&str, &str)] = &[
    ("Nm", "N m"),
    ("kNm", "kN m"),
    ("mNm", "mN m"),
    ("Nmm", "N mm"),
    ("Ncm", "N cm"),
    ("Nms", "N m s"),
    ("Nms2", "N m s2"),
    ("Ns", "N s"),
    ("Ns2", "N s2"),
    ("Vs", "V s"),
    ("kgm2", "kg m2"),
    ("kgcm2", "kg cm2"),
    ("kgmm2", "kg mm2"),
    ("gm2", "g m2"),
    ("gcm2", "g cm2"),
    ("gmm2", "g mm2"),
];

/// Largest length of a unit's text, bytes; bounds the recursion.
const LONGEST: usize = 100;

/// Parses a unit. `None` for an unknown factor, an empty or malformed text, more than one slash, or an exponent beyond -128 .. 127.
///
/// ```
/// use socam_model::units::parse;
///
/// let stiffness = parse("N m/deg").expect("a unit");
/// assert!((stiffness.factor - 180.0 / std::f64::consts::PI).abs() < 1e-12);
/// assert_eq!(stiffness.dimension, parse("Nm/rad").unwrap().dimension);
/// assert_eq!(parse("N m/furlong"), None);
/// ```
pub fn parse(text: &str) -> Option<Unit> {
    if text.len() > LONGEST {
        return None;
    }
    let plain = text.replace('\u{b2}', "2").replace('\u{b3}', "3").replace(['*', '\u{b7}', '\u{22c5}'], " ");
    let (numerator, denominator) = plain.split_once('/').unwrap_or((&plain, "1"));
    let divisor = denominator.trim();
    let divisor = match divisor.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')) {
        Some(inner) => parse(inner)?,
        None => product(divisor)?,
    };
    let mut unit = product(numerator)?;
    unit.multiply(divisor, -1)?;
    Some(unit)
}

/// The names of [`BASES`] and [`RUN_TOGETHER`].
#[cfg(test)]
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    BASES.iter().map(|(name, ..)| *name).chain(RUN_TOGETHER.iter().map(|(name, _)| *name))
}

/// A product of one or more units, separated by blanks.
fn product(text: &str) -> Option<Unit> {
    let mut unit = Unit { factor: 1.0, dimension: [0; 4] };
    for written in text.split_whitespace() {
        let plain = written.replacen('^', "", 1);
        match RUN_TOGETHER.iter().find(|(together, _)| *together == plain) {
            Some((_, apart)) => unit.multiply(product(apart)?, 1)?,
            None => {
                let (base, power) = split_power(written)?;
                let (_, factor, dimension) = BASES.iter().find(|(name, ..)| *name == base)?;
                unit.multiply(Unit { factor: *factor, dimension: *dimension }, power)?;
            }
        }
    }
    (!text.trim().is_empty()).then_some(unit)
}

impl Unit {
    /// Multiplies by a power of another unit; `None` where an exponent overflows.
    fn multiply(&mut self, other: Self, power: i8) -> Option<()> {
        self.factor *= other.factor.powi(power.into());
        for (total, exponent) in self.dimension.iter_mut().zip(other.dimension) {
            *total = total.checked_add(exponent.checked_mul(power)?)?;
        }
        Some(())
    }
}

/// Base and exponent of a factor: `m2` and `m^2` give (`m`, 2), `s^-1` gives (`s`, -1), `1` gives (`1`, 1).
fn split_power(factor: &str) -> Option<(&str, i8)> {
    if let Some((base, power)) = factor.split_once('^') {
        return power.parse().ok().map(|power| (base, power));
    }
    match factor.trim_end_matches(|c: char| c.is_ascii_digit()) {
        "" => (factor == "1").then_some(("1", 1)),
        base if base.len() == factor.len() => Some((base, 1)),
        base => factor[base.len()..].parse().ok().map(|power| (base, power)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mechanical_units_become_si() {
        let degrees = std::f64::consts::PI / 180.0;
        for (text, factor, dimension) in [
            ("N m/rad", 1.0, [1, 2, -2, 0]),
            ("N m/deg", 1.0 / degrees, [1, 2, -2, 0]),
            ("N mm/deg", 1e-3 / degrees, [1, 2, -2, 0]),
            ("N m s/rad", 1.0, [1, 2, -1, 0]),
            ("kg m2", 1.0, [1, 2, 0, 0]),
            ("g cm2", 1e-7, [1, 2, 0, 0]),
            ("rpm", 0.104_719_755_119_659_77, [0, 0, -1, 0]),
            ("1", 1.0, [0; 4]),
            ("1/rad2", 1.0, [0; 4]),
            ("kg m^2", 1.0, [1, 2, 0, 0]),
            ("kg\u{b7}m\u{b2}", 1.0, [1, 2, 0, 0]),
            ("kgm2", 1.0, [1, 2, 0, 0]),
            ("g*cm^2", 1e-7, [1, 2, 0, 0]),
            ("Nm/rad", 1.0, [1, 2, -2, 0]),
            ("Nms/rad", 1.0, [1, 2, -1, 0]),
            ("mN m", 1e-3, [1, 2, -2, 0]),
            ("mNm", 1e-3, [1, 2, -2, 0]),
            ("N/(m/s)", 1.0, [1, 0, -1, 0]),
            ("N m / (rad/s)", 1.0, [1, 2, -1, 0]),
            ("rad s^-1", 1.0, [0, 0, -1, 0]),
            ("N m/A", 1.0, [1, 2, -2, -1]),
            ("V/krpm", 0.06 / std::f64::consts::TAU, [1, 2, -2, -1]),
            ("V/A", 1.0, [1, 2, -3, -2]),
            ("mohm", 1e-3, [1, 2, -3, -2]),
            ("mH", 1e-3, [1, 2, -2, -2]),
        ] {
            let unit = parse(text).unwrap();
            assert!((unit.factor / factor - 1.0).abs() < 1e-14, "{text}: {unit:?}");
            assert_eq!(unit.dimension, dimension, "{text}");
        }
        for text in
            ["", "N m/furlong", "2", "m-2", "/s", "m999", "Nm2", "N m/rad/s", "N/", "m^", "N/(m", "^2"]
        {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
