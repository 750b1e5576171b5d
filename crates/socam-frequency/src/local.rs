//! The local polynomial method: near each line, response and transient are parabolas over a few bins.
//!
//! The transient of a segment (its leakage) is as smooth over frequency as the frequency response, and is estimated together with it.
//! Segments share the response and have transients of their own, so that recordings of any length and with gaps are combined.

use nalgebra::{Complex, DMatrix};
use socam_spectrum::transform;

use crate::{least_squares, lines::Line};

type C = Complex<f64>;

/// Bins to either side of a line: 17 bins less 6 coefficients leave 11 degrees of freedom.
const REACH: usize = 8;
/// Coefficients of a parabola.
const PARABOLA: usize = 3;
/// Greatest variance of a response relative to that of a plain mean over its bins. Noise as excitation gives about 3; lines that are
/// farther apart than the window do not determine parabolas.
const MOST_WIDENED: f64 = 20.0;
/// Power relative to that of the strongest bin below which a bin holds rounding errors only.
const ROUNDING: f64 = 1e-22;
/// Least number of samples: fewer have no line at this distance from both ends.
pub(crate) const SHORTEST: usize = 8 * REACH;

/// The Fourier transform of a segment without gaps.
pub(crate) struct Segment {
    step_hz: f64,
    /// The reference signal, free of noise; `None` if only the measured input is known.
    reference: Option<Vec<C>>,
    input: Vec<C>,
    output: Vec<C>,
    /// Factor that makes transforms of different lengths comparable.
    scale: f64,
    /// Power of the strongest bin of the excitation, including the mean.
    strongest: f64,
}

impl Segment {
    pub(crate) fn new(input: &[f64], output: &[f64], reference: Option<&[f64]>, sample_time_s: f64) -> Self {
        let reference = reference.map(transform);
        let input_lines = transform(input);
        let drive = reference.as_ref().unwrap_or(&input_lines);
        Self {
            step_hz: 1.0 / (input.len() as f64 * sample_time_s),
            strongest: drive.iter().map(C::norm_sqr).fold(0.0, f64::max),
            reference,
            input: input_lines,
            output: transform(output),
            scale: 1.0 / (input.len() as f64).sqrt(),
        }
    }

    /// The bins nearest to a frequency, without bin 0; `None` if the frequency is outside.
    fn bins(&self, frequency_hz: f64) -> Option<std::ops::Range<usize>> {
        let centre = (frequency_hz / self.step_hz).round() as usize;
        if centre < 1 || centre + REACH >= self.input.len() {
            return None;
        }
        let first = centre.saturating_sub(REACH).max(1);
        Some(first..first + 2 * REACH + 1)
    }

    pub(crate) fn lowest_hz(&self) -> f64 {
        self.step_hz
    }
}

/// Bins of a segment.
type Bins<'a> = (&'a Segment, std::ops::Range<usize>);

/// Local-polynomial estimate at one frequency; `None` if the input has no power there.
pub(crate) fn line(segments: &[Segment], frequency_hz: f64) -> Option<Line> {
    let seen: Vec<Bins<'_>> = segments.iter().filter_map(|s| Some((s, s.bins(frequency_hz)?))).collect();
    let rows: usize = seen.iter().map(|(_, bins)| bins.len()).sum();
    if rows == 0 {
        return None;
    }
    let reach_hz = seen.iter().map(|(s, _)| s.step_hz).fold(0.0, f64::max) * REACH as f64;
    let (design, wanted) = equations(&seen, frequency_hz, reach_hz);
    let columns = design.ncols();
    let strongest = seen.iter().map(|(s, _)| s.strongest * s.scale * s.scale).fold(0.0, f64::max);
    let drive_power = (0..rows).map(|i| design[(i, 0)].norm_sqr()).sum::<f64>() / rows as f64;
    if drive_power <= ROUNDING * strongest {
        return None;
    }
    let solved = least_squares::complex(&design, &wanted)?;
    if solved.first_variance * drive_power * rows as f64 > MOST_WIDENED {
        return None;
    }
    let freedom = (rows - columns) as f64;
    let indirect = segments.iter().all(|s| s.reference.is_some());
    // With a reference, the response is that from the reference to the output divided by that from the reference to the input
    // (indirect method).
    let (response, through) = if indirect {
        (solved.unknowns[(0, 0)] / solved.unknowns[(0, 1)], solved.unknowns[(0, 1)])
    } else {
        (solved.unknowns[(0, 0)], C::new(1.0, 0.0))
    };
    let noise_of = |error: &dyn Fn(usize) -> C| (0..rows).map(|i| error(i).norm_sqr()).sum::<f64>() / freedom;
    let output_noise = noise_of(&|i| solved.residuals[(i, 0)]);
    let input_noise = noise_of(&|i| solved.residuals[(i, 1)]);
    let noise = if indirect {
        noise_of(&|i| solved.residuals[(i, 0)] - response * solved.residuals[(i, 1)])
    } else {
        output_noise
    };
    let coherence = if indirect {
        coherent(solved.unknowns[(0, 0)], drive_power, output_noise)
            * coherent(through, drive_power, input_noise)
    } else {
        coherent(response, drive_power, output_noise)
    };
    let variance = noise * solved.first_variance / through.norm_sqr();
    (response.re.is_finite() && response.im.is_finite() && variance.is_finite()).then_some(Line {
        frequency_hz,
        response,
        variance,
        freedom,
        width_hz: 2.0 * reach_hz,
        coherence,
    })
}

/// Linear equations for the parabolas of the response and of each segment's transient near a frequency; right-hand sides: output, input.
fn equations(seen: &[Bins<'_>], frequency_hz: f64, reach_hz: f64) -> (DMatrix<C>, DMatrix<C>) {
    let rows: usize = seen.iter().map(|(_, bins)| bins.len()).sum();
    let columns = PARABOLA * (1 + seen.len());
    let mut design = DMatrix::from_element(rows, columns, C::default());
    let mut wanted = DMatrix::from_element(rows, 2, C::default());
    let mut row = 0;
    for (own, (segment, bins)) in seen.iter().enumerate() {
        for bin in bins.clone() {
            let x = (bin as f64 * segment.step_hz - frequency_hz) / reach_hz;
            let drive = segment.reference.as_ref().unwrap_or(&segment.input)[bin] * segment.scale;
            for (power, factor) in [1.0, x, x * x].into_iter().enumerate() {
                design[(row, power)] = drive * factor;
                design[(row, PARABOLA * (1 + own) + power)] = C::new(factor, 0.0);
            }
            wanted[(row, 0)] = segment.output[bin] * segment.scale;
            wanted[(row, 1)] = segment.input[bin] * segment.scale;
            row += 1;
        }
    }
    (design, wanted)
}

/// Share of signal in the power of signal and noise.
fn coherent(gain: C, drive_power: f64, noise: f64) -> f64 {
    let signal = gain.norm_sqr() * drive_power;
    if signal > 0.0 { signal / (signal + noise) } else { 0.0 }
}
