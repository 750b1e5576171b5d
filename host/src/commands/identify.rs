//! `identify`: recordings and a model in, parameters with intervals out.

mod beside;
mod coefficient_match;
mod etf;
mod frf;
mod options;
mod pictures;
mod signals;

use std::io::Write;
use std::path::PathBuf;

use socam_identify::{
    Band, End, Fit, Identification, IdentifyError, Noise, NoiseLevels, Options, Problem, StartState,
};
use socam_model::{Model, Update};
use socam_recording::{Dataset, OutputFile, RecordingError};

use super::Outcome;
use crate::interrupt::Interrupt;
use crate::output::{self, WrongArguments};
use crate::{
    band::{self, BandFits},
    calibrated, model_file, table, watch,
};
use options::FrequencyArgs;

/// Identify stiffness, damping and friction from recordings
///
/// Fits the free parameters of the model to all recordings together and prints each with its 95 % interval. A
/// parameter that the recordings do not determine gets no number: the note says why, and combinations that are
/// determined are given instead. Ctrl-C ends the search at the best point so far, which is then reported; a second one ends at
/// once.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host identify RUN1.mcap RUN2.mcap
  socam-host identify RUN.mcap --fix k3=52485 --write-model bench.toml
  socam-host identify train.csv --model emps --method inverse-dynamics --validate test.csv
  socam-host identify RUN1.csv RUN2.csv --model bench.toml --validate RUN3.csv --band 2..80
  socam-host identify RUN.mcap --method frf --report response
  socam-host identify RUN.mcap --method etf --orders 3/6 --stable --report transfer
  socam-host identify transfer/transfer.json --method coefficient-match")]
pub(crate) struct Args {
    /// Recordings (.mcap, .csv, legacy .m), or parts of them: RUN@FROM..TO in seconds
    #[arg(value_name = "RUN", required = true)]
    runs: Vec<String>,
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = model_file::HELP)]
    model: String,
    /// How to estimate
    #[arg(long, value_enum, default_value = "output-error")]
    method: Method,
    /// Hold a parameter, at its value in the model or at the given one (SI); may be repeated
    #[arg(long, value_name = "NAME[=VALUE]")]
    fix: Vec<String>,
    /// Start a parameter's search from this value (SI); may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Recordings to predict with the result, not used in the fit; may be repeated
    #[arg(long, value_name = "RUN")]
    validate: Vec<String>,
    /// Say also how well they are predicted within this band of frequencies, in Hz; for the methods over frequency: look only there
    #[arg(long, value_name = "LOW..HIGH", value_parser = band::parse)]
    band: Option<Band>,
    /// Where each recording starts from
    #[arg(long, value_enum, default_value = "free")]
    start: Start,
    #[arg(long, value_name = "[INPUT=]KIND", help = model_file::BETWEEN_HELP)]
    between: Vec<String>,
    /// Known standard deviation of a channel's noise (SI); repeated for every output channel, and for inputs that are noisy
    #[arg(long, value_name = "CHANNEL=STD")]
    noise: Vec<String>,
    /// Number of different start values that compete
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Seed of those start values
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Calibration with the sensors' uncertainty, which then widens the intervals; what travels with the recordings when not given
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Write the model with the identified values to this file
    #[arg(long, value_name = "FILE")]
    write_model: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    json: bool,
    /// Say on stderr how far the fit is, also where that is no terminal
    #[arg(long)]
    progress: bool,
    #[command(flatten)]
    frequency: FrequencyArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// The model runs free from the measured input; residuals of its outputs are made least
    OutputError,
    /// The measured force of a one-coordinate axis is regressed on its measured motion
    InverseDynamics,
    /// The frequency response, with coherence, confidence, and how much is not linear; no parameters
    Frf,
    /// A transfer function fitted to recordings, or to a response that frf wrote
    Etf,
    /// The thesis' method: a transfer function's coefficients matched by the bench's parameters; beside it a direct fit
    CoefficientMatch,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(super) enum Start {
    /// An unknown state, estimated
    Free,
    /// Equilibrium at the first input sample
    Equilibrium,
}

