//! Settings of the estimate of frequency responses.

/// Settings of the estimate of frequency responses.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    /// Column of the reference signal, which is free of noise; `command_V` where it is not given and all recordings have that.
    pub reference: Option<String>,
    /// Lowest and highest frequency, Hz; 0.1 to 100, or to a third of the sampling rate if that is lower.
    pub band_hz: Option<[f64; 2]>,
    /// Period of the excitation, s; estimated where it is not given.
    pub period_s: Option<f64>,
    /// Standard deviations from the median of its neighbours beyond which a sample is replaced by that.
    pub outliers: Option<f64>,
    /// Corner in Hz and order of a Butterworth filter on all signals.
    pub low_pass: Option<(f64, usize)>,
    /// Whether of recordings with the same mean input only the one with least noise is used.
    pub quietest: bool,
}
