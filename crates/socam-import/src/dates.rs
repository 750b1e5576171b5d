//! Dates and times of day in text.

use jiff::civil::{DateTime, Time};

/// Converts a date of a common form to nanoseconds since 1970, by the clock that wrote it: no time zone is applied unless one is
/// written. A time of day counts from midnight. `format` is a pattern as in `strptime`, for ambiguous forms.
pub(crate) fn nanoseconds(text: &str, format: Option<&str>) -> Option<i64> {
    let text = text.trim().trim_matches('"');
    if let Some(format) = format {
        return of_date(DateTime::strptime(format, text).ok()?);
    }
    // Cheap for the numbers that most cells are.
    if !text.contains([':', '-', '.'])
        || !text.starts_with(|c: char| c.is_ascii_digit())
        || !text.contains(':')
    {
        return None;
    }
    let dotted = text.replace(',', ".");
    if let Ok(zoned) = dotted.parse::<jiff::Timestamp>() {
        return i64::try_from(zoned.as_nanosecond()).ok();
    }
    if let Ok(date) = dotted.replace('/', "-").parse::<DateTime>() {
        return of_date(date);
    }
    // A dot between numbers of the date means that the day comes first.
    if let Ok(date) = DateTime::strptime("%d.%m.%Y %H:%M:%S%.f", &dotted) {
        return of_date(date);
    }
    let time: Time = dotted.parse().ok()?;
    of_date(time.on(1970, 1, 1))
}

fn of_date(date: DateTime) -> Option<i64> {
    let zoned = date.to_zoned(jiff::tz::TimeZone::UTC).ok()?;
    i64::try_from(zoned.timestamp().as_nanosecond()).ok()
}

#[cfg(test)]
mod tests {
    use super::nanoseconds;

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
    }
}
