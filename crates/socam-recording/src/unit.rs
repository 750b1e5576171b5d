//! Units of channels, and how a CSV column names them.
//!
//! A column is a channel's name followed by its unit's suffix (`motor_speed_rad_s`). These SI units are the only ones
//! of a recording; other units are converted before.

use serde::{Deserialize, Serialize};

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

    /// The suffix of a CSV column in this unit, underscore included.
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
}

impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.symbol())
    }
}

/// A channel of a recording: what was measured (or commanded), and its unit.
///
/// ```
/// use socam_recording::{Channel, Unit};
///
/// let speed = Channel::from_column_name("motor_speed_rad_s").expect("a name with a unit");
/// assert_eq!(speed, Channel::new("motor_speed", Unit::RadPerS));
/// assert_eq!((speed.column_name().as_str(), speed.unit.suffix(), speed.unit.symbol()), ("motor_speed_rad_s", "_rad_s", "rad/s"));
/// assert_eq!(Channel::from_column_name("motor_speed"), None);
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Channel {
    /// Name without the unit's suffix, such as `motor_speed`.
    pub name: String,
    /// SI unit of every value.
    pub unit: Unit,
}

impl Channel {
    /// A channel of this name and unit.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: Unit) -> Self {
        Self { name: name.into(), unit }
    }

    /// Splits a column's name, longest suffix first; `None` when it has no unit's suffix, or nothing before it.
    #[must_use]
    pub fn from_column_name(column: &str) -> Option<Self> {
        Unit::ALL.into_iter().find_map(|unit| {
            column
                .strip_suffix(unit.suffix())
                .filter(|name| !name.is_empty())
                .map(|name| Self::new(name, unit))
        })
    }

    /// The column's name: `motor_speed_rad_s`.
    #[must_use]
    pub fn column_name(&self) -> String {
        format!("{}{}", self.name, self.unit.suffix())
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
            assert_eq!(Channel::from_column_name(column), Some(Channel::new(name, unit)));
        }
        assert_eq!(Channel::from_column_name("sample_id"), None);
        assert_eq!(Channel::from_column_name("_V"), None);
    }

    #[test]
    fn suffixes_are_tried_longest_first_and_names_come_back() {
        for (index, unit) in Unit::ALL.into_iter().enumerate() {
            for later in &Unit::ALL[index + 1..] {
                assert!(!later.suffix().ends_with(unit.suffix()), "{unit} hides {later}");
            }
            let channel = Channel::new("x", unit);
            assert_eq!(Channel::from_column_name(&channel.column_name()), Some(channel));
        }
    }
}
