//! The one rule for columns of tables from any text, program or container.

use crate::plain::plain_name;
use crate::spelling::{conversion, is_counts, seconds};
use crate::{Conversion, Unit};

/// Content of a column, by its name and by the unit that the file states apart from the name.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name of the channel that the column becomes.
    pub name: String,
    /// Its unit as written: the stated one, else the one at the end of its name.
    pub unit: Option<String>,
    /// Meaning of its numbers.
    pub meaning: Meaning,
    /// Another unit that the end of the name may mean: `N m` for `torque_N_m`, which by the rule is `torque_N` in m.
    pub doubt: Option<String>,
    /// Whether its unit is a suffix of one letter or digit, which elsewhere may be an index: `u_m`, `phase_A`, `kp_1`.
    pub is_letter: bool,
}

/// Meaning of the numbers of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meaning {
    /// Values of a channel, after this conversion.
    Values(Conversion),
    /// Times, in a unit of this many seconds.
    Time(f64),
    /// Counts of an encoder.
    Counts,
    /// Numbers in a unit that is written but unknown, or that no channel has.
    Unknown,
    /// Numbers without a unit.
    Unstated,
}

/// The unit at the end of a column's name.
struct End<'n> {
    /// The name before the unit.
    bare: &'n str,
    unit: String,
    mark: Mark,
}

/// The mark that separates a unit from the name before it.
#[derive(Clone, Copy, PartialEq)]
enum Mark {
    /// An underscore, before one of the suffixes of [`Unit`].
    Suffix,
    /// An underscore, before another unit.
    Underscore,
    /// Brackets around the unit.
    Brackets,
    /// A blank, a comma, a slash or "in".
    Other,
}

/// Determines what a column holds. Every reader uses this function and no other.
///
/// 1. A name that ends in the suffix of a unit of channels, longest suffix first, is that channel in that unit: `command_V`.
/// 2. Else it may end in any known unit: in brackets (`Speed [rpm]`), behind an underscore (`torque_mNm`, `speed_deg_per_s`), or behind
///    a mark (`Zeit / ms`). `in`, `min` and `turn` and single letters behind an underscore are words and indices.
/// 3. A unit that the file states apart from the name counts before the name's end, which then is part of the name, unless both are
///    units of one quantity.
///
/// ```
/// use socam_units::{Meaning, Unit, column};
///
/// let torque = column("torque_in_mNm", None);
/// let Meaning::Values(conversion) = torque.meaning else { panic!() };
/// assert_eq!((torque.name.as_str(), conversion.unit, conversion.factor), ("torque_in", Unit::Nm, 1e-3));
/// assert_eq!(column("Motor speed [1/min]", None).name, "motor_speed");
/// assert_eq!(column("torque_in", None).meaning, Meaning::Unstated);
/// ```
#[must_use]
pub fn column(name: &str, stated: Option<&str>) -> Column {
    let name = name.trim();
    let stated = stated.map(str::trim).filter(|unit| !unit.is_empty());
    let end = end(name);
    let is_whole = end.as_ref().zip(stated).is_some_and(|(end, stated)| {
        end.mark != Mark::Brackets && !is_alike(Meaning::of(&end.unit), Meaning::of(stated))
    });
    let end = end.filter(|_| !is_whole);
    let unit = stated.map(str::to_owned).or_else(|| end.as_ref().map(|end| end.unit.clone()));
    let by_suffix = stated.is_none() && end.as_ref().is_some_and(|end| end.mark == Mark::Suffix);
    Column {
        meaning: unit.as_deref().map_or(Meaning::Unstated, Meaning::of),
        unit,
        doubt: end.as_ref().filter(|_| by_suffix).and_then(|end| doubt(name, end)),
        is_letter: by_suffix && end.as_ref().is_some_and(|end| name.len() == end.bare.len() + 2),
        name: end.map_or_else(|| plain_name(name), |end| end.channel()),
    }
}

impl Meaning {
    fn of(unit: &str) -> Self {
        match (conversion(unit), seconds(unit)) {
            (Some(conversion), _) => Self::Values(conversion),
            (None, Some(seconds)) => Self::Time(seconds),
            (None, None) if is_counts(unit) => Self::Counts,
            (None, None) => Self::Unknown,
        }
    }
}

