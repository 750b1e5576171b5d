//! The frequency response of a model's outputs, from recordings.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use socam_identify::Band;
use socam_model::Model;
use socam_recording::Dataset;
use socam_response::{Answer, ResponseError};

use crate::error::{JobError, Result};
use crate::model::ModelSettings;
use crate::notation::{self, positive};
use crate::options::Settings;

/// Signals of the methods over frequency, and how they are cleaned
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[command(next_help_heading = "Options of frf, etf and coefficient-match")]
pub struct Signals {
    /// Output channel of the response; may be repeated [default: all, or the output speed for a transfer function]
    #[arg(long = "output", value_name = "CHANNEL")]
    #[serde(deserialize_with = "notation::texts")]
    pub outputs: Vec<String>,
    /// Column of the reference signal, which is free of noise [default: command_V, if the recordings have it]
    #[arg(long, value_name = "COLUMN")]
    pub reference: Option<String>,
    /// Period of the excitation, s [default: estimated]
    #[arg(long = "period", value_name = "SECONDS", value_parser = positive)]
    pub period_s: Option<f64>,
    /// Replace samples by the median of their neighbours if they differ by more than this number of standard deviations
    #[arg(long, value_name = "DEVIATIONS", value_parser = positive)]
    pub outliers: Option<f64>,
    /// Low-pass filter (Butterworth) on all signals: corner in Hz, and order [default order: 4]
    #[arg(long, value_name = "HZ[:ORDER]", value_parser = notation::low_pass::read)]
    #[serde(with = "notation::low_pass")]
    pub low_pass: Option<(f64, usize)>,
    /// Of recordings with the same mean input (within 5 %), use only the one with least noise
    #[arg(long)]
    pub quietest: bool,
}

impl Signals {
    /// As the library takes them.
    #[must_use]
    pub fn settings(&self, band: Option<Band>) -> socam_response::Settings {
        socam_response::Settings {
            reference: self.reference.clone(),
            band_hz: band.map(|band| [band.low_hz(), band.high_hz()]),
            period_s: self.period_s,
            outliers: self.outliers,
            low_pass: self.low_pass,
            quietest: self.quietest,
        }
    }

    /// Responses of the outputs of these names, or of all, from recordings on the grid [`View`](crate::Grid::View).
    ///
    /// # Errors
    /// When an output does not exist, a recording lacks a channel, or the signals are too short or not excited.
    pub fn estimate<'m>(
        &self,
        model: &'m Model,
        datasets: &[Dataset],
        outputs: &[String],
        band: Option<Band>,
    ) -> Result<Vec<Answer<'m>>> {
        let settings = self.settings(band);
        socam_response::estimate(model, datasets, outputs, &settings).map_err(|error| match &error {
            ResponseError::UnknownOutput { .. } => {
                let said = error.to_string();
                JobError::value("outputs", "--output", said.strip_prefix("output").unwrap_or(&said))
            }
            _ => match error {
                ResponseError::Recording(error) => error.into(),
                error => error.into(),
            },
        })
    }
}

/// Settings of a frequency response
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Response {
    /// The model.
    #[command(flatten)]
    #[serde(flatten)]
    pub model: ModelSettings,
    /// Frequency band, Hz
    #[arg(long, value_name = "LOW..HIGH", value_parser = notation::band::read)]
    #[serde(with = "notation::band")]
    pub band: Option<Band>,
    /// Signals, and how they are cleaned.
    #[command(flatten)]
    #[serde(flatten)]
    pub signals: Signals,
}

impl Settings for Response {
    const COMMAND: &'static [&'static str] = &["identify", "--method", "frf"];
}

/// Frequency responses.
#[derive(Debug)]
pub struct Responses<'m> {
    /// Of each output.
    pub answers: Vec<Answer<'m>>,
    /// The document `socam.frequency-response/1`.
    pub document: Value,
}

impl Response {
    /// Responses from recordings on the grid [`View`](crate::Grid::View).
    ///
    /// # Errors
    /// As [`Signals::estimate`].
    pub fn run<'m>(&self, model: &'m Model, datasets: &[Dataset], names: &[String]) -> Result<Responses<'m>> {
        let answers = self.signals.estimate(model, datasets, &self.signals.outputs, self.band)?;
        let document = socam_response::document(&model.name, names, &answers);
        Ok(Responses { answers, document })
    }
}
