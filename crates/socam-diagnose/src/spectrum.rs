//! Spectra of residuals.

use socam_identify::compare::Traces;
use socam_recording::Welch;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Longest piece that is transformed at once.
const LONGEST: usize = 16_384;

/// Lines on either side of one with which it is compared, and the chance that noise makes one that counts.
const NEAR: usize = 40;
const NO_CHANCE: f64 = 1e-9;
/// Series whose lines lie apart by the same, but for this share, are of one grid.
const SAME_GRID: f64 = 1e-6;

/// Sample time of a stretch, s.
pub(crate) fn step_s(trace: &Traces) -> f64 {
    let n = trace.time_s.len();
    if n < 2 { 1e-3 } else { (trace.time_s[n - 1] - trace.time_s[0]) / (n - 1) as f64 }
}

/// Measured minus predicted.
pub(crate) fn residual(trace: &Traces, output: usize) -> Vec<f64> {
    trace.measured[output].iter().zip(&trace.predicted[output]).map(|(y, p)| y - p).collect()
}

/// Power density of an output's residual: frequencies in Hz, and units squared per Hz, of one stretch. Missing values count as
/// nothing.
pub(crate) fn power(values: &[f64], step_s: f64) -> (Vec<f64>, Vec<f64>) {
    let length = values.len().min(LONGEST);
    if length < 16 {
        return (Vec::new(), Vec::new());
    }
    let mut welch = Welch::new(length);
    let mut sums = vec![0.0; welch.lines()];
    let mut pieces = 0;
    for start in (0..=values.len() - length).step_by((length / 2).max(1)) {
        let present = |value: &f64| if value.is_nan() { 0.0 } else { *value };
        let lines = welch.transform(values[start..start + length].iter().map(present));
        sums.iter_mut().zip(lines).for_each(|(sum, line)| *sum += line.norm_sqr());
        pieces += 1;
    }
    let scale = welch.density_per_sum(step_s, pieces);
    let frequency_hz = (0..sums.len()).map(|k| k as f64 * welch.step_hz(step_s)).collect();
    (frequency_hz, sums.into_iter().map(|sum| sum * scale).collect())
}

/// The frequencies at which some series, each with its sample time (s), stand out of what is near them, strongest first, Hz: those of
/// one length are taken together, for a line that is weak in each is seen in all of them.
pub(crate) fn peaks<'s>(series: impl Iterator<Item = (&'s [f64], f64)>, most: usize) -> Vec<f64> {
    let mut spectra: Vec<Lines> = Vec::new();
    for (values, step_s) in series.filter(|(values, _)| values.len() > 64) {
        let (frequency, power) = power(values, step_s);
        let is_same = |known: &Lines| {
            known.sums.len() == power.len() && (known.spacing_hz / frequency[1] - 1.0).abs() < SAME_GRID
        };
        let index = spectra.iter().position(is_same).unwrap_or(spectra.len());
        if index == spectra.len() {
            spectra.push(Lines { spacing_hz: frequency[1], sums: vec![0.0; power.len()], series: 0 });
        }
        spectra[index].add(&power);
    }
    let mut found: Vec<(f64, f64)> = spectra.iter().flat_map(Lines::outstanding).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<f64> = Vec::new();
    for (_, frequency) in found {
        if kept.len() < most && kept.iter().all(|known| (known - frequency).abs() > 0.15) {
            kept.push(frequency);
        }
    }
    kept
}

/// Powers of several series of one length, each line as a multiple of what is near it.
struct Lines {
    spacing_hz: f64,
    sums: Vec<f64>,
    series: usize,
}

impl Lines {
    fn add(&mut self, power: &[f64]) {
        for (k, sum) in self.sums.iter_mut().enumerate() {
            let mut near = power[k.saturating_sub(NEAR)..(k + NEAR).min(power.len())].to_vec();
            near.sort_by(f64::total_cmp);
            // Of white noise a line's power is exponentially distributed.
            let mean = near[near.len() / 2] / std::f64::consts::LN_2;
            *sum += power[k] / mean.max(f64::MIN_POSITIVE);
        }
        self.series += 1;
    }

    /// What noise hardly makes: by how much it is more than that, and its frequency.
    fn outstanding(&self) -> Vec<(f64, f64)> {
        let chance = ChiSquared::new(2.0 * self.series as f64);
        let least = chance.map_or(f64::INFINITY, |chance| 0.5 * chance.inverse_cdf(1.0 - NO_CHANCE));
        let sums = &self.sums;
        let lines = 4..sums.len().saturating_sub(4);
        let is_peak = |k: &usize| sums[*k] >= sums[k - 1] && sums[*k] > sums[k + 1] && sums[*k] > least;
        lines.filter(is_peak).map(|k| (sums[k] / least, refined(sums, k, self.spacing_hz))).collect()
    }
}

/// A line's frequency between the grid's, by the parabola through the logarithms.
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
    fn a_line_that_is_weak_in_each_is_seen_in_all_together() {
        let found = |all: &[Vec<f64>]| peaks(all.iter().map(|one| (&**one, 1e-3)), 3);
        let weak: Vec<Vec<f64>> = (0..6).map(|seed| series(seed, 0.08)).collect();
        for one in &weak {
            assert!(found(std::slice::from_ref(one)).is_empty());
        }
        let together = found(&weak);
        assert_eq!(together.len(), 1);
        assert!((together[0] - 6.68).abs() < 0.03, "{together:?}");
        let nothing: Vec<Vec<f64>> = (10..16).map(|seed| series(seed, 0.0)).collect();
        assert!(found(&nothing).is_empty());
    }
}
