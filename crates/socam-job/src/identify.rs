//! Parameters of a model with intervals, from recordings.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use socam_calibrate::sensors::with_sensor_gains;
use socam_frequency::rational::Orders;
use socam_identify::{
    Band, Budget, Document, ForceError, Identification, IdentifyError, Noise, NoiseLevels, Options, Problem,
    ProgressMonitor, Validation,
};
use socam_model::Model;
use socam_recording::{Dataset, RecordingError};

use crate::error::{JobError, Result};
use crate::inputs;
use crate::model::ModelSettings;
use crate::notation;
use crate::options::Settings;
use crate::response::Signals;
use crate::rules::Start;

/// Estimation method
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Method {
    /// Least squares of the residuals of the outputs, simulated from the measured input
    OutputError,
    /// Linear regression of the measured force of a one-coordinate axis on its measured motion
    InverseDynamics,
    /// The frequency response with coherence, confidence and distortion; no parameters
    Frf,
    /// A transfer function fitted to recordings, or to a response that frf wrote
    Etf,
    /// The thesis' method: the bench's parameters matched to the coefficients of a transfer function; also a direct fit
    CoefficientMatch,
}

impl Method {
    /// Whether it fits the model's parameters to signals over time.
    #[must_use]
    pub fn is_over_time(self) -> bool {
        matches!(self, Self::OutputError | Self::InverseDynamics)
    }
}

/// Settings of an identification
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Identify {
    /// The model.
    #[command(flatten)]
    #[serde(flatten)]
    pub model: ModelSettings,
    /// Estimation method
    #[arg(long, value_enum, default_value = "output-error")]
    #[serde(with = "notation::choice")]
    pub method: Method,
    /// Frequency band, Hz: report the fit of validation recordings within it; for frequency-domain methods, use only this band
    #[arg(long, value_name = "LOW..HIGH", value_parser = notation::band::read)]
    #[serde(with = "notation::band")]
    pub band: Option<Band>,
    /// Start state of each recording
    #[arg(long, value_enum, default_value = "free")]
    #[serde(with = "notation::choice")]
    pub start: Start,
    /// Known standard deviation of a channel's noise (SI); may be repeated. With a level for every output, inputs without one are exact; otherwise the other levels are estimated
    #[arg(long, value_name = "CHANNEL=STD")]
    #[serde(deserialize_with = "notation::texts")]
    pub noise: Vec<String>,
    /// Number of start points of the search
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub starts: u16,
    /// Seed of the random start points
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Time within which the fit shall end, as in 60s or 10min (0: no end). The best point by then is the result, marked as unfinished; methods
    /// over frequency are short and have no such end
    #[arg(long = "budget", value_name = "TIME", default_value = "300", value_parser = notation::budget, allow_hyphen_values = true)]
    pub budget_s: f64,
    /// Calibration file with the sensors' uncertainty, which widens the intervals [default: that in the recordings]
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
    /// Signals of the methods over frequency.
    #[command(flatten)]
    #[serde(flatten)]
    pub signals: Signals,
    /// Orders of the transfer function, NUMERATOR/DENOMINATOR [default: least description length; for coefficient-match those of the model]
    #[arg(long, value_name = "B/A", value_parser = notation::orders::read, help_heading = "Options of frf, etf and coefficient-match")]
    #[serde(with = "notation::orders")]
    pub orders: Option<Orders>,
    /// Fit only transfer functions with stable poles
    #[arg(long, help_heading = "Options of frf, etf and coefficient-match")]
    pub stable: bool,
}

impl Settings for Identify {
    const COMMAND: &'static [&'static str] = &["identify"];

    fn validate(&self) -> Result<()> {
        if !self.method.is_over_time() {
            let unused = [
                ("noise", "--noise", !self.noise.is_empty()),
                ("between", "--between", !self.model.between.is_empty()),
            ];
            if let Some((keyword, flag, _)) = unused.iter().find(|(.., given)| *given) {
                return Err(JobError::value(keyword, flag, NOT_OVER_FREQUENCY));
            }
        }
        Ok(())
    }
}

/// Share of the budget that belongs to the search. Intervals and the prediction of held-out recordings take the rest.
const SEARCH_SHARE: f64 = 0.9;

/// Message about an option that only methods over time use.
pub const NOT_OVER_FREQUENCY: &str =
    " belongs to the method output-error; a method over frequency does not use it";

/// The result of an identification.
#[derive(Debug)]
pub struct Identified {
    /// The estimates.
    pub result: socam_identify::Identification,
    /// Errors of the force in the fitted recordings of a one-coordinate axis.
    pub training: Vec<ForceError>,
    /// The fit of each validation recording.
    pub validation: Vec<Validation>,
    /// The model without the gains of its sensors, which belong to the calibration.
    model: Model,
}

impl Identified {
    /// The document `socam.identification/1`.
    #[must_use]
    pub fn document(&self) -> Document<'_> {
        Document { result: &self.result, training: &self.training, validation: &self.validation }
    }

    /// The text of the model file with the identified values.
    ///
    /// # Errors
    /// When the model's text does not hold its parameters.
    pub fn model_text(&self) -> Result<String> {
        Ok(self.result.model_text(&self.model)?)
    }
}

/// A model with the gains of its calibrated sensors.
#[derive(Debug, Clone)]
pub struct Calibrated {
    /// The model with gains.
    pub model: Model,
    /// The model without gains.
    pub plain: Model,
    /// Calibrations that were not used, and why.
    pub warnings: Vec<String>,
}

