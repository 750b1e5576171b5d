//! The rhythm of a device that is asked for each sample.

use crate::device::{Heard, Row};

/// Longest time until an answer, ns.
const ANSWER_NS: i64 = 50_000_000;

/// Questions at an interval, one at a time.
#[derive(Debug)]
pub(crate) struct Asking {
    period_ns: i64,
    /// Longest time until the answer, ns.
    within_ns: i64,
    due_ns: i64,
    asked_ns: Option<i64>,
    missing: u64,
}

impl Asking {
    pub(crate) fn new(period_ns: i64) -> Self {
        Self { period_ns: period_ns.max(1), within_ns: ANSWER_NS, due_ns: 0, asked_ns: None, missing: 0 }
    }

    /// Questions whose answers take this much longer, ns.
    pub(crate) fn slower_by(self, more_ns: i64) -> Self {
        Self { within_ns: self.within_ns.saturating_add(more_ns), ..self }
    }

    /// Appends the question if it is due; returns the time of the next call.
    pub(crate) fn poll(&mut self, now_ns: i64, question: &[u8], out: &mut Vec<u8>) -> i64 {
        match self.asked_ns {
            Some(asked_ns) if now_ns < asked_ns.saturating_add(self.within_ns) => {
                return asked_ns.saturating_add(self.within_ns);
            }
            Some(_) => self.missing += 1,
            None if now_ns < self.due_ns => return self.due_ns,
            None => {}
        }
        out.extend_from_slice(question);
        self.asked_ns = Some(now_ns);
        // A device that is slower than the interval is asked as often as it answers, not more often later.
        self.due_ns = self.due_ns.saturating_add(self.period_ns).max(now_ns);
        now_ns.saturating_add(self.within_ns)
    }

    /// The answer has arrived: a row without clock or number, taken at some time since the question.
    pub(crate) fn answered(&mut self, arrival_ns: i64, values: Vec<f64>) -> Heard {
        let spread_ns = self.asked_ns.take().map_or(0, |asked_ns| arrival_ns.saturating_sub(asked_ns));
        Heard::Row(Row { device_s: None, number: None, arrival_ns, spread_ns, values })
    }

    /// Whether the present question has waited too long for its answer.
    pub(crate) fn is_overdue(&self, now_ns: i64) -> bool {
        self.asked_ns.is_some_and(|asked_ns| now_ns >= asked_ns.saturating_add(self.within_ns))
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
        self.asked_ns = None;
    }
}
