//! Power densities and coherence, over segments without overlap so that their distribution is known.

use socam_recording::Welch;

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
    pub(crate) segments: usize,
    /// Power density of the simulation.
    simulated: Vec<f64>,
}

/// Spectra of evenly sampled values; missing ones are replaced by the mean.
pub(crate) fn spectra(step_s: f64, measured: &[f64], simulated: &[f64]) -> Spectra {
    let n = measured.len();
    let segments = (n / 64).clamp(FEWEST_SEGMENTS, MOST_SEGMENTS);
    let length = (n / segments).max(8);
    let error: Vec<f64> = measured.iter().zip(simulated).map(|(a, b)| a - b).collect();
    let (measured, simulated, error) = (centred(measured), centred(simulated), centred(&error));
    let mut welch = Welch::new(length);
    let lines = welch.lines();
    let mut sums = vec![[0.0; 5]; lines];
    for segment in 0..segments {
        let range = segment * length..(segment + 1) * length;
        let mut lines_of = |values: &[f64]| {
            let part = &values[range.clone()];
            let mean = part.iter().sum::<f64>() / length as f64;
            welch.transform(part.iter().map(|value| value - mean)).to_vec()
        };
        let (y, s, e) = (lines_of(&measured), lines_of(&simulated), lines_of(&error));
        for (line, sum) in sums.iter_mut().enumerate() {
            let cross = e[line] * s[line].conj();
            let parts = [y[line].norm_sqr(), s[line].norm_sqr(), e[line].norm_sqr(), cross.re, cross.im];
            sum.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        }
    }
    let density = welch.density_per_sum(step_s, segments as u64);
    let step_hz = welch.step_hz(step_s);
    let mut spectra = Spectra { segments, ..Spectra::default() };
    for (line, [y, s, e, re, im]) in sums.into_iter().enumerate() {
        spectra.frequency_hz.push(step_hz * line as f64);
        spectra.measured.push(y * density);
        spectra.error.push(e * density);
        spectra.simulated.push(s * density);
        spectra.coherence.push(if s * e > 0.0 { (re * re + im * im) / (s * e) } else { 0.0 });
    }
    spectra
}

fn centred(values: &[f64]) -> Vec<f64> {
    let held = values.iter().filter(|value| value.is_finite());
    let (sum, count) = held.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    let mean = sum / f64::from(count.max(1));
    values.iter().map(|value| if value.is_finite() { value - mean } else { 0.0 }).collect()
}

impl Spectra {
    /// Probability that independent signals are as coherent as this at any of the frequencies that the simulation moves at (Goodman, 1957:
    /// (1 - c)^(segments - 1) at one of them). Elsewhere a simulation that was driven by a measured input holds little but that input's
    /// noise, which is in the error too. Every third line is taken, because the window couples neighbours.
    pub(crate) fn p_value(&self) -> f64 {
        let largest = self.simulated.iter().skip(2).copied().fold(0.0, f64::max);
        let lines =
            (2..self.coherence.len()).step_by(3).filter(|line| self.simulated[*line] > MOVED * largest);
        let lines: Vec<f64> = lines.map(|line| self.coherence[line].min(1.0)).collect();
        let most = lines.iter().copied().fold(0.0, f64::max);
        let one = (1.0 - most).powi(self.segments as i32 - 1);
        (one * lines.len() as f64).min(1.0)
    }

    /// Share of the error's power that a linear filter of the simulation explains, without what chance explains.
    pub(crate) fn linear_share(&self) -> f64 {
        let chance = 1.0 / self.segments as f64;
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
