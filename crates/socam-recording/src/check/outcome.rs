//! The result of a check: verdict, one entry per channel, findings.

use serde::Serialize;

use super::finding::Finding;
use crate::Unit;

/// Whether a recording is fit for use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// No finding weakens or prevents a fit.
    Fit,
    /// A fit is possible; the findings state what weakens it.
    FitWithReservations,
    /// A fit would be meaningless.
    Unfit,
}

/// The result of a check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// The recording's name.
    pub recording: String,
    /// The verdict, from the most severe finding.
    pub verdict: Verdict,
    /// The channel taken as the input; `None` when none was named and none has a usual name.
    pub input: Option<String>,
    /// Checks of the channels, in the dataset's order.
    pub channels: Vec<ChannelCheck>,
    /// The findings, most severe first.
    pub findings: Vec<Finding>,
}

/// Excitation and noise of one channel. Signal-to-noise ratio, band and lines of an angle or a position are those of its rate of
/// change: a turning shaft makes a ramp, whose spectrum is meaningless.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelCheck {
    /// The channel's name.
    pub name: String,
    /// Unit of the channel.
    pub unit: Unit,
    /// Half of peak to peak, in the unit.
    pub amplitude: f64,
    /// Estimated standard deviation of its noise (white; the lesser of two estimates, from the top quarter of the
    /// spectrum and from fourth differences), in the unit; `None` for an angle or a position.
    pub noise_std: Option<f64>,
    /// Signal-to-noise ratio, dB.
    pub snr_db: Option<f64>,
    /// Lowest and highest frequency with power above the noise, Hz.
    pub band_hz: Option<[f64; 2]>,
    /// Number of spectral lines above the noise; a continuous band counts as the lines that would fill it.
    pub lines: Option<usize>,
    /// Jumps of more than 2 % of peak to peak within one sample.
    pub steps: u64,
    /// Changes of direction larger than a tenth of peak to peak.
    pub turning_points: u64,
    /// Changes of sign, with a hysteresis of a tenth of peak to peak.
    pub sign_changes: u64,
}
