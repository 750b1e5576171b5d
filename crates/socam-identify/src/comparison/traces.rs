//! Signals of an evaluation: predictions and measurements.

use rayon::prelude::*;
use socam_model::Model;

use crate::{
    IdentifyError,
    comparison::Evaluation,
    prediction::{
        modal,
        replay::{Replay, replay},
    },
    problem::Problem,
};

/// Signals of one segment of a recording.
#[derive(Debug, Clone)]
pub struct Traces {
    /// Index of the recording.
    pub recording: usize,
    /// Time of the recording, s.
    pub time_s: Vec<f64>,
    /// Inputs as the model reads them, SI.
    pub inputs: Vec<Vec<f64>>,
    /// Measured outputs, SI; NaN where missing.
    pub measured: Vec<Vec<f64>>,
    /// Outputs simulated from the inputs, SI.
    pub predicted: Vec<Vec<f64>>,
}

/// Inputs, measurements and predictions by segment. `observer` is the problem's model with other outputs, which are then predicted
/// instead.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{NoiseModel, measure, traces}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let at = measure(&problem, &noise_model, &values)?.expect("no overflow");
/// let signals = traces(&problem, &at, None)?;
/// assert!((signals[0].measured[0][500] - signals[0].predicted[0][500]).abs() < 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read, or the prediction overflows.
pub fn traces(
    problem: &Problem<'_>,
    at: &Evaluation,
    observer: Option<&Model>,
) -> Result<Vec<Traces>, IdentifyError> {
    let each = problem.segments.par_iter().zip(&at.nuisance).map(|(segment, nuisance)| {
        let model = observer.unwrap_or(problem.model);
        let Replay { inputs, measured, predicted, .. } =
            replay(problem, model, &at.values, segment, nuisance, &[])?;
        let (recording, dataset) = (segment.recording, &problem.datasets[segment.recording]);
        let mut own = Traces { recording, time_s: segment.times_s(dataset)?, inputs, measured, predicted };
        if observer.is_some() {
            return Ok(own);
        }
        let estimated = modal::offset_channels(problem);
        let offsets = &nuisance[nuisance.len() - estimated.len()..];
        for (output, offset) in estimated.into_iter().zip(offsets) {
            own.predicted[output].iter_mut().for_each(|value| *value += offset);
        }
        Ok(own)
    });
    each.collect()
}
