//! Clock times: the moment at which a recording's own time is zero, and parts of recordings that are named by clock times.

use jiff::Timestamp;
use jiff::civil::{DateTime, Time};
use jiff::tz::TimeZone;
use serde::{Deserialize, Serialize};

const SECOND_NS: f64 = 1e9;
const DAY_NS: i128 = 86_400_000_000_000;

/// Times above this are seconds since 1970, not since the recording's start.
pub(crate) const UNIX_TIME_S: f64 = 1e8;

/// What the clock that stamped a recording showed at the recording's own time 0.
///
/// ```
/// use socam_recording::Epoch;
///
/// assert_eq!(Epoch::Date(1_777_644_200_000_000_000).clock_time(0.25), "2026-05-01 14:03:20.25");
/// assert_eq!(Epoch::Midnight.clock_time(50_600.25), "14:03:20.25");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Epoch {
    /// Nanoseconds since 1970: in UTC where the format counts from 1970, else by the clock face of which the file holds the date and time.
    Date(i64),
    /// Midnight of a day that the file does not state: its times are times of day.
    Midnight,
}

impl Epoch {
    /// The epoch of times that are seconds since 1970 themselves; `None` for other times.
    pub(crate) fn of_times(start_s: f64) -> Option<Self> {
        (start_s > UNIX_TIME_S).then_some(Self::Date(0))
    }

    fn ns(self) -> i128 {
        match self {
            Self::Date(ns) => ns.into(),
            Self::Midnight => 0,
        }
    }

    /// Time of day at time 0, s since midnight.
    ///
    /// ```
    /// assert_eq!(socam_recording::Epoch::Date(1_777_644_200_000_000_000).of_day_s(), 50_600.0);
    /// ```
    #[must_use]
    pub fn of_day_s(self) -> f64 {
        self.ns().rem_euclid(DAY_NS) as f64 / SECOND_NS
    }

    /// Date and time of day, or the time of day alone, at a time of the recording, to the microsecond.
    #[must_use]
    pub fn clock_time(self, time_s: f64) -> String {
        let ns = self.ns() + (time_s * 1e6).round() as i128 * 1000;
        let (ns, form) = match self {
            Self::Date(_) => (ns, "%F %T%.f"),
            Self::Midnight => (ns.rem_euclid(DAY_NS), "%T%.f"),
        };
        let moment = Timestamp::from_nanosecond(ns).map(|moment| moment.to_zoned(TimeZone::UTC));
        moment.map_or_else(|_| format!("{time_s} s"), |moment| moment.strftime(form).to_string())
    }
}

/// One end of a part of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// None.
    Open,
    /// A time of the recording, s.
    Seconds(f64),
    /// A time of day, ns since midnight.
    Clock(i64),
    /// A date and time, ns since 1970.
    Date(i64),
}

impl End {
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        if text.is_empty() {
            return Some(Self::Open);
        }
        if let Ok(seconds) = text.parse::<f64>() {
            return seconds.is_finite().then_some(Self::Seconds(seconds));
        }
        let since_1970 = |moment: Timestamp| i64::try_from(moment.as_nanosecond()).ok();
        let at_utc = |moment: DateTime| since_1970(moment.to_zoned(TimeZone::UTC).ok()?.timestamp());
        if let Ok(moment) = text.parse::<Timestamp>() {
            return since_1970(moment).map(Self::Date);
        }
        if let Ok(moment) = text.parse::<DateTime>() {
            return at_utc(moment).map(Self::Date);
        }
        at_utc(text.parse::<Time>().ok()?.on(1970, 1, 1)).map(Self::Clock)
    }

    fn is_clock_time(self) -> bool {
        matches!(self, Self::Clock(_) | Self::Date(_))
    }
}

/// A part of a recording, at least one end of which is a clock time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ClockSpan {
    from: End,
    to: End,
    /// As it was written.
    pub(crate) text: String,
}

/// Why there is no such part: words for an error.
type Problem = String;

