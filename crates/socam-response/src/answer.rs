//! The frequency response of one output, with that of the model.

use socam_frequency::{
    Complex,
    response::{Distortion, Parity, Response},
};

use crate::{beside::Beside, signals::Pair};

/// A measured response, not compared with a model.
#[derive(Debug)]
pub struct Measured {
    /// Lines of the response.
    pub response: Response,
    /// Warnings for the reader.
    pub warnings: Vec<String>,
    /// Notes on the processing of the signals.
    pub notes: Vec<String>,
}

/// The response of one output.
#[derive(Debug)]
pub struct Answer<'m> {
    /// Input and output.
    pub pair: Pair<'m>,
    /// Response from the input to the output.
    pub response: Response,
    /// The model's response at each line.
    pub model: Vec<Complex<f64>>,
    /// Warnings for the reader.
    pub warnings: Vec<String>,
    /// Notes on the processing of the signals.
    pub notes: Vec<String>,
}

impl Answer<'_> {
    /// Comparison of the estimate with the model.
    #[must_use]
    pub fn beside_model(&self) -> Beside {
        let mut beside = Beside::default();
        for (line, exact) in self.response.lines.iter().zip(&self.model) {
            let ratio = line.response / exact;
            let [low, high] = line.magnitude_ci95();
            let phase_held = ratio.arg().to_degrees().abs() <= line.phase_half_width_deg();
            beside.add(ratio, line.coherence, [(low..=high).contains(&exact.norm()), phase_held]);
        }
        beside
    }

    /// Sentences on the distortion at lines that are not excited, one per parity.
    #[must_use]
    pub fn distortion_sentences(&self) -> Vec<String> {
        self.response.distortion.as_ref().map_or_else(Vec::new, distortion_sentences)
    }
}

/// A size in dB.
#[must_use]
pub fn decibel(size: f64) -> f64 {
    20.0 * size.log10()
}

fn distortion_sentences(distortion: &Distortion) -> Vec<String> {
    let sentence = |name: &str, means: &str, parity: Option<Parity>| {
        let parity = parity?;
        Some(match parity.level_db {
            Some(level) if parity.significant => format!(
                "{name} lines that nothing drives stand at {level:.1} dB, noise at {:.1} dB (p {:.1e}): {means}; `diagnose` finds out what",
                parity.noise_db, parity.p_value
            ),
            _ => format!(
                "{name} lines that nothing drives ({}) hold noise only, at {:.1} dB of the driven ones",
                parity.lines, parity.noise_db
            ),
        })
    };
    let even = sentence("Even", "something acts differently in the two directions", distortion.even);
    let odd = sentence(
        "Odd",
        "something bends the same way in both directions, as friction or hardening does",
        distortion.odd,
    );
    even.into_iter().chain(odd).collect()
}