/// Whether both are numbers of one quantity.
fn is_alike(a: Meaning, b: Meaning) -> bool {
    match (a, b) {
        (Meaning::Values(a), Meaning::Values(b)) => a.unit == b.unit,
        (Meaning::Time(_), Meaning::Time(_)) | (Meaning::Counts, Meaning::Counts) => true,
        _ => false,
    }
}

impl End<'_> {
    fn channel(&self) -> String {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        match self.mark {
            Mark::Suffix => self.bare.to_owned(),
            Mark::Underscore if self.bare.chars().all(is_plain) => self.bare.to_owned(),
            _ => plain_name(self.bare),
        }
    }
}

fn end(name: &str) -> Option<End<'_>> {
    if let Some((bare, unit)) = Unit::of_column(name) {
        return Some(End { bare, unit: unit.symbol().to_owned(), mark: Mark::Suffix });
    }
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')] {
        let inner = name.strip_suffix(close).and_then(|rest| rest.rsplit_once(open));
        if let Some((bare, unit)) = inner.filter(|(bare, _)| !bare.trim().is_empty()) {
            return Some(End { bare: bare.trim(), unit: unit.trim().to_owned(), mark: Mark::Brackets });
        }
    }
    let is_unit = |text: &str| !matches!(Meaning::of(text), Meaning::Unknown);
    let marked = [" / ", ", ", " in "].into_iter().filter_map(|mark| name.split_once(mark));
    if let Some((bare, unit)) = marked.into_iter().find(|(_, unit)| is_unit(unit)) {
        return Some(End { bare: bare.trim(), unit: unit.to_owned(), mark: Mark::Other });
    }
    let (bare, unit, mark) =
        ends(name).find(|(bare, unit, _)| is_unit(unit) && (!is_word(unit) || above_per(bare).is_some()))?;
    Some(rate(bare, unit, mark).unwrap_or_else(|| End { bare, unit: unit.to_owned(), mark }))
}

/// Splits of a name at its underscores and blanks, longest end first.
fn ends(name: &str) -> impl Iterator<Item = (&str, &str, Mark)> {
    let split = name.match_indices(['_', ' ']).map(move |(at, mark)| {
        let kind = if mark == "_" { Mark::Underscore } else { Mark::Other };
        (&name[..at], &name[at + 1..], kind)
    });
    split.filter(|(bare, unit, _)| !bare.is_empty() && !unit.is_empty())
}

/// `torque_in`, `x_min`, `run_2` and `motor_U` end in words, numbers and indices, and `time_in_s` is not in inches per second.
fn is_word(end: &str) -> bool {
    let is_index = end.len() == 1 && end != "s";
    let is_inch = end.starts_with("in_") && !end.starts_with("in_per_");
    is_index || is_inch || matches!(end, "in" | "min" | "turn" | "turns" | "rot")
}

/// The text before a "per" at the end.
fn above_per(bare: &str) -> Option<&str> {
    bare.strip_suffix("_per").or_else(|| bare.strip_suffix(" per"))
}

/// A rate of something unknown, or of counts, which is not a time: `litres_per_min`, `vel_counts_s`.
fn rate<'n>(bare: &'n str, unit: &str, mark: Mark) -> Option<End<'n>> {
    let whole = above_per(bare);
    let (before, what) = whole.unwrap_or(bare).rsplit_once(['_', ' '])?;
    let is_rate = whole.is_some() || (is_counts(what) && seconds(unit).is_some());
    is_rate.then(|| End { bare: before, unit: format!("{what}/{unit}"), mark })
}

