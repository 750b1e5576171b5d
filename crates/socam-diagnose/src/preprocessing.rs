//! Preprocessing of recordings: outputs of disconnected sensors and outliers from the base model's prediction are masked.

use socam_identify::{IdentifyError, LeftOut, NoiseLevels, Options, Problem, outliers};
use socam_model::{self as model, Model};
use socam_recording::{
    Dataset, RecordingError,
    check::{Held, HeldAt, held},
};

/// The recordings with outliers masked, and a list of these. Outliers are found by the residuals of `model` at `values` (SI). A recording
/// without outliers is unchanged.
pub(crate) fn preprocessed(
    model: &Model,
    datasets: &[Dataset],
    values: &[f64],
    levels: &NoiseLevels,
    options: &Options,
) -> Result<(Vec<Dataset>, Vec<LeftOut>), IdentifyError> {
    if datasets.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let found = outliers(&Problem::new(model, datasets, options.clone())?, values, levels)?;
    let each = datasets.iter().map(|dataset| {
        let own: Vec<&LeftOut> = found.iter().filter(|note| note.recording == dataset.name()).collect();
        if own.is_empty() { Ok(dataset.clone()) } else { without_outliers(model, dataset, &own) }
    });
    let datasets: Result<Vec<Dataset>, RecordingError> = each.collect();
    Ok((datasets?, found))
}

/// The recordings with constant outputs masked where an input changes, and a sentence about each. Otherwise the readings of a disconnected
/// sensor would be taken for the bench's motion.
pub(crate) fn connected(
    model: &Model,
    datasets: &[Dataset],
) -> Result<(Vec<Dataset>, Vec<String>), RecordingError> {
    let mut notes = Vec::new();
    let each = datasets.iter().map(|dataset| {
        let constant_outputs = constant_channels(dataset, model.outputs())?;
        let constant_inputs: Vec<&str> = constant_channels(dataset, model.inputs())?.iter().map(|c| c.name.as_str()).collect();
        let name = dataset.name();
        if constant_inputs.len() == model.inputs().count() {
            if constant_outputs.len() < model.outputs().count() {
                let inputs = constant_inputs.join(", ");
                notes.push(format!(
                    "{name}: {inputs} never changes although outputs do: is its sensor connected? Without it they cannot be explained"
                ));
            }
            return Ok(dataset.clone());
        }
        if constant_outputs.is_empty() || constant_outputs.len() == model.outputs().count() {
            return Ok(dataset.clone());
        }
        let columns: Vec<&str> = constant_outputs.iter().map(|channel| channel.column.as_str()).collect();
        for channel in &constant_outputs {
            notes.push(format!("{name}: {} never changes and was left out: is its sensor connected?", channel.name));
        }
        let all = 0..dataset.rows();
        masked(dataset, columns.into_iter().map(|column| (column, vec![all.clone()])))
    });
    let datasets: Result<Vec<Dataset>, RecordingError> = each.collect();
    Ok((datasets?, notes))
}

/// A sentence about each input that is clipped or sticks at one value. The true input may differ from the recorded one there, and the
/// difference looks like missing physics. (Every fit leaves such parts of outputs out and reports it.)
pub(crate) fn held_inputs(model: &Model, datasets: &[Dataset]) -> Result<Vec<String>, RecordingError> {
    let mut notes = Vec::new();
    for dataset in datasets {
        for channel in model.inputs().filter(|channel| !channel.quantity.is_clock()) {
            let Some(column) = dataset.channel_index(&channel.column).ok() else { continue };
            let all = held(dataset, &[column])?;
            notes.extend(all.iter().map(|held| held_sentence(dataset.name(), channel, held)));
        }
    }
    Ok(notes)
}

/// Sentence about an input that is held at a value.
fn held_sentence(recording: &str, channel: &model::Channel, Held { value, at, share, .. }: &Held) -> String {
    let value = channel.scale * value + channel.offset;
    let how = if *at == HeldAt::Between { "sticks" } else { "is clipped" };
    format!(
        "{recording}: the input {} {how} at {value:.4} {} in {:.1} % of the rows: its drive was at its limit, or what acted there is not what was \
         recorded",
        channel.name,
        channel.unit,
        100.0 * share
    )
}

