//! Names that every log of this program carries: profile, topics, metadata records.

/// Profile named in the header of every log.
pub const PROFILE: &str = "socam";

/// Topic of samples, one message each.
pub const SAMPLE_TOPIC: &str = "/socam/sample";

/// Topic of the board's state and counters.
pub const STATUS_TOPIC: &str = "/socam/status";

/// Topic of profile phases, stops and faults.
pub const EVENT_TOPIC: &str = "/socam/event";

/// Name of the metadata record with versions and notes.
pub const METADATA_NAME: &str = "socam";

/// Key in that record of the machine's serial number, which `record --machine` writes.
pub const MACHINE_KEY: &str = "machine";

/// Key in that record of what the clock showed at time 0, where that is not `start_unix_ns`: one of the two texts below.
pub(crate) const TIME_ZERO: &str = "time_zero";

/// The times are times of day.
pub(crate) const TIME_ZERO_MIDNIGHT: &str = "midnight of a day that is not known";

/// Nothing states when the recording began.
pub(crate) const TIME_ZERO_UNKNOWN: &str = "not known; the start is when the file was last written";

/// Name of the metadata record written when a recording is finished in order.
pub const SUMMARY_NAME: &str = "socam.summary";

/// Name of the metadata record of a log that was recovered: its source, and what is missing.
pub const RECOVERED_NAME: &str = "socam.recovered";
