//! Difference between an estimate over frequency and the model's response.

use serde_json::{Value, json};
use socam_frequency::Complex;

/// Coherence above which a line is compared.
const GOOD: f64 = 0.9;

/// An estimate beside the model's response.
#[derive(Debug, Default)]
pub struct Beside {
    /// Number of all lines.
    lines: usize,
    /// Number of lines of good coherence.
    good: usize,
    /// Greatest difference of the magnitude among these, dB.
    worst_db: f64,
    /// Greatest difference of the phase among these, degrees.
    worst_deg: f64,
    /// Number of lines whose intervals of magnitude and phase contain the model's values.
    held: [usize; 2],
}

impl Beside {
    /// Adds a line: the ratio of the estimate to the model's response, and whether the intervals of magnitude and phase contain the model's.
    pub fn add(&mut self, ratio: Complex<f64>, coherence: f64, holds: [bool; 2]) {
        self.lines += 1;
        self.held.iter_mut().zip(holds).for_each(|(count, holds)| *count += usize::from(holds));
        if coherence > GOOD {
            self.good += 1;
            self.worst_db = self.worst_db.max(20.0 * ratio.norm().log10().abs());
            self.worst_deg = self.worst_deg.max(ratio.arg().to_degrees().abs());
        }
    }

    fn held_percent(&self) -> [f64; 2] {
        self.held.map(|count| 100.0 * count as f64 / self.lines.max(1) as f64)
    }

    /// The names are part of the JSON document.
    #[must_use]
    pub fn json(&self) -> Value {
        let [magnitude, phase] = self.held_percent();
        json!({
            "lines": self.lines, "lines_of_good_coherence": self.good,
            "worst_db": self.worst_db, "worst_deg": self.worst_deg,
            "magnitude_held_percent": magnitude, "phase_held_percent": phase,
        })
    }

    /// The difference in a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let [magnitude, phase] = self.held_percent();
        format!(
            "beside the model: at most {:.2} dB and {:.2} degrees where coherence is above {GOOD} ({} lines); intervals hold it at \
             {magnitude:.1} % (magnitude) and {phase:.1} % (phase) of lines",
            self.worst_db, self.worst_deg, self.good
        )
    }
}
