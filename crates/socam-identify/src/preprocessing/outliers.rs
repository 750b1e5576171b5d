//! Outliers: single output values that neither the model nor their neighbours explain.
//!
//! After a fit each value's residual is compared with what its past foretells, in units of the bulk of such remainders. A few
//! that stand far out alone are left out, and the fit goes on; many, or many in a row, are what the model does not describe.

use std::{ops::Range, sync::Arc};

use crate::optimiser::nuisance;
use crate::{
    IdentifyError, Problem,
    evaluation::{self, Point, Weights},
    noise::{
        innovations_filter::{Filtered, InnovationsFilter, NoiseLevels},
        levels,
    },
    preprocessing::{
        mask::{LeftOut, Reason},
        segments::{self, Segment},
        spikes,
    },
};

/// An outlier is so many standard deviations of the bulk away.
const LEAST: f64 = 6.0;
/// Longest run of them.
const LONGEST: u64 = 3;
/// The values before and after are at most this fraction of it away.
const ALONE: f64 = 0.5;
/// Most of a channel's values that can be outliers.
const MOST_SHARE: f64 = 0.005;
/// Factors of two below and above one, and bins in each, of the histogram that finds the bulk. A bin is told by a number's
/// exponent and its first four binary digits.
const OCTAVES: i32 = 24;
const BIN_BITS: u32 = 4;

/// Follows the remainders of one segment.
pub(crate) struct OutlierDetector<'w> {
    filter: Option<(&'w InnovationsFilter, Filtered)>,
    /// Standard deviation of the bulk of each output, in units of its noise.
    sizes: Arc<Vec<f64>>,
    row: u64,
    remainder: Vec<f64>,
    tracks: Vec<OutlierStatistics>,
}

/// What was seen of one output.
#[derive(Clone)]
pub(crate) struct OutlierStatistics {
    histogram: Vec<u64>,
    /// Values that stand far out.
    large: u64,
    /// Those that do so alone, by row of the segment, and how far, in units of noise.
    alone: Vec<(Range<u64>, f64)>,
    run: Option<Run>,
    previous: f64,
}

/// Values in a row that stand far out.
#[derive(Clone)]
struct Run {
    rows: Range<u64>,
    largest: f64,
    before: f64,
}

impl<'w> OutlierDetector<'w> {
    pub(crate) fn new(filter: Option<&'w InnovationsFilter>, sizes: Arc<Vec<f64>>) -> Self {
        let bins = (2 * OCTAVES as usize) << BIN_BITS;
        let track = OutlierStatistics {
            histogram: vec![0; bins],
            large: 0,
            alone: Vec::new(),
            run: None,
            previous: 0.0,
        };
        let tracks = vec![track; sizes.len()];
        let filter = filter.map(|filter| (filter, filter.rest()));
        Self { filter, sizes, row: 0, remainder: Vec::new(), tracks }
    }

    /// Takes the residuals of one sample, in units of noise. What stands far out foretells nothing.
    pub(crate) fn take(&mut self, residual: &[f64], present: &[bool]) {
        self.remainder.clear();
        self.remainder.extend_from_slice(residual);
        if let Some((filter, state)) = &self.filter {
            filter.subtract_foretold(state, &mut self.remainder, present);
        }
        for (o, track) in self.tracks.iter_mut().enumerate() {
            let unit = self.filter.as_ref().map_or(1.0, |(filter, _)| filter.covariance[(o, o)].sqrt());
            let value = if present[o] { self.remainder[o].abs() / (unit * self.sizes[o]) } else { 0.0 };
            if present[o] {
                track.count(value);
            }
            if track.stands_out(value, self.row, residual[o]) {
                self.remainder[o] = 0.0;
            }
        }
        if let Some((filter, state)) = &mut self.filter {
            filter.follow(state, &self.remainder);
        }
        self.row += 1;
    }

    pub(crate) fn finish(mut self) -> Vec<OutlierStatistics> {
        self.tracks.iter_mut().for_each(|track| track.close(0.0));
        self.tracks
    }
}

/// A positive number's exponent and its first binary digits: neighbouring bins have neighbouring numbers.
fn bin_bits(value: f64) -> u64 {
    value.to_bits() >> (f64::MANTISSA_DIGITS - 1 - BIN_BITS)
}

