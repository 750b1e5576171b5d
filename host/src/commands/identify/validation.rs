//! Predictions of recordings that were not fitted.

use socam_identify::{Fit, Identification, IdentifyError, Options, Problem};
use socam_model::Model;
use socam_recording::{Dataset, RecordingError};

use super::args::{Args, Method};
use crate::band::BandFits;

/// Fit of a recording that was not fitted.
pub(super) struct Validation {
    pub(super) recording: String,
    pub(super) fit: Fit,
    pub(super) band: Option<BandFits>,
    pub(super) force_error_percent: Option<f64>,
}

pub(super) fn bind<'a>(
    model: &'a Model,
    datasets: &'a [Dataset],
    options: &Options,
) -> anyhow::Result<Problem<'a>> {
    Problem::new(model, datasets, options.clone()).map_err(|error| match error {
        IdentifyError::Recording(error @ RecordingError::NoSuchChannel { .. }) => anyhow::anyhow!(
            "{error}; the model {} needs it (another model is chosen with --model)",
            model.name
        ),
        error => error.into(),
    })
}

pub(super) fn validate(
    args: &Args,
    model: &Model,
    datasets: &[Dataset],
    result: &Identification,
    options: &Options,
) -> anyhow::Result<Vec<Validation>> {
    datasets
        .iter()
        .map(|dataset| {
            let recording = dataset.name().to_owned();
            let problem = bind(model, std::slice::from_ref(dataset), options)?;
            let fit = socam_identify::evaluate(&problem, &result.point)?;
            let within = |band| {
                let channels = socam_identify::evaluate_band(&problem, &result.point, band)?;
                Ok::<_, IdentifyError>(BandFits { band, channels })
            };
            let band = args.band.map(within).transpose()?;
            let force_error_percent = match args.method {
                Method::InverseDynamics => {
                    Some(socam_identify::force_error_percent(model, &result.point, dataset)?)
                }
                _ => None,
            };
            Ok(Validation { recording, fit, band, force_error_percent })
        })
        .collect()
}

/// Recordings that were fitted by inverse dynamics, and their force error, per cent of the norm of the force.
pub(super) fn force_errors(
    args: &Args,
    model: &Model,
    datasets: &[Dataset],
    result: &Identification,
) -> anyhow::Result<Vec<(String, f64)>> {
    if args.method != Method::InverseDynamics {
        return Ok(Vec::new());
    }
    let each = datasets.iter().map(|dataset| {
        let error = socam_identify::force_error_percent(model, &result.point, dataset)?;
        Ok((dataset.name().to_owned(), error))
    });
    each.collect()
}
