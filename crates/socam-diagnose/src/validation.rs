//! Which recordings are fitted and which are only predicted.

use socam_recording::{Channel, Dataset, RecordingError};

use crate::document::Validation;

/// Parts that a single recording is cut into.
const BLOCKS: usize = 3;

/// One way to part the recordings.
#[derive(Debug, Clone)]
pub(crate) struct Fold {
    pub(crate) fitted: Vec<Dataset>,
    pub(crate) held_out: Vec<Dataset>,
}

/// All ways in which a correction is tried on data that it was not fitted to.
#[derive(Debug, Clone)]
pub(crate) struct Folds {
    pub(crate) kind: Validation,
    pub(crate) folds: Vec<Fold>,
}

impl Folds {
    pub(crate) fn new(training: &[Dataset], holdout: &[Dataset]) -> Result<Self, RecordingError> {
        if !holdout.is_empty() {
            let fold = Fold { fitted: training.to_vec(), held_out: holdout.to_vec() };
            return Ok(Self { kind: Validation::Holdout, folds: vec![fold] });
        }
        let (kind, parts) = match training {
            [single] => (Validation::Blocks, blocks(single)?),
            many => (Validation::LeaveOneOut, many.to_vec()),
        };
        let without = |left_out: usize| Fold {
            fitted: parts
                .iter()
                .enumerate()
                .filter(|(k, _)| *k != left_out)
                .map(|(_, part)| part.clone())
                .collect(),
            held_out: vec![parts[left_out].clone()],
        };
        Ok(Self { kind, folds: (0..parts.len()).map(without).collect() })
    }
}

/// A recording in parts of like length.
fn blocks(dataset: &Dataset) -> Result<Vec<Dataset>, RecordingError> {
    let channels: Vec<Channel> = dataset.channels().to_vec();
    let names: Vec<String> = channels.iter().map(Channel::column_name).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let loaded = dataset.load(&names)?;
    let rows = loaded.time_s.len();
    let part = |block: usize| {
        let range = rows * block / BLOCKS..rows * (block + 1) / BLOCKS;
        let columns = loaded.columns.iter().map(|column| column.values()[range.clone()].to_vec()).collect();
        let name = format!("{} part {} of {BLOCKS}", dataset.name(), block + 1);
        Dataset::from_columns(name, channels.clone(), loaded.time_s[range.clone()].to_vec(), columns)
    };
    (0..BLOCKS).map(part).collect()
}