/// Least value in a bin of the histogram.
fn bin_start(bin: usize) -> f64 {
    f64::from_bits((bin as u64 + bin_bits(2f64.powi(-OCTAVES))) << (f64::MANTISSA_DIGITS - 1 - BIN_BITS))
}

impl OutlierStatistics {
    fn count(&mut self, value: f64) {
        let bin = bin_bits(value).saturating_sub(bin_bits(2f64.powi(-OCTAVES)));
        let last = self.histogram.len() - 1;
        self.histogram[(bin as usize).min(last)] += 1;
    }

    /// No value was larger.
    fn largest(&self) -> f64 {
        self.histogram.iter().rposition(|count| *count > 0).map_or(0.0, |bin| {
            if bin + 1 < self.histogram.len() { bin_start(bin + 1) } else { f64::INFINITY }
        })
    }

    fn stands_out(&mut self, value: f64, row: u64, residual: f64) -> bool {
        let large = value > LEAST;
        if large {
            self.large += 1;
            let before = self.previous;
            let run = self.run.get_or_insert(Run { rows: row..row, largest: 0.0, before });
            run.rows.end = row + 1;
            if residual.abs() > run.largest.abs() {
                run.largest = residual;
            }
            self.previous = value.max(self.previous);
        } else {
            self.close(value);
            self.previous = value;
        }
        large
    }

    /// A run has ended before a value of this size. While it lasts, `previous` holds its largest.
    fn close(&mut self, after: f64) {
        let Some(run) = self.run.take() else { return };
        let alone = run.before.max(after) <= ALONE * self.previous;
        if alone && run.rows.end - run.rows.start <= LONGEST {
            self.alone.push((run.rows, run.largest));
        }
    }
}

/// Times that they are looked for: once they are gone, smaller ones show.
const MOST_LOOKS: usize = 3;

/// Outliers of a problem's recordings beside a model at parameter `values` (SI) and noise `levels`; what is local to a recording
/// is fitted to it. So recordings that a fit never saw are looked through too.
///
/// # Errors
/// When a recording cannot be read.
pub fn outliers(
    problem: &Problem<'_>,
    values: &[f64],
    levels: &NoiseLevels,
) -> Result<Vec<LeftOut>, IdentifyError> {
    let mut cleaned = problem.clone();
    for _ in 0..MOST_LOOKS {
        let point =
            Point { values: values.to_vec(), nuisance: evaluation::first_nuisance(&cleaned, values)? };
        let weights = Weights {
            input_std: levels.inputs.clone(),
            ..Weights::white(levels.outputs.clone(), Vec::new())
        };
        let blind = levels::blind(&cleaned);
        let Some(at) = nuisance::with_nuisance_fitted(&blind, point, weights)? else { break };
        if !leave_out(&mut cleaned, &at.point, &at.weights)? {
            break;
        }
    }
    Ok(cleaned.left_out.into_iter().filter(|note| note.reason == Reason::Outliers).collect())
}

/// Has the problem's segments leave out what are outliers at a point, and the problem say so; false if there are none.
pub(crate) fn leave_out(
    problem: &mut Problem<'_>,
    point: &Point,
    weights: &Weights,
) -> Result<bool, IdentifyError> {
    let channels: Vec<String> = problem.model.outputs().map(|channel| channel.name.clone()).collect();
    let units = weights.noise_std.clone();
    problem.misfits.clear();
    let look = |sizes: Vec<f64>| look(problem, point, weights, sizes);
    let Some(bulk) = look(vec![1.0; channels.len()])? else { return Ok(false) };
    let sizes: Vec<f64> = (0..channels.len()).map(|output| bulk_size(&bulk, output)).collect();
    let stands_out =
        |output: usize| bulk.iter().any(|tracks| tracks[output].largest() > LEAST * sizes[output]);
    if !(0..channels.len()).any(stands_out) {
        return Ok(false);
    }
    let Some(seen) = look(sizes)? else { return Ok(false) };
    let mut found = false;
    for (output, channel) in channels.iter().enumerate() {
        let tracks = || seen.iter().map(|tracks| &tracks[output]);
        let large: u64 = tracks().map(|track| track.large).sum();
        let all: u64 = tracks().flat_map(|track| &track.histogram).sum();
        if large as f64 > MOST_SHARE * all as f64 {
            problem.misfits.push(misfit(channel, large, all));
            continue;
        }
        let each: Vec<Vec<(Range<u64>, f64)>> = tracks().map(|track| track.alone.clone()).collect();
        for (index, alone) in each.into_iter().enumerate() {
            found |= amend(problem, index, output, alone, units[output])?;
        }
    }
    Ok(found)
}

