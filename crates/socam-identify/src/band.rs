//! Quality of a prediction within a band of frequencies. Drift below the band and hum above it do not count.

use socam_recording::Dataset;
use socam_spectrum::square_within;

use crate::{
    IdentifyError, Problem,
    optimiser::nuisance,
    prediction::replay::{Replay, replay},
};

/// A band of frequencies, including both ends.
///
/// ```
/// use socam_identify::Band;
///
/// let band = Band::new(1.0, 40.0)?;
/// assert_eq!((band.low_hz(), band.high_hz()), (1.0, 40.0));
/// assert!(Band::new(40.0, 1.0).is_err());
/// # Ok::<(), socam_identify::IdentifyError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    low_hz: f64,
    high_hz: f64,
}

/// Quality of one channel's prediction within a band.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BandFit {
    /// Root mean square of the residual within the band, SI.
    pub rms: f64,
    /// 100 (1 - norm of the residual / norm of the measured channel), both within the band.
    pub fit_percent: f64,
}

impl Band {
    /// Creates the band from `low_hz` to `high_hz`.
    ///
    /// # Errors
    /// When they are not finite, below zero, or the wrong way round.
    pub fn new(low_hz: f64, high_hz: f64) -> Result<Self, IdentifyError> {
        if low_hz >= 0.0 && low_hz < high_hz && high_hz.is_finite() {
            return Ok(Self { low_hz, high_hz });
        }
        Err(IdentifyError::Option(format!(
            "a band of {low_hz} to {high_hz} Hz cannot be meant; its lower end must be 0 or more and below its upper end"
        )))
    }

    fn ends_hz(self) -> [f64; 2] {
        [self.low_hz, self.high_hz]
    }

    /// Lower end, Hz.
    #[must_use]
    pub fn low_hz(self) -> f64 {
        self.low_hz
    }

    /// Upper end, Hz.
    #[must_use]
    pub fn high_hz(self) -> f64 {
        self.high_hz
    }

    /// Checks that half the sampling rate of every part of a recording is at least the upper end.
    ///
    /// ```
    /// use socam_identify::Band;
    ///
    /// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
    /// // The recording is sampled at 500 Hz.
    /// assert!(Band::new(0.0, 250.0)?.check(&recordings[0]).is_ok());
    /// assert!(Band::new(0.0, 300.0)?.check(&recordings[0]).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IdentifyError::Option`] when it is not.
    pub fn check(self, dataset: &Dataset) -> Result<(), IdentifyError> {
        let slowest_s = dataset.segments().iter().map(|segment| segment.sample_time_s).fold(0.0, f64::max);
        if 2.0 * self.high_hz * slowest_s <= 1.0 {
            return Ok(());
        }
        Err(IdentifyError::Option(format!(
            "the band goes up to {} Hz, but {} shows no more than {} Hz, half its sampling rate",
            self.high_hz,
            dataset.name(),
            (500.0 / slowest_s).round() / 1000.0,
        )))
    }
}

/// Quality of the simulation of recordings within a band, by a model with the parameter `values` (SI, all of them). As in
/// [`evaluate`](crate::evaluate), only start states and offsets are fitted to a recording. The result has one entry per output: its name,
/// and `None` where nothing was measured within the band.
///
/// ```
/// use socam_identify::{Band, Options, Problem, evaluate_band};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let problem = Problem::of_known(&model, &recordings, Options::default())?;
/// let channels = evaluate_band(&problem, &model.values(), Band::new(0.0, 50.0)?)?;
/// assert_eq!(channels[0].0, "motor_speed");
/// assert!(channels[0].1.as_ref().expect("a measured channel").rms < 0.07);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Method
/// The mean is removed from residual and measured channel, both are Fourier transformed over each uninterrupted segment, and the squared
/// lines within the band are summed: a zero-phase filter with ideal edges.
///
/// # Errors
/// When a recording cannot be read or is sampled too slowly for the band, or the prediction overflows.
pub fn evaluate_band(
    problem: &Problem<'_>,
    values: &[f64],
    band: Band,
) -> Result<Vec<(String, Option<BandFit>)>, IdentifyError> {
    for dataset in problem.datasets {
        band.check(dataset)?;
    }
    let nuisance = nuisance::fitted_nuisance(problem, values)?;
    let mut sums = vec![Sums::default(); problem.outputs()];
    for (index, nuisance) in nuisance.iter().enumerate() {
        let segment = &problem.segments[index];
        let Replay { measured, predicted, .. } =
            replay(problem, problem.model, values, segment, nuisance, &[])?;
        let sample_time_s = segment.sample_time_s;
        for ((sums, measured), predicted) in sums.iter_mut().zip(&measured).zip(&predicted) {
            sums.add_segment(band, sample_time_s, measured, predicted);
        }
    }
    let names = problem.model.outputs().map(|channel| channel.name.clone());
    Ok(names.zip(sums.iter().map(Sums::fit)).collect())
}

