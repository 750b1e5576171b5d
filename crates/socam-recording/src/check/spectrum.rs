//! Power spectral density by Welch's method; from it noise, band, lines and mains hum.

use socam_spectrum::Welch;

use super::finding::Finding;
use crate::Channel;

/// Longest and shortest window, rows.
const LONGEST: usize = 1 << 14;
const SHORTEST: usize = 64;

/// Power that counts as signal: over the noise (10 dB), and at most 60 dB below the strongest line, where leakage of the window
/// ends.
const OVER_NOISE: f64 = 10.0;
const UNDER_PEAK: f64 = 1e-6;

/// Lines are counted down to this far below the strongest (30 dB).
const LINE_UNDER_PEAK: f64 = 1e-3;

/// Bins that one line fills through the Hann window.
const BINS_PER_LINE: usize = 4;

/// A mains line stands out when it has this many times the power of its strongest neighbour. Eight averages scatter by
/// half; a neighbourhood of forty bins reaches three times its mean.
const HUM_OVER_NEIGHBOURS: f64 = 6.0;

/// Half width of the neighbourhood, Hz.
const NEIGHBOURHOOD_HZ: f64 = 8.0;

/// Sums the power of half-overlapping windows.
pub(super) struct Gatherer {
    /// None where segments are too short for any window.
    welch: Option<Welch>,
    buffer: Vec<f64>,
    sample_time_s: f64,
}

impl Gatherer {
    /// Creates the estimate for segments of at most `longest_segment` rows.
    pub(super) fn new(longest_segment: u64, sample_time_s: f64) -> Self {
        let quarter = usize::try_from(longest_segment / 4).unwrap_or(LONGEST).clamp(1, LONGEST);
        let length = 1_usize << quarter.ilog2();
        let welch = (length >= SHORTEST && sample_time_s > 0.0).then(|| Welch::new(length));
        Self { welch, buffer: Vec::new(), sample_time_s }
    }

    /// Marks a gap: no window reaches across.
    pub(super) fn interrupt(&mut self) {
        self.buffer.clear();
    }

    pub(super) fn push(&mut self, value: f64) {
        let Some(welch) = &mut self.welch else {
            return;
        };
        self.buffer.push(value);
        if self.buffer.len() == welch.length() {
            welch.add([&self.buffer]);
            self.buffer.drain(..welch.hop());
        }
    }

    /// The spectrum; `None` when no window was ever full.
    pub(super) fn finish(self) -> Option<Spectrum> {
        let spectra = self.welch?.finish(self.sample_time_s)?;
        let (density, step_hz) = (spectra.density(0), spectra.step_hz());
        let mut top: Vec<f64> = density[density.len() * 3 / 4..].to_vec();
        let middle = top.len() / 2;
        let floor = *top.select_nth_unstable_by(middle, f64::total_cmp).1;
        Some(Spectrum { density, step_hz, floor })
    }
}

/// One-sided power density, unit squared per Hz, and its floor.
pub(super) struct Spectrum {
    density: Vec<f64>,
    step_hz: f64,
    floor: f64,
}

impl Spectrum {
    /// Standard deviation of white noise with this floor.
    pub(super) fn noise_std(&self) -> f64 {
        (self.floor * self.step_hz * (self.density.len() - 1) as f64).sqrt()
    }

    /// Bounds the noise from above: the high-frequency power of a switching input is not noise.
    pub(super) fn bound_noise(&mut self, noise_std: f64) {
        let density = noise_std.powi(2) / (self.step_hz * (self.density.len() - 1) as f64);
        self.floor = self.floor.min(density);
    }

    /// The lowest frequency that is separated from the mean, Hz.
    pub(super) fn lowest_hz(&self) -> f64 {
        3.0 * self.step_hz
    }

    /// Bins that hold motion: the lowest two belong to the mean.
    fn moving(&self) -> impl Iterator<Item = (usize, f64)> {
        self.density.iter().copied().enumerate().skip(2)
    }

    fn peak(&self) -> f64 {
        self.moving().map(|(_, density)| density).fold(0.0, f64::max)
    }

    /// Power above the noise over the noise's power, dB. `None` without any noise.
    pub(super) fn snr_db(&self) -> Option<f64> {
        let signal: f64 =
            self.density.iter().skip(1).map(|d| (d - self.floor).max(0.0)).sum::<f64>() * self.step_hz;
        let noise = self.noise_std().powi(2);
        let ratio = signal / noise;
        (ratio.is_finite() && ratio > 0.0).then(|| 10.0 * ratio.log10())
    }

