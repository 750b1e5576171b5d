//! Recordings as the fit reads them: uninterrupted stretches with every input present, block by block.

use socam_model::{Channel, Model};
use socam_recording::Dataset;

use crate::{IdentifyError, Intersample};

/// Fewest samples worth a start state of its own.
const MIN_ROWS: u64 = 20;

/// Consecutive rows of a recording at a steady rate, inputs complete.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stretch {
    /// Index of the recording.
    pub(crate) recording: usize,
    pub(crate) first_row: u64,
    pub(crate) rows: u64,
    pub(crate) sample_time_s: f64,
}

/// Some rows of a stretch in SI.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    /// One vector per input, as measured.
    pub(crate) inputs: Vec<Vec<f64>>,
    /// The same, as the hold between samples wants it.
    pub(crate) held: Vec<Vec<f64>>,
    /// One vector per output; NaN where missing.
    pub(crate) outputs: Vec<Vec<f64>>,
}

impl Chunk {
    pub(crate) fn rows(&self) -> usize {
        self.inputs.first().map_or(0, Vec::len)
    }
}

/// Finds the stretches of all recordings and checks that each can be used.
pub(crate) fn stretches(
    model: &Model,
    datasets: &[Dataset],
    warnings: &mut Vec<String>,
) -> Result<Vec<Stretch>, IdentifyError> {
    let mut all = Vec::new();
    for (recording, dataset) in datasets.iter().enumerate() {
        for channel in model.outputs() {
            dataset.channel_index(&channel.column)?;
        }
        let found = stretches_of(model, dataset, recording)?;
        let usable: Vec<Stretch> = found.iter().filter(|s| s.rows >= MIN_ROWS).cloned().collect();
        if usable.is_empty() {
            let rows = found.iter().map(|s| s.rows).max().unwrap_or(0);
            return Err(IdentifyError::TooShort { recording: dataset.name().into(), rows, needed: MIN_ROWS });
        }
        if usable.len() > 1 {
            warnings.push(format!(
                "{}: {} gaps; each part was given a start state of its own",
                dataset.name(),
                usable.len() - 1
            ));
        }
        all.extend(usable);
    }
    Ok(all)
}

fn stretches_of(model: &Model, dataset: &Dataset, recording: usize) -> Result<Vec<Stretch>, IdentifyError> {
    let inputs = model.inputs().map(|channel| dataset.channel_index(&channel.column));
    let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
    let mut found: Vec<Stretch> = Vec::new();
    let mut open = false;
    let mut segment = usize::MAX;
    for block in dataset.blocks()? {
        let block = block?;
        open &= block.segment == segment;
        segment = block.segment;
        let sample_time_s = dataset.segments()[segment].sample_time_s;
        let complete = inputs.iter().all(|index| block.columns[*index].is_complete());
        for row in 0..block.rows() {
            if complete || inputs.iter().all(|index| block.columns[*index].get(row).is_some()) {
                if !open {
                    let first_row = block.first_row + row as u64;
                    found.push(Stretch { recording, first_row, rows: 0, sample_time_s });
                    open = true;
                }
                if let Some(last) = found.last_mut() {
                    last.rows += 1;
                }
            } else {
                open = false;
            }
        }
    }
    Ok(found)
}

/// Calls `use_chunk` with the rows of a stretch, in order.
pub(crate) fn read(
    model: &Model,
    dataset: &Dataset,
    stretch: &Stretch,
    intersample: Intersample,
    mut use_chunk: impl FnMut(&Chunk),
) -> Result<(), IdentifyError> {
    let bind =
        |channel: &Channel| Ok((dataset.channel_index(&channel.column)?, channel.scale, channel.offset));
    let inputs = model.inputs().map(bind).collect::<Result<Vec<_>, IdentifyError>>()?;
    let outputs = model.outputs().map(bind).collect::<Result<Vec<_>, IdentifyError>>()?;
    let end = stretch.first_row + stretch.rows;
    // Sharpening needs the next samples: rows are held back until those are there.
    let mut pending = Chunk {
        inputs: vec![Vec::new(); inputs.len()],
        outputs: vec![Vec::new(); outputs.len()],
        ..Chunk::default()
    };
    let mut before: Vec<Vec<f64>> = vec![Vec::new(); inputs.len()];
    for block in dataset.blocks()? {
        let block = block?;
        let (first, last) = (block.first_row, block.first_row + block.rows() as u64);
        if last <= stretch.first_row {
            continue;
        }
        if first >= end {
            break;
        }
        let from = stretch.first_row.saturating_sub(first) as usize;
        let to = (end.min(last) - first) as usize;
        let append = |target: &mut [Vec<f64>], channels: &[(usize, f64, f64)]| {
            for (column, (index, scale, offset)) in target.iter_mut().zip(channels) {
                column.extend(
                    block.columns[*index].values()[from..to].iter().map(|value| scale * value + offset),
                );
            }
        };
        append(&mut pending.inputs, &inputs);
        append(&mut pending.outputs, &outputs);
        let keep = if last < end { SHARPENING.len() } else { 0 };
        emit(&mut pending, &mut before, keep, intersample, &mut use_chunk);
    }
    Ok(())
}

/// Hands over all but the last `keep` rows of `pending`; `before` holds the rows that went before them.
fn emit(
    pending: &mut Chunk,
    before: &mut [Vec<f64>],
    keep: usize,
    intersample: Intersample,
    use_chunk: &mut impl FnMut(&Chunk),
) {
    let rows = pending.rows().saturating_sub(keep);
    if rows == 0 {
        return;
    }
    let held = |(input, before): (&Vec<f64>, &Vec<f64>)| match intersample {
        Intersample::Linear => input[..rows].to_vec(),
        Intersample::BandLimited => sharpen(before, input, rows),
    };
    pending.held = pending.inputs.iter().zip(before.iter()).map(held).collect();
    let tail = |columns: &mut Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        columns.iter_mut().map(|column| column.split_off(rows)).collect()
    };
    let rest = (tail(&mut pending.inputs), tail(&mut pending.outputs));
    for (before, input) in before.iter_mut().zip(&pending.inputs) {
        before.extend_from_slice(input);
        before.drain(..before.len().saturating_sub(SHARPENING.len()));
    }
    use_chunk(pending);
    (pending.inputs, pending.outputs) = rest;
}

/// Straight lines between samples pass a tone at x rad per sample with the gain (sin(x/2)/(x/2))^2. Its inverse in
/// powers of d = 2 - 2 cos x, that is, of second differences, begins 1 + d/12 + d^2/90 + d^3/560: exact to a part in
/// 1e5 up to a tenth of the sampling rate, 1e-3 up to a fifth.
const SHARPENING: [f64; 3] = [1.0 / 12.0, 1.0 / 90.0, 1.0 / 560.0];

/// The first `rows` of `input` sharpened; `before` are the samples that went before. Towards the ends of a stretch,
/// where neighbours are missing, fewer powers are used.
fn sharpen(before: &[f64], input: &[f64], rows: usize) -> Vec<f64> {
    let all: Vec<f64> = before.iter().chain(input).copied().collect();
    (0..rows)
        .map(|row| {
            let k = before.len() + row;
            let reach = SHARPENING.len().min(k).min(all.len() - 1 - k);
            // d^n by repeated differencing of the window around k.
            let mut window: Vec<f64> = all[k - reach..=k + reach].to_vec();
            let mut sharp = all[k];
            for weight in &SHARPENING[..reach] {
                window = window.windows(3).map(|w| 2.0 * w[1] - w[0] - w[2]).collect();
                sharp += weight * window[window.len() / 2];
            }
            sharp
        })
        .collect()
}
