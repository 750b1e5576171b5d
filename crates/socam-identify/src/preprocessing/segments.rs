//! Segments of recordings, and how they are read: consecutive rows at a constant rate with every input present, chunk by chunk.

use std::{borrow::Cow, ops::Range, sync::Arc};

use socam_model::{Channel, ChannelTransform, Model, TransformStart};

use socam_recording::{Block, Dataset};

use crate::{
    IdentifyError, Intersample,
    prediction::{
        exponential::SampleSteps,
        intersample::{self, BasisPolynomial, InputPolynomial},
    },
    preprocessing::mask::Mask,
};

/// Fewest samples of a segment. A shorter one would cost more unknowns (its start state) than it has information.
const MIN_ROWS: u64 = 20;

/// Largest number of samples of a segment whose start states are free. Longer segments are divided so that one long recording uses
/// all cores; the additional start states cost nothing with this many samples.
pub(crate) const MOST_ROWS: u64 = 250_000;

/// Consecutive rows of a recording at a constant rate, without a missing input.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    /// Index of the recording.
    pub(crate) recording: usize,
    pub(crate) first_row: u64,
    pub(crate) rows: u64,
    pub(crate) sample_time_s: f64,
    /// Length of the longest step where steps are uneven; `sample_time_s` is then the mean.
    pub(crate) longest_step_s: Option<f64>,
    /// Time of row 0 of the recording, extrapolated at the rate of this segment, s.
    pub(crate) origin_s: f64,
    /// The uninterrupted rows of which the segment is all or a part.
    pub(crate) uninterrupted: Range<u64>,
    /// Samples of the recording that are not used as measured.
    pub(crate) mask: Arc<Mask>,
}

impl Segment {
    /// The first `rows` rows of the segment.
    pub(crate) fn head(&self, rows: u64) -> Self {
        Self { rows: self.rows.min(rows), ..self.clone() }
    }

    /// The segment in pieces of `rows` rows; what remains at its end is left out.
    pub(crate) fn pieces(&self, rows: u64) -> impl Iterator<Item = Self> {
        let first = move |piece: u64| self.first_row + piece * rows;
        (0..self.rows / rows).map(move |piece| Self { first_row: first(piece), rows, ..self.clone() })
    }

    /// Lengths of the steps between its samples.
    pub(crate) fn steps(&self) -> SampleSteps {
        self.longest_step_s.map_or(SampleSteps::Even(self.sample_time_s), SampleSteps::Uneven)
    }

    /// Times of its rows, s.
    ///
    /// # Errors
    /// When the recording cannot be read.
    pub(crate) fn times_s(&self, dataset: &Dataset) -> Result<Vec<f64>, IdentifyError> {
        let rows = self.first_row..self.first_row + self.rows;
        if self.longest_step_s.is_none() {
            return Ok(rows.map(|row| self.origin_s + row as f64 * self.sample_time_s).collect());
        }
        let mut times_s = Vec::with_capacity(self.rows as usize);
        for block in dataset.blocks_in(rows, &[])? {
            times_s.extend_from_slice(&block?.time_s);
        }
        Ok(times_s)
    }

    /// Whether the segment is the first part of its uninterrupted rows.
    pub(crate) fn starts_uninterrupted(&self) -> bool {
        self.first_row == self.uninterrupted.start
    }

    /// The uninterrupted rows in parts of similar length, none longer than `longest`.
    fn parts(self, longest: u64) -> impl Iterator<Item = Self> {
        let Range { start, end } = self.uninterrupted;
        let count = (end - start).div_ceil(longest);
        let edge = move |part: u64| start + (end - start) / count * part + ((end - start) % count).min(part);
        (0..count).map(move |part| Self {
            first_row: edge(part),
            rows: edge(part + 1) - edge(part),
            ..self.clone()
        })
    }
}

