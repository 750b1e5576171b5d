//! Signals for frequency-domain methods: segments of one input and one output in SI, with the reference.

use socam_frequency::{
    FrequencyError,
    prepare::{self, Butterworth},
    response::Signals,
};
use socam_model::{Channel, ChannelTransform, Model, TransformStart};
use socam_recording::Dataset;

use crate::error::{ResponseError, Result};

/// The recorded command, the default reference.
const COMMAND: &str = "command_V";

/// The channels of a response, as indices among the model's inputs and outputs.
#[derive(Debug, Clone, Copy)]
pub struct Pair<'m> {
    pub(crate) input_index: usize,
    /// The model's input.
    pub input: &'m Channel,
    pub(crate) output_index: usize,
    /// An output of the model.
    pub output: &'m Channel,
}

/// A signal: a column of the recordings, read as a channel of a model reads it, or as it is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Signal<'a> {
    pub(crate) column: &'a str,
    pub(crate) channel: Option<&'a Channel>,
}

impl<'a> Signal<'a> {
    /// The signal that a channel reads.
    pub(crate) fn of(channel: &'a Channel) -> Self {
        Self { column: &channel.column, channel: Some(channel) }
    }

    /// A column, read as the first of these channels that reads it.
    pub(crate) fn of_column(column: &'a str, mut channels: impl Iterator<Item = &'a Channel>) -> Self {
        Self { column, channel: channels.find(|channel| channel.column == column) }
    }

    fn name(&self) -> &'a str {
        self.channel.map_or(self.column, |channel| &channel.name)
    }

    /// # Errors
    /// [`ResponseError::Wave`] for a channel whose values are no linear function of its column.
    fn check(&self) -> Result<()> {
        match self.channel {
            Some(channel)
                if channel.transform != ChannelTransform::Value
                    && channel.transform != ChannelTransform::Rate =>
            {
                Err(ResponseError::Wave { channel: channel.name.clone() })
            }
            _ => Ok(()),
        }
    }

    fn read(&self, values: &[f64], sample_time_s: f64) -> Vec<f64> {
        self.channel.map_or_else(
            || values.to_vec(),
            |channel| channel.read(values, sample_time_s, TransformStart::default()),
        )
    }
}

/// The model's input with each requested output (all outputs if none is requested).
pub(crate) fn pairs<'m>(model: &'m Model, wanted: &[String]) -> Result<Vec<Pair<'m>>> {
    let moving: Vec<(usize, &Channel)> =
        model.inputs().enumerate().filter(|(_, channel)| !channel.quantity.is_clock()).collect();
    let [(input_index, input)] = moving[..] else {
        return Err(ResponseError::Inputs { model: model.name.clone(), inputs: names(&moving) });
    };
    let outputs: Vec<(usize, &Channel)> = model.outputs().enumerate().collect();
    if let Some(unknown) = wanted.iter().find(|name| !outputs.iter().any(|(_, o)| o.name == **name)) {
        return Err(ResponseError::UnknownOutput {
            name: unknown.clone(),
            model: model.name.clone(),
            outputs: names(&outputs),
        });
    }
    let asked = |channel: &Channel| wanted.is_empty() || wanted.contains(&channel.name);
    Ok(outputs
        .into_iter()
        .filter(|(_, channel)| asked(channel))
        .map(|(output_index, output)| Pair { input_index, input, output_index, output })
        .collect())
}

fn names(channels: &[(usize, &Channel)]) -> String {
    let names: Vec<&str> = channels.iter().map(|(_, channel)| channel.name.as_str()).collect();
    names.join(", ")
}

/// One segment without gaps.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub(crate) recording: String,
    pub(crate) input: Vec<f64>,
    pub(crate) output: Vec<f64>,
    reference: Option<Vec<f64>>,
    pub(crate) sample_time_s: f64,
}

impl Segment {
    pub(crate) fn signals(&self) -> Signals<'_> {
        Signals {
            input: &self.input,
            output: &self.output,
            reference: self.reference.as_deref(),
            sample_time_s: self.sample_time_s,
        }
    }

    pub(crate) fn has_reference(&self) -> bool {
        self.reference.is_some()
    }

    /// Replaces outliers in both signals, and returns their number.
    pub(crate) fn without_outliers(&mut self, limit: f64) -> usize {
        prepare::replace_outliers(&mut self.input, limit) + prepare::replace_outliers(&mut self.output, limit)
    }

    /// Filters all signals in the same way, which does not change the response between them.
    pub(crate) fn filter(&mut self, order: usize, corner_hz: f64) -> std::result::Result<(), FrequencyError> {
        let filter = Butterworth::new(order, corner_hz, 1.0 / self.sample_time_s)?;
        let signals = [Some(&mut self.input), Some(&mut self.output), self.reference.as_mut()];
        for signal in signals.into_iter().flatten() {
            *signal = filter.filtered(signal);
        }
        Ok(())
    }
}

/// Reads the segments of input and output from all recordings. `reference` is the column of the reference signal; without a name it is the command,
/// if every recording has one.
pub(crate) fn segments(
    datasets: &[Dataset],
    signals: [Signal<'_>; 2],
    reference: Option<&str>,
) -> Result<Vec<Segment>> {
    let known = |dataset: &Dataset| dataset.channel_index(COMMAND).is_ok();
    let reference = reference.or_else(|| datasets.iter().all(known).then_some(COMMAND));
    let mut segments = Vec::new();
    for dataset in datasets {
        read(dataset, signals, reference, &mut segments)?;
    }
    Ok(segments)
}

fn read(
    dataset: &Dataset,
    [input, output]: [Signal<'_>; 2],
    reference: Option<&str>,
    segments: &mut Vec<Segment>,
) -> Result<()> {
    input.check()?;
    output.check()?;
    let mut columns = vec![dataset.channel_index(input.column)?, dataset.channel_index(output.column)?];
    if let Some(reference) = reference {
        columns.push(dataset.channel_index(reference)?);
    }
    for segment in dataset.segments() {
        let rows = segment.first_row..segment.end_row();
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
        for block in dataset.blocks_in(rows, &columns)? {
            for (column, own) in block?.columns.iter().zip(&mut values) {
                own.extend_from_slice(column.values());
            }
        }
        let step_s = segment.sample_time_s;
        let (input, output) = (input.read(&values[0], step_s), output.read(&values[1], step_s));
        let command = values.get(2);
        for rows in complete(&values) {
            segments.push(Segment {
                recording: dataset.name().to_owned(),
                input: input[rows.clone()].to_vec(),
                output: output[rows.clone()].to_vec(),
                reference: command.map(|values| values[rows].to_vec()),
                sample_time_s: segment.sample_time_s,
            });
        }
    }
    Ok(())
}

/// Ranges of rows without missing values.
fn complete(columns: &[Vec<f64>]) -> Vec<std::ops::Range<usize>> {
    let rows = columns.first().map_or(0, Vec::len);
    let whole = |row: usize| columns.iter().all(|column| !column[row].is_nan());
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for row in (0..rows).filter(|row| whole(*row)) {
        match runs.last_mut() {
            Some(run) if run.end == row => run.end += 1,
            _ => runs.push(row..row + 1),
        }
    }
    runs
}

/// Warns that the noise of the input biases the response, if there is no reference signal.
pub(crate) fn bias(segments: &[Segment], input: Signal<'_>) -> Option<String> {
    let input = input.name();
    (!segments.iter().all(Segment::has_reference)).then(|| {
        format!(
            "no column tells what made {input} (`{COMMAND}`, or another reference); where the signals do not repeat, noise of {input}'s sensor makes the response too small"
        )
    })
}
