//! Machine and date of a recording: as a list says, else as the log says, else as its path says.

use jiff::{
    Timestamp,
    civil::{Date, DateTime},
    tz::TimeZone,
};
use socam_recording::{Dataset, MACHINE_KEY};

/// Serial number that a log holds.
pub(crate) fn machine_of_log(data: &Dataset) -> Option<String> {
    let text = data.contents()?.metadata.get(MACHINE_KEY)?.trim();
    (!text.is_empty()).then(|| text.to_owned())
}

/// Time at which a log was begun, ms since 1970.
pub(crate) fn date_of_log(data: &Dataset) -> Option<i64> {
    let started = data.contents()?.start_unix_ns.filter(|started| *started > 0)?;
    i64::try_from(started / 1_000_000).ok()
}

/// The first folder of a name.
pub(crate) fn machine_of_name(name: &str) -> Option<String> {
    let (folder, _) = name.trim_start_matches("./").split_once('/')?;
    (!folder.is_empty()).then(|| folder.to_owned())
}

/// The last date `YYYY-MM-DD` in a name, ms since 1970.
pub(crate) fn date_of_name(name: &str) -> Option<i64> {
    const LENGTH: usize = "YYYY-MM-DD".len();
    let starts = (0..name.len().saturating_sub(LENGTH - 1)).rev();
    starts.filter_map(|start| name.get(start..start + LENGTH)).find_map(date)
}

/// Milliseconds since 1970 of a date or time stamp; UTC where it names no zone.
#[must_use]
pub(crate) fn date(text: &str) -> Option<i64> {
    let text = text.trim();
    if let Ok(stamp) = text.parse::<Timestamp>() {
        return Some(stamp.as_millisecond());
    }
    let civil: DateTime = match text.parse::<DateTime>() {
        Ok(civil) => civil,
        Err(_) => text.parse::<Date>().ok()?.at(0, 0, 0, 0),
    };
    Some(civil.to_zoned(TimeZone::UTC).ok()?.timestamp().as_millisecond())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_hold_machines_and_dates() {
        const DAY_MS: i64 = 86_400_000;
        assert_eq!(date("1970-01-03"), Some(2 * DAY_MS));
        assert_eq!(date("1970-01-03T01:00:00+01:00"), Some(2 * DAY_MS));
        assert_eq!(date("1970-01-03 00:00:01"), Some(2 * DAY_MS + 1000));
        assert_eq!(date("yesterday"), None);
        assert_eq!(date_of_name("SN7/1970-01-03 morning.mcap"), Some(2 * DAY_MS));
        assert_eq!(date_of_name("SN7/run-12345-67-8é.mcap"), None);
        assert_eq!(machine_of_name("SN7/1970/run.mcap").as_deref(), Some("SN7"));
        assert_eq!(machine_of_name("run.mcap"), None);
    }
}
