//! Units of derived channels: products and quotients of the units of recordings.

use std::fmt;
use std::ops::{Div, Mul};

/// Base units in the order in which they are written.
const BASES: [&str; 7] = ["N", "V", "A", "K", "m", "rad", "s"];

/// Units with a name of their own. Mechanical work is told from a torque by its angle: N m rad is work, N m/s the slope of a torque.
const NAMED: [(&str, [i8; 7]); 4] = [
    ("W", [1, 0, 0, 0, 1, 1, -1]),
    ("W", [0, 1, 1, 0, 0, 0, 0]),
    ("J", [1, 0, 0, 0, 1, 1, 0]),
    ("J", [0, 1, 1, 0, 0, 0, 1]),
];

/// A unit as exponents of the base units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Units([i8; 7]);

impl Units {
    pub(crate) const SECOND: Self = Self([0, 0, 0, 0, 0, 0, 1]);

    /// Reads a symbol such as `N m`, `rad/s2` or `1/(V s)`; `None` where it has an unknown part.
    pub(crate) fn parse(symbol: &str) -> Option<Self> {
        let (above, below) = symbol.split_once('/').unwrap_or((symbol, ""));
        let product = |text: &str| {
            let parts = text.trim_matches(['(', ')']).split_whitespace().filter(|part| *part != "1");
            parts.map(power).try_fold(Self([0; 7]), |product, part| Some(product * part?))
        };
        Some(product(above)? / product(below)?)
    }

    fn powers(self, sign: i8) -> Vec<String> {
        let powers = BASES.iter().zip(self.0).filter(|(_, exponent)| exponent * sign > 0);
        let text = |(base, exponent): (&&str, i8)| match exponent.abs() {
            1 => (*base).to_owned(),
            more => format!("{base}{more}"),
        };
        powers.map(text).collect()
    }
}

/// A base unit or a named one, with its exponent behind it.
fn power(text: &str) -> Option<Units> {
    let name = text.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let exponent = if name == text { 1 } else { text[name.len()..].parse().ok()? };
    let exponents = match NAMED.iter().find(|(own, _)| *own == name) {
        Some((_, exponents)) => *exponents,
        None => {
            let index = BASES.iter().position(|base| *base == name)?;
            std::array::from_fn(|other| i8::from(other == index))
        }
    };
    (1..=9).contains(&exponent).then(|| Units(exponents.map(|own| own * exponent)))
}

impl Mul for Units {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|n| self.0[n].saturating_add(other.0[n])))
    }
}

impl Div for Units {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        Self(std::array::from_fn(|n| self.0[n].saturating_sub(other.0[n])))
    }
}

impl fmt::Display for Units {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = NAMED.iter().find(|(_, exponents)| *exponents == self.0) {
            return f.write_str(name);
        }
        let (above, below) = (self.powers(1), self.powers(-1));
        f.write_str(if above.is_empty() { "1".into() } else { above.join(" ") }.as_str())?;
        match &below[..] {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            more => write!(f, "/({})", more.join(" ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::Unit;

    #[test]
    fn every_unit_of_recordings_is_read_and_written_as_it_was() {
        for unit in Unit::ALL {
            let read = Units::parse(unit.symbol()).map(|units| units.to_string());
            assert_eq!(read.as_deref(), Some(unit.symbol()));
        }
        assert_eq!(Units::parse("furlong"), None);
    }

    #[test]
    fn products_and_quotients_have_their_units() {
        let unit = |text: &str| Units::parse(text).unwrap();
        let said = |units: Units| units.to_string();
        assert_eq!(said(unit("N m") * unit("rad/s")), "W");
        assert_eq!(said(unit("N m") / Units::SECOND), "N m/s");
        assert_eq!(said(unit("W") * Units::SECOND), "J");
        assert_eq!(said(unit("rad/s") * Units::SECOND), "rad");
        assert_eq!(said(unit("rad/s") / Units::SECOND), "rad/s2");
        assert_eq!(said(unit("N m") / unit("rad")), "N m/rad");
        assert_eq!(said(unit("rad/s") / unit("rad/s")), "1");
        assert_eq!(said(unit("1") / unit("V") / Units::SECOND), "1/(V s)");
        assert_eq!(unit("1/(V s)"), unit("1") / unit("V") / Units::SECOND);
    }
}
