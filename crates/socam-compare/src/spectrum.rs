//! Power densities and coherence, over segments without overlap so that their distribution is known.

use socam_spectrum::{Welch, coherence_p_value};

/// Order of the signals: coherence is that with the first.
const SIMULATED: usize = 0;
const MEASURED: usize = 1;
const ERROR: usize = 2;
/// Largest number of segments; with more, the lowest frequencies would not be resolved.
const MOST_SEGMENTS: usize = 48;
const FEWEST_SEGMENTS: usize = 8;
/// A simulation moves at frequencies where its power density is above this share of its largest.
const MOVED: f64 = 0.01;

/// Densities of a channel, its simulation and its error.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Spectra {
    pub(crate) frequency_hz: Vec<f64>,
    pub(crate) measured: Vec<f64>,
    pub(crate) error: Vec<f64>,
    /// Squared coherence of the error with the simulation.
    pub(crate) coherence: Vec<f64>,
    /// Degrees of freedom of the densities.
    freedom: f64,
    /// Power density of the simulation.
    simulated: Vec<f64>,
}

/// Spectra of evenly sampled values; missing ones are replaced by the mean.
pub(crate) fn spectra(step_s: f64, measured: &[f64], simulated: &[f64]) -> Spectra {
    let n = measured.len();
    let segments = (n / 64).clamp(FEWEST_SEGMENTS, MOST_SEGMENTS);
    let length = (n / segments).max(8);
    let error: Vec<f64> = measured.iter().zip(simulated).map(|(a, b)| a - b).collect();
    let signals = [simulated, measured, &error].map(centred);
    let mut welch = Welch::new(length).without_overlap();
    welch.add_run(signals.each_ref().map(|signal| &signal[..segments * length]));
    welch.finish(step_s).map_or_else(Spectra::default, |welch| Spectra {
        frequency_hz: (0..welch.lines()).map(|line| welch.frequency_hz(line)).collect(),
        simulated: welch.density(SIMULATED),
        measured: welch.density(MEASURED),
        error: welch.density(ERROR),
        coherence: welch.coherence(ERROR),
        freedom: welch.freedom(),
    })
}

fn centred(values: &[f64]) -> Vec<f64> {
    let held = values.iter().filter(|value| value.is_finite());
    let (sum, count) = held.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    let mean = sum / f64::from(count.max(1));
    values.iter().map(|value| if value.is_finite() { value - mean } else { 0.0 }).collect()
}

impl Spectra {
    /// Probability that independent signals are as coherent as this at any of the frequencies that the simulation moves at. Elsewhere a simulation that was driven by a measured input holds little but that input's
    /// noise, which is in the error too. Every third line is taken, because the window couples neighbours.
    pub(crate) fn p_value(&self) -> f64 {
        let largest = self.simulated.iter().skip(2).copied().fold(0.0, f64::max);
        let lines =
            (2..self.coherence.len()).step_by(3).filter(|line| self.simulated[*line] > MOVED * largest);
        let (count, most) =
            lines.fold((0.0, 0.0_f64), |(count, most), line| (count + 1.0, most.max(self.coherence[line])));
        (coherence_p_value(most, self.freedom) * count).min(1.0)
    }

    /// Share of the error's power that a linear filter of the simulation explains, without what chance explains.
    pub(crate) fn linear_share(&self) -> f64 {
        let chance = 2.0 / self.freedom;
        let total: f64 = self.error.iter().skip(1).sum();
        let unbiased = |coherence: f64| ((coherence - chance) / (1.0 - chance)).clamp(0.0, 1.0);
        let linear: f64 = self.error.iter().zip(&self.coherence).skip(1).map(|(e, c)| e * unbiased(*c)).sum();
        if total > 0.0 { linear / total } else { 0.0 }
    }

    /// The narrowest band that holds half of the error's power, Hz.
    pub(crate) fn half_power_hz(&self) -> [f64; 2] {
        let total: f64 = self.error.iter().skip(1).sum();
        let (mut best, mut start, mut sum) = ([0.0, 0.0], 1, 0.0);
        let mut width = usize::MAX;
        for end in 1..self.error.len() {
            sum += self.error[end];
            while start < end && sum - self.error[start] >= 0.5 * total {
                sum -= self.error[start];
                start += 1;
            }
            if sum >= 0.5 * total && end - start < width {
                width = end - start;
                best = [self.frequency_hz[start], self.frequency_hz[end]];
            }
        }
        best
    }
}
