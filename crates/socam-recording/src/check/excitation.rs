//! Findings about how far a channel moves, at which frequencies, and in which directions.

use super::finding::{Finding, LOWEST_SNR_DB};
use super::options::{BothWays, CheckOptions, Resonance};
use super::outcome::ChannelCheck;
use super::spectrum::Spectrum;
use crate::dataset::Dataset;
use crate::statistics::Statistics;
use crate::{Channel, Unit};

/// Standard deviation of the input, as a share of its mean, below which it counts as standing still.
const SMALLEST_SPREAD: f64 = 0.005;

/// Smallest number of spectral lines that determines a drivetrain with a handful of parameters: each line gives two equations
/// per output. A model with many parameters and few outputs needs more.
const FEWEST_LINES: usize = 3;

/// The input excites a resonance when it moves within this factor of its frequency, up or down.
const BESIDE_RESONANCE: f64 = 1.25;

/// A finding where a channel moves too little, or the input at too few frequencies.
pub(super) fn excitation_of(
    channel: &Channel,
    check: &ChannelCheck,
    statistics: &Statistics,
    input_of: Option<&CheckOptions>,
) -> Option<Finding> {
    let is_input = input_of.is_some();
    let needed =
        input_of.and_then(|options| options.free).map_or(FEWEST_LINES, |free| free.lines().max(FEWEST_LINES));
    let mean = statistics.mean.unwrap_or(0.0);
    let std = statistics.std.unwrap_or(0.0);
    let name = channel.name.clone();
    if is_input && std < SMALLEST_SPREAD * mean.abs() {
        let snr_db = check.snr_db;
        return Some(Finding::StandsStill { channel: name, unit: channel.unit, mean, std, snr_db });
    }
    match (check.snr_db, check.lines, check.band_hz) {
        // Differencing an angle amplifies its noise, so its ratio is not judged.
        (Some(snr_db), ..) if snr_db < LOWEST_SNR_DB && check.noise_std.is_some() => {
            Some(Finding::Buried { channel: name, snr_db, is_input })
        }
        (_, Some(lines), Some(band_hz)) if is_input && lines < needed => {
            Some(Finding::FewLines { channel: name, lines, needed, band_hz })
        }
        _ => None,
    }
}

/// A finding that lists the resonances near which the input has no power.
pub(super) fn not_excited(
    channel: &Channel,
    check: &ChannelCheck,
    spectrum: &Spectrum,
    resonances: &[Resonance],
) -> Option<Finding> {
    let band_hz = check.band_hz?;
    let unexcited = |resonance: &&Resonance| {
        let frequency_hz = resonance.frequency_hz;
        // Below the lowest frequency that the windows separate from the mean.
        if frequency_hz < spectrum.lowest_hz() {
            return false;
        }
        !spectrum.moves_between(frequency_hz / BESIDE_RESONANCE, frequency_hz * BESIDE_RESONANCE)
    };
    let resonances: Vec<Resonance> = resonances.iter().filter(unexcited).cloned().collect();
    (!resonances.is_empty()).then(|| Finding::ResonancesNotExcited {
        channel: channel.name.clone(),
        resonances,
        band_hz,
        highest_hz: spectrum.highest_hz(),
    })
}

/// A finding where a motion that must reverse never does.
pub(super) fn one_way(data: &Dataset, motion: &BothWays, channels: &[ChannelCheck]) -> Option<Finding> {
    let name = &data.channels()[data.channel_index(&motion.channel).ok()?].name;
    let channel = channels.iter().find(|channel| channel.name == *name)?;
    let turns = match channel.unit {
        Unit::Rad | Unit::M => channel.turning_points,
        _ => channel.sign_changes,
    };
    (turns == 0).then(|| Finding::OneWay { channel: name.clone(), parameters: motion.parameters.clone() })
}
