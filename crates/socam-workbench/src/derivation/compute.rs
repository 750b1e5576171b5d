//! The values of derived channels. Gaps and missing values divide a channel into runs; nothing is computed across them.

use std::ops::Range;

use socam_frequency::prepare::Butterworth;
use socam_model::formula::Tape;
use socam_recording::Segment;

use super::{Derivation, Operation, formula};
use crate::job::Handle;
use crate::signal::Signal;
use socam_samples::Samples;

/// Greatest number of rows: a derived channel is kept in memory, and is computed whole.
pub(crate) const MOST_ROWS: usize = 20_000_000;

/// Ratio of the corner of a filter that is applied twice to that of one pass, for second-order Butterworth filters, in terms of the
/// tangent of half the angle: two passes halve the power where each leaves 1/sqrt(2) of it.
const TWO_PASSES: f64 = 0.802_243;

/// The values of a derived channel, one per row; NaN where there is none. The sources are channels of one recording.
///
/// # Errors
/// When the recording is too long, a filter is not possible, a formula does not fit, or the work was cancelled; one sentence.
pub(crate) fn values(
    derivation: &Derivation,
    signals: &[Signal],
    sources: &[(&Samples, usize)],
    handle: &Handle,
) -> Result<Vec<f64>, String> {
    let Some((samples, channel)) = sources.first().copied() else {
        return Err("it is derived from no channel".into());
    };
    let is_formula = derivation.operation == Operation::Formula;
    let tape = is_formula.then(|| formula::tape(derivation.text(), signals)).transpose()?;
    let rows = samples.rows();
    if rows > MOST_ROWS {
        return Err(format!(
            "{} is derived from at most {MOST_ROWS} samples, and the recording has {rows}; open a part of it as RUN@FROM..TO",
            derivation.name()
        ));
    }
    let mut all = vec![f64::NAN; rows];
    for segment in samples.segments() {
        handle.reached(segment.first_row as f32 / rows.max(1) as f32)?;
        let part = segment.first_row as usize..segment.end_row() as usize;
        let (time_s, mut own) = (samples.times(part.clone()), samples.values(channel, part.clone()));
        let others = || sources[1..].iter().map(|(samples, channel)| samples.values(*channel, part.clone()));
        if let Some(tape) = &tape {
            evaluate(tape, &mut own, &others().collect::<Vec<_>>());
        } else if let Some(second) = others().next() {
            combine(derivation.operation, &mut own, &second);
        }
        for run in runs(&own) {
            let (time_s, own) = (&time_s[run.clone()], &mut own[run]);
            of_run(derivation, segment, time_s, own)?;
        }
        all[part].copy_from_slice(&own);
    }
    Ok(all)
}

/// Replaces the values of a formula's first channel by those of the formula.
fn evaluate(tape: &Tape, values: &mut [f64], others: &[Vec<f64>]) {
    let mut inputs = vec![0.0; 1 + others.len()];
    for (row, value) in values.iter_mut().enumerate() {
        inputs[0] = *value;
        inputs[1..].iter_mut().zip(others).for_each(|(input, other)| *input = other[row]);
        // `min` and `max` of a missing value and a number are the number.
        let is_whole = inputs.iter().all(|input| input.is_finite());
        let found = is_whole.then(|| tape.value(&inputs));
        *value = found.filter(|value| value.is_finite()).unwrap_or(f64::NAN);
    }
}

fn combine(operation: Operation, values: &mut [f64], second: &[f64]) {
    for (value, other) in values.iter_mut().zip(second) {
        *value = match operation {
            Operation::Difference => *value - other,
            Operation::Product => *value * other,
            _ => *value / other,
        };
        if !value.is_finite() {
            *value = f64::NAN;
        }
    }
}

/// Ranges without a missing value.
fn runs(values: &[f64]) -> Vec<Range<usize>> {
    let mut first = 0;
    let mut runs = Vec::new();
    for run in values.chunk_by(|a, b| a.is_finite() == b.is_finite()) {
        if run[0].is_finite() {
            runs.push(first..first + run.len());
        }
        first += run.len();
    }
    runs
}

