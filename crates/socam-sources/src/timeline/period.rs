//! Whether a device samples evenly, and how often.

/// Steps from which the period is found.
const STEPS: usize = 40;
/// Largest deviation of a step from the period, as a share of it, that still counts as even.
const EVEN: f64 = 0.2;
/// Share of the steps that must be even.
const MOST: f64 = 0.9;

/// The period between rows.
#[derive(Debug, Default)]
pub(super) struct Period {
    steps: Vec<i64>,
    even_ns: Option<i64>,
}

impl Period {
    /// Takes a step of the device's clock.
    pub(super) fn take(&mut self, step_ns: i64) {
        if self.steps.len() >= STEPS {
            return;
        }
        self.steps.push(step_ns);
        if self.steps.len() == STEPS {
            let mut sorted = self.steps.clone();
            sorted.sort_unstable();
            let middle = sorted[STEPS / 2];
            let is_even = |step: &&i64| ((**step - middle) as f64).abs() < EVEN * middle as f64;
            let even: Vec<i64> = sorted.iter().filter(is_even).copied().collect();
            // The mean of the even steps: a clock in whole milliseconds has steps of 3 and 4 for 300 Hz.
            let mean = even.iter().sum::<i64>() / even.len().max(1) as i64;
            self.even_ns = (even.len() as f64 >= MOST * STEPS as f64 && mean > 0).then_some(mean);
        }
    }

    /// The period, if the device samples evenly.
    pub(super) fn even_ns(&self) -> Option<i64> {
        self.even_ns
    }
}
