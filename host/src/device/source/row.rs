//! A row of a source.

/// A row with its time and number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// Time since the first row, ns.
    pub(crate) time_ns: i64,
    /// Number; a jump means lost rows.
    pub(crate) sequence: u64,
    /// Time of arrival since the link was opened, ns.
    pub(crate) arrival_ns: i64,
    /// Whether its time is the device's own; otherwise it is that of arrival.
    pub(crate) has_clock: bool,
    /// Whether the device's clock jumped before it.
    pub(crate) is_new_clock: bool,
    /// Values of all channels.
    pub(crate) values: Vec<f64>,
}