impl Start {
    pub(super) fn state(self) -> StartState {
        match self {
            Self::Free => StartState::Free,
            Self::Equilibrium => StartState::Equilibrium,
        }
    }
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let mut model = model_file::load(&args.model)?;
    model_file::set(&mut model, &args.set, false)?;
    model_file::set(&mut model, &args.fix, true)?;
    model_file::set_between(&mut model, &args.between)?;
    let uncalibrated = model.clone();
    if let Some(calibration) = calibrated::of(&args.runs, args.calibration.as_deref())?
        && args.method == Method::OutputError
    {
        model = calibrated::with_sensor_gains(&model, &calibration)?;
    }
    refuse_unused(&args)?;
    match args.method {
        Method::Frf => return frf::run(&args, &model),
        Method::Etf => return etf::run(&args, &model),
        Method::CoefficientMatch => return coefficient_match::run(&args, &model),
        Method::OutputError | Method::InverseDynamics => {}
    }
    if args.band.is_some() && args.validate.is_empty() {
        let message = "--band needs --validate RUN with this method: it is the held-out fit that it bounds";
        return Err(WrongArguments(message.into()).into());
    }
    let mut options = options(&args, &model)?;
    let interrupt = Interrupt::listen();
    interrupt.end_after(0);
    // Where it cannot be written is said before the fit, not after it.
    let target = args.write_model.as_deref().map(output::create).transpose()?;
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
    let validation = validate(&args, &model, &held_out, &result, &options)?;
    let force_errors = force_errors(&args, &model, &datasets, &result)?;
    if let Some(target) = target {
        // Sensors' gains are the calibration's, not the drivetrain's.
        write_model(target, &uncalibrated, &result)?;
        interrupt.unfinished(None);
    }
    if args.json {
        print_json(&result, &validation, &force_errors)?;
    } else {
        result.warnings.iter().for_each(output::warn);
        output::print(&report(&result, &validation, &force_errors))?;
    }
    Ok(Outcome::Done)
}

/// An option that a method over frequency would not use is refused rather than ignored.
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

fn bind<'a>(model: &'a Model, datasets: &'a [Dataset], options: &Options) -> anyhow::Result<Problem<'a>> {
    Problem::new(model, datasets, options.clone()).map_err(|error| match error {
        IdentifyError::Recording(error @ RecordingError::NoSuchChannel { .. }) => anyhow::anyhow!(
            "{error}; the model {} needs it (another model is chosen with --model)",
            model.name
        ),
        error => error.into(),
    })
}

/// How well recordings that were not fitted are predicted.
struct Validation {
    recording: String,
    fit: Fit,
    band: Option<BandFits>,
    force_error_percent: Option<f64>,
}

fn open_all(runs: &[String], model: &Model) -> anyhow::Result<Vec<Dataset>> {
    runs.iter().map(|run| output::open_for(run, model, output::GRID_PARTS)).collect()
}

fn options(args: &Args, model: &Model) -> anyhow::Result<Options> {
    let noise = noise(&args.noise, model)?;
    Ok(Options {
        noise,
        start_state: args.start.state(),
        try_other_intersamples: true,
        starts: args.starts.into(),
        seed: args.seed,
        ..Options::default()
    })
}

