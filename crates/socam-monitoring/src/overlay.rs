//! Data that a view draws: model and measurement in one plot.

use std::sync::Arc;

use crate::{Alarm, Summary, Symptom};

/// Signals of one block.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockSignals {
    /// Times of the samples, s.
    pub time_s: Vec<f64>,
    /// Measured values by output of the model, SI; NaN where missing.
    pub measured: Vec<Vec<f64>>,
    /// Free run of the model from an initial state fitted to this block, by output, SI.
    pub model: Vec<Vec<f64>>,
    /// Innovations by output, in units of healthy noise; zero where missing.
    pub innovations: Vec<Vec<f64>>,
    /// Sequential test by statistic, in the order of [`Overlay::statistics`], divided by its threshold, 1. An alarm is raised above
    /// 1. Empty if the block was not judged.
    pub tests: Vec<f64>,
}

/// A channel of the overlay.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OverlayChannel {
    /// Name of the output channel.
    pub name: String,
    /// SI unit of the channel.
    pub unit: &'static str,
}

/// Phase of the monitoring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    /// The baseline is being collected.
    Learning {
        /// Healthy samples so far, s.
        collected_s: f64,
        /// Length that is needed, s.
        needed_s: f64,
    },
    /// Samples are being monitored.
    Watching,
    /// An alarm stands.
    Alarmed,
}

/// A snapshot for views. Taking one copies references, no samples.
#[derive(Debug, Clone)]
pub struct Overlay {
    /// Phase of the monitoring.
    pub phase: Phase,
    /// The outputs of the model.
    pub channels: Arc<Vec<OverlayChannel>>,
    /// Quantity that each statistic measures.
    pub statistics: Arc<Vec<Symptom>>,
    /// Blocks of the window, the oldest first.
    pub blocks: Vec<Arc<BlockSignals>>,
    /// All alarms so far, the oldest first; at most [`Overlay::MOST_ALARMS`].
    pub alarms: Vec<Alarm>,
    /// Amount of healthy data in the baseline; `None` while the baseline is collected.
    pub baseline: Option<Summary>,
    /// Number of blocks that were judged.
    pub judged: usize,
    /// Number of blocks that were not judged: more or less motion than in the baseline, too few samples, an overflow.
    pub not_judged: usize,
}

/// What the monitoring says about the health of the bench. Blocks that move otherwise than the baseline are not judged, and nothing is
/// said about a bench of which no block was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judgement {
    /// The baseline is being collected.
    Learning,
    /// No block was judged.
    NotJudged,
    /// Blocks were judged before, and none raised an alarm; none of those in the window was judged.
    NotJudgedNow,
    /// Blocks of the window were judged, and no alarm stands.
    AsUsual,
    /// An alarm stands.
    Changed,
}

impl Overlay {
    /// Largest number of alarms that are kept.
    pub const MOST_ALARMS: usize = 100;

    /// What can be said about the health of the bench at present.
    #[must_use]
    pub fn judgement(&self) -> Judgement {
        let is_judged = |block: &Arc<BlockSignals>| !block.tests.is_empty();
        match self.phase {
            Phase::Learning { .. } => Judgement::Learning,
            Phase::Alarmed => Judgement::Changed,
            Phase::Watching if self.judged == 0 => Judgement::NotJudged,
            Phase::Watching if !self.blocks.iter().any(is_judged) => Judgement::NotJudgedNow,
            Phase::Watching => Judgement::AsUsual,
        }
    }
}