impl Identify {
    /// The model with the gains of sensors whose calibration is given or stored in the recordings; only output-error fits have these.
    ///
    /// # Errors
    /// When the calibration cannot be read, or does not suit the model.
    pub fn calibrated<'p>(
        &self,
        plain: Model,
        recordings: impl IntoIterator<Item = &'p Path>,
    ) -> Result<Calibrated> {
        let (calibration, warnings) = inputs::calibration(recordings, self.calibration.as_deref())?;
        let model = match calibration.filter(|_| self.method == Method::OutputError) {
            Some(calibration) => with_sensor_gains(&plain, &calibration)?,
            None => plain.clone(),
        };
        Ok(Calibrated { model: self.with_stated_noise(model)?, plain, warnings })
    }

    /// Fits the model to recordings on the grid [`Fit`](crate::Grid::Fit), and predicts those that are held out.
    ///
    /// # Errors
    /// When recordings and model do not go together, or the caller cancels.
    pub fn run(
        &self,
        calibrated: &Calibrated,
        training: &[Dataset],
        held_out: &[Dataset],
        progress: ProgressMonitor,
    ) -> Result<Identified> {
        let Calibrated { model, plain, .. } = calibrated;
        let progress = progress.within(Budget::seconds(self.budget_s, SEARCH_SHARE));
        let options = Options { progress, ..self.options(model)? };
        let in_words = |error| in_words(model, error);
        if let Some(band) = self.band {
            let checked = held_out.iter().try_for_each(|dataset| band.check(dataset));
            checked.map_err(|error| JobError::value("band", "--band", format!(": {error}")))?;
        }
        let result = match self.method {
            Method::InverseDynamics => socam_identify::inverse_dynamics(model, training)?,
            Method::Frf | Method::Etf | Method::CoefficientMatch => {
                let problem = ": only output-error and inverse-dynamics fit the model's parameters to signals over time";
                return Err(JobError::value("method", "--method", problem));
            }
            Method::OutputError => fitted(model, training, &options)?,
        };
        // The remaining work is short, and is done even after an interrupted search.
        let options = Options { progress: ProgressMonitor::default(), ..options };
        let validation = socam_identify::validate(model, held_out, &result, &options, self.band);
        let validation = validation.map_err(in_words)?;
        let training = socam_identify::force_errors(model, training, &result)?;
        Ok(Identified { result, training, validation, model: plain.clone() })
    }

    /// The settings in the form of the library.
    ///
    /// # Errors
    /// When a noise level is not a number, or its channel is unknown.
    pub fn options(&self, model: &Model) -> Result<Options> {
        Ok(Options {
            noise: self.noise_levels(model)?,
            start_state: self.start.state(),
            try_other_intersamples: true,
            starts: self.starts.into(),
            seed: self.seed,
            ..Options::default()
        })
    }

    /// The stated levels, where every output has one; otherwise they are the channels' own ([`Identify::calibrated`]), and the rest is estimated.
    fn noise_levels(&self, model: &Model) -> Result<Noise> {
        let stated = self.stated_noise()?;
        let open = model.outputs().filter(|output| !stated.iter().any(|(name, _)| *name == output.name));
        let open: Vec<(String, f64)> = open.map(|output| (output.name.clone(), 1.0)).collect();
        let levels = NoiseLevels::by_name(model, &[&stated[..], &open[..]].concat());
        let levels = levels.map_err(|error| JobError::value("noise", "--noise", format!(": {error}")))?;
        Ok(if open.is_empty() && !stated.is_empty() { Noise::Given(levels) } else { Noise::Estimated })
    }

    /// The stated levels by channel name.
    fn stated_noise(&self) -> Result<Vec<(String, f64)>> {
        let level = |text: &String| {
            let level =
                text.split_once('=').and_then(|(name, std)| Some((name.to_owned(), std.parse().ok()?)));
            level.ok_or_else(|| JobError::value("noise", "--noise", format!(" {text}: expected CHANNEL=STD")))
        };
        self.noise.iter().map(level).collect()
    }

    /// The model with the stated noise of its channels.
    fn with_stated_noise(&self, mut model: Model) -> Result<Model> {
        self.noise_levels(&model)?;
        for (name, std) in self.stated_noise()? {
            let own = model.channels.iter_mut().filter(|channel| channel.name == name);
            own.for_each(|channel| channel.noise_std = Some(std));
        }
        Ok(model)
    }
}

/// The fit of a model to recordings by output error. Where it misses them by more than noise, its intervals allow for effects that the model
/// may leave out.
///
/// # Errors
/// When recordings and model do not go together, or the caller cancels.
pub fn fitted(model: &Model, recordings: &[Dataset], options: &Options) -> Result<Identification> {
    let problem = Problem::new(model, recordings, options.clone()).map_err(|error| in_words(model, error))?;
    let mut found = socam_identify::output_error(&problem)?;
    if !found.end.is_cut_off() {
        let suspected = socam_diagnose::suspects(model, recordings, &found, options)?;
        // What was tested before a search was ended says nothing of the rest.
        if !options.progress.stops() {
            found.allow_for(model, suspected);
        }
    }
    Ok(found)
}

/// The error, with a remedy if the recording belongs to another model.
fn in_words(model: &Model, error: IdentifyError) -> JobError {
    match error {
        IdentifyError::Recording(error @ RecordingError::NoSuchChannel { .. }) => JobError::OtherModel {
            problem: format!("{error}; the model {} needs it: choose the model of this bench", model.name),
        },
        error => error.into(),
    }
}