impl ClockSpan {
    /// `None` where no end is a clock time.
    pub(crate) fn of(from: End, to: End, text: &str) -> Option<Self> {
        (from.is_clock_time() || to.is_clock_time()).then(|| Self { from, to, text: text.into() })
    }

    /// Whether FROM is before TO, as far as the two themselves tell.
    pub(crate) fn is_forwards(&self) -> bool {
        match (self.from, self.to) {
            (End::Date(from), End::Date(to)) => from < to,
            // A part that ends earlier in the day passes midnight.
            (End::Clock(from), End::Clock(to)) => from != to,
            _ => true,
        }
    }

    /// Whether two parts of one recording have a time in common; `None` where only the recording could tell.
    pub(crate) fn overlaps(&self, other: &Self) -> Option<bool> {
        let range = |span: &Self| {
            let (from, to) = match (span.from, span.to) {
                (End::Date(from), End::Date(to)) => (Some(from), Some(to)),
                (End::Date(from), End::Open) => (Some(from), None),
                (End::Open, End::Date(to)) => (None, Some(to)),
                _ => return None,
            };
            Some((from.unwrap_or(i64::MIN), to.unwrap_or(i64::MAX)))
        };
        if let (Some(own), Some(theirs)) = (range(self), range(other)) {
            return Some(own.0 < theirs.1 && theirs.0 < own.1);
        }
        match ((self.from, self.to), (other.from, other.to)) {
            ((End::Clock(a), End::Clock(b)), (End::Clock(c), End::Clock(d))) => {
                // On the circle of a day two parts meet where one begins within the other.
                let day = DAY_NS as i64;
                let within =
                    |at: i64, from: i64, to: i64| (at - from).rem_euclid(day) < (to - from).rem_euclid(day);
                Some(within(c, a, b) || within(a, c, d))
            }
            _ => None,
        }
    }