/// Some rows of a segment in SI.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    /// One vector per input, as measured.
    pub(crate) inputs: Vec<Vec<f64>>,
    /// One vector per input: the coefficients of its reconstruction between samples, from some before the first row to some after the
    /// last, see [`intersample::coefficients`].
    pub(crate) held: Vec<Vec<f64>>,
    /// One vector per output; NaN where missing.
    pub(crate) outputs: Vec<Vec<f64>>,
    /// The steps between the samples and the inputs over them, where steps are uneven; `held` is then empty.
    pub(crate) steps: Option<UnevenSteps>,
}

/// Steps of different lengths, one for each row, which ends it.
#[derive(Debug)]
pub(crate) struct UnevenSteps {
    /// Start of the first step and end of each, s since the segment's first row.
    times_s: Vec<f64>,
    /// Per input, its course over each step.
    inputs: Vec<Vec<InputPolynomial>>,
}

impl UnevenSteps {
    /// Length of the step that ends at row `k`, s.
    pub(crate) fn length_s(&self, k: usize) -> f64 {
        self.times_s[k + 1] - self.times_s[k]
    }

    /// Course of an input over the step that ends at row `k`; `None` where there is no such input.
    pub(crate) fn input(&self, input: usize, k: usize) -> Option<&InputPolynomial> {
        Some(&self.inputs.get(input)?[k])
    }
}

impl Chunk {
    pub(crate) fn rows(&self) -> usize {
        self.inputs.first().map_or(0, Vec::len)
    }

    /// Sets `polynomials` to the course of each input over the step that ends at row `k`; `bases` are those of the inputs' kinds.
    pub(crate) fn inputs_along(
        &self,
        k: usize,
        bases: &[Vec<BasisPolynomial>],
        polynomials: &mut Vec<InputPolynomial>,
    ) {
        polynomials.clear();
        match &self.steps {
            Some(steps) => polynomials.extend(steps.inputs.iter().map(|input| input[k])),
            None => {
                let along = self.held.iter().zip(bases);
                polynomials.extend(along.map(|(held, bases)| InputPolynomial::new(bases, &held[k..])));
            }
        }
    }

    /// Length of the step that ends at row `k` in parts of `part_s`, so that no sample is further than half a part from its time; `None`
    /// where all steps are equal.
    pub(crate) fn parts(&self, k: usize, part_s: f64) -> Option<usize> {
        let steps = self.steps.as_ref()?;
        let at = |edge: usize| (steps.times_s[edge] / part_s).round();
        Some((at(k + 1) - at(k)) as usize)
    }
}

/// The recording at a constant rate, for filters of its motion.
pub(crate) fn evenly(dataset: &Dataset) -> Result<Cow<'_, Dataset>, IdentifyError> {
    Ok(if dataset.has_uneven_steps() {
        Cow::Owned(dataset.clone().regular()?)
    } else {
        Cow::Borrowed(dataset)
    })
}

/// Values of a column as recorded.
pub(crate) fn recorded(
    dataset: &Dataset,
    column: usize,
    rows: Range<u64>,
) -> Result<Vec<f64>, IdentifyError> {
    let mut values = Vec::with_capacity((rows.end - rows.start) as usize);
    for block in dataset.blocks_in(rows, &[column])? {
        values.extend_from_slice(block?.columns[0].values());
    }
    Ok(values)
}

/// The segments of all recordings, none longer than `longest` rows. Sentences about gaps are appended to `warnings`.
///
/// # Errors
/// When a recording lacks a channel of the model, has no segment of enough rows, or cannot be read.
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
        all.extend(usable.into_iter().flat_map(|run| run.parts(longest)));
    }
    Ok(all)
}

