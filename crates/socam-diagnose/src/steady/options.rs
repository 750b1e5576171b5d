//! Settings of a diagnosis of steady states.

/// False alarm rate, and assumptions about the operating points.
#[derive(Debug, Clone, Copy)]
pub struct SteadyOptions {
    /// Share of benches with nothing missing for which the diagnosis may report an effect, 1.
    pub false_alarm_rate: f64,
    /// Relative standard uncertainty of a mean reading, 1.
    pub repeatability: f64,
}

impl Default for SteadyOptions {
    /// A repeatability of 0.2 %: ratios of speeds and of torques in the thesis' coupling tests, which have no losses, scatter by 0.2 %, and
    /// a single reading therefore by 0.14 %.
    fn default() -> Self {
        Self { false_alarm_rate: 0.01, repeatability: 2e-3 }
    }
}