    /// The part in the recording's own time. A time of day is the one within the recording; a part that ends earlier in the day than it
    /// begins passes midnight.
    pub(crate) fn within(&self, epoch: Option<Epoch>, start_s: f64, end_s: f64) -> Result<[f64; 2], Problem> {
        let Some(epoch) = epoch else {
            return Err(format!(
                "its file states neither a date nor a time of day; name its part in seconds, from {start_s} to {end_s}"
            ));
        };
        let of_row = |time_s: f64| epoch.ns() + (time_s * SECOND_NS).round() as i128;
        let (start, end) = (of_row(start_s), of_row(end_s));
        let names_a_day = |end| matches!(end, End::Date(_));
        if epoch == Epoch::Midnight && (names_a_day(self.from) || names_a_day(self.to)) {
            return Err(format!(
                "its file states times of day and no date; leave the date out, from {} to {}",
                epoch.clock_time(start_s),
                epoch.clock_time(end_s)
            ));
        }
        let takes_a_day = |end| matches!(end, End::Clock(_));
        if end - start >= DAY_NS && (takes_a_day(self.from) || takes_a_day(self.to)) {
            return Err(format!(
                "it lasts longer than a day, so that a time of day is in it twice; write the date too ({}) or seconds",
                epoch.clock_time(start_s).replace(' ', "T")
            ));
        }
        let resolved = |which: End, after: Option<i128>| match which {
            End::Open => None,
            End::Seconds(seconds) => Some(of_row(seconds)),
            End::Date(ns) => Some(ns.into()),
            End::Clock(ns) => {
                let first_day = start.div_euclid(DAY_NS) * DAY_NS + i128::from(ns);
                Some(match after {
                    Some(after) => after + 1 + (i128::from(ns) - after - 1).rem_euclid(DAY_NS),
                    None if first_day < start && first_day + DAY_NS <= end => first_day + DAY_NS,
                    None => first_day,
                })
            }
        };
        let from = resolved(self.from, None);
        let to = resolved(self.to, from);
        // Half a nanosecond earlier, because stamps in seconds are rounded.
        let seconds = |ns: i128| ((ns - epoch.ns()) as f64 - 0.5) / SECOND_NS;
        let from_s = from.map_or(f64::NEG_INFINITY, seconds);
        let to_s = to.map_or(f64::INFINITY, seconds);
        if from_s < to_s { Ok([from_s, to_s]) } else { Err("FROM must be before TO".into()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAY_FIRST: i64 = 1_777_593_600_000_000_000; // 2026-05-01

    fn part(text: &str) -> ClockSpan {
        let (from, to) = text.split_once("..").unwrap();
        ClockSpan::of(End::parse(from).unwrap(), End::parse(to).unwrap(), text).unwrap()
    }

    fn within(text: &str, epoch: Epoch, start_s: f64, end_s: f64) -> [f64; 2] {
        part(text).within(Some(epoch), start_s, end_s).unwrap().map(|s| (s * 1e6).round() / 1e6)
    }

    #[test]
    fn ends_are_seconds_or_clock_times() {
        let hour = 3_600_000_000_000;
        assert_eq!(End::parse(" 2.5 "), Some(End::Seconds(2.5)));
        assert_eq!(End::parse("14:30"), Some(End::Clock(14 * hour + hour / 2)));
        assert_eq!(End::parse("00:00:01.5"), Some(End::Clock(1_500_000_000)));
        for text in [
            "2026-05-01",
            "2026-05-01T00:00",
            "2026-05-01 00:00:00",
            "2026-05-01T02:00+02:00",
            "2026-05-01T00:00:00Z",
        ] {
            assert_eq!(End::parse(text), Some(End::Date(MAY_FIRST)), "{text}");
        }
        for text in ["nan", "25:00", "2026-13-01", "noon", "14:60"] {
            assert_eq!(End::parse(text), None, "{text}");
        }
    }

    #[test]
    fn a_part_is_found_by_times_of_day_and_by_dates() {
        let (hour, two) = (3600.0, 2.0 * 3600.0);
        // From 23:00 on, for two hours.
        let late = Epoch::Date(MAY_FIRST + 23 * 3_600_000_000_000);
        assert_eq!(within("23:30..00:30", late, 0.0, two), [0.5 * hour, 1.5 * hour]);
        assert_eq!(within("00:30..00:45", late, 0.0, two), [1.5 * hour, 1.75 * hour]);
        assert_eq!(within("22:00..23:15", late, 0.0, two), [-hour, 0.25 * hour]);
        assert_eq!(within("..00:15", late, 0.0, two), [f64::NEG_INFINITY, 1.25 * hour]);
        assert_eq!(within("2026-05-01T23:10..2026-05-02", late, 0.0, two), [600.0, hour]);
        assert_eq!(within("60..23:10", late, 0.0, two), [60.0, 600.0]);
        assert_eq!(within("14:00..14:05", Epoch::Midnight, 50_400.0, 50_500.0), [50_400.0, 50_700.0]);
    }

    #[test]
    fn what_the_recording_cannot_tell_is_said() {
        let why = |text: &str, epoch, end_s| part(text).within(epoch, 0.0, end_s).unwrap_err();
        assert!(why("14:00..14:05", None, 10.0).contains("neither a date nor a time of day"));
        assert!(why("2026-05-01..", Some(Epoch::Midnight), 10.0).contains("no date"));
        assert!(why("14:00..", Some(Epoch::Date(MAY_FIRST)), 90_000.0).contains("longer than a day"));
        assert!(why("2026-05-01T00:00:09..3", Some(Epoch::Date(MAY_FIRST)), 10.0).contains("before TO"));
    }

    #[test]
    fn parts_are_compared_where_they_are_of_a_kind() {
        let overlaps = |a: &str, b: &str| part(a).overlaps(&part(b));
        assert_eq!(overlaps("14:00..14:05", "14:05..14:10"), Some(false));
        assert_eq!(overlaps("14:00..14:05", "14:04..14:10"), Some(true));
        assert_eq!(overlaps("23:00..01:00", "00:30..02:00"), Some(true));
        assert_eq!(overlaps("2026-05-01..2026-05-02", "2026-05-02.."), Some(false));
        assert_eq!(overlaps("14:00..14:05", "2026-05-02.."), None);
    }
}
