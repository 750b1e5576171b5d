//! Spikes of a channel: one or two values that differ from their neighbours, which show no trace of them. Those of an input are imputed,
//! those of an output are failed reads and left out, whatever the model predicts there.
//!
//! The deviation of a value is its distance from the polynomial of fifth degree through three values on either side. It consists of
//! noise, of motion near half the sampling rate, and of sudden changes. A sudden change is a spike if no large deviation remains once
//! one or two rows are imputed by such a polynomial. A step, a corner or a burst leaves deviations, and is not changed.

use std::ops::Range;

use rayon::prelude::*;
use socam_model::{Channel, Role};
use socam_recording::Dataset;

use crate::{
    IdentifyError,
    preprocessing::{
        repeats,
        segments::{self, Segment},
    },
};

/// Rows of a block. The standard deviation of the deviations is estimated block by block.
const BLOCK: usize = 1024;
/// Least deviation of a spike, in standard deviations of its block.
const THRESHOLD: f64 = 10.0;
/// Largest deviation that may remain after the imputation, as a share of the spike's size.
const MOST_LEFT: f64 = 0.15;
/// Least size of a spike, in units of the largest change from row to row about it.
const ABOVE_MOTION: f64 = 1.5;
/// Most rows that are imputed within [`NEAR`] rows of a deviation.
const MOST_ROWS: usize = 2;
/// Rows on either side of a deviation that its test looks at.
const NEAR: usize = 8;
/// Largest share of a channel's rows that can be spikes. If there are more, they are part of its motion. A bus or an encoder fails one read in
/// fifty.
const MOST_SHARE: f64 = 0.025;
/// Share of an input's rows above which its spikes may be a command, a row of pulses, and must be irregular.
const FEW: f64 = 0.005;
/// Least share of single rows among irregular spikes, and least standard deviation of their distances relative to the mean: 1 where each row
/// may fail alike, 0 for a row of pulses.
const SINGLE: f64 = 0.8;
const IRREGULAR: f64 = 0.5;
/// Most large deviations in a block; a spike makes up to seven. If there are more, they are part of the motion.
const MOST_SUDDEN: usize = 300;
/// Least size of an output's spike, in units of its resolution: where a slow encoder counts once in many rows, each count is a spike.
const MANY_STEPS: f64 = 8.0;
/// Rows on either side that the polynomial passes through.
pub(crate) const REACH: usize = 3;

/// Spikes of each input: rows and imputed values in the recording's unit. A servo's reference is known exactly and is not searched.
pub(crate) fn find(
    inputs: &[&Channel],
    dataset: &Dataset,
    segments: &[&Segment],
) -> Result<Vec<Vec<(u64, f64)>>, IdentifyError> {
    let mut all = Vec::new();
    for channel in inputs {
        if channel.quantity.is_exact() {
            all.push(Vec::new());
            continue;
        }
        all.push(in_channel(channel, dataset, segments)?);
    }
    Ok(all)
}

/// Failed reads of an output: spikes, and values that repeat the last one. Rows, ascending.
pub(crate) fn failed_reads(
    output: &Channel,
    dataset: &Dataset,
    segments: &[&Segment],
) -> Result<Vec<u64>, IdentifyError> {
    let mut rows = in_channel(output, dataset, segments)?.into_iter().map(|(row, _)| row).collect::<Vec<_>>();
    let column = dataset.channel_index(&output.column)?;
    for segment in segments {
        let own = segment.first_row..segment.first_row + segment.rows;
        let values = segments::recorded(dataset, column, own)?;
        rows.extend(repeats::find(&values).into_iter().map(|k| segment.first_row + k as u64));
    }
    rows.sort_unstable();
    rows.dedup();
    Ok(rows)
}

