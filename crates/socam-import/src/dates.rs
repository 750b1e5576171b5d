//! Dates and times of day in text.

use jiff::civil::{Date, DateTime, Time};

/// A moment, as far as a cell states it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moment {
    /// A date with its time, ns since 1970.
    Full(i64),
    /// A time of day, ns since midnight.
    Clock(i64),
    /// A day, ns from 1970 to its midnight.
    Day(i64),
}

impl Moment {
    pub(crate) const fn nanoseconds(self) -> i64 {
        match self {
            Self::Full(ns) | Self::Clock(ns) | Self::Day(ns) => ns,
        }
    }
}

/// Forms of a day in which the order of its numbers is certain.
const DAYS: [&str; 3] = ["%Y-%m-%d", "%Y/%m/%d", "%d.%m.%Y"];

/// Converts a date of a common form to nanoseconds since 1970, by the clock that wrote it: no time zone is applied unless one is
/// written. A time of day counts from midnight. `format` is a pattern as in `strptime`, for ambiguous forms.
pub(crate) fn nanoseconds(text: &str, format: Option<&str>) -> Option<i64> {
    moment(text, format).map(Moment::nanoseconds)
}

/// What a cell states of a moment, see [`nanoseconds`].
pub(crate) fn moment(text: &str, format: Option<&str>) -> Option<Moment> {
    let text = text.trim().trim_matches('"');
    if let Some(format) = format {
        return of_date(DateTime::strptime(format, text).ok()?).map(Moment::Full);
    }
    // Cheap for the numbers that most cells are.
    if !text.contains([':', '-', '.', '/']) || !text.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if !text.contains(':') {
        return day(text).map(Moment::Day);
    }
    let dotted = text.replace(',', ".");
    if let Ok(zoned) = dotted.parse::<jiff::Timestamp>() {
        return i64::try_from(zoned.as_nanosecond()).ok().map(Moment::Full);
    }
    if let Ok(date) = dotted.replace('/', "-").parse::<DateTime>() {
        return of_date(date).map(Moment::Full);
    }
    // A dot between numbers of the date means that the day comes first.
    if let Ok(date) = DateTime::strptime("%d.%m.%Y %H:%M:%S%.f", &dotted) {
        return of_date(date).map(Moment::Full);
    }
    let time: Time = dotted.parse().ok()?;
    of_date(time.on(1970, 1, 1)).map(Moment::Clock)
}

/// A day with a year of four digits.
fn day(text: &str) -> Option<i64> {
    if !(8..=10).contains(&text.len()) {
        return None;
    }
    let date = DAYS.iter().find_map(|form| Date::strptime(form, text).ok())?;
    of_date(date.at(0, 0, 0, 0))
}

fn of_date(date: DateTime) -> Option<i64> {
    let zoned = date.to_zoned(jiff::tz::TimeZone::UTC).ok()?;
    i64::try_from(zoned.timestamp().as_nanosecond()).ok()
}

#[cfg(test)]
mod tests {
    use super::{Moment, moment, nanoseconds};

    #[test]
    fn common_forms_of_dates_are_read() {
        let second = 1_714_564_800_000_000_000_i64; // 2024-05-01 12:00:00
        for text in [
            "2024-05-01T12:00:00.25",
            "2024-05-01 12:00:00,25",
            "2024/05/01 12:00:00.250",
            "01.05.2024 12:00:00.25",
            "2024-05-01T14:00:00.25+02:00",
        ] {
            assert_eq!(nanoseconds(text, None), Some(second + 250_000_000), "{text}");
        }
        assert_eq!(nanoseconds("00:00:01.5", None), Some(1_500_000_000));
        assert_eq!(nanoseconds("05/01/2024 12:00:00", Some("%m/%d/%Y %H:%M:%S")), Some(second));
        // The month, or the day first: only a format says.
        assert_eq!(nanoseconds("05/01/2024 12:00:00", None), None);
        assert_eq!((nanoseconds("1.25", None), nanoseconds("n.a.", None)), (None, None));
        let midnight = second - 43_200_000_000_000;
        for text in ["2024-05-01", "2024/5/01", "01.05.2024"] {
            assert_eq!(moment(text, None), Some(Moment::Day(midnight)), "{text}");
        }
        assert_eq!(moment("12:00:00", None), Some(Moment::Clock(43_200_000_000_000)));
        for text in ["1.2.3", "05/01/2024", "10.25.2024", "2024.0512", "1-2"] {
            assert_eq!(moment(text, None), None, "{text}");
        }
    }
}