/// Sums over one channel: squares within the band, and samples.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    residual: f64,
    measured: f64,
    samples: usize,
}

impl Sums {
    fn add_segment(&mut self, band: Band, sample_time_s: f64, measured: &[f64], predicted: &[f64]) {
        let rows: Vec<usize> = (0..measured.len()).filter(|row| !measured[*row].is_nan()).collect();
        // Missing values divide the segment further.
        for part in rows.chunk_by(|row, next| row + 1 == *next) {
            let (first, rows) = (part[0], part.len());
            let measured = &measured[first..first + rows];
            let residual: Vec<f64> = measured.iter().zip(&predicted[first..]).map(|(m, p)| m - p).collect();
            self.residual += square_within(&residual, sample_time_s, band.ends_hz());
            self.measured += square_within(measured, sample_time_s, band.ends_hz());
            self.samples += rows;
        }
    }

    fn fit(&self) -> Option<BandFit> {
        (self.measured > 0.0).then(|| BandFit {
            rms: (self.residual / self.samples as f64).sqrt(),
            fit_percent: 100.0 * (1.0 - (self.residual / self.measured).sqrt()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tones of whole periods: frequency in Hz, amplitude.
    fn tones(rows: usize, tones: &[(f64, f64)]) -> Vec<f64> {
        let at = |t: f64| tones.iter().map(move |(hz, size)| size * (std::f64::consts::TAU * hz * t).cos());
        (0..rows).map(|row| at(row as f64 / 1000.0).sum()).collect()
    }

    #[test]
    fn only_what_lies_within_the_band_counts() {
        let band = Band::new(2.0, 80.0).unwrap();
        let measured = tones(5000, &[(0.0, 7.0), (1.0, 9.0), (2.0, 3.0), (80.0, 4.0), (500.0, 8.0)]);
        let predicted = tones(5000, &[(10.0, 1.0), (2.0, 3.0), (80.0, 4.0)]);
        let mut sums = Sums::default();
        sums.add_segment(band, 1e-3, &measured, &predicted);
        let fit = sums.fit().unwrap();
        assert!((fit.rms - 0.5_f64.sqrt()).abs() < 1e-9, "{fit:?}");
        assert!((fit.fit_percent - 80.0).abs() < 1e-9, "{fit:?}");
        assert!((square_within(&measured, 1e-3, [0.0, 500.0]) / 5000.0 - 117.0).abs() < 1e-9);
    }

    #[test]
    fn missing_values_divide_a_segment() {
        let band = Band::new(5.0, 400.0).unwrap();
        let mut measured = tones(2101, &[(20.0, 2.0)]);
        measured[1000] = f64::NAN;
        measured[2001..].fill(f64::NAN);
        let mut sums = Sums::default();
        sums.add_segment(band, 1e-3, &measured, &vec![0.0; 2101]);
        assert_eq!(sums.samples, 2000);
        let fit = sums.fit().unwrap();
        assert!((fit.rms - 2.0_f64.sqrt()).abs() < 1e-9 && fit.fit_percent.abs() < 1e-9, "{fit:?}");
        let mut nothing = Sums::default();
        nothing.add_segment(Band::new(1.0, 2.0).unwrap(), 1e-3, &measured[..300], &[0.0; 300]);
        assert_eq!(nothing.fit(), None);
    }

    #[test]
    fn a_band_has_its_ends_the_right_way_round() {
        for (low_hz, high_hz) in [(5.0, 5.0), (6.0, 5.0), (-1.0, 5.0), (f64::NAN, 5.0), (0.0, f64::INFINITY)]
        {
            assert!(Band::new(low_hz, high_hz).is_err(), "{low_hz} {high_hz}");
        }
    }
}
