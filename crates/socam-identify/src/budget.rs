//! Budget of a work: the time that its search may take, and what ended the search before its own end.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Wall-clock time that a work may take. Its search gets a share of it, so that intervals and pictures are made within the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// `None` where there is no end.
    total_s: Option<f64>,
    search_share: f64,
}

impl Budget {
    /// No end.
    pub const NONE: Self = Self { total_s: None, search_share: 1.0 };

    /// A number of seconds, of which this share (0 to 1) belongs to the search. Zero seconds mean no end.
    ///
    /// ```
    /// use socam_identify::Budget;
    ///
    /// assert_eq!(Budget::seconds(0.0, 0.75), Budget::NONE);
    /// ```
    #[must_use]
    pub fn seconds(total_s: f64, search_share: f64) -> Self {
        if total_s > 0.0 { Self { total_s: Some(total_s), search_share } } else { Self::NONE }
    }
}

/// What ended a search before its own end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The observer, for example by Ctrl-C.
    Interrupt,
    /// The budget.
    Budget,
}

/// The end of a search before its own end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cutoff {
    /// What ended it.
    pub cause: Cause,
    /// Time from the beginning of the work, s.
    pub after_s: f64,
    /// The budget, s; `None` where there is none.
    pub budget_s: Option<f64>,
}

/// `the search was ended after 45.0 s, to keep its budget of 60 s`
impl std::fmt::Display for Cutoff {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.cause, self.budget_s) {
            (Cause::Budget, Some(budget_s)) => {
                write!(
                    f,
                    "the search was ended after {:.1} s, to keep its budget of {budget_s} s",
                    self.after_s
                )
            }
            _ => write!(f, "the search was interrupted after {:.1} s", self.after_s),
        }
    }
}

/// The clock of a work. Once it has ended the search, the search stays ended.
#[derive(Debug)]
pub(crate) struct Clock {
    since: Instant,
    budget: Budget,
    /// Whether the search has come to its own end, so that the rest of the work has the rest of the budget.
    is_closing: AtomicBool,
    cutoff: OnceLock<Cutoff>,
}

impl Clock {
    pub(crate) fn start(budget: Budget) -> Self {
        Self { since: Instant::now(), budget, is_closing: AtomicBool::new(false), cutoff: OnceLock::new() }
    }

    /// Gives the rest of the work the rest of the budget.
    pub(crate) fn close(&self) {
        self.is_closing.store(true, Ordering::Relaxed);
    }

    /// Whether the search shall end, because of its observer or because its time is over.
    pub(crate) fn stops(&self, is_interrupted: bool) -> bool {
        if self.cutoff.get().is_some() {
            return true;
        }
        let elapsed = self.since.elapsed();
        let cause = match (is_interrupted, self.limit()) {
            (true, _) => Cause::Interrupt,
            (false, Some(limit)) if elapsed >= limit => Cause::Budget,
            _ => return false,
        };
        let budget_s = self.budget.total_s;
        self.cutoff.get_or_init(|| Cutoff { cause, after_s: elapsed.as_secs_f64(), budget_s });
        true
    }

    pub(crate) fn cutoff(&self) -> Option<Cutoff> {
        self.cutoff.get().copied()
    }

    /// Time after which no step of the search begins. A budget beyond the range of the clock has no end.
    fn limit(&self) -> Option<Duration> {
        let share = if self.is_closing.load(Ordering::Relaxed) { 1.0 } else { self.budget.search_share };
        Duration::try_from_secs_f64(share * self.budget.total_s?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that was started some seconds ago.
    fn started(ago_s: f64, budget: Budget) -> Clock {
        let since = Instant::now().checked_sub(Duration::from_secs_f64(ago_s)).unwrap();
        Clock { since, ..Clock::start(budget) }
    }

    #[test]
    fn a_search_ends_at_its_share_and_the_rest_of_the_work_at_the_whole() {
        let budget = Budget::seconds(1000.0, 0.75);
        assert!(!started(0.0, budget).stops(false));
        let clock = started(0.5, Budget::seconds(0.5, 0.75));
        clock.close();
        assert!(clock.stops(false), "the whole budget is over");
        let clock = started(0.5, Budget::seconds(0.6, 0.75));
        assert_eq!(clock.cutoff(), None);
        assert!(clock.stops(false));
        // What was ended stays ended.
        clock.close();
        assert!(clock.stops(false));
        let cutoff = clock.cutoff().unwrap();
        assert_eq!((cutoff.cause, cutoff.budget_s), (Cause::Budget, Some(0.6)));
    }

    #[test]
    fn a_search_that_came_to_its_own_end_leaves_the_rest_of_the_budget() {
        let clock = started(0.5, Budget::seconds(1000.0, 0.0005));
        clock.close();
        assert!(!clock.stops(false));
        assert!(clock.stops(true));
        assert_eq!(clock.cutoff().unwrap().cause, Cause::Interrupt);
    }

    #[test]
    fn nothing_ends_without_a_budget() {
        for endless in [Budget::NONE, Budget::seconds(0.0, 0.75), Budget::seconds(f64::MAX, 0.75)] {
            assert!(!started(0.5, endless).stops(false));
        }
    }

    #[test]
    fn a_cutoff_is_a_clause() {
        let budget = Cutoff { cause: Cause::Budget, after_s: 45.02, budget_s: Some(60.0) };
        assert_eq!(budget.to_string(), "the search was ended after 45.0 s, to keep its budget of 60 s");
        let interrupt = Cutoff { cause: Cause::Interrupt, ..budget };
        assert_eq!(interrupt.to_string(), "the search was interrupted after 45.0 s");
    }
}