fn misfit(channel: &str, large: u64, all: u64) -> String {
    format!(
        "{channel}: {large} samples ({:.1} %) are further from the prediction than {LEAST} standard deviations of the rest; so many are no outliers: the model does not describe them",
        100.0 * large as f64 / all as f64
    )
}

/// One pass; `None` where the prediction overflows.
fn look(
    problem: &Problem<'_>,
    point: &Point,
    weights: &Weights,
    sizes: Vec<f64>,
) -> Result<Option<Vec<Vec<OutlierStatistics>>>, IdentifyError> {
    let blind = levels::blind(problem);
    let weights = Weights { detector: Some(Arc::new(sizes)), scales: Vec::new(), ..weights.clone() };
    let results = evaluation::run(&blind, point, &weights)?;
    Ok(results.map(|results| results.into_iter().filter_map(|result| result.detector).collect()))
}

/// Standard deviation of an output's bulk, were it Gaussian.
fn bulk_size(seen: &[Vec<OutlierStatistics>], output: usize) -> f64 {
    let bins = seen.first().map_or(0, |tracks| tracks[output].histogram.len());
    let sums: Vec<u64> =
        (0..bins).map(|bin| seen.iter().map(|tracks| tracks[output].histogram[bin]).sum()).collect();
    let all: u64 = sums.iter().sum();
    let mut below = 0;
    let middle = sums.iter().position(|count| {
        below += count;
        2 * below >= all
    });
    middle.map_or(1.0, |bin| 0.5 * (bin_start(bin) + bin_start(bin + 1)) / 0.6745)
}

/// Leaves out those of a segment's candidates that their neighbours do not explain either.
fn amend(
    problem: &mut Problem<'_>,
    index: usize,
    output: usize,
    alone: Vec<(Range<u64>, f64)>,
    unit: f64,
) -> Result<bool, IdentifyError> {
    let mut rows = Vec::new();
    for (own, residual) in alone {
        if is_in_the_data(problem, &problem.segments[index], output, &own, residual * unit)? {
            let first = problem.segments[index].first_row;
            rows.push(first + own.start..first + own.end);
        }
    }
    let recording = problem.segments[index].recording;
    let dataset = &problem.datasets[recording];
    let channel = problem.model.outputs().nth(output).map_or("", |channel| &channel.name);
    let Some(note) = LeftOut::new(dataset, channel, Reason::Outliers, &rows) else { return Ok(false) };
    note.join(&mut problem.left_out);
    let mut mask = (*problem.segments[index].mask).clone();
    mask.add(output, rows);
    let mask = Arc::new(mask);
    let own = problem.segments.iter_mut().filter(|segment| segment.recording == recording);
    own.for_each(|segment| segment.mask = Arc::clone(&mask));
    Ok(true)
}

/// Whether measured values stand out of their neighbours as they do of the prediction: a prediction may be sudden where the
/// measured motion is not.
fn is_in_the_data(
    problem: &Problem<'_>,
    segment: &Segment,
    output: usize,
    rows: &Range<u64>,
    residual: f64,
) -> Result<bool, IdentifyError> {
    let reach = spikes::REACH as u64;
    if rows.start < reach || rows.end + reach > segment.rows {
        return Ok(true);
    }
    let first_row = segment.first_row + rows.start - reach;
    let near = Segment { first_row, rows: rows.end - rows.start + 2 * reach, ..segment.clone() };
    let mut values = Vec::new();
    let dataset = &problem.datasets[segment.recording];
    segments::read(problem.model, dataset, &near, &problem.intersample, |chunk| {
        values.extend_from_slice(&chunk.outputs[output]);
    })?;
    let gap = spikes::REACH..values.len() - spikes::REACH;
    let off = spikes::off_imputed(&mut values, gap);
    // A missing neighbour says nothing.
    Ok(off.is_nan() || off >= ALONE * residual.abs())
}
