//! One channel: how large its error is, and what it follows.

use serde::Serialize;

use crate::delay::Matched;
use crate::laws::laws;
use crate::pair::{Motion, Pair, Pairing};
use crate::spectrum::spectra;

/// Number of periods into which a recording is divided.
const PERIODS: usize = 50;
/// Least error of a period that stands out, in medians of all periods.
const OUTSTANDING: f64 = 2.0;
/// Bins of speed.
const BINS: usize = 40;

/// The law of an offset.
pub(crate) const CONSTANT: &str = "a constant";

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its interval.
    pub ci95: [f64; 2],
}

impl Estimate {
    pub(crate) fn new(value: f64, half_width: f64) -> Self {
        Self { value, ci95: [value - half_width, value + half_width] }
    }

    /// Whether the interval leaves out a value.
    #[must_use]
    pub fn excludes(&self, value: f64) -> bool {
        value < self.ci95[0] || value > self.ci95[1]
    }
}

/// A law that the error follows: a factor times a function of the simulated motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Law {
    /// The function, in words.
    pub of: String,
    /// Factor, in the channel's unit per unit of the function.
    pub factor: Estimate,
    /// Unit of the factor.
    pub unit: String,
    /// Share of the error's power that this law explains and no other of the list does.
    pub share: f64,
    /// p-value, corrected for the number of tests.
    pub p_value: f64,
}

/// A span of time in which the error stands out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Period {
    /// Where it begins and ends, s.
    pub time_s: [f64; 2],
    /// Root mean square of the error in it.
    pub rms: f64,
}

/// One channel of a recording beside its simulation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelComparison {
    /// Name of the measured channel.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Standard deviation of the measurement.
    pub measured_std: f64,
    /// Root mean square of measured minus simulated.
    pub error_rms: f64,
    /// `error_rms` divided by `measured_std`.
    pub error_share: f64,
    /// Whether the error depends on the simulated motion. Sensor noise does not.
    pub differs: bool,
    /// Smallest p-value of the tests, corrected for their number.
    pub p_value: f64,
    /// Time by which the recording is behind the simulation, s.
    pub delay_s: Option<Estimate>,
    /// Measured divided by simulated.
    pub gain: Option<Estimate>,
    /// Measured minus simulated, constant part.
    pub offset: Option<Estimate>,
    /// Root mean square of the error without delay, gain and offset.
    pub error_rms_without: f64,
    /// Share of the error's power that any linear filter of the simulation explains: a wrong stiffness, inertia, damping or delay.
    pub linear_share: f64,
    /// Functions of the simulated motion that the error follows, strongest first.
    pub laws: Vec<Law>,
    /// Narrowest band with half of the error's power, Hz.
    pub half_power_hz: [f64; 2],
    /// Spans of time in which the error stands out.
    pub periods: Vec<Period>,
    /// Error over the simulated speed, bin by bin.
    pub over_speed: Option<OverSpeed>,
    /// Signals and spectra for pictures; they are not part of the JSON document.
    #[serde(skip)]
    pub drawn: Drawn,
}

/// Error over speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OverSpeed {
    /// The channel that gives the speed.
    pub channel: String,
    /// Its unit.
    pub unit: &'static str,
    /// Middle of each bin.
    pub speed: Vec<f64>,
    /// Mean error.
    pub mean: Vec<f64>,
    /// Standard deviation within the bin.
    pub std: Vec<f64>,
}

/// Signals and power densities of a channel, in its unit and in its squared unit per Hz, for pictures.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawn {
    /// Common times, s.
    pub time_s: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Simulated values at the same times.
    pub simulated: Vec<f64>,
    /// Frequencies of the power densities, Hz, from zero.
    pub frequency_hz: Vec<f64>,
    /// Power density of the measurement.
    pub measured_density: Vec<f64>,
    /// Power density of measured minus simulated.
    pub error_density: Vec<f64>,
}

