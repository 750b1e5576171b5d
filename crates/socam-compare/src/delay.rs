//! Delay, gain and offset of a recording against its simulation.

use crate::estimate::Estimate;
use crate::pair::{Pair, interpolated, rms, slope};
use crate::regression;

/// Largest delay that is looked for, as a share of the recording and in seconds.
const LARGEST_DELAY: (f64, f64) = (0.1, 0.5);

/// Delay, gain and offset with which the simulation is nearest to the measurement.
pub(crate) struct Matched {
    pub(crate) delay_s: Estimate,
    pub(crate) gain: Estimate,
    pub(crate) offset: Estimate,
    pub(crate) rms: f64,
}

impl Matched {
    pub(crate) fn of(pair: &Pair, time_s: &[f64], step_s: f64) -> Option<Self> {
        let span_s = time_s.last()? - time_s.first()?;
        let delay_s = coarse_delay(pair, step_s, (LARGEST_DELAY.0 * span_s).min(LARGEST_DELAY.1));
        Self::near(&pair.measured, &pair.simulated, time_s, (step_s, delay_s), 1)
    }

    /// The delay of `simulated` near one that is known to a few steps. Its slope is taken over `reach` rows to both sides: where it is measured
    /// too, its noise in a short slope would make the interval too narrow.
    pub(crate) fn near(
        measured: &[f64],
        simulated: &[f64],
        time_s: &[f64],
        (step_s, near_s): (f64, f64),
        reach: usize,
    ) -> Option<Self> {
        let span_s = time_s.last()? - time_s.first()?;
        let (mut delay_s, mut result) = (near_s, None);
        for _ in 0..6 {
            let moved: Vec<f64> = time_s.iter().map(|time| time - delay_s).collect();
            let simulated = interpolated(&moved, time_s, simulated);
            let slope = slope(time_s, &simulated, reach);
            let columns = [vec![1.0; time_s.len()], simulated, slope];
            let fit = regression::fit(measured, &columns)?;
            let gain = fit.coefficients[1];
            if gain.abs() < 1e-3 {
                return None;
            }
            let change_s = -fit.coefficients[2] / gain;
            delay_s += change_s;
            let width = |index: usize| fit.half_width(index);
            result = Some(Self {
                delay_s: Estimate::new(delay_s, width(2) / gain.abs()),
                gain: Estimate::new(gain, width(1)),
                offset: Estimate::new(fit.coefficients[0], width(0)),
                rms: rms(measured) * (1.0 - fit.explained).max(0.0).sqrt(),
            });
            if change_s.is_nan() || change_s.abs() <= 1e-3 * step_s {
                break;
            }
        }
        result.filter(|matched| matched.delay_s.value.abs() < span_s)
    }
}

/// The whole number of steps, as seconds, at which the two are most correlated.
fn coarse_delay(pair: &Pair, step_s: f64, largest_s: f64) -> f64 {
    let most = ((largest_s / step_s) as isize).min(pair.measured.len() as isize / 2);
    let centre = |values: &[f64]| {
        let held: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let mean = held.iter().sum::<f64>() / held.len().max(1) as f64;
        values.iter().map(|value| if value.is_finite() { value - mean } else { 0.0 }).collect::<Vec<f64>>()
    };
    let (measured, simulated) = (centre(&pair.measured), centre(&pair.simulated));
    let at = |shift: isize| {
        let (from, to) = (shift.max(0) as usize, (-shift).max(0) as usize);
        let (a, b) = (&measured[from..], &simulated[to..]);
        let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
        product / a.len().min(b.len()) as f64
    };
    let stride = (most / 250).max(1);
    let coarse =
        (-most / stride..=most / stride).map(|k| k * stride).max_by(|a, b| at(*a).total_cmp(&at(*b)));
    let coarse = coarse.unwrap_or(0);
    let fine = (coarse - stride..=coarse + stride).max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap_or(coarse);
    step_s * fine as f64
}
