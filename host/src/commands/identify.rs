//! `identify`: recordings and a model in, parameters with intervals out.

mod args;
#[cfg(feature = "thesis")]
mod coefficient_match;
#[cfg(feature = "exchange")]
mod etf;
#[cfg(feature = "exchange")]
mod files;
mod frf;
mod noise;
mod options;
mod result;
mod validation;

use std::io::Write;

use socam_identify::Document;
use socam_model::Model;
use socam_recording::{Dataset, OutputFile};

use super::Outcome;
#[cfg(not(all(feature = "exchange", feature = "thesis")))]
use super::not_built;
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use crate::{band, calibrated, model_file, watch};
use args::Method;
pub(crate) use args::{Args, Start};
use noise::options;
use result::report;
use validation::{bind, in_words};

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let mut model = model_file::load(&args.model)?;
    model_file::set(&mut model, &args.set, false)?;
    model_file::set(&mut model, &args.fix, true)?;
    model_file::set_between(&mut model, &args.between)?;
    let uncalibrated = model.clone();
    if let Some(calibration) = calibrated::of(&args.runs, args.calibration.as_deref())?
        && args.method == Method::OutputError
    {
        model = socam_calibrate::sensors::with_sensor_gains(&model, &calibration)?;
    }
    refuse_unused(&args)?;
    match args.method {
        Method::Frf => return frf::run(&args, &model),
        #[cfg(feature = "exchange")]
        Method::Etf => return etf::run(&args, &model),
        #[cfg(not(feature = "exchange"))]
        Method::Etf => return Err(not_built("`--method etf`", "exchange")),
        #[cfg(feature = "thesis")]
        Method::CoefficientMatch => return coefficient_match::run(&args, &model),
        #[cfg(not(feature = "thesis"))]
        Method::CoefficientMatch => return Err(not_built("`--method coefficient-match`", "thesis")),
        Method::OutputError | Method::InverseDynamics => {}
    }
    if args.band.is_some() && args.validate.is_empty() {
        let message = "--band needs --validate RUN with this method: it is the held-out fit that it bounds";
        return Err(WrongArguments(message.into()).into());
    }
    let mut options = options(&args, &model)?;
    let interrupt = Interrupt::listen();
    // The output file is created before the fit, so that an error is reported before it.
    let target = args.write_model.as_deref().map(|path| output::create_new(path, args.force)).transpose()?;
    interrupt.unfinished(target.as_ref().and_then(OutputFile::temporary));
    if let Some(twice) = args.runs.iter().enumerate().find(|(i, run)| args.runs[..*i].contains(run)) {
        let message = format!("`{}` is named twice; its samples would count double", twice.1);
        return Err(WrongArguments(message).into());
    }
    let datasets = open_all(&args.runs, &model)?;
    let held_out = open_all(&args.validate, &model)?;
    args.band.map_or(Ok(()), |band| band::check(band, &held_out))?;
    let result = match args.method {
        Method::OutputError => watch::fit(&interrupt, args.progress, &mut options, |options| {
            socam_identify::output_error(&bind(&model, &datasets, options)?).map_err(anyhow::Error::from)
        })?,
        _ => socam_identify::inverse_dynamics(&model, &datasets)?,
    };
    let validation = socam_identify::validate(&model, &held_out, &result, &options, args.band)
        .map_err(|error| in_words(&model, error))?;
    let training = socam_identify::force_errors(&model, &datasets, &result)?;
    let document = Document { result: &result, training: &training, validation: &validation };
    if let Some(mut target) = target {
        // The written model has no sensor gains, which belong to the calibration.
        target.write_all(result.model_text(&uncalibrated)?.as_bytes())?;
        target.commit()?;
        interrupt.unfinished(None);
    }
    if args.json {
        output::print_json(&document)?;
    } else {
        result.warnings.iter().for_each(output::warn);
        output::print(&report(document))?;
    }
    Ok(Outcome::on(datasets.iter().chain(&held_out)))
}

/// Refuses options that the method does not use.
fn refuse_unused(args: &Args) -> Result<(), WrongArguments> {
    if matches!(args.method, Method::OutputError | Method::InverseDynamics) {
        return match args.frequency.report {
            Some(_) => Err(WrongArguments(
                "--report belongs to the methods over frequency (frf, etf, coefficient-match); this method's results are written by --json and --write-model, and `diagnose --report` draws measured against predicted"
                    .into(),
            )),
            None => Ok(()),
        };
    }
    let unused = [
        ("--validate", !args.validate.is_empty()),
        ("--write-model", args.write_model.is_some()),
        ("--noise", !args.noise.is_empty()),
        ("--between", !args.between.is_empty()),
    ];
    match unused.iter().find(|(_, given)| *given) {
        Some((option, _)) => Err(WrongArguments(format!(
            "{option} belongs to --method output-error; a method over frequency does not use it"
        ))),
        None => Ok(()),
    }
}

fn open_all(runs: &[String], model: &Model) -> anyhow::Result<Vec<Dataset>> {
    runs.iter().map(|run| output::open_for(run, model, socam_expectation::GRID_PARTS)).collect()
}