fn of_run(
    derivation: &Derivation,
    segment: &Segment,
    time_s: &[f64],
    values: &mut [f64],
) -> Result<(), String> {
    let value = derivation.value.unwrap_or_default();
    let step_s = segment.sample_time_s;
    match derivation.operation {
        Operation::Derivative => differentiate(time_s, values),
        Operation::Integral => integrate(time_s, values),
        Operation::LowPass => values.copy_from_slice(&low_pass(values, value, step_s)?),
        Operation::HighPass => {
            let slow = low_pass(values, value, step_s)?;
            values.iter_mut().zip(slow).for_each(|(value, slow)| *value -= slow);
        }
        Operation::MovingMean => values.copy_from_slice(&moving_mean(values, value, step_s)?),
        Operation::Difference | Operation::Ratio | Operation::Product | Operation::Formula => {}
    }
    Ok(())
}

/// Central differences; at the ends of a run the difference to the one neighbour.
fn differentiate(time_s: &[f64], values: &mut [f64]) {
    let original = values.to_vec();
    let last = original.len() - 1;
    for (index, value) in values.iter_mut().enumerate() {
        let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
        let step_s = time_s[after] - time_s[before];
        *value = if step_s > 0.0 { (original[after] - original[before]) / step_s } else { f64::NAN };
    }
}

fn integrate(time_s: &[f64], values: &mut [f64]) {
    let (mut sum, mut last) = (0.0, values[0]);
    values[0] = 0.0;
    for index in 1..values.len() {
        sum += 0.5 * (last + values[index]) * (time_s[index] - time_s[index - 1]);
        last = std::mem::replace(&mut values[index], sum);
    }
}

/// Forward and backward, with the signal reflected about its ends.
fn low_pass(values: &[f64], corner_hz: f64, step_s: f64) -> Result<Vec<f64>, String> {
    let rate_hz = 1.0 / step_s;
    let impossible =
        || format!("a filter at {corner_hz} Hz needs a corner above 0 and below half of {rate_hz:.6} Hz");
    if values.len() < 2 {
        return Ok(values.to_vec());
    }
    if !(corner_hz > 0.0 && corner_hz < 0.49 * rate_hz) {
        return Err(impossible());
    }
    let warped = (std::f64::consts::PI * corner_hz / rate_hz).tan() / TWO_PASSES;
    let single_hz = rate_hz / std::f64::consts::PI * warped.atan();
    let filter = Butterworth::new(2, single_hz, rate_hz).map_err(|_| impossible())?;
    let last = values.len() - 1;
    let room = ((2.0 * rate_hz / corner_hz).ceil() as usize).clamp(1, last);
    let mirrored = |end: usize, index: usize| 2.0 * values[end] - values[index];
    let mut padded: Vec<f64> = (1..=room).rev().map(|index| mirrored(0, index)).collect();
    padded.extend_from_slice(values);
    padded.extend((1..=room).map(|index| mirrored(last, last - index)));
    for _ in 0..2 {
        padded = filter.filtered(&padded);
        padded.reverse();
    }
    Ok(padded[room..room + values.len()].to_vec())
}

/// Mean of the samples up to half a window before and after each one.
fn moving_mean(values: &[f64], window_s: f64, step_s: f64) -> Result<Vec<f64>, String> {
    if window_s.is_nan() || window_s < step_s {
        return Err(format!(
            "a moving mean over {window_s} s needs a window of one sample ({step_s} s) or more"
        ));
    }
    let half = (0.5 * window_s / step_s).round() as usize;
    // Sums of differences from the mean lose no digits where the mean is large.
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let mut sums = vec![0.0];
    sums.extend(values.iter().scan(0.0, |sum, value| {
        *sum += value - mean;
        Some(*sum)
    }));
    let at = |index: usize| {
        let (from, to) = (index.saturating_sub(half), (index + half + 1).min(values.len()));
        mean + (sums[to] - sums[from]) / (to - from) as f64
    };
    Ok((0..values.len()).map(at).collect())
}

#[cfg(test)]
mod tests;
