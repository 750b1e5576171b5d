//! Arguments of `identify`.

use std::path::PathBuf;

use socam_identify::{Band, StartState};

use super::options::FrequencyArgs;
use crate::{band, model_file};

/// Identify stiffness, damping and friction from recordings
///
/// Fits the free parameters of the model to all recordings together and prints each with its 95 % interval. For a parameter that the
/// recordings do not determine, a note says why, and combinations that are determined are printed. Ctrl-C ends the search and reports the
/// best point so far; a second Ctrl-C ends at once.
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
    pub(super) runs: Vec<String>,
    #[arg(long, value_name = "MODEL", default_value = "speed-o-cam", help = model_file::HELP)]
    pub(super) model: String,
    /// Estimation method
    #[arg(long, value_enum, default_value = "output-error")]
    pub(super) method: Method,
    /// Fix a parameter at its value in the model or at the given value (SI); may be repeated
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub(super) fix: Vec<String>,
    /// Start value of a parameter (SI); may be repeated
    #[arg(long, value_name = "NAME=VALUE")]
    pub(super) set: Vec<String>,
    /// Validation recordings, predicted with the result and not used in the fit; may be repeated
    #[arg(long, value_name = "RUN")]
    pub(super) validate: Vec<String>,
    /// Frequency band, Hz: report the fit of validation recordings within it; for frequency-domain methods, use only this band
    #[arg(long, value_name = "LOW..HIGH", value_parser = band::parse)]
    pub(super) band: Option<Band>,
    /// Start state of each recording
    #[arg(long, value_enum, default_value = "free")]
    pub(super) start: Start,
    #[arg(long, value_name = "[INPUT=]KIND", help = model_file::BETWEEN_HELP)]
    pub(super) between: Vec<String>,
    /// Known standard deviation of a channel's noise (SI); repeat it for every output channel and for noisy inputs
    #[arg(long, value_name = "CHANNEL=STD")]
    pub(super) noise: Vec<String>,
    /// Number of start points of the search
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(super) starts: u16,
    /// Seed of the random start points
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,
    /// Calibration file with the sensors' uncertainty, which widens the intervals [default: that in the recordings]
    #[arg(long, value_name = "FILE")]
    pub(super) calibration: Option<PathBuf>,
    /// Write the model with the identified values to this file
    #[arg(long, value_name = "FILE")]
    pub(super) write_model: Option<PathBuf>,
    /// Replace the file of --write-model, if it exists
    #[arg(long)]
    pub(super) force: bool,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub(super) json: bool,
    /// Report progress on stderr even if it is not a terminal
    #[arg(long)]
    pub(super) progress: bool,
    #[command(flatten)]
    pub(super) frequency: FrequencyArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Method {
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

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub(crate) enum Start {
    /// An unknown state, which is estimated
    Free,
    /// Equilibrium at the first input sample
    Equilibrium,
}

impl Start {
    pub(crate) fn state(self) -> StartState {
        match self {
            Self::Free => StartState::Free,
            Self::Equilibrium => StartState::Equilibrium,
        }
    }
}