    /// Power density that counts as motion.
    fn threshold(&self) -> f64 {
        (OVER_NOISE * self.floor).max(UNDER_PEAK * self.peak())
    }

    /// Whether there is motion between two frequencies, Hz.
    pub(super) fn moves_between(&self, from_hz: f64, to_hz: f64) -> bool {
        let threshold = self.threshold();
        let bins = (from_hz / self.step_hz).round() as usize..=(to_hz / self.step_hz).round() as usize;
        self.moving().any(|(bin, density)| bins.contains(&bin) && density > threshold)
    }

    /// The Nyquist frequency, Hz.
    pub(super) fn highest_hz(&self) -> f64 {
        self.step_hz * (self.density.len() - 1) as f64
    }

    /// Lowest and highest frequency above the noise, Hz.
    pub(super) fn band_hz(&self) -> Option<[f64; 2]> {
        let threshold = self.threshold();
        let mut above = self.moving().filter(|(_, density)| *density > threshold);
        let first = above.next()?.0;
        let last = above.last().map_or(first, |(bin, _)| bin);
        Some([first as f64 * self.step_hz, last as f64 * self.step_hz])
    }

    /// Number of lines above the noise; a continuous band counts as the lines that would fill it.
    pub(super) fn lines(&self) -> usize {
        let threshold = (OVER_NOISE * self.floor).max(LINE_UNDER_PEAK * self.peak());
        let mut lines = 0;
        let mut width = 0_usize;
        for (_, density) in self.moving().chain([(0, 0.0)]) {
            if density > threshold {
                width += 1;
            } else if width > 0 {
                lines += width.div_ceil(BINS_PER_LINE + 1);
                width = 0;
            }
        }
        lines
    }

    /// Lines at 50 or 60 Hz and their harmonics that stand out from their surroundings.
    pub(super) fn hum(&self, channel: &Channel) -> Option<Finding> {
        let family = |mains_hz: f64| -> Vec<(u32, f64)> {
            (1..=10).filter_map(|order| Some((order, self.line_at(mains_hz * f64::from(order))?))).collect()
        };
        let (mains_hz, lines) = [50.0, 60.0]
            .map(|mains_hz| (mains_hz, family(mains_hz)))
            .into_iter()
            .max_by_key(|(_, lines)| lines.len())?;
        let strongest = lines.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        // Mains hum has the mains' own line, or a rectifier's harmonics of its double; other lines are of the motion.
        let has = |order| lines.iter().any(|line| line.0 == order);
        let is_hum = has(1) || (has(2) && lines.len() >= 2);
        if !is_hum {
            return None;
        }
        Some(Finding::MainsHum {
            channel: channel.name.clone(),
            unit: channel.unit,
            frequency_hz: mains_hz * f64::from(strongest.0),
            amplitude: strongest.1,
            harmonics: lines.iter().map(|(order, _)| *order).collect(),
        })
    }

    /// Amplitude of a line at this frequency; `None` if no line stands out there.
    fn line_at(&self, frequency_hz: f64) -> Option<f64> {
        let bin = (frequency_hz / self.step_hz).round() as usize;
        let reach = (NEIGHBOURHOOD_HZ / self.step_hz) as usize;
        // Resolution too coarse to separate a line from its neighbours, or too near either end.
        if reach < 8 || bin < reach + 3 || bin + reach + 3 >= self.density.len() {
            return None;
        }
        let own = &self.density[bin - 2..=bin + 2];
        let peak = own.iter().copied().fold(0.0, f64::max);
        let around = self.density[bin - reach..bin - 3].iter().chain(&self.density[bin + 4..bin + reach]);
        let (count, sum, strongest) =
            around.fold((0, 0.0, 0.0_f64), |(n, sum, max), d| (n + 1, sum + d, max.max(*d)));
        // Rounding errors of a noiseless simulation are not hum.
        let rounding = 1e-12 * self.peak();
        if peak < HUM_OVER_NEIGHBOURS * strongest || peak < rounding {
            return None;
        }
        let background = sum / f64::from(count);
        let power: f64 = own.iter().map(|d| (d - background).max(0.0)).sum::<f64>() * self.step_hz;
        Some((2.0 * power).sqrt())
    }
}
