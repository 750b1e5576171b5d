//! The recorded inputs and outputs of a model, and the model driven by them.

use socam_model::{Channel, ChannelTransform, Intersample, Model, TransformStart};
use socam_recording::{Dataset, Segment};

use super::intersample;
use crate::SimError;
use crate::plant::Trajectory;

/// An input of the equations as a sum of columns, each with the channel that reads it.
pub(super) type Mix = Vec<(usize, Channel)>;

/// The recording in the model's channels: SI, one list per input and per output (NaN where nothing was measured).
#[derive(Debug)]
pub(super) struct Feed {
    pub(super) time_s: Vec<f64>,
    pub(super) inputs: Vec<Vec<f64>>,
    /// Intersample behaviour of each input.
    pub(super) kinds: Vec<Intersample>,
    pub(super) measured: Vec<Option<Vec<f64>>>,
}

impl Feed {
    pub(super) fn read(data: &Dataset, model: &Model, mixes: &[Mix]) -> Result<Self, SimError> {
        let column_of =
            |channel: &Channel| data.channels().iter().position(|c| c.column_name() == channel.column);
        let outputs: Vec<_> = model.outputs().map(|channel| (column_of(channel), channel)).collect();
        let mut feed = Self {
            time_s: Vec::new(),
            inputs: vec![Vec::new(); mixes.len()],
            kinds: model.inputs().map(Channel::intersample).collect(),
            measured: outputs.iter().map(|(column, ..)| column.map(|_| Vec::new())).collect(),
        };
        for block in data.blocks()? {
            let block = block?;
            let step_s = data.segments()[block.segment].sample_time_s;
            feed.time_s.extend_from_slice(&block.time_s);
            for ((column, channel), measured) in outputs.iter().zip(&mut feed.measured) {
                if let (Some(column), Some(measured)) = (column, measured) {
                    measured.extend(channel.read(
                        block.columns[*column].values(),
                        step_s,
                        TransformStart::default(),
                    ));
                }
            }
        }
        for (mix, input) in mixes.iter().zip(&mut feed.inputs) {
            *input = mixed(data, mix)?;
        }
        feed.inputs.iter_mut().for_each(|input| bridge(&feed.time_s, input));
        Ok(feed)
    }

    /// Drives a trajectory through the first `count` of rows without a gap; `take` gets the outputs at each.
    pub(super) fn follow(
        &self,
        trajectory: &mut Trajectory<'_>,
        rows: std::ops::Range<usize>,
        count: usize,
        mut take: impl FnMut(&[f64]),
    ) -> Result<(), SimError> {
        let from_s = self.time_s[rows.start];
        let mut outputs = vec![0.0; self.measured.len()];
        // Piecewise-linear inputs need no points between samples.
        let parts = if self.kinds.contains(&Intersample::BandLimited) { intersample::PARTS } else { 1 };
        let mut input = vec![0.0; self.inputs.len()];
        for row in rows.clone().take(count) {
            let inputs = || self.inputs.iter().zip(&self.kinds);
            if row > rows.start {
                let before_s = self.time_s[row - 1] - from_s;
                let step_s = self.time_s[row] - self.time_s[row - 1];
                let knots: Vec<_> =
                    inputs().map(|(column, kind)| intersample::knots(column, &rows, row, *kind)).collect();
                for part in 1..=parts {
                    let knot = part * intersample::PARTS / parts - 1;
                    input.iter_mut().zip(&knots).for_each(|(value, knots)| *value = knots[knot]);
                    trajectory.ramp(before_s + step_s * part as f64 / parts as f64, &input)?;
                }
            }
            // Outputs with feedthrough use the input as measured.
            input.iter_mut().zip(inputs()).for_each(|(value, (column, _))| *value = column[row]);
            trajectory.set_input(&input);
            trajectory.outputs(&mut outputs);
            take(&outputs);
            let begin =
                |(column, kind): (&Vec<f64>, &Intersample)| intersample::first(column, &rows, row, *kind);
            input.iter_mut().zip(inputs()).for_each(|(value, input)| *value = begin(input));
            trajectory.set_input(&input);
        }
        Ok(())
    }
}

/// An input over the whole recording. A channel's transform of its column restarts after each gap.
fn mixed(data: &Dataset, mix: &Mix) -> Result<Vec<f64>, SimError> {
    let columns: Vec<usize> = mix.iter().map(|(column, _)| *column).collect();
    let mut recorded = vec![Vec::new(); mix.len()];
    for block in data.blocks_in(0..data.rows(), &columns)? {
        let block = block?;
        recorded.iter_mut().zip(&block.columns).for_each(|(all, more)| all.extend_from_slice(more.values()));
    }
    let mut sum = vec![0.0; recorded.first().map_or(0, Vec::len)];
    for (values, (_, channel)) in recorded.iter().zip(mix) {
        let mut angle = 0.0;
        for segment in data.segments() {
            let from = TransformStart { time_s: segment.start_s, integral: angle };
            let read = channel.read(&values[segment_rows(segment)], segment.sample_time_s, from);
            // The angle turned during a gap is unknown.
            if channel.transform == ChannelTransform::Integral {
                angle = read.last().map_or(angle, |last| last / channel.scale);
            }
            sum[segment_rows(segment)].iter_mut().zip(read).for_each(|(sum, value)| *sum += value);
        }
    }
    Ok(sum)
}

/// Replaces missing values by linear interpolation; at the ends, by the nearest value.
pub(super) fn bridge(time_s: &[f64], values: &mut [f64]) {
    let mut last: Option<usize> = None;
    for row in 0..values.len() {
        if values[row].is_nan() {
            continue;
        }
        let start = last.map_or(0, |last| last + 1);
        for gap in start..row {
            values[gap] = match last {
                None => values[row],
                Some(last) => {
                    let part = (time_s[gap] - time_s[last]) / (time_s[row] - time_s[last]);
                    values[last] + part * (values[row] - values[last])
                }
            };
        }
        last = Some(row);
    }
    let end = last.map_or(0.0, |last| values[last]);
    values.iter_mut().filter(|value| value.is_nan()).for_each(|value| *value = end);
}

/// The rows of a segment.
pub(super) fn segment_rows(segment: &Segment) -> std::ops::Range<usize> {
    segment.first_row as usize..segment.end_row() as usize
}
