//! Power densities of a recording's channels, by Welch's method.

use std::ops::Range;

use socam_chart::numbers::{significant, trimmed};
use socam_samples::Samples;
use socam_spectrum::{Detrend, Spectra, Welch};
use socam_workbench::job::Handle;
use socam_workbench::spectrum_settings::{SHORTEST, Scaling, SpectrumSettings};

/// Greatest number of averaged windows, spread over the recording.
const WINDOWS: usize = 300;
/// Longest segment that is chosen by the length of the recording.
const LONGEST: usize = 1 << 15;

/// Text for a recording without windows.
pub(super) const TOO_SHORT: &str =
    "too short for a spectrum: it takes 64 samples without a gap or a missing value";

/// Spectra of all channels; `None` for a channel without a whole window.
pub(super) type Densities = Vec<Option<Spectra>>;

/// What spectra are made of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Part {
    /// Range of the recording's own time, s; `None` is the whole recording.
    range_s: Option<[f64; 2]>,
    /// How they are made; scales do not count.
    settings: SpectrumSettings,
}

impl Part {
    /// What is made of a recording that is drawn `shift_s` later, while the view over time has a range in sight.
    pub(super) fn of(settings: SpectrumSettings, in_sight: Option<[f64; 2]>, shift_s: f64) -> Self {
        let range_s = in_sight.filter(|_| settings.in_sight).map(|range| range.map(|time| time - shift_s));
        Self {
            range_s,
            settings: SpectrumSettings { scaling: Scaling::default(), in_sight: false, ..settings },
        }
    }

    /// Words on the range, to be put before others; empty for a whole recording.
    pub(super) fn words(&self) -> String {
        let words = |[from, to]: [f64; 2]| format!("{} s to {} s: ", trimmed(from), trimmed(to));
        self.range_s.map_or_else(String::new, words)
    }
}

/// # Errors
/// When no channel has a whole window, or the job was cancelled; one sentence.
pub(super) fn densities(samples: &Samples, part: Part, handle: &Handle) -> Result<Densities, String> {
    let runs = runs(samples, part.range_s);
    let longest = runs.iter().map(Range::len).max().unwrap_or(0);
    // Eight windows or more, so that their mean is smooth; fewer only where there are few samples.
    let usual = || (1_usize << (longest / 4).max(1).ilog2()).clamp(SHORTEST, LONGEST);
    let length = part.settings.length.unwrap_or_else(usual);
    let mut welch: Vec<Welch> = (0..samples.channels()).map(|_| part.settings.welch(length)).collect();
    let hop = welch.first().map_or(length, Welch::hop);
    let starts = starts(&runs, length, hop);
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

/// Rows without a gap, those of a range of time.
fn runs(samples: &Samples, range_s: Option<[f64; 2]>) -> Vec<Range<usize>> {
    let [first, end] = match range_s {
        Some([from, to]) => [samples.row_at(from), samples.row_at(to.next_up())],
        None => [0, samples.rows()],
    };
    let run = |segment: &socam_recording::Segment| {
        (segment.first_row as usize).max(first)..(segment.end_row() as usize).min(end)
    };
    samples.segments().iter().map(run).filter(|run| !run.is_empty()).collect()
}

/// First rows of windows of one length, `hop` rows apart, that do not cross gaps.
fn starts(runs: &[Range<usize>], length: usize, hop: usize) -> Vec<usize> {
    let mut starts = Vec::new();
    for run in runs.iter().filter(|run| run.len() >= length) {
        starts.extend((run.start..=run.end - length).step_by(hop));
    }
    let every = starts.len().div_ceil(WINDOWS).max(1);
    starts.into_iter().step_by(every).collect()
}

/// How they were made, how smooth they are, and how fine.
pub(super) fn remark(spectra: &Spectra, settings: &SpectrumSettings) -> String {
    let removed = match settings.detrend {
        Detrend::Nothing => "",
        Detrend::Mean => ", mean removed",
        Detrend::Line => ", straight line removed",
    };
    format!(
        "{} window of {} s, {} averaged{removed}: resolution {} Hz",
        settings.window.name(),
        trimmed(1.0 / spectra.step_hz()),
        socam_plot::words::counted(spectra.segments() as usize, "window", "windows"),
        significant(spectra.step_hz(), 3)
    )
}

/// A spectrum over frequency, Hz, without the mean, of a channel that is shown in a unit with so many per SI unit.
pub(super) fn line(spectra: &Spectra, scaling: Scaling, per_si: f64) -> Vec<[f64; 2]> {
    let shown = |value: f64| match scaling {
        Scaling::Density | Scaling::Amplitude => per_si * value,
        Scaling::Decibel => value + 20.0 * per_si.log10(),
    };
    let values = scaling.values(spectra).into_iter().enumerate().skip(1);
    values.map(|(line, value)| [spectra.frequency_hz(line), shown(value)]).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

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
        for spectra in densities(&samples, Part::default(), &Handle::default()).unwrap() {
            let line = line(&spectra.unwrap(), Scaling::Density, 1.0);
            let mean = line.iter().map(|point| point[1].powi(2)).sum::<f64>() / line.len() as f64;
            assert!((mean.sqrt() / (std * (2.0 * step_s).sqrt()) - 1.0).abs() < 0.02, "{mean}");
        }
    }

    #[test]
    fn what_is_too_short_says_so() {
        let samples = Samples::in_memory(vec![0.0], &[vec![1.0]], Vec::new());
        assert_eq!(
            densities(&samples, Part::default(), &Handle::default()).err().as_deref(),
            Some(TOO_SHORT)
        );
    }

    /// A sine of amplitude 3 in the second half only: the range decides what is seen, and the length what is told apart.
    #[test]
    fn a_range_and_a_length_are_those_that_were_asked_for() {
        let (rows, step_s) = (20_000, 1e-3);
        let value =
            |row: usize| if row < rows / 2 { 0.0 } else { 3.0 * (TAU * 50.0 * row as f64 * step_s).sin() };
        let (time_s, values) =
            (0..rows).map(|row| (row as f64 * step_s, value(row))).unzip::<_, _, Vec<_>, Vec<_>>();
        let data = Dataset::from_columns(
            "r",
            vec![Channel::new("u", Unit::V)],
            time_s.clone(),
            vec![values.clone()],
        );
        let samples = Samples::in_memory(time_s, &[values], data.unwrap().segments().to_vec());
        let at_50_hz = |range_s: [f64; 2]| {
            let settings =
                SpectrumSettings { length: Some(1000), in_sight: true, ..SpectrumSettings::default() };
            // It is drawn 2 s later than it is.
            let part = Part::of(settings, Some(range_s.map(|time| time + 2.0)), 2.0);
            let all = densities(&samples, part, &Handle::default()).unwrap();
            let spectra = all[0].as_ref().unwrap();
            assert!((spectra.step_hz() - 1.0).abs() < 1e-9);
            // Doubled, an amplitude has 6.02 dB more.
            let [once, twice] = [1.0, 2.0].map(|per_si| line(spectra, Scaling::Decibel, per_si)[49][1]);
            assert!((twice - once - 6.0206).abs() < 1e-3, "{once} {twice}");
            line(spectra, Scaling::Amplitude, 1.0)[49]
        };
        let [frequency_hz, amplitude] = at_50_hz([10.0, 20.0]);
        assert!((frequency_hz - 50.0).abs() < 1e-9 && (amplitude - 3.0).abs() < 0.01, "{amplitude}");
        assert!(at_50_hz([0.0, 9.0])[1] < 1e-6);
    }
}
