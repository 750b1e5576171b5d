//! Welch's spectra of a recording's channels, and cross spectra with the input.

use nalgebra::Complex;
use socam_recording::{Welch, without_mean};

use socam_samples::Samples;
use socam_workbench::job::Handle;

/// Greatest number of averaged windows, spread over the recording.
const WINDOWS: usize = 300;
const SHORTEST: usize = 64;
const LONGEST: usize = 1 << 15;

/// Text for a recording without windows.
pub(super) const TOO_SHORT: &str =
    "too short for a spectrum: it takes 64 samples without a gap or a missing value";

/// Averaged spectra of all channels, and of each together with the input.
pub(super) struct Spectra {
    step_hz: f64,
    /// Two-sided sums of squares per channel and line.
    power: Vec<Vec<f64>>,
    cross: Vec<Vec<Complex<f64>>>,
    input: usize,
    windows: u64,
    /// Factor from sums to densities.
    scale: f64,
}

/// Frequency response, output over input.
pub(super) struct Response {
    /// Magnitude where the coherence is significant, in parts.
    pub(super) magnitude: Vec<Vec<[f64; 2]>>,
    /// Phase, degrees, in the same parts and interrupted where it wraps.
    pub(super) phase: Vec<Vec<[f64; 2]>>,
    /// Coherence at all frequencies.
    pub(super) coherence: Vec<[f64; 2]>,
}

/// First rows of windows of one length; they overlap by half and do not cross gaps.
fn starts(samples: &Samples, length: usize) -> Vec<usize> {
    let mut starts = Vec::new();
    for segment in samples.segments().iter().filter(|segment| segment.rows as usize >= length) {
        let (first, rows) = (segment.first_row as usize, segment.rows as usize);
        starts.extend((0..=rows - length).step_by(length / 2).map(|start| first + start));
    }
    let every = starts.len().div_ceil(WINDOWS).max(1);
    starts.into_iter().step_by(every).collect()
}

pub(super) fn spectra(samples: &Samples, input: usize, handle: &Handle) -> Result<Spectra, String> {
    let channels = samples.channels();
    let longest = samples.segments().iter().map(|segment| segment.rows as usize).max().unwrap_or(0);
    if longest < SHORTEST || input >= channels {
        return Err(TOO_SHORT.into());
    }
    // Eight windows or more, so that coherence tells something; fewer only where there are few samples.
    let length = (1_usize << (longest / 4).max(1).ilog2()).clamp(SHORTEST, LONGEST);
    let mut welch = Welch::new(length);
    let step_s = samples.segments().iter().map(|segment| segment.sample_time_s).fold(0.0, f64::max);
    let mut result = Spectra {
        step_hz: welch.step_hz(step_s),
        power: vec![vec![0.0; welch.lines()]; channels],
        cross: vec![vec![Complex::new(0.0, 0.0); welch.lines()]; channels],
        input,
        windows: 0,
        scale: 0.0,
    };
    let starts = starts(samples, length);
    for (done, start) in starts.iter().enumerate() {
        handle.reached(done as f32 / starts.len() as f32)?;
        let mut transformed = |channel: usize| {
            let values = samples.values(channel, *start..start + length);
            welch.transform(without_mean(&values)).to_vec()
        };
        let lines: Vec<Vec<Complex<f64>>> = (0..channels).map(&mut transformed).collect();
        // A window with a missing value is skipped.
        let whole = |lines: &Vec<Complex<f64>>| lines[0].re.is_finite();
        if !whole(&lines[input]) {
            continue;
        }
        result.windows += 1;
        for (channel, own) in lines.iter().enumerate().filter(|(_, own)| whole(own)) {
            for (line, value) in own.iter().enumerate() {
                result.power[channel][line] += value.norm_sqr();
                result.cross[channel][line] += lines[input][line].conj() * value;
            }
        }
    }
    if result.windows == 0 {
        return Err(TOO_SHORT.into());
    }
    result.scale = welch.density_per_sum(step_s, result.windows);
    Ok(result)
}

impl Spectra {
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

