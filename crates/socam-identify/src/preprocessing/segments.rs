//! Recordings as the fit reads them: uninterrupted segments with every input present, block by block.

use std::{ops::Range, sync::Arc};

use socam_model::{Channel, ChannelTransform, Model, TransformStart};

use socam_recording::Dataset;

use crate::{IdentifyError, Intersample, prediction::intersample, preprocessing::mask::Mask};

/// Fewest samples worth a start state of its own.
const MIN_ROWS: u64 = 20;

/// Longest segment where start states are free: longer runs are cut, so that one long recording uses all cores. Among so many
/// samples a start state of its own costs nothing.
pub(crate) const PIECE_ROWS: u64 = 250_000;

/// Consecutive rows of a recording at a steady rate, inputs complete.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    /// Index of the recording.
    pub(crate) recording: usize,
    pub(crate) first_row: u64,
    pub(crate) rows: u64,
    pub(crate) sample_time_s: f64,
    /// Time of row 0 of the recording, were its rate that of this segment all along, s.
    pub(crate) origin_s: f64,
    /// The uninterrupted rows that it is all or a piece of.
    pub(crate) run: Range<u64>,
    /// What of its recording is not used as measured.
    pub(crate) mask: Arc<Mask>,
}

impl Segment {
    /// Whether nothing comes before it without a gap.
    pub(crate) fn begins_run(&self) -> bool {
        self.first_row == self.run.start
    }

    /// The run in pieces of like length, none longer than `longest`.
    fn pieces(self, longest: u64) -> impl Iterator<Item = Self> {
        let Range { start, end } = self.run;
        let count = (end - start).div_ceil(longest);
        let edge =
            move |piece: u64| start + (end - start) / count * piece + ((end - start) % count).min(piece);
        (0..count).map(move |piece| Self {
            first_row: edge(piece),
            rows: edge(piece + 1) - edge(piece),
            ..self.clone()
        })
    }
}

/// Some rows of a segment in SI.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    /// One vector per input, as measured.
    pub(crate) inputs: Vec<Vec<f64>>,
    /// Coefficients of its course between samples, from some before the first row to some after the last: see
    /// [`intersample::coefficients`].
    pub(crate) held: Vec<Vec<f64>>,
    /// One vector per output; NaN where missing.
    pub(crate) outputs: Vec<Vec<f64>>,
}

impl Chunk {
    pub(crate) fn rows(&self) -> usize {
        self.inputs.first().map_or(0, Vec::len)
    }
}

/// Finds the segments of all recordings, none longer than `longest`, and checks that each recording can be used.
pub(crate) fn segments(
    model: &Model,
    datasets: &[Dataset],
    longest: u64,
    warnings: &mut Vec<String>,
) -> Result<Vec<Segment>, IdentifyError> {
    let mut all = Vec::new();
    for (recording, dataset) in datasets.iter().enumerate() {
        for channel in model.outputs() {
            dataset.channel_index(&channel.column)?;
        }
        let runs = runs(model, dataset, recording)?;
        let (usable, short): (Vec<Segment>, Vec<Segment>) =
            runs.into_iter().partition(|run| run.rows >= MIN_ROWS);
        if usable.is_empty() {
            let rows = short.iter().map(|run| run.rows).max().unwrap_or(0);
            return Err(IdentifyError::TooShort { recording: dataset.name().into(), rows, needed: MIN_ROWS });
        }
        let gaps = usable.len() + short.len() - 1;
        if gaps > 0 {
            warnings.push(format!(
                "{}: {gaps} {}; each part was given a start state of its own",
                dataset.name(),
                if gaps == 1 { "gap" } else { "gaps" },
            ));
        }
        if !short.is_empty() {
            warnings.push(format!(
                "{}: {} of the parts between gaps have fewer than {MIN_ROWS} samples and were left out, {} samples in all",
                dataset.name(),
                short.len(),
                short.iter().map(|run| run.rows).sum::<u64>(),
            ));
        }
        all.extend(usable.into_iter().flat_map(|run| run.pieces(longest)));
    }
    Ok(all)
}

/// Rows without a gap in time or a missing input.
fn runs(model: &Model, dataset: &Dataset, recording: usize) -> Result<Vec<Segment>, IdentifyError> {
    let inputs = model.inputs().map(|channel| dataset.channel_index(&channel.column));
    let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
    let run = |segment: usize, rows: Range<u64>| Segment {
        recording,
        first_row: rows.start,
        rows: rows.end - rows.start,
        sample_time_s: dataset.segments()[segment].sample_time_s,
        origin_s: {
            let segment = &dataset.segments()[segment];
            segment.start_s - segment.first_row as f64 * segment.sample_time_s
        },
        run: rows,
        mask: Arc::default(),
    };
    if inputs.iter().all(|input| dataset.statistics()[*input].missing == 0) {
        let segments = dataset.segments().iter().enumerate();
        return Ok(segments.map(|(index, s)| run(index, s.first_row..s.end_row())).collect());
    }
    let mut found = Vec::new();
    let mut open: Option<(usize, Range<u64>)> = None;
    for block in dataset.blocks_in(0..dataset.rows(), &inputs)? {
        let block = block?;
        for row in 0..block.rows() {
            let complete = block.columns.iter().all(|column| column.get(row).is_some());
            let at = block.first_row + row as u64;
            match &mut open {
                Some((segment, rows)) if complete && *segment == block.segment => rows.end = at + 1,
                _ => {
                    let next = complete.then_some((block.segment, at..at + 1));
                    found.extend(std::mem::replace(&mut open, next));
                }
            }
        }
    }
    found.extend(open);
    Ok(found.into_iter().map(|(segment, rows)| run(segment, rows)).collect())
}