pub(crate) fn compare(
    pair: &Pair,
    pairing: &Pairing,
    motion: Option<&Motion>,
    level: f64,
) -> ChannelComparison {
    let time_s = &pairing.time_s;
    let error: Vec<f64> = pair.measured.iter().zip(&pair.simulated).map(|(a, b)| a - b).collect();
    let spectra = spectra(pairing.step_s, &pair.measured, &pair.simulated);
    let measured_std = std(&pair.measured);
    let error_rms = rms(&error);
    let matched = Matched::of(pair, time_s, pairing.step_s);
    let laws = laws(pair, time_s.len(), &error, motion, level);
    let tests = (laws.len() + 1) as f64;
    let mut p_value = (spectra.p_value() * tests).min(1.0);
    p_value = laws.iter().map(|law| law.p_value).fold(p_value, f64::min);
    let mut laws: Vec<Law> = laws.into_iter().filter(|law| law.p_value < level && law.share > 1e-3).collect();
    laws.sort_by(|a, b| b.share.total_cmp(&a.share));
    ChannelComparison {
        name: pair.channel.name.clone(),
        unit: pair.channel.unit.symbol(),
        measured_std,
        error_rms,
        error_share: if measured_std > 0.0 { error_rms / measured_std } else { f64::INFINITY },
        differs: p_value < level,
        p_value,
        delay_s: matched.as_ref().map(|m| m.delay_s),
        gain: matched.as_ref().map(|m| m.gain),
        offset: matched.as_ref().map(|m| m.offset),
        error_rms_without: matched.as_ref().map_or(error_rms, |m| m.rms),
        linear_share: spectra.linear_share(),
        laws,
        half_power_hz: spectra.half_power_hz(),
        periods: periods(time_s, &error),
        over_speed: motion.map(|motion| over_speed(motion, &error)),
        drawn: Drawn {
            time_s: time_s.clone(),
            measured: pair.measured.clone(),
            simulated: pair.simulated.clone(),
            frequency_hz: spectra.frequency_hz,
            measured_density: spectra.measured,
            error_density: spectra.error,
        },
    }
}

pub(crate) fn rms(values: &[f64]) -> f64 {
    let held = values.iter().filter(|value| value.is_finite());
    let (sum, count) = held.fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count.max(1))).sqrt()
}

fn std(values: &[f64]) -> f64 {
    let held = || values.iter().filter(|value| value.is_finite());
    let mean = held().sum::<f64>() / held().count().max(1) as f64;
    rms(&values.iter().map(|value| value - mean).collect::<Vec<_>>())
}

/// Spans of neighbouring periods whose error is far above the median.
fn periods(time_s: &[f64], error: &[f64]) -> Vec<Period> {
    let n = time_s.len();
    let span = |k: usize| (k * n / PERIODS, (k + 1) * n / PERIODS);
    let each: Vec<f64> = (0..PERIODS).map(|k| rms(&error[span(k).0..span(k).1])).collect();
    let mut sorted = each.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[PERIODS / 2];
    let mut periods: Vec<(usize, usize)> = Vec::new();
    for (k, rms) in each.iter().enumerate() {
        if *rms <= OUTSTANDING * median {
            continue;
        }
        match periods.last_mut() {
            Some((_, end)) if *end == k => *end = k + 1,
            _ => periods.push((k, k + 1)),
        }
    }
    let period = |(from, to): (usize, usize)| {
        let (first, last) = (span(from).0, span(to - 1).1);
        Period { time_s: [time_s[first], time_s[last - 1]], rms: rms(&error[first..last]) }
    };
    let mut periods: Vec<Period> = periods.into_iter().map(period).collect();
    periods.sort_by(|a, b| b.rms.total_cmp(&a.rms));
    periods.truncate(3);
    periods
}

fn over_speed(motion: &Motion, error: &[f64]) -> OverSpeed {
    let held = || motion.speed.iter().zip(error).filter(|(v, e)| v.is_finite() && e.is_finite());
    let (low, high) =
        held().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (v, _)| (l.min(*v), h.max(*v)));
    let width = (high - low) / BINS as f64;
    let mut sums = vec![[0.0; 3]; BINS];
    for (v, e) in held() {
        let bin = (((v - low) / width) as usize).min(BINS - 1);
        sums[bin].iter_mut().zip([1.0, *e, e * e]).for_each(|(sum, part)| *sum += part);
    }
    let mut over = OverSpeed {
        channel: motion.name.clone(),
        unit: motion.unit.symbol(),
        speed: Vec::new(),
        mean: Vec::new(),
        std: Vec::new(),
    };
    for (bin, [count, sum, squares]) in sums.into_iter().enumerate().filter(|(_, [count, ..])| *count >= 5.0)
    {
        over.speed.push(low + (bin as f64 + 0.5) * width);
        over.mean.push(sum / count);
        over.std.push((squares / count - (sum / count).powi(2)).max(0.0).sqrt());
    }
    over
}
