//! Recordings as signals over frequency: stretches of one input and one output in SI, and what made the input.

use socam_frequency::{
    FrequencyError,
    prepare::{self, Butterworth},
    response::Signals,
};
use socam_model::{Channel, ChannelTransform, Model, Role, TransformStart};
use socam_recording::Dataset;

use crate::output::{self, WrongArguments};

/// What the virtual bench and the board record of what they were told.
const COMMAND: &str = "command_V";

/// The channels of a response, as indices among the model's inputs and outputs.
pub(super) struct Pair<'m> {
    pub(super) input_index: usize,
    pub(super) input: &'m Channel,
    pub(super) output_index: usize,
    pub(super) output: &'m Channel,
}

/// The model's input and the outputs asked for (all, where none is).
pub(super) fn pairs<'m>(model: &'m Model, wanted: &[String]) -> anyhow::Result<Vec<Pair<'m>>> {
    let moving: Vec<(usize, &Channel)> =
        model.inputs().enumerate().filter(|(_, channel)| !channel.quantity.is_clock()).collect();
    let [(input_index, input)] = moving[..] else {
        let names: Vec<&str> = moving.iter().map(|(_, channel)| channel.name.as_str()).collect();
        anyhow::bail!(
            "the model {} has the inputs {}; a frequency response is of one input, so give a model with one",
            model.name,
            names.join(", ")
        );
    };
    let outputs: Vec<(usize, &Channel)> = model.outputs().enumerate().collect();
    if let Some(unknown) = wanted.iter().find(|name| !outputs.iter().any(|(_, o)| o.name == **name)) {
        let names: Vec<&str> = outputs.iter().map(|(_, channel)| channel.name.as_str()).collect();
        let message =
            format!("--output {unknown}: the model {} has the outputs {}", model.name, names.join(", "));
        return Err(WrongArguments(message).into());
    }
    let asked = |channel: &Channel| wanted.is_empty() || wanted.contains(&channel.name);
    Ok(outputs
        .into_iter()
        .filter(|(_, channel)| asked(channel))
        .map(|(output_index, output)| Pair { input_index, input, output_index, output })
        .collect())
}

/// One stretch without gaps.
#[derive(Debug, Clone)]
pub(super) struct Stretch {
    pub(super) recording: String,
    pub(super) input: Vec<f64>,
    pub(super) output: Vec<f64>,
    reference: Option<Vec<f64>>,
    pub(super) sample_time_s: f64,
}

impl Stretch {
    pub(super) fn signals(&self) -> Signals<'_> {
        Signals {
            input: &self.input,
            output: &self.output,
            reference: self.reference.as_deref(),
            sample_time_s: self.sample_time_s,
        }
    }

    pub(super) fn has_reference(&self) -> bool {
        self.reference.is_some()
    }

    /// Takes outliers out of both signals, and tells how many.
    pub(super) fn without_outliers(&mut self, limit: f64) -> usize {
        prepare::replace_outliers(&mut self.input, limit) + prepare::replace_outliers(&mut self.output, limit)
    }

    /// Filters all signals alike, so that what is between them stays.
    pub(super) fn filter(&mut self, order: usize, corner_hz: f64) -> Result<(), FrequencyError> {
        let filter = Butterworth::new(order, corner_hz, 1.0 / self.sample_time_s)?;
        let signals = [Some(&mut self.input), Some(&mut self.output), self.reference.as_mut()];
        for signal in signals.into_iter().flatten() {
            *signal = filter.filtered(signal);
        }
        Ok(())
    }
}

/// Reads a pair's stretches out of all recordings. `reference` names the column that made the input; without a name it is the
/// command, where every recording has one.
pub(super) fn stretches(
    datasets: &[Dataset],
    pair: &Pair<'_>,
    reference: Option<&str>,
) -> anyhow::Result<Vec<Stretch>> {
    let known = |dataset: &Dataset| dataset.channel_index(COMMAND).is_ok();
    let reference = reference.or_else(|| datasets.iter().all(known).then_some(COMMAND));
    let mut stretches = Vec::new();
    for dataset in datasets {
        read(dataset, pair, reference, &mut stretches)?;
    }
    Ok(stretches)
}

fn read(
    dataset: &Dataset,
    pair: &Pair<'_>,
    reference: Option<&str>,
    stretches: &mut Vec<Stretch>,
) -> anyhow::Result<()> {
    for channel in [pair.input, pair.output] {
        if channel.transform != ChannelTransform::Value && channel.transform != ChannelTransform::Rate {
            anyhow::bail!(
                "the channel {} takes a wave of its column, which has no frequency response; use --method output-error",
                channel.name
            );
        }
    }
    let mut columns =
        vec![dataset.channel_index(&pair.input.column)?, dataset.channel_index(&pair.output.column)?];
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
        let si = |channel: &Channel, column: &[f64]| {
            channel.read(column, segment.sample_time_s, TransformStart::default())
        };
        let (input, output) = (si(pair.input, &values[0]), si(pair.output, &values[1]));
        let command = values.get(2);
        for rows in complete(&values) {
            stretches.push(Stretch {
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

/// Runs of rows in which no value is missing.
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

/// Whether the model's channel of this name is an input of it.
pub(super) fn say_bias(stretches: &[Stretch], pair: &Pair<'_>) {
    debug_assert!(pair.input.role == Role::Input);
    if stretches.iter().all(Stretch::has_reference) {
        return;
    }
    output::warn(format_args!(
        "no column tells what made {0} (`{COMMAND}`, or --reference COLUMN); where the signals do not repeat, noise of {0}'s sensor makes the response too small",
        pair.input.name
    ));
}
