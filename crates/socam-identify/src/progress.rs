//! Progress of a fit, and its end: by its observer or by its budget.

use std::sync::Arc;

use crate::{
    IdentifyError,
    budget::{Budget, Clock, Cutoff},
};

/// Stage of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Descents from different start values on a part of the data.
    Start {
        /// Number of the start, from one.
        number: usize,
        /// Number of starts.
        of: usize,
    },
    /// A descent on all data. Noise levels are re-estimated between descents.
    Descent {
        /// Number of the descent, from one.
        round: usize,
    },
    /// Confidence intervals.
    Intervals,
}

/// State of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Stage.
    pub stage: Stage,
    /// Attempted steps in this stage.
    pub step: usize,
    /// Mean squared residual at the best point so far, in units of the present noise level: one for a model that leaves only noise.
    /// `None` where it was not evaluated.
    pub misfit: Option<f64>,
}

/// `start 2 of 6, step 14, chi2/n 1.0300`
impl std::fmt::Display for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.stage {
            Stage::Start { number, of } => write!(f, "start {number} of {of}")?,
            Stage::Descent { round } => write!(f, "all data, descent {round}")?,
            Stage::Intervals => return f.write_str("intervals"),
        }
        write!(f, ", step {}", self.step)?;
        self.misfit.map_or(Ok(()), |misfit| write!(f, ", chi2/n {misfit:.4}"))
    }
}

/// Receiver of a fit's progress; it is called from the fit's threads.
pub trait Observer: Send + Sync {
    /// Called at each step.
    fn progress(&self, progress: &Progress);

    /// Whether the search shall end at the best point so far; called before each step. Intervals are computed all the same. A search that was
    /// ended stays ended.
    fn stop(&self) -> bool;

    /// Called when a part of a work of several fits begins, with its name and the share of the whole work that is usually done by then, 0
    /// to 1.
    fn part(&self, _name: &str, _done: f64) {}

    /// Whether the work shall end without a result, with [`IdentifyError::Cancelled`]; called before each evaluation of a segment.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// An optional [`Observer`], and the clock of the work's [`Budget`].
///
/// ```
/// use std::sync::{Arc, atomic::{AtomicUsize, Ordering}};
///
/// use socam_identify::{Observer, Options, Problem, Progress, ProgressMonitor, output_error};
///
/// #[derive(Default)]
/// struct Counter(AtomicUsize);
/// impl Observer for Counter {
///     fn progress(&self, _: &Progress) {
///         self.0.fetch_add(1, Ordering::Relaxed);
///     }
///     fn stop(&self) -> bool {
///         false
///     }
/// }
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let counter = Arc::new(Counter::default());
/// let options = Options { starts: 1, progress: ProgressMonitor::by(counter.clone()), ..Options::default() };
/// output_error(&Problem::new(&model, &recordings, options)?)?;
/// assert!(counter.0.load(Ordering::Relaxed) > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Default)]
pub struct ProgressMonitor {
    observer: Option<Arc<dyn Observer>>,
    /// `None` where nothing can end the search.
    clock: Option<Arc<Clock>>,
    is_tentative: bool,
}

impl ProgressMonitor {
    /// Reports to `observer`.
    pub fn by(observer: Arc<dyn Observer>) -> Self {
        Self {
            observer: Some(observer),
            clock: Some(Arc::new(Clock::start(Budget::NONE))),
            is_tentative: false,
        }
    }

    /// The same with a budget, whose time begins now.
    #[must_use]
    pub fn within(self, budget: Budget) -> Self {
        Self { clock: Some(Arc::new(Clock::start(budget))), ..self }
    }

    /// The same for work whose result is of no use once the search is ended, as that of a candidate's fit: where the search is ended, an
    /// evaluation is given up on its way, as if the prediction had overflowed. One evaluation of a stiff model may take many seconds.
    #[must_use]
    pub fn tentative(self) -> Self {
        Self { is_tentative: true, ..self }
    }

    /// Whether evaluations are given up on their way where the search is ended.
    pub(crate) fn is_tentative(&self) -> bool {
        self.is_tentative
    }

    /// Reports the state of the fit.
    pub(crate) fn tell(&self, stage: Stage, step: usize, misfit: Option<f64>) {
        if let Some(observer) = &self.observer {
            observer.progress(&Progress { stage, step, misfit });
        }
    }

    /// Reports that a part of a work of several fits begins; see [`Observer::part`].
    pub fn part(&self, name: &str, done: f64) {
        if let Some(observer) = &self.observer {
            observer.part(name, done);
        }
    }

    /// Returns an error if the work was cancelled.
    pub(crate) fn proceed(&self) -> Result<(), IdentifyError> {
        match &self.observer {
            Some(observer) if observer.is_cancelled() => Err(IdentifyError::Cancelled),
            _ => Ok(()),
        }
    }

    /// Whether the search shall end. What takes long asks before each step; a step that has begun is completed, so that its result is valid.
    pub fn stops(&self) -> bool {
        let is_interrupted = self.observer.as_ref().is_some_and(|observer| observer.stop());
        self.clock.as_ref().is_some_and(|clock| clock.stops(is_interrupted))
    }

    /// What ended the search before its own end, if anything did.
    pub fn cutoff(&self) -> Option<Cutoff> {
        self.clock.as_ref()?.cutoff()
    }

    /// Says that the search is over: the rest of the work has the rest of the budget.
    pub fn close(&self) {
        if let Some(clock) = &self.clock {
            clock.close();
        }
    }
}

impl std::fmt::Debug for ProgressMonitor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.observer.is_some() { "watched" } else { "unwatched" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_is_a_line() {
        let progress = Progress { stage: Stage::Start { number: 2, of: 6 }, step: 14, misfit: Some(1.03) };
        assert_eq!(progress.to_string(), "start 2 of 6, step 14, chi2/n 1.0300");
        let progress = Progress { stage: Stage::Descent { round: 1 }, step: 3, misfit: None };
        assert_eq!(progress.to_string(), "all data, descent 1, step 3");
    }
}