/// The uninterrupted rows of a recording: those without a gap in time or a missing input.
fn runs(model: &Model, dataset: &Dataset, recording: usize) -> Result<Vec<Segment>, IdentifyError> {
    let inputs = model.inputs().map(|channel| dataset.channel_index(&channel.column));
    let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
    let run = |segment: usize, rows: Range<u64>| Segment {
        recording,
        first_row: rows.start,
        rows: rows.end - rows.start,
        sample_time_s: dataset.segments()[segment].sample_time_s,
        longest_step_s: dataset.has_uneven_steps().then(|| {
            let segment = &dataset.segments()[segment];
            segment.sample_time_s + segment.jitter_s
        }),
        origin_s: {
            let segment = &dataset.segments()[segment];
            segment.start_s - segment.first_row as f64 * segment.sample_time_s
        },
        uninterrupted: rows,
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

/// Reads a segment chunk by chunk, in order, and calls `use_chunk` with each. `intersample` has one entry per input.
///
/// # Errors
/// When the recording lacks a channel of the model, or a file cannot be read.
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
    // A spline or a rate needs samples before and after the rows. A part of an uninterrupted stretch takes them from its neighbours.
    let by_transform = channels.iter().map(|channel| channel.transform.reach()).max().unwrap_or(0);
    let by_spline = intersample.iter().map(|kind| intersample::reach(*kind)).max().unwrap_or(0);
    let by_spline =
        by_spline.max(if segment.longest_step_s.is_some() { intersample::UNEVEN_SIDE } else { 0 });
    let reach = (by_spline + by_transform) as u64;
    let end = segment.first_row + segment.rows;
    let first = segment.uninterrupted.start.max(segment.first_row.saturating_sub(reach));
    let last = segment.uninterrupted.end.min(end + reach);
    let mut window = Window::new(model, channels, segment, first);
    for (integral, (channel, column)) in window.integrals.iter_mut().zip(window.channels.iter().zip(&columns))
    {
        if channel.transform == ChannelTransform::Integral {
            *integral = integral_before(dataset, *column, first)?;
        }
    }
    let mut next = segment.first_row;
    for block in dataset.blocks_in(first..last, &columns)? {
        let block = block?;
        let read = block.first_row + block.rows() as u64;
        window.append(&block);
        let ready = if read == last { end } else { read.saturating_sub(reach).min(end) };
        if ready <= next {
            continue;
        }
        let (chunk, si) = window.chunk(next..ready, intersample);
        use_chunk(&chunk);
        next = ready;
        window.drop_before(next.saturating_sub(reach), &si);
    }
    Ok(())
}

/// Consecutive recorded values of all channels of a segment, as far as they are needed.
struct Window<'a> {
    segment: &'a Segment,
    channels: Vec<&'a Channel>,
    /// Number of inputs, which come first among the channels.
    inputs: usize,
    /// Row of the recording at which the window starts.
    start: u64,
    /// Values in the recording's units, per channel.
    values: Vec<Vec<f64>>,
    /// Times of the recording, s, where steps are uneven.
    time_s: Vec<f64>,
    /// Time of the segment's first row, s; known from the first chunk on.
    first_s: Option<f64>,
    /// Per channel, the integral from the recording's beginning to `start`; zero for other transforms.
    integrals: Vec<f64>,
}

impl<'a> Window<'a> {
    fn new(model: &Model, channels: Vec<&'a Channel>, segment: &'a Segment, start: u64) -> Self {
        let count = channels.len();
        Self {
            segment,
            channels,
            inputs: model.inputs().count(),
            start,
            values: vec![Vec::new(); count],
            time_s: Vec::new(),
            first_s: None,
            integrals: vec![0.0; count],
        }
    }

    /// Appends a block, masked outputs as NaN and imputed inputs replaced.
    fn append(&mut self, block: &Block) {
        let rows = block.first_row..block.first_row + block.rows() as u64;
        if self.segment.longest_step_s.is_some() {
            self.time_s.extend_from_slice(&block.time_s);
        }
        for (index, (values, column)) in self.values.iter_mut().zip(&block.columns).enumerate() {
            values.extend_from_slice(column.values());
            let new = values.len() - block.rows();
            match index.checked_sub(self.inputs) {
                None => self.segment.mask.impute(index, rows.clone(), &mut values[new..]),
                Some(output) => self.segment.mask.leave_out(output, rows.clone(), &mut values[new..]),
            }
        }
    }

