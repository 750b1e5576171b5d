//! The rhythm of a device that is asked for each sample.

use crate::device::{Heard, Row};

/// Longest time until an answer, ns.
const ANSWER_NS: i64 = 50_000_000;
/// Time without an answer after which all late ones have come, ns: questions without an answer are that of an answer apart.
const QUIET_NS: i64 = ANSWER_NS + 25_000_000;
/// Longest time for which late answers are waited for, ns.
const DRAINED_NS: i64 = 2_000_000_000;

/// What is said of an answer to no question.
pub(crate) const UNASKED: &str = "an answer came that was not asked for";

/// Questions at an interval, one at a time.
#[derive(Debug)]
pub(crate) struct Asking {
    period_ns: i64,
    /// Longest time until the answer, ns.
    within_ns: i64,
    due_ns: i64,
    asked_ns: Option<i64>,
    /// The first of the questions without an answer before that one: an answer now may be to it.
    doubtful_ns: Option<i64>,
    /// Since when late answers are waited for.
    draining_ns: Option<i64>,
    missing: u64,
}

impl Asking {
    pub(crate) fn new(period_ns: i64) -> Self {
        Self {
            period_ns: period_ns.max(1),
            within_ns: ANSWER_NS,
            due_ns: 0,
            asked_ns: None,
            doubtful_ns: None,
            draining_ns: None,
            missing: 0,
        }
    }

    /// Questions whose answers take this much longer, ns.
    pub(crate) fn slower_by(self, more_ns: i64) -> Self {
        Self { within_ns: self.within_ns.saturating_add(more_ns), ..self }
    }

    /// The time of the next call, where no question is due.
    pub(crate) fn wait(&self, now_ns: i64) -> Option<i64> {
        let due_ns = self.asked_ns.map_or(self.due_ns, |asked_ns| asked_ns.saturating_add(self.within_ns));
        (now_ns < due_ns).then_some(due_ns)
    }

    /// Appends the question if it is due; returns the time of the next call.
    pub(crate) fn poll(&mut self, now_ns: i64, question: &[u8], out: &mut Vec<u8>) -> i64 {
        if let Some(next_ns) = self.wait(now_ns) {
            return next_ns;
        }
        if let Some(asked_ns) = self.asked_ns {
            self.missing += 1;
            self.doubtful_ns.get_or_insert(asked_ns);
        }
        out.extend_from_slice(question);
        self.asked_ns = Some(now_ns);
        self.draining_ns = None;
        // A device that is slower than the interval is asked as often as it answers, not more often later.
        self.due_ns = self.due_ns.saturating_add(self.period_ns).max(now_ns);
        now_ns.saturating_add(self.within_ns)
    }

    /// The answer has arrived: a row without clock or number, taken at some time since the question. After questions without an answer it may be
    /// to the first of them; then nothing is asked until those to the others have had time to come, and those are no rows.
    pub(crate) fn answered(&mut self, arrival_ns: i64, values: Vec<f64>) -> Heard {
        let asked_ns = self.asked_ns.take();
        let doubtful_ns = self.doubtful_ns.take();
        if doubtful_ns.is_some() {
            self.draining_ns = Some(arrival_ns);
        }
        self.late(arrival_ns);
        let Some(since_ns) = asked_ns.map(|asked_ns| doubtful_ns.unwrap_or(asked_ns)) else {
            return Heard::Damaged(UNASKED);
        };
        let spread_ns = arrival_ns.saturating_sub(since_ns);
        Heard::Row(Row { device_s: None, number: None, arrival_ns, spread_ns, values })
    }

    /// A message that may be a part of a late answer has arrived: what is as late as that is waited for too.
    pub(crate) fn late(&mut self, arrival_ns: i64) {
        let is_draining = |begin_ns| arrival_ns.saturating_sub(begin_ns) < DRAINED_NS;
        if self.draining_ns.is_some_and(is_draining) {
            self.due_ns = self.due_ns.max(arrival_ns.saturating_add(QUIET_NS));
        }
    }

    pub(crate) fn awaits(&self) -> bool {
        self.asked_ns.is_some()
    }

    /// Hands on the questions that got no answer.
    pub(crate) fn take_missing(&mut self, heard: &mut Vec<Heard>) {
        let missing = std::mem::take(&mut self.missing);
        heard.extend((0..missing).map(|_| Heard::Damaged("a question got no answer")));
    }

    /// The link was interrupted, perhaps within a message: no answer comes to what was asked.
    pub(crate) fn interrupted(&mut self, is_within: bool, heard: &mut Vec<Heard>) {
        if is_within {
            heard.push(Heard::Damaged("the link broke within it"));
        }
        (self.asked_ns, self.doubtful_ns, self.draining_ns) = (None, None, None);
    }
}
