//! Progress of a fit in words and as a share.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use socam_identify::{Observer, Progress, ProgressMonitor, Stage};

use socam_workbench::job::Handle;

/// Shares of the time of an identification that precede its descents on all data and its intervals as a rule, 1.
const BEFORE_DESCENTS: f64 = 0.4;
const BEFORE_INTERVALS: f64 = 0.9;

/// A monitor that reports to a job and ends with it.
pub(crate) fn monitor(handle: &Handle) -> ProgressMonitor {
    ProgressMonitor::by(Arc::new(Follow {
        handle: handle.clone(),
        begun: AtomicUsize::new(0),
        part: Mutex::new(None),
    }))
}

struct Follow {
    handle: Handle,
    /// Starts that have begun; they run side by side.
    begun: AtomicUsize,
    /// Name of the present part of a work of several fits.
    part: Mutex<Option<String>>,
}

impl Observer for Follow {
    fn progress(&self, progress: &Progress) {
        let stage = match progress.stage {
            Stage::Start { number, of } => {
                let begun = self.begun.fetch_max(number, Ordering::Relaxed).max(number);
                format!("start {begun} of {of}")
            }
            Stage::Descent { round } => format!("all data, descent {round}"),
            Stage::Intervals => "intervals".into(),
        };
        let step = if progress.stage == Stage::Intervals {
            String::new()
        } else {
            format!(", step {}", progress.step)
        };
        match &*self.part.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(part) => self.handle.doing(format!("{part}: {stage}{step}")),
            None => {
                self.handle.doing(format!("{stage}{step}"));
                self.handle.at(share(progress.stage) as f32);
            }
        }
    }

    fn stop(&self) -> bool {
        self.handle.is_cancelled()
    }

    fn is_cancelled(&self) -> bool {
        self.handle.is_cancelled()
    }

    fn part(&self, name: &str, done: f64) {
        self.handle.doing(name.to_owned());
        self.handle.at(done as f32);
        *self.part.lock().unwrap_or_else(PoisonError::into_inner) = Some(name.to_owned());
    }
}

/// Usual share of an identification that precedes a stage. Each descent is taken to halve the remaining time: there are usually few
/// descents, and seven at most.
fn share(stage: Stage) -> f64 {
    match stage {
        Stage::Start { number, of } => BEFORE_DESCENTS * (number - 1) as f64 / of.max(1) as f64,
        Stage::Descent { round } => {
            let done = 1.0 - 0.5_f64.powi(round.saturating_sub(1).min(60) as i32);
            BEFORE_DESCENTS + (BEFORE_INTERVALS - BEFORE_DESCENTS) * done
        }
        Stage::Intervals => BEFORE_INTERVALS,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_rise_from_stage_to_stage() {
        let starts = (1..=6).map(|number| Stage::Start { number, of: 6 });
        let descents = (1..=7).map(|round| Stage::Descent { round });
        let shares: Vec<f64> = starts.chain(descents).chain([Stage::Intervals]).map(share).collect();
        assert!(shares.windows(2).all(|pair| pair[0] < pair[1]), "{shares:?}");
        assert_eq!((shares[0], shares[6]), (0.0, BEFORE_DESCENTS));
    }
}
