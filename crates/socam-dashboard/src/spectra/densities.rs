//! Power densities of a recording's channels, by Welch's method.

use socam_samples::Samples;
use socam_spectrum::{Spectra, Welch};
use socam_workbench::job::Handle;

/// Greatest number of averaged windows, spread over the recording.
const WINDOWS: usize = 300;
const SHORTEST: usize = 64;
const LONGEST: usize = 1 << 15;

/// Text for a recording without windows.
pub(super) const TOO_SHORT: &str =
    "too short for a spectrum: it takes 64 samples without a gap or a missing value";

/// Spectra of all channels; `None` for a channel without a whole window.
pub(super) type Densities = Vec<Option<Spectra>>;

/// # Errors
/// When no channel has a whole window, or the job was cancelled; one sentence.
pub(super) fn densities(samples: &Samples, handle: &Handle) -> Result<Densities, String> {
    let longest = samples.segments().iter().map(|segment| segment.rows as usize).max().unwrap_or(0);
    // Eight windows or more, so that their mean is smooth; fewer only where there are few samples.
    let length = (1_usize << (longest / 4).max(1).ilog2()).clamp(SHORTEST, LONGEST);
    let mut welch: Vec<Welch> = (0..samples.channels()).map(|_| Welch::new(length)).collect();
    let starts = starts(samples, length);
    for (done, start) in starts.iter().enumerate() {
        handle.reached(done as f32 / starts.len() as f32)?;
        for (channel, welch) in welch.iter_mut().enumerate() {
            welch.add([&samples.values(channel, *start..start + length)]);
        }
    }
    let step_s = samples.segments().iter().map(|segment| segment.sample_time_s).fold(0.0, f64::max);
    let densities: Densities = welch.iter_mut().map(|welch| welch.finish(step_s)).collect();
    if densities.iter().all(Option::is_none) { Err(TOO_SHORT.into()) } else { Ok(densities) }
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

/// Amplitude spectral density over frequency, Hz, without the mean.
pub(super) fn amplitudes(spectra: &Spectra) -> Vec<[f64; 2]> {
    let density = spectra.density(0).into_iter().enumerate().skip(1);
    density.map(|(line, density)| [spectra.frequency_hz(line), density.sqrt()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::{Channel, Dataset, Unit};

    #[test]
    fn white_noise_has_its_density_and_a_channel_with_missing_values_has_none_there() {
        let (rows, step_s, std) = (100_000, 1e-3, 0.7);
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let noise: Vec<f64> = (0..rows).map(|_| std * 12_f64.sqrt() * next()).collect();
        // Half of the second channel's values are missing: its density is the same.
        let half = |(n, value): (usize, &f64)| if n < rows / 2 { f64::NAN } else { *value };
        let columns = [noise.clone(), noise.iter().enumerate().map(half).collect()];
        let time_s: Vec<f64> = (0..rows).map(|n| n as f64 * step_s).collect();
        let channels = vec![Channel::new("u", Unit::V), Channel::new("y", Unit::V)];
        let data = Dataset::from_columns("r", channels, time_s.clone(), columns.to_vec()).unwrap();
        let samples = Samples::in_memory(time_s, &columns, data.segments().to_vec());
        for spectra in densities(&samples, &Handle::default()).unwrap() {
            let line = amplitudes(&spectra.unwrap());
            let mean = line.iter().map(|point| point[1].powi(2)).sum::<f64>() / line.len() as f64;
            assert!((mean.sqrt() / (std * (2.0 * step_s).sqrt()) - 1.0).abs() < 0.02, "{mean}");
        }
    }

    #[test]
    fn what_is_too_short_says_so() {
        let samples = Samples::in_memory(vec![0.0], &[vec![1.0]], Vec::new());
        assert_eq!(densities(&samples, &Handle::default()).err().as_deref(), Some(TOO_SHORT));
    }
}
