//! Power spectra of residuals and the frequencies that stand out in them.

use socam_identify::comparison::Traces;
use socam_spectrum::{Detrend, Welch};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Largest number of samples of one segment.
const LONGEST: usize = 16_384;

/// Number of samples up to which a series has too few spectral lines.
const SHORTEST: usize = 64;
/// Spectral lines on either side with which one is compared.
const NEAR: usize = 40;
/// p-value below which a spectral line counts as significant.
const NO_CHANCE: f64 = 1e-9;
/// Relative difference of line spacings up to which series share a frequency grid.
const SAME_GRID: f64 = 1e-6;

/// Mean sample time of a segment, s.
pub(crate) fn step_s(trace: &Traces) -> f64 {
    let n = trace.time_s.len();
    if n < 2 { 1e-3 } else { (trace.time_s[n - 1] - trace.time_s[0]) / (n - 1) as f64 }
}

/// Residual of an output: measured minus predicted, SI.
pub(crate) fn residual(trace: &Traces, output: usize) -> Vec<f64> {
    trace.measured[output].iter().zip(&trace.predicted[output]).map(|(y, p)| y - p).collect()
}

/// Power spectral density of a series by Welch's method: frequencies in Hz, and density in units squared per Hz. Missing values count as
/// zero.
pub(crate) fn power(values: &[f64], step_s: f64) -> (Vec<f64>, Vec<f64>) {
    let length = values.len().min(LONGEST);
    if length < 16 {
        return (Vec::new(), Vec::new());
    }
    let present: Vec<f64> = values.iter().map(|value| if value.is_nan() { 0.0 } else { *value }).collect();
    let mut welch = Welch::new(length).with_detrend(Detrend::Nothing);
    welch.add_run([&present]);
    welch.finish(step_s).map_or((Vec::new(), Vec::new()), |spectra| {
        ((0..spectra.lines()).map(|line| spectra.frequency_hz(line)).collect(), spectra.density(0))
    })
}

/// Frequency below which half of a series' power lies, Hz, without its mean; `None` for too few values or a constant series.
pub(crate) fn median_hz(values: &[f64], step_s: f64) -> Option<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let swing: Vec<f64> = values.iter().map(|value| value - mean).collect();
    let (frequency, power) = power(&swing, step_s);
    let total: f64 = power.iter().skip(1).sum();
    let mut below = 0.0;
    let half = frequency.iter().zip(&power).skip(1).find(|(_, power)| {
        below += **power;
        below >= 0.5 * total
    });
    half.filter(|_| total > 0.0).map(|(frequency, _)| *frequency)
}

/// Spectral lines of a series, each as a multiple of the noise level near it.
pub(crate) struct Lines {
    spacing_hz: f64,
    sizes: Vec<f64>,
}

impl Lines {
    /// Lines of a series with this sample time, s; `None` for too few values.
    pub(crate) fn new(values: &[f64], step_s: f64) -> Option<Self> {
        if values.len() <= SHORTEST {
            return None;
        }
        let (frequency, power) = power(values, step_s);
        let relative = |k: usize| {
            let mut near = power[k.saturating_sub(NEAR)..(k + NEAR).min(power.len())].to_vec();
            near.sort_by(f64::total_cmp);
            // The power of a line of white noise is exponentially distributed: its mean is its median over ln 2.
            let mean = near[near.len() / 2] / std::f64::consts::LN_2;
            power[k] / mean.max(f64::MIN_POSITIVE)
        };
        Some(Self { spacing_hz: frequency[1], sizes: (0..power.len()).map(relative).collect() })
    }

    /// Whether both series have lines at the same frequencies.
    fn has_grid_of(&self, other: &Self) -> bool {
        self.sizes.len() == other.sizes.len() && (self.spacing_hz / other.spacing_hz - 1.0).abs() < SAME_GRID
    }
}

