//! Welch's method: spectra of overlapping windows, averaged.

use nalgebra::Complex;
use realfft::RealFftPlanner;

use crate::job::Handle;
use crate::samples::Samples;

/// Windows that are averaged at most, spread over the recording.
const WINDOWS: usize = 300;
const SHORTEST: usize = 64;
const LONGEST: usize = 1 << 15;

/// What is said where there are no windows.
pub(super) const TOO_SHORT: &str =
    "too short for a spectrum: it takes 64 samples without a gap or a missing value";

/// Averaged spectra of all channels, and of each together with the input.
pub(super) struct Welch {
    step_hz: f64,
    /// Two-sided sums of squares per channel and line.
    power: Vec<Vec<f64>>,
    cross: Vec<Vec<Complex<f64>>>,
    input: usize,
    /// From sums to densities.
    scale: f64,
}

pub(super) fn welch(samples: &Samples, input: usize, handle: &Handle) -> Result<Welch, String> {
    let channels = samples.channels();
    let longest = samples.segments().iter().map(|segment| segment.rows as usize).max().unwrap_or(0);
    // About eight windows where there are few samples.
    let length = (longest / 4).next_power_of_two().clamp(SHORTEST, LONGEST);
    let length = if length > longest { longest.next_power_of_two() / 2 } else { length };
    if length < SHORTEST || input >= channels {
        return Err(TOO_SHORT.into());
    }
    let mut starts = Vec::new();
    for segment in samples.segments() {
        let (first, rows) = (segment.first_row as usize, segment.rows as usize);
        starts.extend(
            (0..=rows.saturating_sub(length))
                .step_by(length / 2)
                .filter(|_| rows >= length)
                .map(|s| first + s),
        );
    }
    let every = starts.len().div_ceil(WINDOWS).max(1);
    let starts: Vec<usize> = starts.into_iter().step_by(every).collect();
    let step_s = samples.segments().iter().map(|segment| segment.sample_time_s).fold(0.0, f64::max);
    let window: Vec<f64> = (0..length)
        .map(|n| 0.5 - 0.5 * (std::f64::consts::TAU * (n as f64 + 0.5) / length as f64).cos())
        .collect();
    let lines = length / 2 + 1;
    let mut result = Welch {
        step_hz: 1.0 / (length as f64 * step_s),
        power: vec![vec![0.0; lines]; channels],
        cross: vec![vec![Complex::new(0.0, 0.0); lines]; channels],
        input,
        scale: 0.0,
    };
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let mut used = 0;
    for (done, start) in starts.iter().enumerate() {
        handle.reached(done as f32 / starts.len() as f32)?;
        let mut spectra = Vec::with_capacity(channels);
        for channel in 0..channels {
            let mut values = samples.values(channel, *start..start + length);
            let mean = values.iter().sum::<f64>() / length as f64;
            values.iter_mut().zip(&window).for_each(|(value, weight)| *value = (*value - mean) * weight);
            let mut spectrum = fft.make_output_vec();
            fft.process(&mut values, &mut spectrum).map_err(|error| error.to_string())?;
            spectra.push(spectrum);
        }
        // A missing value makes its whole window one.
        let whole = |spectrum: &Vec<Complex<f64>>| spectrum[0].re.is_finite();
        if !whole(&spectra[input]) {
            continue;
        }
        used += 1;
        for (channel, spectrum) in spectra.iter().enumerate().filter(|(_, spectrum)| whole(spectrum)) {
            for (line, value) in spectrum.iter().enumerate() {
                result.power[channel][line] += value.norm_sqr();
                result.cross[channel][line] += spectra[input][line].conj() * value;
            }
        }
    }
    if used == 0 {
        return Err(TOO_SHORT.into());
    }
    let weight: f64 = window.iter().map(|weight| weight * weight).sum();
    result.scale = 2.0 * step_s / (weight * f64::from(used));
    Ok(result)
}

impl Welch {
    pub(super) fn frequency_hz(&self, line: usize) -> f64 {
        line as f64 * self.step_hz
    }

    pub(super) fn highest_hz(&self) -> f64 {
        self.frequency_hz(self.power.first().map_or(0, Vec::len).saturating_sub(1))
    }

