//! Units of channels.

use serde::{Deserialize, Serialize};

use crate::Product;

/// The unit of a channel. All SI; no prefixes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Unit {
    /// Angular acceleration, rad/s2, suffix `_rad_s2`.
    #[serde(rename = "rad/s2")]
    RadPerS2,
    /// Angular speed, rad/s, suffix `_rad_s`.
    #[serde(rename = "rad/s")]
    RadPerS,
    /// Angle, rad, suffix `_rad`.
    #[serde(rename = "rad")]
    Rad,
    /// Acceleration, m/s2, suffix `_m_s2`.
    #[serde(rename = "m/s2")]
    MPerS2,
    /// Speed, m/s, suffix `_m_s`.
    #[serde(rename = "m/s")]
    MPerS,
    /// Length, m, suffix `_m`.
    #[serde(rename = "m")]
    M,
    /// Torque, N m, suffix `_Nm`.
    #[serde(rename = "N m")]
    Nm,
    /// Force, N, suffix `_N`.
    #[serde(rename = "N")]
    N,
    /// Voltage, V, suffix `_V`.
    #[serde(rename = "V")]
    V,
    /// Current, A, suffix `_A`.
    #[serde(rename = "A")]
    A,
    /// Temperature, K, suffix `_K`.
    #[serde(rename = "K")]
    K,
    /// A pure number, suffix `_1`.
    #[serde(rename = "1")]
    One,
}

impl Unit {
    /// Every unit, longest suffix first: the order in which a column's name is tried.
    pub const ALL: [Self; 12] = [
        Self::RadPerS2,
        Self::RadPerS,
        Self::Rad,
        Self::MPerS2,
        Self::MPerS,
        Self::M,
        Self::Nm,
        Self::N,
        Self::V,
        Self::A,
        Self::K,
        Self::One,
    ];

    /// The suffix of a column in this unit, underscore included.
    #[must_use]
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::RadPerS2 => "_rad_s2",
            Self::RadPerS => "_rad_s",
            Self::Rad => "_rad",
            Self::MPerS2 => "_m_s2",
            Self::MPerS => "_m_s",
            Self::M => "_m",
            Self::Nm => "_Nm",
            Self::N => "_N",
            Self::V => "_V",
            Self::A => "_A",
            Self::K => "_K",
            Self::One => "_1",
        }
    }

    /// The unit's symbol.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::RadPerS2 => "rad/s2",
            Self::RadPerS => "rad/s",
            Self::Rad => "rad",
            Self::MPerS2 => "m/s2",
            Self::MPerS => "m/s",
            Self::M => "m",
            Self::Nm => "N m",
            Self::N => "N",
            Self::V => "V",
            Self::A => "A",
            Self::K => "K",
            Self::One => "1",
        }
    }

    /// A column's name without its suffix, and the unit of that suffix, longest suffix first; `None` where the name has no suffix, or
    /// nothing before it.
    ///
    /// ```
    /// use socam_units::Unit;
    ///
    /// assert_eq!(Unit::of_column("motor_speed_rad_s"), Some(("motor_speed", Unit::RadPerS)));
    /// assert_eq!((Unit::of_column("motor_speed"), Unit::of_column("_V")), (None, None));
    /// ```
    #[must_use]
    pub fn of_column(column: &str) -> Option<(&str, Self)> {
        Self::ALL.into_iter().find_map(|unit| {
            let name = column.strip_suffix(unit.suffix())?;
            (!name.is_empty()).then_some((name, unit))
        })
    }

    /// The channel unit that equals a product; `None` if no channel has it.
    pub(crate) fn of(product: Product) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.product() == product)
    }

    const fn product(self) -> Product {
        Product(match self {
            Self::RadPerS2 => [0, 0, 0, 0, 0, 1, -2],
            Self::RadPerS => [0, 0, 0, 0, 0, 1, -1],
            Self::Rad => [0, 0, 0, 0, 0, 1, 0],
            Self::MPerS2 => [0, 0, 0, 0, 1, 0, -2],
            Self::MPerS => [0, 0, 0, 0, 1, 0, -1],
            Self::M => [0, 0, 0, 0, 1, 0, 0],
            Self::Nm => [1, 0, 0, 0, 1, 0, 0],
            Self::N => [1, 0, 0, 0, 0, 0, 0],
            Self::V => [0, 1, 0, 0, 0, 0, 0],
            Self::A => [0, 0, 1, 0, 0, 0, 0],
            Self::K => [0, 0, 0, 1, 0, 0, 0],
            Self::One => [0; 7],
        })
    }
}

impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.symbol())
    }
}

/// Conversion of numbers into values of a channel: `factor * number + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Unit of the channel.
    pub unit: Unit,
    /// SI units per unit of the numbers.
    pub factor: f64,
    /// SI value of the number 0.
    pub offset: f64,
}

impl Conversion {
    /// No conversion: the numbers are in the channel's unit.
    #[must_use]
    pub const fn none(unit: Unit) -> Self {
        Self { unit, factor: 1.0, offset: 0.0 }
    }

    /// The SI value of a number; NaN stays NaN.
    #[must_use]
    pub fn si(&self, number: f64) -> f64 {
        let value = self.factor * number;
        if self.offset == 0.0 { value } else { value + self.offset }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_suffix_wins() {
        for (column, name, unit) in [
            ("motor_speed_rad_s", "motor_speed", Unit::RadPerS),
            ("a_rad_s2", "a", Unit::RadPerS2),
            ("enc1_angle_rad", "enc1_angle", Unit::Rad),
            ("x_m_s2", "x", Unit::MPerS2),
            ("x_m_s", "x", Unit::MPerS),
            ("torque_in_Nm", "torque_in", Unit::Nm),
            ("force_N", "force", Unit::N),
            ("duty_1", "duty", Unit::One),
        ] {
            assert_eq!(Unit::of_column(column), Some((name, unit)));
        }
        assert_eq!((Unit::of_column("sample_id"), Unit::of_column("_V")), (None, None));
    }

    #[test]
    fn suffixes_are_tried_longest_first_and_symbols_are_units_of_the_table() {
        for (index, unit) in Unit::ALL.into_iter().enumerate() {
            for later in &Unit::ALL[index + 1..] {
                assert!(!later.suffix().ends_with(unit.suffix()), "{unit} hides {later}");
            }
            assert_eq!(Unit::of_column(&format!("x{}", unit.suffix())), Some(("x", unit)));
            assert_eq!(Product::of_symbol(unit.symbol()), Some(unit.product()));
        }
    }
}
