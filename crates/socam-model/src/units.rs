//! Units at the edge of a model file: `N m/deg` in, SI out.
//!
//! A unit is written as factors with integer powers, then an optional slash and the divisors:
//! `kg m2`, `N m s/rad`, `N mm/deg`, `rpm`, `1/rad2`. Angles carry no dimension, so `N m s` and
//! `N m s/rad` agree; degrees and turns are only factors.

/// Exponents of kg, m, s, A and V (volt is kept apart: drives are calibrated in it).
pub type Dimension = [i8; 5];

/// A unit that was understood: how many SI units it is worth, and of what dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// One of this unit in SI.
    pub factor: f64,
    /// Its dimension.
    pub dimension: Dimension,
}

const BASES: &[(&str, f64, Dimension)] = &[
    ("1", 1.0, [0, 0, 0, 0, 0]),
    ("kg", 1.0, [1, 0, 0, 0, 0]),
    ("g", 1e-3, [1, 0, 0, 0, 0]),
    ("m", 1.0, [0, 1, 0, 0, 0]),
    ("cm", 1e-2, [0, 1, 0, 0, 0]),
    ("mm", 1e-3, [0, 1, 0, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0, 0]),
    ("ms", 1e-3, [0, 0, 1, 0, 0]),
    ("min", 60.0, [0, 0, 1, 0, 0]),
    ("Hz", 1.0, [0, 0, -1, 0, 0]),
    ("rad", 1.0, [0, 0, 0, 0, 0]),
    ("deg", std::f64::consts::PI / 180.0, [0, 0, 0, 0, 0]),
    ("turn", std::f64::consts::TAU, [0, 0, 0, 0, 0]),
    ("rpm", std::f64::consts::TAU / 60.0, [0, 0, -1, 0, 0]),
    ("krpm", std::f64::consts::TAU / 0.06, [0, 0, -1, 0, 0]),
    ("N", 1.0, [1, 1, -2, 0, 0]),
    ("kN", 1e3, [1, 1, -2, 0, 0]),
    ("A", 1.0, [0, 0, 0, 1, 0]),
    ("V", 1.0, [0, 0, 0, 0, 1]),
    ("mV", 1e-3, [0, 0, 0, 0, 1]),
    ("%", 1e-2, [0, 0, 0, 0, 0]),
];

/// Reads a unit; `None` if a factor is unknown.
pub fn parse(text: &str) -> Option<Unit> {
    let (numerator, denominator) = text.split_once('/').unwrap_or((text, ""));
    let mut unit = Unit { factor: 1.0, dimension: [0; 5] };
    for (factors, sign) in [(numerator, 1), (denominator, -1)] {
        for factor in factors.split_whitespace() {
            let (base, power) = split_power(factor)?;
            let (_, value, dimension) = BASES.iter().find(|(name, ..)| *name == base)?;
            let power = power * sign;
            unit.factor *= value.powi(power.into());
            for (total, exponent) in unit.dimension.iter_mut().zip(dimension) {
                *total = total.checked_add(exponent.checked_mul(power)?)?;
            }
        }
    }
    (!numerator.trim().is_empty()).then_some(unit)
}

/// `m2` is (`m`, 2); `1` stays itself.
fn split_power(factor: &str) -> Option<(&str, i8)> {
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
            ("N m/rad", 1.0, [1, 2, -2, 0, 0]),
            ("N m/deg", 1.0 / degrees, [1, 2, -2, 0, 0]),
            ("N mm/deg", 1e-3 / degrees, [1, 2, -2, 0, 0]),
            ("N m s/rad", 1.0, [1, 2, -1, 0, 0]),
            ("kg m2", 1.0, [1, 2, 0, 0, 0]),
            ("g cm2", 1e-7, [1, 2, 0, 0, 0]),
            ("rpm", 0.104_719_755_119_659_77, [0, 0, -1, 0, 0]),
            ("1", 1.0, [0; 5]),
            ("1/rad2", 1.0, [0; 5]),
        ] {
            let unit = parse(text).unwrap();
            assert!((unit.factor / factor - 1.0).abs() < 1e-14, "{text}: {unit:?}");
            assert_eq!(unit.dimension, dimension, "{text}");
        }
        for text in ["", "N m/furlong", "2", "m-2", "/s", "m999"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
