//! The statistics of one block: how its innovations differ from noise.

use socam_identify::{
    IdentifyError, Options, Problem, StartState,
    comparison::{self, NoiseModel},
};
use socam_model::{Model, Quantity};
use socam_recording::{Channel, Dataset};

use crate::{
    BlockSignals, MonitorError, Symptom,
    cutter::{self, Block},
};

/// Attempted integration steps per sample beyond which a block is not judged.
const MOST_STEPS: usize = 64;
/// Share of a block's samples that a channel must have for its statistics to count.
const MOST_MISSING: f64 = 0.5;

/// Options of every evaluation.
pub(crate) fn options() -> Options {
    Options { starts: 1, start_state: StartState::Free, most_steps: Some(MOST_STEPS), ..Options::default() }
}

/// Evaluates a model on blocks under a fixed noise model.
#[derive(Debug, Clone)]
pub(crate) struct Meter {
    pub(crate) model: Model,
    pub(crate) noise: NoiseModel,
    /// Sample time, s.
    pub(crate) step_s: f64,
    /// Columns that the model reads.
    pub(crate) channels: Vec<Channel>,
    /// Indices of the free parameters.
    free: Vec<usize>,
}

/// A block compared with the model.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    /// `tests` is empty.
    pub(crate) signals: BlockSignals,
    /// One value per statistic; NaN where the block does not determine it.
    pub(crate) values: Vec<f64>,
    /// Root mean square of each input and of each output's prediction, SI.
    pub(crate) motion: Vec<f64>,
}

impl Meter {
    pub(crate) fn new(model: &Model, noise: NoiseModel, step_s: f64, channels: Vec<Channel>) -> Self {
        let free = (0..model.parameters.len()).filter(|k| !model.parameters[*k].fixed).collect();
        Self { model: model.clone(), noise, step_s, channels, free }
    }

    /// Quantity that each statistic measures.
    pub(crate) fn symptoms(&self) -> Vec<Symptom> {
        let outputs = || self.model.outputs().map(|output| output.name.clone());
        let parameters = self.free.iter().map(|k| Symptom::Parameter(self.model.parameters[*k].name.clone()));
        outputs().map(Symptom::Level).chain(outputs().map(Symptom::Power)).chain(parameters).collect()
    }

    /// Compares a block with the model; `None` if it has too few samples or the prediction overflows.
    pub(crate) fn measure(&self, block: &Block) -> Result<Option<Measured>, MonitorError> {
        let data = [cutter::dataset([block], &self.channels, self.step_s)?];
        match self.measured(&data) {
            Ok(Some(mut found)) => {
                let rows = found.signals.time_s.len();
                found.signals.time_s = (0..rows).map(|k| block.start_s + k as f64 * self.step_s).collect();
                Ok(Some(found))
            }
            Ok(None) | Err(IdentifyError::TooShort { .. } | IdentifyError::Diverged { .. }) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    fn measured(&self, data: &[Dataset]) -> Result<Option<Measured>, IdentifyError> {
        let values = self.model.values();
        let problem = if self.free.is_empty() {
            Problem::of_known(&self.model, data, options())?
        } else {
            Problem::new(&self.model, data, options())?
        };
        let Some(at) = comparison::measure(&problem, &self.noise, &values)? else { return Ok(None) };
        let Some(innovations) = comparison::innovations(&problem, &self.noise, &at)? else { return Ok(None) };
        let traces = comparison::traces(&problem, &at, None)?;
        // A missing input divides a block: its longest part counts.
        let longest = |count: usize| (0..count).max_by_key(|k| traces[*k].time_s.len());
        let Some(part) = longest(traces.len()) else { return Ok(None) };
        let rows = traces[part].time_s.len();
        if (rows as f64) < MOST_MISSING * data[0].rows() as f64 {
            return Ok(None);
        }
        let white = &innovations[part].outputs;
        let levels = white.iter().map(|channel| level(channel));
        let powers = white.iter().map(|channel| power(channel));
        let mut statistics: Vec<f64> = levels.chain(powers).collect();
        statistics.extend(self.parameter_scores(&problem, &at, &values)?);
        let inputs = self.model.inputs().zip(&traces[part].inputs);
        let inputs = inputs.filter(|(input, _)| input.quantity != Quantity::Time).map(|(_, values)| values);
        let motion = inputs.chain(&traces[part].predicted).map(|values| rms(values)).collect();
        let traces = traces.into_iter().nth(part).into_iter().next();
        let Some(traces) = traces else { return Ok(None) };
        let signals = BlockSignals {
            time_s: traces.time_s,
            measured: traces.measured,
            model: traces.predicted,
            innovations: white.clone(),
            tests: Vec::new(),
        };
        Ok(Some(Measured { signals, values: statistics, motion }))
    }

    /// Step of each free parameter alone to its optimum, in standard errors.
    fn parameter_scores(
        &self,
        problem: &Problem<'_>,
        at: &comparison::Evaluation,
        values: &[f64],
    ) -> Result<Vec<f64>, IdentifyError> {
        if self.free.is_empty() {
            return Ok(Vec::new());
        }
        let groups: Vec<Vec<usize>> = self.free.iter().map(|index| vec![*index]).collect();
        let scores = comparison::score_test(problem, &self.noise, values, (&self.model, at), &[], &groups)?;
        let one = |k: usize| {
            let score = scores.as_ref().and_then(|scores| scores.get(k));
            score.map_or(f64::NAN, |score| score.step[0] / score.std[0])
        };
        Ok((0..self.free.len()).map(one).collect())
    }
}

/// Sum of innovations over the root of their number: of variance 1 for white innovations of noise alone.
fn level(channel: &[f64]) -> f64 {
    let present = present(channel);
    present.iter().sum::<f64>() / (present.len() as f64).sqrt()
}

/// Natural logarithm of the mean square.
fn power(channel: &[f64]) -> f64 {
    let present = present(channel);
    (present.iter().map(|value| value * value).sum::<f64>() / present.len() as f64).ln()
}

/// Innovations that are not missing; empty where too many are.
fn present(channel: &[f64]) -> Vec<f64> {
    let present: Vec<f64> = channel.iter().copied().filter(|value| *value != 0.0).collect();
    if (present.len() as f64) < MOST_MISSING * channel.len() as f64 { Vec::new() } else { present }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
