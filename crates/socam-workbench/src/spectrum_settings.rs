//! How spectra are made and scaled, in the view over frequency and in spectrograms.

use serde::{Deserialize, Serialize};
use socam_spectrum::{Detrend, Spectra, Welch, Window};

/// Shortest and longest segment, samples.
pub const SHORTEST: usize = 64;
/// See [`SHORTEST`].
pub const LONGEST: usize = 1 << 18;
/// Lengths to choose from, samples; `None`: as the length of the recording allows.
pub const LENGTHS: [Option<usize>; 8] =
    [None, Some(SHORTEST), Some(256), Some(1024), Some(4096), Some(16_384), Some(65_536), Some(LONGEST)];
/// Overlaps to choose from, percent of a segment.
pub const OVERLAPS: [u8; 4] = [0, 50, 67, 75];

/// How spectra are made and scaled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpectrumSettings {
    /// Weights of a segment.
    pub window: Window,
    /// Samples of a segment; `None`: as the length of the recording allows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<usize>,
    /// Share of a segment that the next one overlaps, percent.
    pub overlap_percent: u8,
    /// What is taken off each segment.
    pub detrend: Detrend,
    /// Whether only the range that the view over time has in sight counts.
    pub in_sight: bool,
    /// How densities are scaled.
    pub scaling: Scaling,
}

impl Default for SpectrumSettings {
    fn default() -> Self {
        Self {
            window: Window::default(),
            length: None,
            overlap_percent: 50,
            detrend: Detrend::default(),
            in_sight: false,
            scaling: Scaling::default(),
        }
    }
}

impl SpectrumSettings {
    /// Whether nothing was chosen.
    #[must_use]
    pub fn are_usual(&self) -> bool {
        *self == Self::default()
    }

    /// The settings of a file of another hand, within what can be computed.
    #[must_use]
    pub fn within_limits(self) -> Self {
        let length = self.length.map(|length| length.clamp(SHORTEST, LONGEST));
        Self { length, overlap_percent: self.overlap_percent.min(90), ..self }
    }

    /// Averages segments of so many samples as these settings say.
    #[must_use]
    pub fn welch(&self, length: usize) -> Welch {
        let welch = Welch::new(length).with_window(self.window).with_detrend(self.detrend);
        welch.with_overlap(0.01 * f64::from(self.overlap_percent))
    }
}

/// How a spectrum is scaled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scaling {
    /// Amplitude spectral density, unit per sqrt(Hz): the level of noise.
    #[default]
    Density,
    /// Amplitude of a sine at that frequency, unit.
    Amplitude,
    /// Power density in decibels relative to the unit squared per Hz.
    Decibel,
}

impl Scaling {
    /// All scales with their names.
    pub const ALL: [(Self, &str); 3] =
        [(Self::Density, "density"), (Self::Amplitude, "amplitude"), (Self::Decibel, "dB")];

    /// Unit of a channel's spectrum.
    #[must_use]
    pub fn unit(self, unit: &str) -> String {
        match self {
            Self::Density => format!("{unit} per sqrt(Hz)"),
            Self::Amplitude => unit.to_owned(),
            Self::Decibel => format!("dB of ({unit})²/Hz"),
        }
    }

    /// The scaled values of a power density.
    #[must_use]
    pub fn values(self, spectra: &Spectra) -> Vec<f64> {
        let one = |density: f64| match self {
            Self::Density => density.sqrt(),
            Self::Amplitude => (2.0 * spectra.noise_bandwidth_hz() * density).sqrt(),
            Self::Decibel => 10.0 * density.max(1e-300).log10(),
        };
        spectra.density(0).into_iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_survive_their_file_and_a_strange_file_stays_within_limits() {
        let chosen = SpectrumSettings {
            window: Window::FlatTop,
            length: Some(4096),
            overlap_percent: 75,
            detrend: Detrend::Line,
            in_sight: true,
            scaling: Scaling::Amplitude,
        };
        let text = serde_json::to_string(&chosen).unwrap();
        assert!(text.contains(r#""window":"flat_top""#) && text.contains(r#""detrend":"line""#), "{text}");
        assert_eq!(serde_json::from_str::<SpectrumSettings>(&text).unwrap(), chosen);
        let strange: SpectrumSettings =
            serde_json::from_str(r#"{"length": 900000000000, "overlap_percent": 100}"#).unwrap();
        let sound = strange.within_limits();
        assert_eq!((sound.length, sound.overlap_percent), (Some(LONGEST), 90));
        assert!(serde_json::from_str::<SpectrumSettings>(r#"{"windows": "hann"}"#).is_err());
    }
}
