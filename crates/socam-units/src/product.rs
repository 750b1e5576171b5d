//! Products of units in written form.

use std::fmt;
use std::ops::{Div, Mul};

/// Base units in the order in which they are written.
const BASES: [&str; 7] = ["N", "V", "A", "K", "m", "rad", "s"];

/// Products with names of their own. The radian distinguishes work from torque: N m rad is work, N m/s is the slope of a torque.
const NAMED: [(&str, Product); 4] = [
    ("W", Product::WATT),
    ("W", Product([0, 1, 1, 0, 0, 0, 0])),
    ("J", Product::JOULE),
    ("J", Product([0, 1, 1, 0, 0, 0, 1])),
];

/// A product of the units N, V, A, K, m, rad and s with an exponent each: `N m/rad`.
///
/// Newton and volt are kept although both follow from kg, m, s and A: a stiffness is written in N m/rad and a resistance in V/A.
/// Mass is N s2/m here.
///
/// ```
/// use socam_units::Product;
///
/// let torque = Product::of_symbol("N m").unwrap();
/// let speed = Product::of_symbol("rad/s").unwrap();
/// assert_eq!((torque * speed).to_string(), "W");
/// assert_eq!((torque / speed).to_string(), "N m s/rad");
/// assert_eq!(Product::of_symbol("rpm"), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Product(pub(crate) [i8; 7]);

impl Product {
    /// The product without a unit.
    pub const ONE: Self = Self([0; 7]);
    /// The second.
    pub const SECOND: Self = Self([0, 0, 0, 0, 0, 0, 1]);
    pub(crate) const WATT: Self = Self([1, 0, 0, 0, 1, 1, -1]);
    pub(crate) const JOULE: Self = Self([1, 0, 0, 0, 1, 1, 0]);

    /// Exponent of the radian.
    #[must_use]
    pub const fn radians(self) -> i8 {
        self.0[5]
    }

    /// Multiplies by a power of another product; `None` where an exponent is beyond -128 .. 127.
    pub(crate) fn times(self, other: Self, power: i8) -> Option<Self> {
        let mut product = self;
        for (total, exponent) in product.0.iter_mut().zip(other.0) {
            *total = total.checked_add(exponent.checked_mul(power)?)?;
        }
        Some(product)
    }

    fn powers(self, sign: i8) -> Vec<String> {
        let powers = BASES.iter().zip(self.0).filter(|(_, exponent)| exponent.signum() == sign);
        let text = |(base, exponent): (&&str, i8)| match exponent.unsigned_abs() {
            1 => (*base).to_owned(),
            more => format!("{base}{more}"),
        };
        powers.map(text).collect()
    }
}

impl Mul for Product {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|n| self.0[n].saturating_add(other.0[n])))
    }
}

impl Div for Product {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        Self(std::array::from_fn(|n| self.0[n].saturating_sub(other.0[n])))
    }
}

impl fmt::Display for Product {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, _)) = NAMED.iter().find(|(_, product)| product == self) {
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
