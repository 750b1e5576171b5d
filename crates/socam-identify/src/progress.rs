//! Whoever waits for a fit: how far it is, and whether it shall go on.

use std::sync::Arc;

/// What a fit is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Different start values compete on a part of the data.
    Start {
        /// Which of them, from one.
        number: usize,
        /// How many there are.
        of: usize,
    },
    /// A descent on all data; noise levels are judged anew between descents.
    Descent {
        /// Which descent, from one.
        round: usize,
    },
    /// Intervals of what was found.
    Intervals,
}

/// How far a fit is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What it is doing.
    pub stage: Stage,
    /// Steps that were tried in this stage.
    pub step: usize,
    /// Mean of the squared residuals at the best point so far, in units of the noise as judged so far: one when nothing is left
    /// to explain. `None` where it was not looked at.
    pub misfit: Option<f64>,
}

/// Follows a fit, from its own thread or another.
pub trait Observer: Send + Sync {
    /// Learns of each step.
    fn progress(&self, progress: &Progress);

    /// Whether the search shall end at the best point so far; asked before each step. Intervals are made all the same.
    fn stop(&self) -> bool;
}

/// An observer, or none.
#[derive(Clone, Default)]
pub struct ProgressMonitor(Option<Arc<dyn Observer>>);

impl ProgressMonitor {
    /// Lets `observer` follow.
    pub fn by(observer: Arc<dyn Observer>) -> Self {
        Self(Some(observer))
    }

    /// Tells where the fit stands.
    pub(crate) fn tell(&self, stage: Stage, step: usize, misfit: Option<f64>) {
        if let Some(observer) = &self.0 {
            observer.progress(&Progress { stage, step, misfit });
        }
    }

    /// Whether the search shall end.
    pub(crate) fn stops(&self) -> bool {
        self.0.as_ref().is_some_and(|observer| observer.stop())
    }
}

impl std::fmt::Debug for ProgressMonitor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.0.is_some() { "watched" } else { "unwatched" })
    }
}