    /// Amplitude spectral density of a channel.
    pub(super) fn density(&self, channel: usize) -> Vec<[f64; 2]> {
        let power = self.power[channel].iter().enumerate().skip(1);
        power.map(|(line, power)| [self.frequency_hz(line), (power * self.scale).sqrt()]).collect()
    }

    /// Magnitude, phase in degrees and coherence of a channel over the input; the first two where they are coherent at least
    /// so much.
    pub(super) fn response(&self, channel: usize, coherent: f64) -> [Vec<Vec<[f64; 2]>>; 3] {
        let mut magnitude = Vec::new();
        let mut phase = Vec::new();
        let mut coherence = Vec::new();
        for line in 1..self.power[channel].len() {
            let (input, output, cross) =
                (self.power[self.input][line], self.power[channel][line], self.cross[channel][line]);
            if input <= 0.0 || output <= 0.0 {
                continue;
            }
            let frequency = self.frequency_hz(line);
            let share = cross.norm_sqr() / (input * output);
            coherence.push([frequency, share]);
            let there = share >= coherent;
            magnitude.push([frequency, if there { cross.norm() / input } else { f64::NAN }]);
            phase.push([frequency, if there { cross.arg().to_degrees() } else { f64::NAN }]);
        }
        let parts = |line: &[[f64; 2]]| -> Vec<Vec<[f64; 2]>> {
            line.split(|point| point[1].is_nan()).filter(|part| !part.is_empty()).map(<[_]>::to_vec).collect()
        };
        let phase = parts(&phase).iter().flat_map(|part| unjoined(part)).collect();
        [parts(&magnitude), phase, vec![coherence]]
    }
}

/// A phase in parts: where it wraps from one end to the other there is no line.
pub(super) fn unjoined(phase: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    phase.chunk_by(|a, b| (a[1] - b[1]).abs() < 180.0).map(<[[f64; 2]]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::{Channel, Dataset, Unit};

    #[test]
    fn a_gain_with_a_delay_has_its_response_and_white_noise_its_density() {
        let (rows, step_s, std) = (100_000, 1e-3, 0.7);
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let input: Vec<f64> = (0..rows).map(|_| std * 12_f64.sqrt() * next()).collect();
        let output: Vec<f64> =
            (0..rows).map(|n: usize| if n < 3 { 0.0 } else { 2.5 * input[n - 3] }).collect();
        let time_s: Vec<f64> = (0..rows).map(|n| n as f64 * step_s).collect();
        let channels = vec![Channel::new("u", Unit::V), Channel::new("y", Unit::V)];
        let data = Dataset::from_columns("r", channels, time_s.clone(), vec![input.clone(), output.clone()])
            .unwrap();
        let samples = Samples::in_memory(time_s, &[input, output], data.segments().to_vec());
        let welch = welch(&samples, 0, &Handle::default()).unwrap();
        let density = welch.density(0);
        let middle = density.iter().map(|point| point[1].powi(2)).sum::<f64>() / density.len() as f64;
        assert!((middle.sqrt() / (std * (2.0 * step_s).sqrt()) - 1.0).abs() < 0.02, "{middle}");
        let [magnitude, phase, coherence] = welch.response(1, 0.5);
        let at = |line: &[Vec<[f64; 2]>]| {
            *line.iter().flatten().min_by(|a, b| (a[0] - 50.0).abs().total_cmp(&(b[0] - 50.0).abs())).unwrap()
        };
        assert!((at(&magnitude)[1] - 2.5).abs() < 0.05);
        let expected = -360.0 * at(&phase)[0] * 3e-3;
        assert!((at(&phase)[1] - expected).abs() < 2.0, "{:?} {expected}", at(&phase));
        assert!(at(&coherence)[1] > 0.99);
    }

    #[test]
    fn what_is_too_short_says_so() {
        let samples = Samples::in_memory(vec![0.0], &[vec![1.0]], Vec::new());
        assert_eq!(super::welch(&samples, 0, &Handle::default()).err().as_deref(), Some(TOO_SHORT));
    }
}