    /// The coherence that two signals which have nothing to do with each other reach on one line in ten such pictures, from what
    /// Carter, Knapp and Nuttall (IEEE Trans. Audio Electroacoust. 21, 1973) say of independent windows; half overlapping ones count
    /// a little less.
    pub(super) fn chance(&self) -> f64 {
        let independent = self.windows as f64 / 1.056;
        let lines = self.power.first().map_or(1, Vec::len) as f64;
        if independent > 1.0 { 1.0 - (0.1 / lines).powf(1.0 / (independent - 1.0)) } else { 1.0 }
    }

    /// The response of a channel to the input.
    pub(super) fn response(&self, channel: usize) -> Response {
        let chance = self.chance();
        let (mut magnitude, mut phase, mut coherence) = (Vec::new(), Vec::new(), Vec::new());
        for line in 1..self.power[channel].len() {
            let (input, output, cross) =
                (self.power[self.input][line], self.power[channel][line], self.cross[channel][line]);
            if input <= 0.0 || output <= 0.0 {
                continue;
            }
            let frequency = self.frequency_hz(line);
            let share = cross.norm_sqr() / (input * output);
            coherence.push([frequency, share]);
            let there = share > chance;
            magnitude.push([frequency, if there { cross.norm() / input } else { f64::NAN }]);
            phase.push([frequency, if there { cross.arg().to_degrees() } else { f64::NAN }]);
        }
        let phase = parts(&phase).iter().flat_map(|part| unjoined(part)).collect();
        Response { magnitude: parts(&magnitude), phase, coherence }
    }
}

/// Ranges without missing values.
fn parts(line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    line.split(|point| point[1].is_nan()).filter(|part| !part.is_empty()).map(<[_]>::to_vec).collect()
}

/// A phase in parts that end where it wraps.
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
        let spectra = spectra(&samples, 0, &Handle::default()).unwrap();
        let density = spectra.density(0);
        let middle = density.iter().map(|point| point[1].powi(2)).sum::<f64>() / density.len() as f64;
        assert!((middle.sqrt() / (std * (2.0 * step_s).sqrt()) - 1.0).abs() < 0.02, "{middle}");
        let Response { magnitude, phase, coherence } = spectra.response(1);
        let coherence = [coherence];
        let at = |line: &[Vec<[f64; 2]>]| {
            *line.iter().flatten().min_by(|a, b| (a[0] - 50.0).abs().total_cmp(&(b[0] - 50.0).abs())).unwrap()
        };
        assert!((at(&magnitude)[1] - 2.5).abs() < 0.05);
        let expected = -360.0 * at(&phase)[0] * 3e-3;
        assert!((at(&phase)[1] - expected).abs() < 2.0, "{:?} {expected}", at(&phase));
        assert!(at(&coherence)[1] > 0.99);
    }

    #[test]
    fn signals_that_have_nothing_to_do_with_each_other_have_no_response() {
        let mut state = 3_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let mut drawn = 0;
        for _ in 0..20 {
            let columns: Vec<Vec<f64>> = (0..2).map(|_| (0..9000).map(|_| next()).collect()).collect();
            let time_s: Vec<f64> = (0..9000).map(|n| f64::from(n) * 1e-3).collect();
            let channels = vec![Channel::new("u", Unit::V), Channel::new("y", Unit::V)];
            let data = Dataset::from_columns("r", channels, time_s.clone(), columns.clone()).unwrap();
            let samples = Samples::in_memory(time_s, &columns, data.segments().to_vec());
            let spectra = spectra(&samples, 0, &Handle::default()).unwrap();
            assert!((0.5..0.95).contains(&spectra.chance()), "{}", spectra.chance());
            drawn += usize::from(!spectra.response(1).magnitude.is_empty());
        }
        assert!(drawn <= 6, "{drawn} of 20 pictures have stray points; two are expected");
    }

    #[test]
    fn what_is_too_short_says_so() {
        let samples = Samples::in_memory(vec![0.0], &[vec![1.0]], Vec::new());
        assert_eq!(super::spectra(&samples, 0, &Handle::default()).err().as_deref(), Some(TOO_SHORT));
    }
}