/// Spikes of a channel; none where there are many.
fn in_channel(
    channel: &Channel,
    dataset: &Dataset,
    segments: &[&Segment],
) -> Result<Vec<(u64, f64)>, IdentifyError> {
    let column = dataset.channel_index(&channel.column)?;
    let each = segments.par_iter().map(|segment| in_segment(column, channel.role, dataset, segment));
    let each: Result<Vec<Vec<(u64, f64)>>, IdentifyError> = each.collect();
    let found: Vec<(u64, f64)> = each?.into_iter().flatten().collect();
    let rows: u64 = segments.iter().map(|segment| segment.rows).sum();
    let share = found.len() as f64 / rows.max(1) as f64;
    let may_be_many = || channel.role == Role::Output || are_irregular(&found);
    let are_spikes = share <= FEW || share <= MOST_SHARE && may_be_many();
    Ok(if are_spikes { found } else { Vec::new() })
}

/// Whether spikes are single rows at irregular distances, as failed reads are and pulses of a command are not.
fn are_irregular(found: &[(u64, f64)]) -> bool {
    let distances: Vec<f64> = found.windows(2).map(|pair| (pair[1].0 - pair[0].0) as f64).collect();
    let apart: Vec<f64> = distances.iter().copied().filter(|distance| *distance > 1.0).collect();
    let count = apart.len() as f64;
    let mean = apart.iter().sum::<f64>() / count;
    let variance = apart.iter().map(|distance| (distance - mean).powi(2)).sum::<f64>() / count;
    count > SINGLE * distances.len() as f64 && variance.sqrt() > IRREGULAR * mean
}

/// Spikes of one segment; the uninterrupted rows on either side of it are taken into account.
fn in_segment(
    column: usize,
    role: Role,
    dataset: &Dataset,
    segment: &Segment,
) -> Result<Vec<(u64, f64)>, IdentifyError> {
    let (near, end) = (2 * NEAR as u64, segment.first_row + segment.rows);
    let first = segment.first_row.saturating_sub(near).max(segment.uninterrupted.start);
    let last = (end + near).min(segment.uninterrupted.end);
    let values = segments::recorded(dataset, column, first..last)?;
    let found = spikes_in(&values, role).into_iter().map(|(k, value)| (first + k as u64, value));
    Ok(found.filter(|(row, _)| (segment.first_row..end).contains(row)).collect())
}

/// Positions of spikes, ascending, and their imputed values.
fn spikes_in(values: &[f64], role: Role) -> Vec<(usize, f64)> {
    let mut values = values.to_vec();
    let resolved = if role == Role::Output { MANY_STEPS * resolution(&values) } else { 0.0 };
    let mut found = Vec::new();
    let deviations: Vec<f64> = (0..values.len()).map(|k| deviation(&values, k)).collect();
    let mut workspace = Vec::new();
    for from in (0..values.len()).step_by(BLOCK) {
        let block = &deviations[from..values.len().min(from + BLOCK)];
        let least =
            (THRESHOLD * spread(block, &mut workspace)).max(1e-9 * size(&values[from..from + block.len()]));
        let least = least.max(resolved);
        let most = MOST_SUDDEN * block.len() / BLOCK;
        if block.iter().filter(|own| **own > least).count() > most {
            continue;
        }
        for (k, own) in block.iter().enumerate() {
            // An earlier imputation may have removed the deviation.
            if *own > least && deviation(&values, from + k) > least {
                found.extend(impute(&mut values, from + k, least));
            }
        }
    }
    found.sort_by_key(|(k, _)| *k);
    found
}

/// Imputes the spike whose first large deviation is at `at`. Returns the imputed rows; none, with `values` unchanged, if there is no
/// spike.
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

/// The gap whose imputation leaves the least sum of squared deviations, the largest deviation that it leaves, and the least distance of
/// the gap's values from the imputed ones.
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
            // A longer gap must reduce the sum by a factor of four.
            let worth = if length == 1 { 1.0 } else { 0.25 };
            if best.as_ref().is_none_or(|(least, ..)| squares < worth * least) {
                best = Some((squares, gap, largest, sudden));
            }
        }
    }
    best.map(|(_, gap, largest, sudden)| (gap, largest, sudden))
}

/// Whether the values of a gap differ by more than the motion about it, and are not a step between its sides.
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

