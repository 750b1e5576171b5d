//! Residuals for the report's pictures; they are not part of the JSON document.
//!
//! All quantities are SI. A residual is measured minus free-run prediction; a missing value is NaN and leaves a gap in the picture.
//! "Before" is the base model at its best fit, "after" the corrected one.

/// Residuals of all recordings over time, and their means over other quantities.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Evidence {
    /// One per recording, training and held-out ones, in the order given.
    pub recordings: Vec<RecordingTraces>,
    /// One per output channel, in the order of the model, all recordings together.
    pub channels: Vec<ChannelEvidence>,
}

/// Residuals of one recording over time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RecordingTraces {
    /// The recording's name.
    pub name: String,
    /// Whether it was never fitted, only predicted.
    pub held_out: bool,
    /// One per output channel, in the order of the model; a channel that the recording lacks is left out.
    pub channels: Vec<Trace>,
}

/// Residual of one channel in one recording. Samples may be thinned out beforehand if extremes are kept; the report thins them out to its
/// picture's resolution in any case.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    /// The channel's name, as in [`ChannelEvidence::name`].
    pub channel: String,
    /// Time from the start of the recording, s, rising.
    pub time_s: Vec<f64>,
    /// Residual of the base model at each `time_s`, in the channel's SI unit.
    pub before: Vec<f64>,
    /// Residual of the model with all findings at each `time_s`, in the channel's SI unit; empty where nothing was corrected.
    pub after: Vec<f64>,
}

/// One output channel over all recordings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ChannelEvidence {
    /// The channel's name.
    pub name: String,
    /// Its SI unit.
    pub unit: String,
    /// Noise floor: standard deviation of the residual of a perfect model, in `unit`, including the effect of a noisy input.
    pub noise_std: f64,
    /// Mean residual over the speed at the channel's place, rad/s.
    pub over_speed: Option<Binned>,
    /// Mean residual over the angle at the channel's place within one turn, rad.
    pub over_angle: Option<Binned>,
    /// Mean residual over the torque at the channel's place, N m.
    pub over_torque: Option<Binned>,
    /// The residual's spectrum.
    pub spectrum: Option<Spectrum>,
}

/// Mean residuals in bins of another quantity, with standard errors.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Binned {
    /// Bin centres, SI, rising.
    pub x: Vec<f64>,
    /// Mean residual of the base model in each bin, in the channel's SI unit; NaN where a bin is empty.
    pub before: Vec<f64>,
    /// Standard error of each `before`.
    pub before_std: Vec<f64>,
    /// Mean residual of the model with all findings; empty where nothing was corrected.
    pub after: Vec<f64>,
    /// Standard error of each `after`.
    pub after_std: Vec<f64>,
}

/// Amplitude spectral densities: the square roots of one-sided power densities.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spectrum {
    /// Frequencies, Hz, rising; zero is left out of pictures with a logarithmic axis.
    pub frequency_hz: Vec<f64>,
    /// Base model, channel's unit per square root of Hz.
    pub before: Vec<f64>,
    /// Corrected model; empty where nothing was corrected.
    pub after: Vec<f64>,
    /// Spectrum of the residual of a perfect model, including the noise of the input.
    pub noise: Vec<f64>,
}
