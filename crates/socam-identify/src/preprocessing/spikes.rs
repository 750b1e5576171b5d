//! Spikes of an input: a value or two that stand out of what lies about them and leave no trace in it.
//!
//! Each value is compared with the polynomial of fifth degree through three to either side. What is left is noise, motion near
//! half the sampling rate, or something sudden. A spike is what is gone once its few rows are imputed by such a polynomial;
//! a step, a corner or a burst stays and is left as it is.

use std::ops::Range;

use rayon::prelude::*;
use socam_model::{Channel, Quantity};
use socam_recording::Dataset;

use crate::{IdentifyError, preprocessing::segments::Segment};

/// Rows over which the ordinary size of deviations is taken.
const BLOCK: usize = 1024;
/// A spike deviates by so many of their standard deviations.
const THRESHOLD: f64 = 10.0;
/// Bridging it leaves at most this fraction of its deviation.
const MOST_LEFT: f64 = 0.15;
/// It is so many times larger than the motion from row to row about it.
const ABOVE_MOTION: f64 = 1.5;
/// Most rows that are imputed within [`NEAR`] of a deviation.
const MOST_ROWS: usize = 2;
/// Rows about a deviation that it is judged by.
const NEAR: usize = 8;
/// Largest share of an input's rows that can be spikes. More are what the input does.
const MOST_SHARE: f64 = 0.005;
/// Most deviations in a block: where there are more, they are what the input does.
const MOST_SUDDEN: usize = 100;
/// Rows to either side that a polynomial goes through.
pub(crate) const REACH: usize = 3;

/// Rows of each input that are spikes, and what their neighbours say instead, in the recording's unit. A servo's reference is known as it is.
pub(crate) fn find(
    inputs: &[&Channel],
    dataset: &Dataset,
    segments: &[&Segment],
) -> Result<Vec<Vec<(u64, f64)>>, IdentifyError> {
    let mut all = Vec::new();
    for channel in inputs {
        if channel.quantity == Quantity::Reference || channel.quantity.is_clock() {
            all.push(Vec::new());
            continue;
        }
        let column = dataset.channel_index(&channel.column)?;
        let each = segments.par_iter().map(|segment| in_segment(column, dataset, segment));
        let each: Result<Vec<Vec<(u64, f64)>>, IdentifyError> = each.collect();
        let found: Vec<(u64, f64)> = each?.into_iter().flatten().collect();
        let rows: u64 = segments.iter().map(|segment| segment.rows).sum();
        let few = found.len() as f64 <= MOST_SHARE * rows as f64;
        all.push(if few { found } else { Vec::new() });
    }
    Ok(all)
}

/// Spikes of one segment, its neighbours in the run being looked at too.
fn in_segment(column: usize, dataset: &Dataset, segment: &Segment) -> Result<Vec<(u64, f64)>, IdentifyError> {
    let (near, end) = (2 * NEAR as u64, segment.first_row + segment.rows);
    let first = segment.first_row.saturating_sub(near).max(segment.run.start);
    let last = (end + near).min(segment.run.end);
    let mut values = Vec::with_capacity((last - first) as usize);
    for block in dataset.blocks_in(first..last, &[column])? {
        values.extend_from_slice(block?.columns[0].values());
    }
    let found = spikes_in(&values).into_iter().map(|(k, value)| (first + k as u64, value));
    Ok(found.filter(|(row, _)| (segment.first_row..end).contains(row)).collect())
}

/// Positions of spikes, and what stands there instead.
fn spikes_in(values: &[f64]) -> Vec<(usize, f64)> {
    let mut values = values.to_vec();
    let mut found = Vec::new();
    let deviations: Vec<f64> = (0..values.len()).map(|k| deviation(&values, k)).collect();
    let mut workspace = Vec::new();
    for from in (0..values.len()).step_by(BLOCK) {
        let block = &deviations[from..values.len().min(from + BLOCK)];
        let least =
            (THRESHOLD * spread(block, &mut workspace)).max(1e-9 * size(&values[from..from + block.len()]));
        if block.iter().filter(|own| **own > least).count() > MOST_SUDDEN * block.len() / BLOCK {
            continue;
        }
        for (k, own) in block.iter().enumerate() {
            // Not if an earlier impute has taken it along.
            if *own > least && deviation(&values, from + k) > least {
                found.extend(impute(&mut values, from + k, least));
            }
        }
    }
    found.sort_by_key(|(k, _)| *k);
    found
}