/// Largest distance of a gap's values from the imputed ones, NaN if one is missing. Fills the gap. `values` must have [`REACH`] rows on
/// either side of it.
pub(crate) fn off_imputed(values: &mut [f64], gap: Range<usize>) -> f64 {
    let own = values[gap.clone()].to_vec();
    fill(values, gap.clone());
    let off = own.iter().zip(&values[gap]).map(|(own, impute)| (own - impute).abs());
    // A NaN must not be lost in a maximum.
    off.fold(0.0, |most, off| if off > most || off.is_nan() { off } else { most })
}

/// Fills a gap by the polynomial through [`REACH`] values on either side (Lagrange's formula).
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

/// Distance of a value from the polynomial through its neighbours; zero within [`REACH`] rows of the ends.
fn deviation(values: &[f64], k: usize) -> f64 {
    if k < REACH || k + REACH >= values.len() {
        return 0.0;
    }
    let pair = |distance: usize| values[k - distance] + values[k + distance];
    (values[k] - (15.0 * pair(1) - 6.0 * pair(2) + pair(3)) / 20.0).abs()
}

/// Standard deviation of the bulk: the median of the magnitudes over that of a standard normal variable. There must be at least one.
fn spread(deviations: &[f64], workspace: &mut Vec<f64>) -> f64 {
    workspace.clear();
    workspace.extend_from_slice(deviations);
    let middle = workspace.len() / 2;
    *workspace.select_nth_unstable_by(middle, f64::total_cmp).1 / 0.6745
}

/// Smallest change from row to row; zero where nothing changes.
fn resolution(values: &[f64]) -> f64 {
    let changes = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
    Some(changes.fold(f64::INFINITY, f64::min)).filter(|least| least.is_finite()).unwrap_or(0.0)
}

/// Largest magnitude.
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
            assert_eq!(spikes_in(&clean, Role::Input), [], "{level}");
            let mut spiked = clean.clone();
            let at = [50, 777, 783, 1500, 1501, 2047, 4000, 5990];
            for (i, k) in at.into_iter().enumerate() {
                spiked[k] += if i % 3 == 0 { -20.0 } else { 8.0 + i as f64 };
            }
            let found = spikes_in(&spiked, Role::Input);
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
                for role in [Role::Input, Role::Output] {
                    let found = spikes_in(&values, role);
                    assert_eq!(found, [], "shape {i}, noise {level}");
                }
            }
        }
    }

    #[test]
    fn pulses_are_regular_and_failed_reads_are_not() {
        let spikes = |at: fn(u64) -> u64| -> Vec<(u64, f64)> { (0..200).map(|k| (at(k), 0.0)).collect() };
        assert!(!are_irregular(&spikes(|k| 60 * k)));
        assert!(!are_irregular(&spikes(|k| 60 * k + k % 7)));
        assert!(are_irregular(&spikes(|k| (0..k).map(|j| 2 + (j * j * 31 % 59).pow(2) / 15).sum())));
        // Pulses of two rows, at irregular distances.
        assert!(!are_irregular(&spikes(|k| 60 * (k / 2) + k % 2 + (k / 2).pow(2) * 31 % 57)));
    }

    /// One read in sixty fails, as zero or as the end of the range; an encoder's single counts are no failed reads.
    #[test]
    fn failed_reads_of_an_output_are_found() {
        let clean: Vec<f64> = (0..6000).map(|k| moving(k) + 0.02 * noise(k)).collect();
        let at: Vec<usize> = (40..5900).step_by(61).collect();
        let mut failing = clean.clone();
        at.iter().enumerate().for_each(|(i, k)| failing[*k] = if i % 2 == 0 { 0.0 } else { 655.36 });
        assert!(spikes_in(&failing, Role::Output).iter().map(|(k, _)| k).eq(&at));
        assert!(spikes_in(&clean, Role::Output).is_empty());
        let slow: Vec<f64> = (0..6000).map(|k| if k % 40 == 0 { 0.5 } else { 0.0 }).collect();
        assert_eq!(spikes_in(&slow, Role::Output), []);
    }
}
