//! How far an estimate over frequency is from the model's own response.

use serde_json::{Value, json};
use socam_frequency::Complex;

/// Lines of more coherence than this make a good estimate.
const GOOD: f64 = 0.9;

/// Of all lines.
#[derive(Default)]
pub(super) struct Beside {
    lines: usize,
    /// Lines of good coherence.
    good: usize,
    /// Greatest difference among these, dB.
    worst_db: f64,
    /// The same of the phase, degrees.
    worst_deg: f64,
    /// Lines whose intervals of magnitude and phase hold the model's.
    held: [usize; 2],
}

impl Beside {
    /// One more line: the estimate over the model's response there, and whether the intervals of magnitude and phase hold the model's.
    pub(super) fn add(&mut self, ratio: Complex<f64>, coherence: f64, holds: [bool; 2]) {
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
    pub(super) fn json(&self) -> Value {
        let [magnitude, phase] = self.held_percent();
        json!({
            "lines": self.lines, "lines_of_good_coherence": self.good,
            "worst_db": self.worst_db, "worst_deg": self.worst_deg,
            "magnitude_held_percent": magnitude, "phase_held_percent": phase,
        })
    }

    pub(super) fn sentence(&self) -> String {
        let [magnitude, phase] = self.held_percent();
        format!(
            "beside the model: at most {:.2} dB and {:.2} degrees where coherence is above {GOOD} ({} lines); intervals hold it at \
             {magnitude:.1} % (magnitude) and {phase:.1} % (phase) of lines",
            self.worst_db, self.worst_deg, self.good
        )
    }
}