/// Bridges a spike of which the first deviation lies at `at`; nothing if it is none.
fn impute(values: &mut [f64], at: usize, least: f64) -> Vec<(usize, f64)> {
    let larger = |a: &usize, b: &usize| deviation(values, *a).total_cmp(&deviation(values, *b));
    let at = (at..values.len().min(at + REACH + 1)).max_by(larger).unwrap_or(at);
    let near = at.saturating_sub(NEAR)..(at + NEAR + 1).min(values.len());
    let before = values[near.clone()].to_vec();
    let mut gaps: Vec<(Range<usize>, f64)> = Vec::new();
    let mut rows = 0;
    while rows < MOST_ROWS {
        let Some((gap, rest, sudden)) = best_gap(values, near.clone(), MOST_ROWS - rows) else { break };
        fill(values, gap.clone());
        rows += gap.len();
        gaps.push((gap, sudden));
        if rest < least {
            let are_spikes = gaps
                .iter()
                .all(|(gap, sudden)| rest < MOST_LEFT * sudden && stands_out(values, gap, *sudden));
            if are_spikes {
                return gaps.into_iter().flat_map(|(gap, _)| gap).map(|k| (k, values[k])).collect();
            }
            break;
        }
    }
    values[near].copy_from_slice(&before);
    Vec::new()
}

/// The gap whose impute leaves least, how large a deviation it leaves, and how far the rows that it takes are off the impute.
fn best_gap(values: &mut [f64], near: Range<usize>, longest: usize) -> Option<(Range<usize>, f64, f64)> {
    let mut best: Option<(f64, Range<usize>, f64, f64)> = None;
    for length in 1..=longest {
        let starts = near.start.max(REACH)..near.end.min(values.len().saturating_sub(REACH + length - 1));
        for start in starts {
            let gap = start..start + length;
            let own = values[gap.clone()].to_vec();
            fill(values, gap.clone());
            let rest = || near.clone().map(|k| deviation(values, k));
            let (squares, largest) = (rest().map(|r| r * r).sum::<f64>(), rest().fold(0.0, f64::max));
            let off = own.iter().zip(&values[gap.clone()]).map(|(own, impute)| (own - impute).abs());
            let sudden = off.fold(f64::INFINITY, f64::min);
            values[gap.clone()].copy_from_slice(&own);
            // A longer gap must be worth it.
            let worth = if length == 1 { 1.0 } else { 0.25 };
            if best.as_ref().is_none_or(|(least, ..)| squares < worth * least) {
                best = Some((squares, gap, largest, sudden));
            }
        }
    }
    best.map(|(_, gap, largest, sudden)| (gap, largest, sudden))
}

/// Whether what a gap held stands out of the motion about it, and is not a step between its sides.
fn stands_out(values: &[f64], gap: &Range<usize>, sudden: f64) -> bool {
    let across = gap.len() + 1;
    let changes = |distance: usize| {
        let sides = [gap.start.saturating_sub(NEAR)..gap.start, gap.end..(gap.end + NEAR).min(values.len())];
        let pairs = sides.into_iter().flat_map(|rows| values[rows].windows(distance + 1));
        pairs.map(|window| (window[distance] - window[0]).abs()).fold(0.0, f64::max)
    };
    let step = (values[gap.end] - values[gap.start - 1]).abs();
    sudden > ABOVE_MOTION * changes(1) && step <= 2.0 * changes(across) + 0.5 * sudden
}