    /// Some rows as a chunk, and the SI values of the whole window.
    fn chunk(&mut self, rows: Range<u64>, intersample: &[Intersample]) -> (Chunk, Vec<Vec<f64>>) {
        let is_uneven = self.segment.longest_step_s.is_some();
        let rows = (rows.start - self.start) as usize..(rows.end - self.start) as usize;
        let time_s = self.segment.origin_s + self.start as f64 * self.segment.sample_time_s;
        let read = self.channels.iter().zip(&self.values).zip(&self.integrals);
        let si: Vec<_> = read
            .map(|((channel, values), integral)| {
                let start = TransformStart { time_s, integral: *integral };
                match is_uneven {
                    true => channel.read_at(values, &self.time_s, start),
                    false => channel.read(values, self.segment.sample_time_s, start),
                }
            })
            .collect();
        let steps = is_uneven.then(|| {
            let first_s = *self.first_s.get_or_insert(self.time_s[rows.start]);
            let times = rows.start.saturating_sub(1)..rows.end;
            let before = (rows.start == 0).then_some(self.time_s[0]);
            let along = |(values, kind): (&Vec<f64>, &Intersample)| {
                rows.clone().map(|k| InputPolynomial::between(values, &self.time_s, k, *kind)).collect()
            };
            UnevenSteps {
                times_s: before.iter().chain(&self.time_s[times]).map(|time_s| time_s - first_s).collect(),
                inputs: si[..self.inputs].iter().zip(intersample).map(along).collect(),
            }
        });
        let part =
            |columns: &[Vec<f64>]| columns.iter().map(|values| values[rows.clone()].to_vec()).collect();
        let held = |(values, kind): (&Vec<f64>, &Intersample)| {
            intersample::coefficients(values, rows.clone(), *kind)
        };
        let chunk = Chunk {
            inputs: part(&si[..self.inputs]),
            held: match is_uneven {
                true => Vec::new(),
                false => si[..self.inputs].iter().zip(intersample).map(held).collect(),
            },
            steps,
            outputs: part(&si[self.inputs..]),
        };
        (chunk, si)
    }

    /// Drops all rows before `row`; `si` are the SI values of the window.
    fn drop_before(&mut self, row: u64, si: &[Vec<f64>]) {
        let row = row.max(self.start);
        let count = (row - self.start) as usize;
        for ((channel, integral), values) in self.channels.iter().zip(&mut self.integrals).zip(si) {
            if channel.transform == ChannelTransform::Integral {
                *integral = values[count] / channel.scale;
            }
        }
        self.values.iter_mut().for_each(|values| drop(values.drain(..count)));
        self.time_s.drain(..count.min(self.time_s.len()));
        self.start = row;
    }
}

/// Integral over time of a column, in its own unit, from the recording's beginning up to a row. Gaps are bridged linearly.
fn integral_before(dataset: &Dataset, column: usize, row: u64) -> Result<f64, IdentifyError> {
    let (mut sum, mut last) = (0.0, None);
    for block in dataset.blocks_in(0..(row + 1).min(dataset.rows()), &[column])? {
        let block = block?;
        let segment = &dataset.segments()[block.segment];
        for (k, value) in block.columns[0].values().iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            let at = block.first_row + k as u64 - segment.first_row;
            let time_s = match dataset.has_uneven_steps() {
                true => block.time_s[k],
                false => segment.start_s + at as f64 * segment.sample_time_s,
            };
            sum += last.map_or(0.0, |(before_s, before)| 0.5 * (time_s - before_s) * (before + value));
            last = Some((time_s, *value));
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests;
