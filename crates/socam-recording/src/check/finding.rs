//! The findings of a check, as values.

use serde::Serialize;

use super::options::Resonance;
use crate::Unit;

/// Signal-to-noise ratio below which a channel carries little information, dB.
pub(super) const LOWEST_SNR_DB: f64 = 10.0;

/// Severity of a finding for a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The finding is for information.
    Note,
    /// A fit is possible, but weaker.
    Weakens,
    /// A fit would be meaningless.
    Prevents,
}

/// Value at which a channel is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HeldAt {
    /// The channel is held at its least value: clipped.
    Least,
    /// The channel is held at its greatest value: clipped.
    Greatest,
    /// The channel is held at a value between: stuck.
    Between,
}

/// Something found in a recording. Values of channels are in the channel's unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
#[allow(missing_docs, reason = "each field is explained by the sentence its variant makes")]
pub enum Finding {
    /// Channels that the model reads are missing.
    MissingChannels { channels: Vec<String>, available: Vec<String> },
    /// Too few rows for any dynamics.
    TooShort { rows: u64, needed: u64 },
    /// Rows are missing between others.
    Gaps { count: u64, total_s: f64, longest_s: f64 },
    /// Samples were lost while recording.
    LostSamples { samples: u64 },
    /// The recording was cut off.
    CutOff { missing: String },
    /// A part of the log was damaged.
    Damaged { byte: u64, bytes: u64 },
    /// Steps of time differ from each other.
    UnevenSteps { sample_time_s: f64, jitter_s: f64 },
    /// A channel lacks values.
    MissingValues { channel: String, missing: u64, rows: u64 },
    /// A channel has one value only.
    Constant { channel: String, unit: Unit, value: f64, is_input: bool },
    /// The input hardly moves.
    StandsStill { channel: String, unit: Unit, mean: f64, std: f64, snr_db: Option<f64> },
    /// No channel is known to be the input.
    InputUnknown,
    /// A channel is mostly noise.
    Buried { channel: String, snr_db: f64, is_input: bool },
    /// The input moves at too few frequencies.
    FewLines { channel: String, lines: usize, needed: usize, band_hz: [f64; 2] },
    /// The input does not move near some resonances of the model.
    ResonancesNotExcited { channel: String, resonances: Vec<Resonance>, band_hz: [f64; 2], highest_hz: f64 },
    /// A motion never reverses.
    OneWay { channel: String, parameters: Vec<String> },
    /// A channel is clipped: it stays at its extreme while the quantity moves on.
    Saturated {
        channel: String,
        unit: Unit,
        limit: f64,
        at: HeldAt,
        rows: u64,
        share_percent: f64,
        runs: u64,
        longest_run_rows: u64,
    },
    /// A noisy channel repeats one value between its extremes.
    Stuck { channel: String, unit: Unit, value: f64, rows: u64, longest_run_rows: u64 },
    /// Single samples far outside the range of all others.
    Spikes { channel: String, unit: Unit, spikes: u64, farthest: f64, range: [f64; 2] },
    /// A channel is in another unit than the model expects.
    WrongUnit { channel: String, unit: Unit, expected: String },
    /// A line at the mains frequency or its harmonics.
    MainsHum { channel: String, unit: Unit, frequency_hz: f64, amplitude: f64, harmonics: Vec<u32> },
    /// Two speeds deviate from their fixed ratio.
    RatioBroken { fast: String, slow: String, expected: f64, measured: f64, deviation_percent: f64 },
    /// A speed is this factor times the derivative of its angle.
    NotTheDerivative { speed: String, angle: String, factor: f64 },
    /// A speed falls where the torque that drives it is positive.
    RunsAgainst { speed: String, torque: String },
}

impl Finding {
    /// Severity of the finding.
    #[must_use]
    pub fn severity(&self) -> Severity {
        match self {
            // A small motion well above the noise still carries information.
            Self::StandsStill { snr_db: Some(snr_db), .. } if *snr_db >= LOWEST_SNR_DB => Severity::Weakens,
            Self::MissingChannels { .. }
            | Self::TooShort { .. }
            | Self::WrongUnit { .. }
            | Self::StandsStill { .. }
            | Self::Constant { is_input: true, .. }
            | Self::Buried { is_input: true, .. } => Severity::Prevents,
            Self::MainsHum { .. } | Self::CutOff { .. } | Self::InputUnknown => Severity::Note,
            _ => Severity::Weakens,
        }
    }
}
