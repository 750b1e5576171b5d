//! The frequency response of one output, with that of the model.

use socam_frequency::{Complex, response::Response};

use super::{beside::Beside, signals::Pair};

/// The response of one output.
pub(super) struct Answer<'m> {
    pub(super) pair: Pair<'m>,
    pub(super) response: Response,
    /// The model's response at each line.
    pub(super) model: Vec<Complex<f64>>,
}

impl Answer<'_> {
    pub(super) fn beside_model(&self) -> Beside {
        let mut beside = Beside::default();
        for (line, exact) in self.response.lines.iter().zip(&self.model) {
            let ratio = line.response / exact;
            let [low, high] = line.magnitude_ci95();
            let phase_held = ratio.arg().to_degrees().abs() <= line.phase_half_width_deg();
            beside.add(ratio, line.coherence, [(low..=high).contains(&exact.norm()), phase_held]);
        }
        beside
    }
}

pub(super) fn decibel(size: f64) -> f64 {
    20.0 * size.log10()
}