/// How far the furthest value of a gap is off the imputed values.
pub(crate) fn off_imputed(values: &mut [f64], gap: Range<usize>) -> f64 {
    let own = values[gap.clone()].to_vec();
    fill(values, gap.clone());
    let off = own.iter().zip(&values[gap]).map(|(own, impute)| (own - impute).abs());
    // A NaN must not be lost in a maximum.
    off.fold(0.0, |most, off| if off > most || off.is_nan() { off } else { most })
}

/// Puts the polynomial through [`REACH`] values to either side into a gap.
fn fill(values: &mut [f64], gap: Range<usize>) {
    let nodes: Vec<usize> = (gap.start - REACH..gap.start).chain(gap.end..gap.end + REACH).collect();
    for k in gap {
        let term = |node: &usize| {
            let others = nodes.iter().filter(|other| *other != node);
            let weight = others.map(|other| (k as f64 - *other as f64) / (*node as f64 - *other as f64));
            values[*node] * weight.product::<f64>()
        };
        values[k] = nodes.iter().map(term).sum();
    }
}

/// How far a value is off the polynomial through its neighbours; nothing at the ends.
fn deviation(values: &[f64], k: usize) -> f64 {
    if k < REACH || k + REACH >= values.len() {
        return 0.0;
    }
    let pair = |distance: usize| values[k - distance] + values[k + distance];
    (values[k] - (15.0 * pair(1) - 6.0 * pair(2) + pair(3)) / 20.0).abs()
}

/// Standard deviation of the bulk.
fn spread(deviations: &[f64], workspace: &mut Vec<f64>) -> f64 {
    workspace.clear();
    workspace.extend_from_slice(deviations);
    let middle = workspace.len() / 2;
    *workspace.select_nth_unstable_by(middle, f64::total_cmp).1 / 0.6745
}

fn size(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(k: usize) -> f64 {
        let mut x = (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mut uniform = || {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (x >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    fn moving(k: usize) -> f64 {
        let t = k as f64 / 1000.0;
        60.0 + 8.0 * (4.0 * t).sin() + 4.0 * (380.0 * t).sin() + 2.0 * (560.0 * t).sin()
    }

    #[test]
    fn spikes_are_imputed_and_nothing_else() {
        let rows = 6000;
        for level in [0.0, 0.02, 0.2] {
            let clean: Vec<f64> = (0..rows).map(|k| moving(k) + level * noise(k)).collect();
            assert_eq!(spikes_in(&clean), [], "{level}");
            let mut spiked = clean.clone();
            let at = [50, 777, 783, 1500, 1501, 2047, 4000, 5990];
            for (i, k) in at.into_iter().enumerate() {
                spiked[k] += if i % 3 == 0 { -20.0 } else { 8.0 + i as f64 };
            }
            let found = spikes_in(&spiked);
            assert!(found.iter().map(|(k, _)| *k).eq(at), "{level}: {found:?}");
            let error = found.iter().map(|(k, value)| (value - clean[*k]).abs()).fold(0.0, f64::max);
            assert!(error < 0.05 + 8.0 * level, "{level}: {error}");
        }
    }

    #[test]
    fn steps_corners_and_pulses_are_no_spikes() {
        let shapes: [fn(usize) -> f64; 5] = [
            |k| [10.0, 20.0, 35.0, 15.0][k / 500 % 4],
            |k| (k % 400).min(400 - k % 400) as f64 * 0.1,
            |k| if k / 7 * 2654435761 % 64 < 32 { 1.0 } else { -1.0 },
            |k| if k % 97 < 5 { 3.0 } else { 0.0 },
            |k| (k % 300) as f64 * 0.01,
        ];
        for (i, shape) in shapes.into_iter().enumerate() {
            for level in [0.0, 1e-3, 0.02, 0.1] {
                let values: Vec<f64> = (0..8000).map(|k| shape(k) + level * noise(k)).collect();
                let found = spikes_in(&values);
                assert_eq!(found, [], "shape {i}, noise {level}");
            }
        }
    }
}