/// Frequencies at which series have lines above the noise near them, the strongest first, Hz. Series of one frequency grid are summed, so
/// that a line that is weak in each can be significant in their sum.
pub(crate) fn peaks<'s>(series: impl Iterator<Item = &'s Lines>, most: usize) -> Vec<f64> {
    let mut groups: Vec<Vec<&Lines>> = Vec::new();
    for lines in series {
        match groups.iter_mut().find(|group| group[0].has_grid_of(lines)) {
            Some(group) => group.push(lines),
            None => groups.push(vec![lines]),
        }
    }
    let mut found: Vec<(f64, f64)> = groups.iter().flat_map(|group| outstanding(group)).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<f64> = Vec::new();
    for (_, frequency) in found {
        if kept.len() < most && kept.iter().all(|known| (known - frequency).abs() > 0.15) {
            kept.push(frequency);
        }
    }
    kept
}

/// Significant lines of the sum of series of one grid: the ratio of each to the significance threshold, and its frequency, Hz.
fn outstanding(group: &[&Lines]) -> Vec<(f64, f64)> {
    let chance = ChiSquared::new(2.0 * group.len() as f64);
    let least = chance.map_or(f64::INFINITY, |chance| 0.5 * chance.inverse_cdf(1.0 - NO_CHANCE));
    let count = group[0].sizes.len();
    let sums: Vec<f64> = (0..count).map(|k| group.iter().map(|lines| lines.sizes[k]).sum()).collect();
    let is_peak = |k: &usize| sums[*k] >= sums[k - 1] && sums[*k] > sums[k + 1] && sums[*k] > least;
    let lines = (4..count.saturating_sub(4)).filter(is_peak);
    lines.map(|k| (sums[k] / least, refined(&sums, k, group[0].spacing_hz))).collect()
}

/// A line's frequency between those of the grid, from a parabola through the logarithms of three lines, Hz.
fn refined(power: &[f64], k: usize, spacing: f64) -> f64 {
    let [a, b, c] = [k - 1, k, k + 1].map(|i| power[i].max(f64::MIN_POSITIVE).ln());
    let bend = a - 2.0 * b + c;
    let shift = if bend < 0.0 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    (k as f64 + shift) * spacing
}

#[cfg(test)]
mod tests {
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// White noise of unit variance with a sine at 6.68 Hz, sampled for 10 s.
    fn series(seed: u64, amplitude: f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
        let at = |k: usize| (std::f64::consts::TAU * 6.68 * 1e-3 * k as f64).sin();
        (0..10_000).map(|k| noise() + amplitude * at(k)).collect()
    }

    #[test]
    fn half_of_the_power_of_a_sine_lies_below_its_frequency() {
        let sine: Vec<f64> =
            (0..10_000).map(|k| 3.0 + (std::f64::consts::TAU * 4.0 * 1e-3 * f64::from(k)).sin()).collect();
        assert!((median_hz(&sine, 1e-3).unwrap() - 4.0).abs() < 0.2);
        assert_eq!(median_hz(&[1.0; 100], 1e-3), None);
    }

    #[test]
    fn a_line_that_is_weak_in_each_is_seen_in_all_together() {
        let found = |all: &[Vec<f64>]| {
            let lines: Vec<Lines> = all.iter().filter_map(|one| Lines::new(one, 1e-3)).collect();
            peaks(lines.iter(), 3)
        };
        let weak: Vec<Vec<f64>> = (0..6).map(|seed| series(seed, 0.08)).collect();
        for one in &weak {
            assert!(found(std::slice::from_ref(one)).is_empty());
        }
        let together = found(&weak);
        assert_eq!(together.len(), 1);
        assert!((together[0] - 6.68).abs() < 0.03, "{together:?}");
        let noise_only: Vec<Vec<f64>> = (10..16).map(|seed| series(seed, 0.0)).collect();
        assert!(found(&noise_only).is_empty());
    }
}