/// Calls `use_chunk` with the rows of a segment, in order; `intersample` says of each input how it moves between samples.
pub(crate) fn read(
    model: &Model,
    dataset: &Dataset,
    segment: &Segment,
    intersample: &[Intersample],
    mut use_chunk: impl FnMut(&Chunk),
) -> Result<(), IdentifyError> {
    let channels: Vec<&Channel> = model.inputs().chain(model.outputs()).collect();
    let columns = channels.iter().map(|channel| dataset.channel_index(&channel.column));
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    let inputs = model.inputs().count();
    // A spline or a rate needs the samples before and after; a piece of a run has those of its neighbours.
    let taken = channels.iter().map(|channel| channel.transform.reach()).max().unwrap_or(0);
    let around = intersample.iter().map(|kind| intersample::reach(*kind)).max().unwrap_or(0);
    let reach = (around + taken) as u64;
    let end = segment.first_row + segment.rows;
    let first = segment.run.start.max(segment.first_row.saturating_sub(reach));
    let last = segment.run.end.min(end + reach);
    let mut angles = vec![0.0; channels.len()];
    for (angle, (channel, column)) in angles.iter_mut().zip(channels.iter().zip(&columns)) {
        if channel.transform == ChannelTransform::Integral {
            *angle = turned_before(dataset, *column, first)?;
        }
    }
    // As recorded.
    let mut window = vec![Vec::new(); channels.len()];
    // Row of the recording at which the window starts, and the next to hand over.
    let (mut start, mut next) = (first, segment.first_row);
    for block in dataset.blocks_in(first..last, &columns)? {
        let block = block?;
        let read = block.first_row + block.rows() as u64;
        for (index, (values, column)) in window.iter_mut().zip(&block.columns).enumerate() {
            values.extend_from_slice(column.values());
            let (rows, new) = (block.first_row..read, values.len() - block.rows());
            match index.checked_sub(inputs) {
                None => segment.mask.impute(index, rows, &mut values[new..]),
                Some(output) => segment.mask.leave_out(output, rows, &mut values[new..]),
            }
        }
        let ready = if read == last { end } else { read.saturating_sub(reach).min(end) };
        if ready <= next {
            continue;
        }
        let rows = (next - start) as usize..(ready - start) as usize;
        let time_s = segment.origin_s + start as f64 * segment.sample_time_s;
        let read = channels.iter().zip(&window).zip(&angles);
        let si: Vec<_> = read
            .map(|((channel, values), angle)| {
                channel.read(values, segment.sample_time_s, TransformStart { time_s, angle: *angle })
            })
            .collect();
        let part =
            |columns: &[Vec<f64>]| columns.iter().map(|values| values[rows.clone()].to_vec()).collect();
        let held = |(values, kind): (&Vec<f64>, &Intersample)| {
            intersample::coefficients(values, rows.clone(), *kind)
        };
        use_chunk(&Chunk {
            inputs: part(&si[..inputs]),
            held: si[..inputs].iter().zip(intersample).map(held).collect(),
            outputs: part(&si[inputs..]),
        });
        next = ready;
        let keep = next.saturating_sub(reach).max(start);
        for ((channel, angle), values) in channels.iter().zip(&mut angles).zip(&si) {
            if channel.transform == ChannelTransform::Integral {
                *angle = values[(keep - start) as usize] / channel.scale;
            }
        }
        window.iter_mut().for_each(|values| drop(values.drain(..(keep - start) as usize)));
        start = keep;
    }
    Ok(())
}

/// Integral of a column from the recording's beginning up to a row, as recorded; over gaps in a straight line.
fn turned_before(dataset: &Dataset, column: usize, row: u64) -> Result<f64, IdentifyError> {
    let (mut sum, mut last) = (0.0, None);
    for block in dataset.blocks_in(0..(row + 1).min(dataset.rows()), &[column])? {
        let block = block?;
        let segment = &dataset.segments()[block.segment];
        for (k, value) in block.columns[0].values().iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            let at = block.first_row + k as u64 - segment.first_row;
            let time_s = segment.start_s + at as f64 * segment.sample_time_s;
            sum += last.map_or(0.0, |(before_s, before)| 0.5 * (time_s - before_s) * (before + value));
            last = Some((time_s, *value));
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests;
