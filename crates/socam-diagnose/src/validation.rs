//! Which recordings are fitted and which are only predicted.

use std::ops::Range;

use socam_model::Model;
use socam_recording::{Dataset, RecordingError};

use crate::{cleaned::blanked, document::Validation};

/// Parts that a single recording is cut into.
const BLOCKS: usize = 3;

/// One way to part the recordings.
#[derive(Debug, Clone)]
pub(crate) struct Fold {
    /// None where recordings are held out: all others are fitted.
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
    pub(crate) fn new(
        model: &Model,
        training: &[Dataset],
        holdout: &[Dataset],
    ) -> Result<Self, RecordingError> {
        if !holdout.is_empty() {
            // What is fitted to is all that there is.
            let fold = Fold { fitted: Vec::new(), held_out: holdout.to_vec() };
            return Ok(Self { kind: Validation::Holdout, folds: vec![fold] });
        }
        if let [single] = training {
            let folds: Result<_, _> = (0..BLOCKS).map(|block| without_block(model, single, block)).collect();
            return Ok(Self { kind: Validation::Blocks, folds: folds? });
        }
        Ok(Self::in_turn(training))
    }

    /// Each of some recordings left out in turn.
    pub(crate) fn in_turn(training: &[Dataset]) -> Self {
        let without = |left_out: usize| Fold {
            fitted: [&training[..left_out], &training[left_out + 1..]].concat(),
            held_out: vec![training[left_out].clone()],
        };
        Self { kind: Validation::LeaveOneOut, folds: (0..training.len()).map(without).collect() }
    }
}

/// A recording whose outputs are held out in one part and fitted in the others. Its inputs stay: angles, time and the start are those
/// of the whole.
fn without_block(model: &Model, dataset: &Dataset, block: usize) -> Result<Fold, RecordingError> {
    let edge = |block: usize| dataset.rows() * block as u64 / BLOCKS as u64;
    let (from, to) = (edge(block), edge(block + 1));
    let missing = |rows: &[Range<u64>]| {
        let outputs = model.outputs().filter(|channel| !channel.quantity.is_clock());
        blanked(dataset, outputs.map(|channel| (channel.column.as_str(), rows.to_vec())))
    };
    let block = from..to;
    let others = [0..from, to..dataset.rows()];
    Ok(Fold { fitted: vec![missing(std::slice::from_ref(&block))?], held_out: vec![missing(&others)?] })
}
