//! A range of a channel as a line with about as many points as the picture has pixels.

use super::pyramid::BASE;
use super::stored::Samples;

/// A line of values in the channel's unit over time in s. Gaps and missing values separate its parts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Envelope {
    /// The parts, each of points `[time_s, value]`.
    pub parts: Vec<Vec<[f64; 2]>>,
    /// Whether each point is a sample and there is room for markers.
    pub sparse: bool,
}

/// Samples per pixel up to which every sample is drawn; above, blocks of a pixel or more are drawn.
const DRAWN: usize = 1;
/// Distance between samples, pixels, from which each sample gets a marker.
const APART: usize = 8;

/// The line of a channel from one time to another for a picture that is `pixels` wide. It contains the least and the greatest value of
/// each block. Blocks are counted from the recording's first row, so that the line does not flicker while it is panned.
#[must_use]
pub fn envelope(samples: &Samples, channel: usize, from_s: f64, to_s: f64, pixels: usize) -> Envelope {
    let pixels = pixels.max(1);
    // One sample more at either side, so that the line reaches the edges.
    let first = samples.row_at(from_s).saturating_sub(1);
    let last = (samples.row_at(to_s) + 1).min(samples.rows());
    let rows = last.saturating_sub(first);
    let mut block = 1;
    while rows / block > DRAWN * pixels {
        block *= 2;
    }
    let mut line = Envelope { sparse: block == 1 && rows <= pixels / APART, ..Envelope::default() };
    for segment in samples.segments() {
        let (start, end) = ((segment.first_row as usize).max(first), (segment.end_row() as usize).min(last));
        if start >= end {
            continue;
        }
        if block == 1 {
            samples_of(samples, channel, start, end, &mut line.parts);
        } else if block < BASE {
            small_blocks(samples, channel, [start, end], block, &mut line.parts);
        } else {
            large_blocks(samples, channel, [start, end], block, &mut line.parts);
        }
    }
    line
}

fn samples_of(samples: &Samples, channel: usize, start: usize, end: usize, parts: &mut Vec<Vec<[f64; 2]>>) {
    let mut part = Vec::with_capacity(end - start);
    for (time, value) in samples.times(start..end).into_iter().zip(samples.values(channel, start..end)) {
        if value.is_finite() && time.is_finite() {
            part.push([time, value]);
        } else if !part.is_empty() {
            parts.push(std::mem::take(&mut part));
        }
    }
    if !part.is_empty() {
        parts.push(part);
    }
}

/// Blocks smaller than the base of the pyramid, from the samples.
fn small_blocks(
    samples: &Samples,
    channel: usize,
    [start, end]: [usize; 2],
    block: usize,
    parts: &mut Vec<Vec<[f64; 2]>>,
) {
    let times = samples.times(start..end);
    let values = samples.values(channel, start..end);
    let mut part = Vec::with_capacity(2 * (end - start) / block + 4);
    let mut from = start;
    while from < end {
        let to = ((from / block + 1) * block).min(end);
        let mut extremes = [f64::NAN; 2];
        for value in &values[from - start..to - start] {
            extremes = [extremes[0].min(*value), extremes[1].max(*value)];
        }
        add(&mut part, parts, 0.5 * (times[from - start] + times[to - 1 - start]), extremes);
        from = to;
    }
    if !part.is_empty() {
        parts.push(part);
    }
}

/// Whole blocks of the pyramid; blocks at the ends are cut to the range.
fn large_blocks(
    samples: &Samples,
    channel: usize,
    [start, end]: [usize; 2],
    block: usize,
    parts: &mut Vec<Vec<[f64; 2]>>,
) {
    let mut part = Vec::new();
    let mut from = start;
    while from < end {
        let to = ((from / block + 1) * block).min(end);
        let extremes = samples.extremes(channel, from..to).unwrap_or([f64::NAN; 2]);
        let time = 0.5 * (time_of(samples, from) + time_of(samples, to - 1));
        add(&mut part, parts, time, extremes);
        from = to;
    }
    if !part.is_empty() {
        parts.push(part);
    }
}

/// Time of a row; the first row of each block needs no reading.
fn time_of(samples: &Samples, row: usize) -> f64 {
    if row.is_multiple_of(BASE) {
        return samples.knots[row / BASE];
    }
    samples.times(row..row + 1).first().copied().unwrap_or(f64::NAN)
}

fn add(part: &mut Vec<[f64; 2]>, parts: &mut Vec<Vec<[f64; 2]>>, time: f64, [low, high]: [f64; 2]) {
    if low.is_finite() && time.is_finite() {
        // The value nearer to the last point comes first: the picture is the same with fewer crossings.
        let rises = part.last().is_none_or(|[_, last]| (low - last).abs() <= (high - last).abs());
        let (first, second) = if rises { (low, high) } else { (high, low) };
        part.push([time, first]);
        if first != second {
            part.push([time, second]);
        }
    } else if !part.is_empty() {
        parts.push(std::mem::take(part));
    }
}
