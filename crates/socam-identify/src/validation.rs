//! Validation of a result on recordings that were not fitted, and the JSON document of both.

use serde::{Serialize, Serializer};
use socam_model::Model;
use socam_recording::Dataset;

use crate::{
    Band, BandFit, Fit, Identification, IdentifyError, Options, Problem, evaluate, evaluate_band,
    inverse_dynamics::{METHOD, force_error_percent},
};

/// Prediction errors of a result for a recording that was not fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Validation {
    /// Name of the recording.
    pub recording: String,
    /// Fit of a free run whose start states are fitted to this recording.
    pub fit: Fit,
    /// Error of the force in inverse dynamics, per cent of the norm of the force; `None` for other methods.
    pub force_error_percent: Option<f64>,
    /// The fit within a band of frequencies, if one was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band: Option<BandFits>,
}

/// Fits within a band, by output; `None` where nothing was measured within it.
#[derive(Debug, Clone, PartialEq)]
pub struct BandFits {
    /// The band.
    pub band: Band,
    /// Fit within the band by channel name, in the order of the model.
    pub channels: Vec<(String, Option<BandFit>)>,
}

impl Serialize for BandFits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Fields<'a> {
            low_hz: f64,
            high_hz: f64,
            #[serde(serialize_with = "crate::report::as_map")]
            channels: &'a [(String, Option<BandFit>)],
        }
        let (low_hz, high_hz) = (self.band.low_hz(), self.band.high_hz());
        Fields { low_hz, high_hz, channels: &self.channels }.serialize(serializer)
    }
}

/// Error of the force of a recording that inverse dynamics fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceError {
    /// Name of the recording.
    pub recording: String,
    /// Error of the force, per cent of its norm.
    pub force_error_percent: f64,
}

/// A result with its validation: the document that `identify --json` prints.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Document<'a> {
    /// The result.
    #[serde(flatten)]
    pub result: &'a Identification,
    /// Force errors of the recordings that inverse dynamics fitted; empty for other methods.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub training: &'a [ForceError],
    /// Recordings that were not fitted.
    pub validation: &'a [Validation],
}

/// Predicts recordings that were not fitted with a result for `model`, each from its own start states.
///
/// ```
/// use socam_identify::{Options, Problem, output_error, validate};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let options = Options { starts: 1, ..Options::default() };
/// let result = output_error(&Problem::new(&model, &recordings, options.clone())?)?;
/// let held_out = validate(&model, &recordings, &result, &options, None)?;
/// assert!(held_out[0].fit.channels[0].1.fit_percent > 90.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read, lacks a channel or does not show the band.
pub fn validate(
    model: &Model,
    datasets: &[Dataset],
    result: &Identification,
    options: &Options,
    band: Option<Band>,
) -> Result<Vec<Validation>, IdentifyError> {
    let mut settled = model.clone();
    result.state_between(&mut settled)?;
    let one = |dataset: &Dataset| {
        let problem = Problem::new(&settled, std::slice::from_ref(dataset), options.clone())?;
        let fit = evaluate(&problem, &result.point)?;
        let within = |band| {
            let channels = evaluate_band(&problem, &result.point, band)?;
            Ok::<_, IdentifyError>(BandFits { band, channels })
        };
        let band = band.map(within).transpose()?;
        let error = force_errors(model, std::slice::from_ref(dataset), result)?;
        let force_error_percent = error.first().map(|error| error.force_error_percent);
        Ok(Validation { recording: dataset.name().to_owned(), fit, force_error_percent, band })
    };
    datasets.iter().map(one).collect()
}

/// Errors of the force of each recording by a result of inverse dynamics; none for other methods.
///
/// # Errors
/// The errors of [`force_error_percent`].
pub fn force_errors(
    model: &Model,
    datasets: &[Dataset],
    result: &Identification,
) -> Result<Vec<ForceError>, IdentifyError> {
    if result.method != METHOD {
        return Ok(Vec::new());
    }
    let one = |dataset: &Dataset| {
        let force_error_percent = force_error_percent(model, &result.point, dataset)?;
        Ok(ForceError { recording: dataset.name().to_owned(), force_error_percent })
    };
    datasets.iter().map(one).collect()
}
