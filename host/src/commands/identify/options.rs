//! Options of the frequency-domain methods.

use std::path::PathBuf;

use socam_response::Settings;

/// Options of the methods frf, etf and coefficient-match.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Options of frf, etf and coefficient-match")]
pub(crate) struct FrequencyArgs {
    /// Output channel of the response; may be repeated [default: all, or the output speed for a transfer function]
    #[arg(long, value_name = "CHANNEL")]
    pub(super) output: Vec<String>,
    /// Column of the reference signal, which is free of noise [default: command_V, if the recordings have it]
    #[arg(long, value_name = "COLUMN")]
    pub(super) reference: Option<String>,
    /// Period of the excitation, s [default: estimated]
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub(super) period: Option<f64>,
    /// Replace samples by the median of their neighbours if they differ by more than this number of standard deviations
    #[arg(long, value_name = "DEVIATIONS", value_parser = positive)]
    pub(super) outliers: Option<f64>,
    /// Low-pass filter (Butterworth) on all signals: corner in Hz, and order [default order: 4]
    #[arg(long, value_name = "HZ[:ORDER]", value_parser = low_pass)]
    pub(super) low_pass: Option<(f64, usize)>,
    /// Of recordings with the same mean input (within 5 %), use only the one with least noise
    #[arg(long)]
    pub(super) quietest: bool,
    /// Orders of the transfer function, NUMERATOR/DENOMINATOR [default: least description length; for coefficient-match those of the model]
    #[arg(long, value_name = "B/A", value_parser = orders)]
    pub(super) orders: Option<socam_frequency::rational::Orders>,
    /// Fit only transfer functions with stable poles
    #[arg(long)]
    pub(super) stable: bool,
    /// Write a page, its plots and its numbers into this folder
    #[arg(long, value_name = "DIR")]
    pub(super) report: Option<PathBuf>,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0);
    number.ok_or_else(|| "expected a positive number".into())
}

fn low_pass(text: &str) -> Result<(f64, usize), String> {
    let (corner, order) = text.split_once(':').unwrap_or((text, "4"));
    let order = order.parse().map_err(|_| "expected HZ[:ORDER], as in 60:4".to_owned())?;
    Ok((positive(corner)?, order))
}

fn orders(text: &str) -> Result<socam_frequency::rational::Orders, String> {
    let expected = || "expected NUMERATOR/DENOMINATOR, as in 5/6".to_owned();
    let (numerator, denominator) = text.split_once('/').ok_or_else(expected)?;
    let number = |text: &str| text.trim().parse().map_err(|_| expected());
    Ok(socam_frequency::rational::Orders { numerator: number(numerator)?, denominator: number(denominator)? })
}

impl FrequencyArgs {
    /// How responses are estimated, in this band.
    pub(super) fn settings(&self, band_hz: Option<[f64; 2]>) -> Settings {
        Settings {
            reference: self.reference.clone(),
            band_hz,
            period_s: self.period,
            outliers: self.outliers,
            low_pass: self.low_pass,
            quietest: self.quietest,
        }
    }
}
