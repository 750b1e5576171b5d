//! The grammar of units.

use crate::Product;
use crate::table::Words;

/// Exponents of kg, m, s, A and K. A volt is a watt per ampere: a torque constant in N m/A and a back-EMF in V s/rad have one dimension.
/// Angles have none.
pub type Dimension = [i8; 5];

/// A unit that was read: its SI value is `factor * value + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// SI units per unit.
    pub factor: f64,
    /// SI value of zero; it is other than 0 only for temperatures.
    pub offset: f64,
    /// The SI unit as written.
    pub product: Product,
    /// Its dimension.
    pub dimension: Dimension,
}

/// Largest length of a unit's text, bytes; bounds the recursion.
const LONGEST: usize = 100;

/// Parses a unit of a model file: factors with integer powers, then an optional slash and the divisors, such as `kg m2`, `N m s/rad`,
/// `N mm/deg`, `rpm`, `1/rad2`. Other usual spellings are read too: `kg m^2`, `kg·m²`, `N*m`, `Nm/rad`, `N/(m/s)`.
///
/// `None` for an unknown factor, an empty or malformed text, more than one slash, or an exponent beyond -128 .. 127.
///
/// ```
/// use socam_units::parse;
///
/// let stiffness = parse("N m/deg").expect("a unit");
/// assert!((stiffness.factor - 180.0 / std::f64::consts::PI).abs() < 1e-12);
/// assert_eq!(stiffness.dimension, parse("Nm/rad").unwrap().dimension);
/// assert_eq!(parse("N m/furlong"), None);
/// ```
#[must_use]
pub fn parse(text: &str) -> Option<Scale> {
    read(text, Words::ModelFile)
}

/// Parses a unit with the names of the model file, or with all names.
pub(crate) fn read(text: &str, words: Words) -> Option<Scale> {
    if text.len() > LONGEST {
        return None;
    }
    // Only a unit that stands alone has an offset: two degrees Celsius per second are two kelvins per second.
    if let Some(row) = words.row(text.trim()) {
        return Scale::new(row.factor, row.offset, row.product);
    }
    let plain = text.replace('\u{b2}', "2").replace('\u{b3}', "3").replace(['*', '\u{b7}', '\u{22c5}'], " ");
    let (numerator, denominator) = plain.split_once('/').unwrap_or((&plain, "1"));
    let divisor = denominator.trim();
    let (per, below) = match divisor.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')) {
        Some(inner) => read(inner, words).map(|scale| (scale.factor, scale.product))?,
        None => product(divisor, words)?,
    };
    let (factor, above) = product(numerator, words)?;
    Scale::new(factor * per.powi(-1), 0.0, above.times(below, -1)?)
}

impl Scale {
    fn new(factor: f64, offset: f64, product: Product) -> Option<Self> {
        let [newton, volt, ampere, kelvin, metre, _, second] = product.0.map(i16::from);
        let dimension =
            [newton + volt, newton + 2 * volt + metre, second - 2 * newton - 3 * volt, ampere - volt, kelvin];
        let mut small = [0; 5];
        for (small, exponent) in small.iter_mut().zip(dimension) {
            *small = i8::try_from(exponent).ok()?;
        }
        Some(Self { factor, offset, product, dimension: small })
    }
}

/// A product of one or more units, separated by blanks.
fn product(text: &str, words: Words) -> Option<(f64, Product)> {
    let mut whole = (1.0, Product::ONE);
    for written in text.split_whitespace() {
        let (factor, unit, power) = match words.apart(&written.replacen('^', "", 1)) {
            Some(apart) => product(apart, words).map(|(factor, unit)| (factor, unit, 1))?,
            None => {
                let (base, power) = split_power(written)?;
                let row = words.row(base)?;
                (row.factor, row.product, power)
            }
        };
        whole = (whole.0 * factor.powi(power.into()), whole.1.times(unit, power)?);
    }
    (!text.trim().is_empty()).then_some(whole)
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
            ("N m/rad", 1.0, [1, 2, -2, 0, 0]),
            ("N m/deg", 1.0 / degrees, [1, 2, -2, 0, 0]),
            ("N mm/deg", 1e-3 / degrees, [1, 2, -2, 0, 0]),
            ("N m s/rad", 1.0, [1, 2, -1, 0, 0]),
            ("kg m2", 1.0, [1, 2, 0, 0, 0]),
            ("g cm2", 1e-7, [1, 2, 0, 0, 0]),
            ("rpm", 0.104_719_755_119_659_77, [0, 0, -1, 0, 0]),
            ("1", 1.0, [0; 5]),
            ("1/rad2", 1.0, [0; 5]),
            ("kg m^2", 1.0, [1, 2, 0, 0, 0]),
            ("kg\u{b7}m\u{b2}", 1.0, [1, 2, 0, 0, 0]),
            ("kgm2", 1.0, [1, 2, 0, 0, 0]),
            ("g*cm^2", 1e-7, [1, 2, 0, 0, 0]),
            ("Nm/rad", 1.0, [1, 2, -2, 0, 0]),
            ("Nms/rad", 1.0, [1, 2, -1, 0, 0]),
            ("mN m", 1e-3, [1, 2, -2, 0, 0]),
            ("mNm", 1e-3, [1, 2, -2, 0, 0]),
            ("N/(m/s)", 1.0, [1, 0, -1, 0, 0]),
            ("N m / (rad/s)", 1.0, [1, 2, -1, 0, 0]),
            ("rad s^-1", 1.0, [0, 0, -1, 0, 0]),
            ("N m/A", 1.0, [1, 2, -2, -1, 0]),
            ("V/krpm", 0.06 / std::f64::consts::TAU, [1, 2, -2, -1, 0]),
            ("V/A", 1.0, [1, 2, -3, -2, 0]),
            ("mohm", 1e-3, [1, 2, -3, -2, 0]),
            ("mH", 1e-3, [1, 2, -2, -2, 0]),
            ("N m/K", 1.0, [1, 2, -2, 0, -1]),
        ] {
            let unit = parse(text).unwrap();
            assert!((unit.factor / factor - 1.0).abs() < 1e-14, "{text}: {unit:?}");
            assert_eq!((unit.dimension, unit.offset), (dimension, 0.0), "{text}");
        }
        for text in [
            "",
            "N m/furlong",
            "2",
            "m-2",
            "/s",
            "m999",
            "Nm2",
            "N m/rad/s",
            "N/",
            "m^",
            "N/(m",
            "^2",
            "in",
            "degC",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
    }

    #[test]
    fn a_unit_with_an_offset_stands_alone() {
        assert_eq!(read("degC", Words::All).unwrap().offset, 273.15);
        assert_eq!(read("degC/s", Words::All).unwrap().offset, 0.0);
    }
}
