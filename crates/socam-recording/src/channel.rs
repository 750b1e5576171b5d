//! Channels, and how the columns of tables become channels.

use serde::{Deserialize, Serialize};
use socam_units::{Conversion, Meaning, Unit, column, distinct_names};

use crate::cell::number;
use crate::error::excerpt;
use crate::line_problem::LineProblem;
use crate::warning::Warning;

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
        Unit::of_column(column).map(|(name, unit)| Self::new(name, unit))
    }

    /// The column's name: `motor_speed_rad_s`.
    #[must_use]
    pub fn column_name(&self) -> String {
        format!("{}{}", self.name, self.unit.suffix())
    }
}

/// A column of a table that becomes a channel.
#[derive(Debug, Clone)]
pub(crate) struct TableColumn {
    /// Index of the column among the cells of a line.
    pub(crate) cell: usize,
    /// Name of the column in the file.
    pub(crate) title: String,
    pub(crate) channel: Channel,
    /// Conversion from the column's numbers to values of the channel.
    pub(crate) conversion: Conversion,
}

impl TableColumn {
    /// The SI value in a cell of this column, `None` where it is empty.
    pub(crate) fn value(&self, cell: &[u8]) -> Result<Option<f64>, LineProblem> {
        let value = number(cell, &self.title)?.map(|number| self.conversion.si(number));
        match value {
            Some(value) if !value.is_finite() => {
                Err(LineProblem::NotFinite { column: self.title.clone(), found: excerpt(cell) })
            }
            value => Ok(value),
        }
    }
}

/// Columns of a table that become channels, in the order of the file, and warnings about the others. The first column is not a
/// channel and is left out.
pub(crate) fn table_columns(header: &[String]) -> (Vec<TableColumn>, Vec<Warning>) {
    let columns: Vec<_> = header.iter().skip(1).map(|title| (column(title, None), "")).collect();
    let names = distinct_names(&columns);
    let (mut taken, mut warnings) = (Vec::new(), Vec::new());
    for (index, ((column, _), name)) in columns.into_iter().zip(names).enumerate() {
        let title = header[index + 1].clone();
        let Meaning::Values(conversion) = column.meaning else {
            warnings.push(Warning::left_aside(title, column.meaning));
            continue;
        };
        warnings.extend(Warning::of_doubt(&title, &column));
        let channel = Channel::new(name, conversion.unit);
        taken.push(TableColumn { cell: index + 1, title, channel, conversion });
    }
    (taken, warnings)
}