/// Channels of a recording that are constant.
fn constant_channels<'m>(
    dataset: &Dataset,
    channels: impl Iterator<Item = &'m model::Channel>,
) -> Result<Vec<&'m model::Channel>, RecordingError> {
    let mut found = Vec::new();
    for channel in channels {
        let statistics = &dataset.statistics()[dataset.channel_index(&channel.column)?];
        if statistics.count > 1 && statistics.min == statistics.max {
            found.push(channel);
        }
    }
    Ok(found)
}

/// Name of a channel that is constant in all recordings while others change: an output, or an input with a value other than zero. (An input
/// that is zero throughout is a bench that runs freely.)
pub(crate) fn disconnected(model: &Model, datasets: &[Dataset]) -> Result<Option<String>, RecordingError> {
    let (mut constant, mut any_changes): (Vec<&model::Channel>, bool) =
        (model.channels.iter().collect(), false);
    for dataset in datasets {
        let all = model.channels.iter().filter(|channel| !channel.quantity.is_clock());
        let own = constant_channels(dataset, all)?;
        any_changes |= own.len() < model.channels.len();
        constant.retain(|channel| own.contains(channel));
        for channel in model.inputs() {
            let statistics = &dataset.statistics()[dataset.channel_index(&channel.column)?];
            constant.retain(|own| *own != channel || statistics.max.is_some_and(|value| value != 0.0));
        }
    }
    Ok(constant.first().filter(|_| any_changes && !datasets.is_empty()).map(|channel| channel.name.clone()))
}

/// A recording with these outliers masked.
fn without_outliers(
    model: &Model,
    dataset: &Dataset,
    outliers: &[&LeftOut],
) -> Result<Dataset, RecordingError> {
    let each = outliers.iter().filter_map(|note| {
        let channel = model.channels.iter().find(|channel| channel.name == note.channel)?;
        Some((channel.column.as_str(), note.rows.clone()))
    });
    masked(dataset, each)
}

/// The first part of each recording, together about `most` rows; a recording stays as it is where all have no more.
pub(crate) fn heads(datasets: &[Dataset], most: u64) -> Result<Vec<Dataset>, RecordingError> {
    let all: u64 = datasets.iter().map(Dataset::rows).sum();
    let head = |dataset: &Dataset| {
        if all <= most {
            return Ok(dataset.clone());
        }
        let rows = (dataset.rows() as f64 * most as f64 / all as f64).ceil() as u64;
        let loaded = dataset.load_rows(0..rows)?;
        let columns = loaded.columns.iter().map(|column| column.values().to_vec()).collect();
        dataset.with_columns(loaded.time_s, columns)
    };
    datasets.iter().map(head).collect()
}

/// A copy in memory with these rows of columns masked (NaN).
pub(crate) fn masked<'c>(
    dataset: &Dataset,
    rows: impl Iterator<Item = (&'c str, Vec<std::ops::Range<u64>>)>,
) -> Result<Dataset, RecordingError> {
    let loaded = dataset.load_all()?;
    let mut columns: Vec<Vec<f64>> = loaded.columns.iter().map(|column| column.values().to_vec()).collect();
    for (column, rows) in rows {
        let column = dataset.channel_index(column)?;
        for rows in rows {
            columns[column][rows.start as usize..rows.end as usize].fill(f64::NAN);
        }
    }
    dataset.with_columns(loaded.time_s, columns)
}

#[cfg(test)]
mod tests {
    use socam_recording::{Channel, Unit};

    use super::*;

    #[test]
    fn an_input_that_is_clipped_is_seen_before_any_fit() {
        let model = Model::builtin("emps").unwrap();
        let time_s: Vec<f64> = (0..4000).map(|k| 1e-3 * f64::from(k)).collect();
        let force = |limit: f64| -> Vec<f64> {
            let noise = |t: f64| 0.01 * (1e5 * t * t).sin();
            time_s.iter().map(|t| (60.0 * (5.0 * t).sin() + noise(*t)).clamp(-limit, limit)).collect()
        };
        let recording = |limit: f64| {
            let channels = vec![Channel::new("force", Unit::N), Channel::new("position", Unit::M)];
            let position = time_s.iter().map(|t| (5.0 * t).cos()).collect();
            Dataset::from_columns("axis", channels, time_s.clone(), vec![force(limit), position]).unwrap()
        };
        assert_eq!(held_inputs(&model, &[recording(100.0)]).unwrap(), Vec::<String>::new());
        let notes = held_inputs(&model, &[recording(40.0)]).unwrap();
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(
            notes[0].contains("axis: the input force is clipped at") && notes[0].contains("40"),
            "{notes:?}"
        );
    }
}
