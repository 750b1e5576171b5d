//! Options of the methods over frequency.

use std::path::PathBuf;

use super::signals::Stretch;
use crate::output;

/// Options of the methods frf, etf and coefficient-match.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Options of frf, etf and coefficient-match")]
pub(crate) struct FrequencyArgs {
    /// Output channel to take the response of; may be repeated [default: all, or the output speed for a transfer function]
    #[arg(long, value_name = "CHANNEL")]
    pub(super) output: Vec<String>,
    /// Column that made the input and is known without noise [default: command_V, where recordings have it]
    #[arg(long, value_name = "COLUMN")]
    pub(super) reference: Option<String>,
    /// Period of a periodic excitation, in s; otherwise it is found
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub(super) period: Option<f64>,
    /// Replace samples this many standard deviations away from their neighbours' median by that median
    #[arg(long, value_name = "DEVIATIONS", value_parser = positive)]
    pub(super) outliers: Option<f64>,
    /// Butterworth low-pass on all signals, of order 4 unless another is given
    #[arg(long, value_name = "HZ[:ORDER]", value_parser = low_pass)]
    pub(super) low_pass: Option<(f64, usize)>,
    /// Of recordings with the same mean input (within 5 %), take only the one with least noise
    #[arg(long)]
    pub(super) quietest: bool,
    /// Orders of the transfer function, NUMERATOR/DENOMINATOR [default: the advised ones; those of the model for coefficient-match]
    #[arg(long, value_name = "B/A", value_parser = orders)]
    pub(super) orders: Option<socam_frequency::rational::Orders>,
    /// ChannelTransform only transfer functions with stable poles
    #[arg(long)]
    pub(super) stable: bool,
    /// Write a page with its pictures and numbers into this folder
    #[arg(long, value_name = "DIR")]
    pub(super) report: Option<PathBuf>,
}

/// Mean inputs this close belong to repeated runs.
const SAME: f64 = 0.05;

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
    /// Stretches chosen and cleaned as asked, and said.
    pub(super) fn prepared(&self, stretches: Vec<Stretch>) -> anyhow::Result<Vec<Stretch>> {
        let mut stretches = if self.quietest { quietest(stretches) } else { stretches };
        for stretch in &mut stretches {
            if let Some(limit) = self.outliers {
                let replaced = stretch.without_outliers(limit);
                if replaced > 0 {
                    output::say(format_args!("{}: {replaced} outliers replaced", stretch.recording));
                }
            }
            if let Some((corner_hz, order)) = self.low_pass {
                stretch.filter(order, corner_hz)?;
            }
        }
        Ok(stretches)
    }
}

/// Of repeated runs the one whose output is least noisy (thesis section 4.1.1).
fn quietest(stretches: Vec<Stretch>) -> Vec<Stretch> {
    let mean = |stretch: &Stretch| stretch.input.iter().sum::<f64>() / stretch.input.len().max(1) as f64;
    let noise = |stretch: &Stretch| socam_frequency::prepare::noise_std(&stretch.output);
    let mut kept: Vec<(f64, f64, Stretch)> = Vec::new();
    for stretch in stretches {
        let (mean, noise) = (mean(&stretch), noise(&stretch));
        match kept.iter_mut().find(|(known, ..)| (known - mean).abs() <= SAME * known.abs()) {
            Some(best) if best.1 <= noise => {}
            Some(best) => *best = (best.0, noise, stretch),
            None => kept.push((mean, noise, stretch)),
        }
    }
    for (mean, noise, stretch) in &kept {
        output::say(format_args!(
            "{}: taken for a mean input of {mean:.4}, output noise {noise:.3e}",
            stretch.recording
        ));
    }
    kept.into_iter().map(|(_, _, stretch)| stretch).collect()
}
