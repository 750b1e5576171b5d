//! The point at which a model is evaluated, and the weights of its residuals and sensitivities.

use std::sync::Arc;

use crate::noise::{
    discrepancy::Discrepancy, innovations_filter::NoiseLevels, levels::Probe, prewhitening::Prewhitening,
};

/// Unknowns at which a pass is made.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// All parameters of the model, SI.
    pub(crate) values: Vec<f64>,
    /// For each segment its local unknowns: start state (if free), then offsets of the outputs that have one.
    pub(crate) nuisance: Vec<Vec<f64>>,
}

/// How residuals and sensitivities are weighted in a pass.
#[derive(Clone)]
pub(crate) struct Weights {
    /// Noise standard deviation of each output, SI.
    pub(crate) noise_std: Vec<f64>,
    /// Of each input.
    pub(crate) input_std: Vec<f64>,
    /// Sensitivities with respect to free parameter j are multiplied by `scales[j]`.
    pub(crate) scales: Vec<f64>,
    /// Whether block scores are wanted.
    pub(crate) scores: bool,
    /// Whether whitened residuals are wanted.
    pub(crate) innovations: bool,
    /// Noise levels under test, one set for each sample time; empty where none are.
    pub(crate) probes: Arc<Vec<(f64, Probe)>>,
    /// Sizes of remainders when outliers are looked for.
    pub(crate) detector: Option<Arc<Vec<f64>>>,
    /// Filters to be used instead of those that follow the parameters.
    pub(crate) frozen: Option<Arc<Vec<Prewhitening>>>,
    /// Levels of the model discrepancy, behind the filters of sensor noise; empty where residuals are taken for sensor noise only.
    pub(crate) discrepancy: Arc<Vec<Discrepancy>>,
}

impl Weights {
    /// White noise of the outputs, no other.
    pub(crate) fn white(noise_std: Vec<f64>, scales: Vec<f64>) -> Self {
        Self {
            noise_std,
            input_std: Vec::new(),
            scales,
            scores: false,
            innovations: false,
            probes: Arc::default(),
            detector: None,
            frozen: None,
            discrepancy: Arc::default(),
        }
    }

    pub(crate) fn levels(&self) -> NoiseLevels {
        NoiseLevels { outputs: self.noise_std.clone(), inputs: self.input_std.clone() }
    }
}