fn noise(given: &[String], model: &Model) -> anyhow::Result<Noise> {
    if given.is_empty() {
        return Ok(Noise::Estimated);
    }
    let outputs: Vec<_> = model.outputs().map(|channel| channel.name.as_str()).collect();
    let inputs: Vec<_> = model.inputs().map(|channel| channel.name.as_str()).collect();
    let mut levels = (vec![None; outputs.len()], vec![0.0; inputs.len()]);
    for text in given {
        let wrong = || {
            WrongArguments(format!(
                "--noise {text}: expected CHANNEL=STD with one of {}, {} and a positive number, or nought for an input",
                outputs.join(", "),
                inputs.join(", ")
            ))
        };
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let std: f64 =
            value.parse().ok().filter(|std: &f64| *std >= 0.0 && std.is_finite()).ok_or_else(wrong)?;
        let position = |names: &[&str]| names.iter().position(|known| *known == name);
        match (position(&outputs), position(&inputs)) {
            (Some(output), _) if std > 0.0 => levels.0[output] = Some(std),
            (None, Some(input)) => levels.1[input] = std,
            _ => return Err(wrong().into()),
        }
    }
    let known: Option<Vec<f64>> = levels.0.into_iter().collect();
    known.map(|outputs| Noise::Given(NoiseLevels { outputs, inputs: levels.1 })).ok_or_else(|| {
        WrongArguments(format!("--noise is needed for every output channel: {}", outputs.join(", "))).into()
    })
}

fn validate(
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

/// Recordings that were fitted by inverse dynamics, and how much of the force that leaves, per cent.
fn force_errors(
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

/// Writes `model` with the identified values.
pub(crate) fn write_model(
    mut target: OutputFile,
    model: &Model,
    result: &Identification,
) -> anyhow::Result<()> {
    let recordings = result.recordings.join(", ");
    let updates: Vec<Update> = result
        .parameters
        .iter()
        .zip(&result.point)
        .filter(|(parameter, _)| parameter.source != socam_identify::Source::Fixed)
        .map(|(parameter, value)| Update {
            name: parameter.name.clone(),
            value: *value,
            ci95: parameter.ci95[0]
                .zip(parameter.ci95[1])
                .map(|(low, high)| [low, high])
                .filter(|_| parameter.identifiable),
            source: if parameter.identifiable && result.end == End::Interrupted {
                format!("best so far of an interrupted search ({}) from {recordings}", result.method)
            } else if parameter.identifiable {
                format!("identified ({}) from {recordings}", result.method)
            } else {
                format!("not determined by {recordings}; part of the fit only")
            },
        })
        .collect();
    target.write_all(model.text_with(&updates)?.as_bytes())?;
    Ok(target.commit()?)
}

fn print_json(
    result: &Identification,
    validation: &[Validation],
    force_errors: &[(String, f64)],
) -> anyhow::Result<()> {
    let mut document = serde_json::to_value(result)?;
    if !force_errors.is_empty() {
        let each = force_errors.iter().map(
            |(recording, error)| serde_json::json!({ "recording": recording, "force_error_percent": error }),
        );
        document["training"] = each.collect();
    }
    document["validation"] = validation
        .iter()
        .map(|v| {
            let mut entry = serde_json::json!({
                "recording": v.recording, "fit": v.fit, "force_error_percent": v.force_error_percent
            });
            if let Some(band) = &v.band {
                entry["band"] = band.json();
            }
            entry
        })
        .collect();
    output::print_json(&document)
}

/// The result as tables.
fn report(result: &Identification, validation: &[Validation], force_errors: &[(String, f64)]) -> String {
    let mut text = format!(
        "{} by {}: {} after {} iterations, {:.2} CPU s\n\n",
        result.model,
        result.method,
        table::end(result.end),
        result.iterations,
        result.cpu_s
    );
    text.push_str(&table::parameters(result));
    text.push_str(&table::combinations(result));
    text.push_str(&table::nuisance(result));
    text.push_str(&table::advice(result));
    text.push_str(&table::fit("Fit (free run)", &result.fit));
    text.push_str(&table::noise(result));
    for (recording, error) in force_errors {
        text.push_str(&format!(
            "\nFitted: {recording}\n  inverse dynamics: force error {error:.3} % of its norm\n"
        ));
    }
    for held_out in validation {
        text.push_str(&table::fit(&format!("Not fitted: {} (free run)", held_out.recording), &held_out.fit));
        if let Some(band) = &held_out.band {
            text.push_str(&band.table());
        }
        if let Some(error) = held_out.force_error_percent {
            text.push_str(&format!("  inverse dynamics: force error {error:.3} % of its norm\n"));
        }
    }
    text
}
