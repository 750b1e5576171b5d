//! What a view draws: model and measurement over each other.

use std::sync::Arc;

use crate::{Alarm, Summary, Symptom};

/// Signals of one block.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockSignals {
    /// Times of the samples, s.
    pub time_s: Vec<f64>,
    /// By output of the model, as measured, SI; NaN where missing.
    pub measured: Vec<Vec<f64>>,
    /// By output, the free run of the model from a start state fitted to this block, SI.
    pub model: Vec<Vec<f64>>,
    /// By output, innovations in units of healthy noise; zero where missing.
    pub innovations: Vec<Vec<f64>>,
    /// By statistic, in the order of [`Overlay::statistics`]: its sequential test divided by its threshold, 1. An alarm is raised above 1.
    /// Empty where the block was not judged.
    pub tests: Vec<f64>,
}

/// A channel of the overlay.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OverlayChannel {
    /// Name of the output channel.
    pub name: String,
    /// Its SI unit.
    pub unit: &'static str,
}

/// What a watch is doing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    /// It collects the baseline.
    Learning {
        /// Healthy samples so far, s.
        collected_s: f64,
        /// Length that is needed, s.
        needed_s: f64,
    },
    /// It watches.
    Watching,
    /// An alarm stands.
    Alarmed,
}

/// A snapshot for views. Taking one copies references, no samples.
#[derive(Debug, Clone)]
pub struct Overlay {
    /// What the watch is doing.
    pub phase: Phase,
    /// The outputs of the model.
    pub channels: Arc<Vec<OverlayChannel>>,
    /// What each statistic measures.
    pub statistics: Arc<Vec<Symptom>>,
    /// Blocks of the window, the oldest first.
    pub blocks: Vec<Arc<BlockSignals>>,
    /// All alarms so far, the oldest first; at most [`Overlay::MOST_ALARMS`].
    pub alarms: Vec<Alarm>,
    /// What the baseline supports; `None` while it is learned.
    pub baseline: Option<Summary>,
    /// Number of blocks that were not judged: more or less motion than in the baseline, too few samples, an overflow.
    pub not_judged: usize,
}

impl Overlay {
    /// Largest number of alarms that are kept.
    pub const MOST_ALARMS: usize = 100;
}
