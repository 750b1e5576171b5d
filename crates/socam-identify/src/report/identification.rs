//! The result of an identification, and its JSON form.

use serde::Serialize;

use crate::{
    between::Between, optimiser::descent::End, preprocessing::mask::LeftOut,
    uncertainty::covariance::Uncertainty,
};

/// Version of [`Identification`]'s JSON form.
pub const SCHEMA: &str = "socam.identification/1";

/// Source of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The recordings.
    Data,
    /// Mostly the prior.
    Prior,
    /// The parameter was not estimated.
    Fixed,
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Name.
    pub name: String,
    /// SI; `None` where the data do not determine it.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// Standard deviation.
    pub std: Option<f64>,
    /// 95 % interval; an open end is `None`.
    pub ci95: [Option<f64>; 2],
    /// Whether the data determine it: the interval lies inside the bounds and is at most half the value to
    /// either side.
    pub identifiable: bool,
    /// Source of the value.
    pub source: Source,
    /// Parameters that cannot be distinguished from this one.
    pub determined_with: Vec<String>,
    /// Reason why the parameter is not determined, or another remark.
    pub note: String,
}

/// A combination of parameters that the data determine better than the parameters themselves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CombinationEstimate {
    /// Name.
    pub name: String,
    /// Formula in terms of parameters.
    pub expression: String,
    /// SI; `None` where not even this is determined.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: String,
    /// Standard deviation.
    pub std: Option<f64>,
    /// 95 % interval.
    pub ci95: [Option<f64>; 2],
}

/// Error of a free run for one channel, over all recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelFit {
    /// Root mean square of the residual, SI.
    pub rms: f64,
    /// Level by which the residuals were weighted, SI: the sensor's noise, or the misfit where the model leaves more.
    pub noise_std: f64,
    /// Noise of the sensor, SI: stated, or from the fastest content of the channel; `None` where that is filtered, or was not looked at.
    pub sensor_noise_std: Option<f64>,
    /// 100 rms / standard deviation of the measured channel.
    pub nrmse_percent: f64,
    /// 100 - `nrmse_percent`.
    pub fit_percent: f64,
    /// Variance accounted for, per cent.
    pub vaf_percent: f64,
    /// 100 norm(residual) / norm(measured).
    pub relative_error_percent: f64,
}

/// Fit of all channels, in the model's order.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// Fit by channel name.
    #[serde(serialize_with = "as_map")]
    pub channels: Vec<(String, ChannelFit)>,
}

pub(crate) fn as_map<T: Serialize, S: serde::Serializer>(
    channels: &[(String, T)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(channels.iter().map(|(name, value)| (name, value)))
}

/// Whether a model explains recordings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Explained {
    /// No output is left by more than its sensor's noise.
    #[serde(rename = "explained")]
    Yes,
    /// Most of each output, but at least one is left by several times its noise: intervals hold scatter, not what the model lacks.
    #[serde(rename = "explained_to")]
    InPart,
    /// An output is left by many times its noise and a fifth of its standard deviation.
    #[serde(rename = "not_explained")]
    No,
    /// No output has a noise level to compare with: all are filtered.
    NotJudged,
}

/// The verdict on a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Whether the model explains the recordings.
    pub explained: Explained,
    /// The output that is left furthest beyond its noise; `None` where nothing was judged.
    pub channel: Option<String>,
    /// Its residual in units of its noise, root mean squares.
    pub times_noise: Option<f64>,
    /// Its noise, SI: stated, or from its fastest content.
    pub noise_std: Option<f64>,
    /// Its unit, SI.
    pub unit: Option<&'static str>,
    /// Whether noise of the inputs is counted apart: the residual is then that of a prediction from sample to sample.
    pub beside_input_noise: bool,
    /// The recording in which that output is left most.
    pub recording: Option<String>,
}

/// How a parameter would move if a suspected effect were in the model, SI. In JSON the pair of values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// The fitted value.
    pub from: f64,
    /// The value with the effect.
    pub to: f64,
    /// Standard deviation of the difference.
    pub std: f64,
}

impl Serialize for Move {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.from, self.to].serialize(serializer)
    }
}

/// An effect that a model may leave out, with what it would explain and change. Sizes are linearised at the fit: where they are large, they
/// show a direction, and only a fit with the effect in the model shows the size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suspect {
    /// Id of the effect.
    pub effect: String,
    /// Its name in words.
    pub name: String,
    /// Place, or channel.
    pub location: String,
    /// Share of the squares left by the fit that it would explain, 0 to 1.
    pub explains: f64,
    /// The free parameters, in the model's order.
    #[serde(serialize_with = "as_map")]
    pub moves: Vec<(String, Move)>,
}

/// Result of an identification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identification {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Method id.
    pub method: &'static str,
    /// Model name.
    pub model: String,
    /// Recordings used.
    pub recordings: Vec<String>,
    /// Whether the estimate is a minimum.
    pub converged: bool,
    /// Reason for which the fit ended.
    pub end: End,
    /// Whether the search came to its own end. Otherwise values and intervals are those of the best point so far.
    pub finished: bool,
    /// When and by what the search was ended before its own end, and what was not tried, as a sentence without a full stop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unfinished: Option<String>,
    /// Iterations of the last descents.
    pub iterations: usize,
    /// Processor time of the fit without reading files, s, all threads.
    pub cpu_s: f64,
    /// All parameters of the model, in its order.
    pub parameters: Vec<ParameterEstimate>,
    /// Covariance of the estimates, for functions of them; `None` for inverse dynamics.
    #[serde(skip)]
    pub joint: Option<Uncertainty>,
    /// Combinations.
    pub combinations: Vec<CombinationEstimate>,
    /// Sensor offsets, one per channel and uninterrupted segment.
    pub nuisance: Vec<ParameterEstimate>,
    /// Fit of the model to the recordings.
    pub fit: Fit,
    /// Whether the model explains the recordings; `None` for inverse dynamics.
    pub fit_verdict: Option<Explained>,
    /// Residual of each output in units of its sensor's noise, where that is known.
    #[serde(serialize_with = "as_map")]
    pub misfit: Vec<(String, f64)>,
    /// What the verdict rests on.
    #[serde(skip)]
    pub verdict: Option<Verdict>,
    /// Effects that the model may leave out, the one that would explain most first; empty where the model explains the recordings, or no
    /// effect was tried.
    pub suspects: Vec<Suspect>,
    /// Noise levels of the inputs that were used, SI, by channel name; zero where an input was taken as exact; empty for inverse
    /// dynamics.
    #[serde(serialize_with = "as_map")]
    pub input_noise_std: Vec<(String, f64)>,
    /// Behaviour of the inputs between their samples, by channel name; empty for inverse dynamics.
    #[serde(serialize_with = "as_map")]
    pub between: Vec<(String, Between)>,
    /// Samples that were not used as measured.
    pub left_out: Vec<LeftOut>,
    /// Advice for quantities that are not determined: sensors and experiments that would determine them.
    pub advice: Vec<String>,
    /// Warnings about the result.
    pub warnings: Vec<String>,
    /// Point values of all parameters, SI, determined or not: they reproduce `fit` and are written into models.
    #[serde(skip)]
    pub point: Vec<f64>,
    /// Sum of squared residuals in noise units, halved.
    pub cost: f64,
}
