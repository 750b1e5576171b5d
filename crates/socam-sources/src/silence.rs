//! How long a device has given nothing, though its link lives: an adapter answers also where its bus is dead, and a server talks on.

/// The time since a device last gave what is waited for.
#[derive(Debug, Default)]
pub(crate) struct Silence {
    since_ns: Option<i64>,
}

impl Silence {
    /// Longest silence, s.
    pub(crate) const MOST_S: i64 = 10;

    /// What is waited for has arrived.
    pub(crate) fn heard(&mut self, at_ns: i64) {
        self.since_ns = Some(at_ns);
    }

    /// Whether it has lasted too long; it begins with the first call.
    pub(crate) fn is_too_long(&mut self, now_ns: i64) -> bool {
        now_ns - *self.since_ns.get_or_insert(now_ns) > Self::MOST_S * 1_000_000_000
    }
}
