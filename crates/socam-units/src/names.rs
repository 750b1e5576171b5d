//! Names of channels.

use std::collections::HashSet;

use crate::plain::plain_name;
use crate::{Column, Conversion, Meaning};

/// Names of the channels of some columns, each given with the group of its table (empty if there is one table). No two channels share name
/// and unit: among columns that would, one in the SI unit keeps the name; the others get their group's name before it, or a number.
///
/// ```
/// use socam_units::{column, distinct_names};
///
/// let columns = ["position_deg", "position_rad", "position_V"].map(|name| (column(name, None), ""));
/// assert_eq!(distinct_names(&columns), ["position_2", "position", "position"]);
/// ```
#[must_use]
pub fn distinct_names(columns: &[(Column, &str)]) -> Vec<String> {
    let unit = |column: &Column| match column.meaning {
        Meaning::Values(conversion) => Some(conversion.unit),
        _ => None,
    };
    let is_si = |column: &Column| matches!(column.meaning, Meaning::Values(conversion) if conversion == Conversion::none(conversion.unit));
    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_by_key(|index| !is_si(&columns[*index].0));
    let mut taken = HashSet::new();
    let mut names = vec![String::new(); columns.len()];
    for index in order {
        let (column, group) = &columns[index];
        let of_group = (!group.is_empty()).then(|| format!("{}_{}", plain_name(group), column.name));
        let numbered = (2..).map(|number| format!("{}_{number}", column.name));
        let mut free = std::iter::once(column.name.clone()).chain(of_group).chain(numbered);
        names[index] = free.find(|name| taken.insert((name.clone(), unit(column)))).unwrap_or_default();
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::column;

    #[test]
    fn names_of_channels_are_plain_and_distinct() {
        for (name, plain) in [
            ("Motor Speed", "motor_speed"),
            ("velocity.hip", "velocity_hip"),
            ("Geschw\u{e4}he", "geschwaehe"),
            ("\u{3c9}", "signal"),
        ] {
            assert_eq!(plain_name(name), plain);
        }
        let speeds = [("speed [rpm]", "Load side"), ("speed [rpm]", "Motor"), ("speed [rpm]", "Motor")];
        let columns = speeds.map(|(name, group)| (column(name, None), group));
        assert_eq!(distinct_names(&columns), ["speed", "motor_speed", "speed_2"]);
    }
}