/// The meaning of a suffix if a longer end of the name is the unit.
fn doubt(name: &str, end: &End<'_>) -> Option<String> {
    if end.unit == Unit::One.symbol() {
        return None;
    }
    let longer = ends(name).take_while(|(bare, ..)| bare.len() < end.bare.len());
    let known = longer.map(|(_, unit, _)| unit).find(|unit| conversion(unit).is_some() && !is_word(unit));
    match (known, above_per(end.bare)) {
        (Some(unit), _) => Some(unit.replace("_per_", "/").replace('_', " ")),
        (None, Some(whole)) => {
            let above = whole.rsplit('_').next().unwrap_or(whole);
            Some(format!("{above}/{}", end.unit))
        }
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Name and unit of a column's channel, with the factor; the unit as written if no channel has it.
    fn said(name: &str, stated: Option<&str>) -> String {
        let column = column(name, stated);
        let unit = column.unit.unwrap_or_default();
        match column.meaning {
            Meaning::Values(c) => format!("{} {} {:.6}", column.name, c.unit, c.factor),
            Meaning::Time(seconds) => format!("{} time {seconds}", column.name),
            Meaning::Counts => format!("{} counts", column.name),
            Meaning::Unknown => format!("{} ? {unit}", column.name),
            Meaning::Unstated => format!("{} -", column.name),
        }
    }

    #[test]
    fn a_name_may_end_in_its_unit() {
        for (name, meaning) in [
            ("command_V", "command V 1.000000"),
            ("Motor Speed_rad_s", "Motor Speed rad/s 1.000000"),
            ("u_m", "u m 1.000000"),
            ("kp_1", "kp 1 1.000000"),
            ("torque_in_mNm", "torque_in N m 0.001000"),
            ("torque_in", "torque_in -"),
            ("torque_in_Nm", "torque_in N m 1.000000"),
            ("torque_mN_m", "torque_mN m 1.000000"),
            ("Speed_rpm", "Speed rad/s 0.104720"),
            ("speed_deg_per_s", "speed rad/s 0.017453"),
            ("velocity_rot_per_s", "velocity rad/s 6.283185"),
            ("omega_rad_per_s", "omega rad/s 1.000000"),
            ("v_m_per_s", "v m/s 1.000000"),
            ("accel_rad_per_s2", "accel rad/s2 1.000000"),
            ("accel_deg_s2", "accel rad/s2 0.017453"),
            ("vel_counts_s", "vel ? counts/s"),
            ("vel_ticks_per_s", "vel ? ticks/s"),
            ("flow_litres_per_min", "flow ? litres/min"),
            ("x_min", "x_min -"),
            ("x_min_s", "x_min time 1"),
            ("time_in_s", "time_in time 1"),
            ("run_7", "run_7 -"),
            ("motor_U", "motor_u -"),
            ("Time (s)", "time time 1"),
            ("Zeit / ms", "zeit time 0.001"),
            ("n_Mot, rpm", "n_mot rad/s 0.104720"),
            ("Spannung / V", "spannung V 1.000000"),
            ("Drehmoment [Nm]", "drehmoment N m 1.000000"),
            ("Angle in deg", "angle rad 0.017453"),
            ("load.torque_mNm", "load_torque N m 0.001000"),
            ("x [furlong]", "x ? furlong"),
            ("encoder_counts", "encoder counts"),
            ("t_s", "t time 1"),
        ] {
            assert_eq!(said(name, None), meaning, "{name}");
        }
    }

    #[test]
    fn a_stated_unit_counts_before_the_end_of_the_name() {
        for (name, stated, meaning) in [
            ("torque", "N m", "torque N m 1.000000"),
            ("command_V", "V", "command V 1.000000"),
            ("command_V", "mV", "command V 0.001000"),
            ("u_m", "N m", "u_m N m 1.000000"),
            ("Speed [rpm]", "1/min", "speed rad/s 0.104720"),
            ("speed_rpm", "rad/s", "speed rad/s 1.000000"),
            ("x", "furlong", "x ? furlong"),
            ("x_deg", "", "x rad 0.017453"),
        ] {
            assert_eq!(said(name, Some(stated)), meaning, "{name} in {stated}");
        }
    }

    #[test]
    fn what_a_suffix_may_mean_otherwise_is_said() {
        let doubt = |name: &str| column(name, None).doubt;
        assert_eq!(doubt("torque_N_m").as_deref(), Some("N m"));
        assert_eq!(doubt("stiffness_N_per_m").as_deref(), Some("N/m"));
        for name in ["torque_in_Nm", "speed_m_s", "motor_V", "speed_rpm_1"] {
            assert_eq!(doubt(name), None, "{name}");
        }
        assert!(column("u_m", None).is_letter && !column("x_Nm", None).is_letter);
        assert!(!column("u_m", Some("m")).is_letter);
    }
}
