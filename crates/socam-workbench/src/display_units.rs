//! Units in which values are shown. Data, files and formulas stay in SI.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::signal::Signal;

/// Units to choose from, the SI unit first.
const CHOICES: [&[&str]; 6] = [
    &["rad/s", "rpm", "deg/s", "rev/s"],
    &["rad", "deg", "rev"],
    &["rad/s2", "deg/s2", "rev/s2"],
    &["m/s", "mm/s"],
    &["m", "mm"],
    &["N m", "mN m"],
];

/// Units to choose from for channels of an SI unit, that unit first; none for those that are shown as they are.
#[must_use]
pub fn choices(si: &str) -> &'static [&'static str] {
    CHOICES.into_iter().find(|units| units[0] == si).unwrap_or_default()
}

/// Units in which channels are shown.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DisplayUnits {
    /// For all channels of an SI unit, by that unit.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub all: BTreeMap<String, String>,
    /// For single channels, by their names; these go before [`all`](Self::all).
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub channels: BTreeMap<String, String>,
}

/// A unit in which values are shown.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownIn {
    /// Its symbol.
    pub unit: String,
    /// Factor from the SI value to the value that is shown.
    pub per_si: f64,
}

impl DisplayUnits {
    /// Whether everything is shown in SI.
    #[must_use]
    pub fn is_si(&self) -> bool {
        self.all.is_empty() && self.channels.is_empty()
    }

    /// The unit in which a channel is shown.
    #[must_use]
    pub fn of(&self, signal: &Signal) -> ShownIn {
        let chosen = [self.channels.get(&signal.name), self.all.get(&signal.unit)];
        // A layout of another hand may name any unit, and a channel of that name may have another quantity.
        let known = choices(&signal.unit);
        let mut fitting = chosen.into_iter().flatten().filter(|unit| known.contains(&unit.as_str()));
        let scale = fitting.next().and_then(|unit| Some((unit, socam_units::parse(unit)?)));
        match scale {
            Some((unit, scale)) => ShownIn { unit: unit.clone(), per_si: 1.0 / scale.factor },
            None => ShownIn { unit: signal.unit.clone(), per_si: 1.0 },
        }
    }

    /// Name and unit of a channel as they are shown: `motor_speed, rpm`.
    #[must_use]
    pub fn label(&self, signal: &Signal) -> String {
        format!("{}, {}", signal.name, self.of(signal).unit)
    }

    /// Shows all channels of an SI unit in another one, also those that had one of their own.
    pub fn choose_for_all(&mut self, si: &str, unit: &str) {
        self.channels.retain(|_, own| !choices(si).contains(&own.as_str()));
        if unit == si {
            self.all.remove(si);
        } else {
            self.all.insert(si.to_owned(), unit.to_owned());
        }
    }

    /// Shows one channel in another unit than the others.
    pub fn choose_for_one(&mut self, signal: &Signal, unit: &str) {
        if self.all.get(&signal.unit).map_or(signal.unit.as_str(), String::as_str) == unit {
            self.channels.remove(&signal.name);
        } else {
            self.channels.insert(signal.name.clone(), unit.to_owned());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_is_a_unit_of_its_quantity() {
        for units in CHOICES {
            let si = socam_units::parse(units[0]).unwrap();
            assert_eq!(si.factor, 1.0);
            for unit in units {
                assert_eq!(socam_units::parse(unit).unwrap().product, si.product, "{unit}");
            }
        }
    }

    #[test]
    fn a_channel_is_shown_in_its_own_unit_else_in_that_of_all() {
        let of = |name: &str| Signal { name: name.into(), unit: "rad/s".into() };
        let mut units = DisplayUnits::default();
        units.choose_for_all("rad/s", "rpm");
        units.choose_for_one(&of("output_speed"), "deg/s");
        let shown = units.of(&of("motor_speed"));
        assert_eq!((shown.unit.as_str(), (shown.per_si * std::f64::consts::TAU).round()), ("rpm", 60.0));
        assert_eq!(units.label(&of("output_speed")), "output_speed, deg/s");
        units.choose_for_one(&of("output_speed"), "rpm");
        assert!(units.channels.is_empty(), "as all others");
        units.choose_for_one(&of("output_speed"), "rad/s");
        assert_eq!(units.of(&of("output_speed")).per_si, 1.0);
        units.choose_for_all("rad/s", "rad/s");
        assert!(units.is_si());
        // What a file of another hand says is not believed.
        units.all.insert("N m".into(), "rpm".into());
        assert_eq!(units.of(&Signal { name: "torque".into(), unit: "N m".into() }).unit, "N m");
    }
}
