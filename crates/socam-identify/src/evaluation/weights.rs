//! The point at which a model is evaluated, and the weights of its residuals and sensitivities.

use std::sync::Arc;

use crate::noise::{
    discrepancy::Discrepancy, innovations_filter::NoiseLevels, level_score::PerturbedFilters,
    prewhitening::Prewhitening,
};

/// Values of all unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// All parameters of the model, SI.
    pub(crate) values: Vec<f64>,
    /// Nuisance parameters by segment: start state (if free), then offsets of the outputs that have one.
    pub(crate) nuisance: Vec<Vec<f64>>,
}

/// Weights of residuals and sensitivities, and what else an evaluation computes.
#[derive(Clone)]
pub(crate) struct Weights {
    /// Noise standard deviation of each output, SI.
    pub(crate) noise_std: Vec<f64>,
    /// Noise standard deviation of each input, SI; empty where inputs are exact.
    pub(crate) input_std: Vec<f64>,
    /// Sensitivities with respect to free parameter j are multiplied by `scales[j]`.
    pub(crate) scales: Vec<f64>,
    /// Whether scores by block are computed.
    pub(crate) scores: bool,
    /// Whether whitened residuals are kept.
    pub(crate) innovations: bool,
    /// Noise levels whose score is computed, one set per sample time; empty where none is.
    pub(crate) perturbed_filters: Arc<Vec<(f64, PerturbedFilters)>>,
    /// Scale of the innovations of each output for the outlier search.
    pub(crate) detector: Option<Arc<Vec<f64>>>,
    /// Fixed whitening filters; `None` for filters that follow the parameters.
    pub(crate) frozen: Option<Arc<Vec<Prewhitening>>>,
    /// Levels of the model discrepancy, applied after the filters of sensor noise; empty without discrepancy.
    pub(crate) discrepancy: Arc<Vec<Discrepancy>>,
}

impl Weights {
    /// White output noise and exact inputs.
    pub(crate) fn white(noise_std: Vec<f64>, scales: Vec<f64>) -> Self {
        Self {
            noise_std,
            input_std: Vec::new(),
            scales,
            scores: false,
            innovations: false,
            perturbed_filters: Arc::default(),
            detector: None,
            frozen: None,
            discrepancy: Arc::default(),
        }
    }

    pub(crate) fn levels(&self) -> NoiseLevels {
        NoiseLevels { outputs: self.noise_std.clone(), inputs: self.input_std.clone() }
    }
}
