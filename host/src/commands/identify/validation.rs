//! Predictions of recordings that were not fitted.

use socam_identify::{Identification, IdentifyError, Options, Problem, Validation};
use socam_model::Model;
use socam_recording::{Dataset, RecordingError};

use super::args::{Args, Method};
use crate::band::BandFits;

/// Fit of a recording that was not fitted, and within the band of `--band`.
pub(super) struct HeldOut {
    pub(super) own: Validation,
    pub(super) band: Option<BandFits>,
}

pub(super) fn bind<'a>(
    model: &'a Model,
    datasets: &'a [Dataset],
    options: &Options,
) -> anyhow::Result<Problem<'a>> {
    Problem::new(model, datasets, options.clone()).map_err(|error| named(model, error))
}

/// The error, with the remedy where the model needs a channel that a recording lacks.
fn named(model: &Model, error: IdentifyError) -> anyhow::Error {
    match error {
        IdentifyError::Recording(error @ RecordingError::NoSuchChannel { .. }) => anyhow::anyhow!(
            "{error}; the model {} needs it (another model is chosen with --model)",
            model.name
        ),
        error => error.into(),
    }
}

pub(super) fn validate(
    args: &Args,
    model: &Model,
    datasets: &[Dataset],
    result: &Identification,
    options: &Options,
) -> anyhow::Result<Vec<HeldOut>> {
    datasets
        .iter()
        .map(|dataset| {
            let own = result.validate(model, dataset, options).map_err(|error| named(model, error))?;
            let within = |band| -> anyhow::Result<BandFits> {
                let problem = bind(model, std::slice::from_ref(dataset), options)?;
                let channels = socam_identify::evaluate_band(&problem, &result.point, band)?;
                Ok(BandFits { band, channels })
            };
            Ok(HeldOut { own, band: args.band.map(within).transpose()? })
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
