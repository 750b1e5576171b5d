//! The noise model: levels, whitening filters and discrepancy, fixed while models are compared; and the innovations under it.

use std::sync::Arc;

use crate::{
    IdentifyError,
    comparison::Evaluation,
    evaluation::{self, Point, Weights},
    noise::{
        discrepancy::Discrepancy,
        innovations_filter::NoiseLevels,
        input_noise, levels,
        prewhitening::{self, Prewhitening},
    },
    optimiser::factors,
    problem::{Problem, sample_times},
};

/// Noise levels, whitening filters and model discrepancy, held fixed while models are compared.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{NoiseModel, measure}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let problem = Problem::new(&model, &recordings, Options::default())?;
/// let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// let noise_model = NoiseModel::new(&[&problem], &model.values(), levels.clone())?;
/// assert_eq!((noise_model.levels(), noise_model.with_exact_inputs().levels()), (&levels, &levels));
/// let at = measure(&problem, &noise_model, &model.values())?.expect("no overflow");
/// // The model is complete: there is no discrepancy beyond the noise.
/// let discrepant = noise_model.with_discrepancy(&problem, &at)?.expect("no overflow");
/// assert!((discrepant.excess() - 1.0).abs() < 0.2, "{}", discrepant.excess());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct NoiseModel {
    levels: NoiseLevels,
    prewhitenings: Arc<Vec<Prewhitening>>,
    discrepancy: Arc<Vec<Discrepancy>>,
    excess: f64,
}

impl NoiseModel {
    /// Noise model from a reference model at parameter `values` (SI) and noise `levels` of its channels, for all recordings of
    /// `problems`. Inputs are taken as exact if no stable filter exists.
    ///
    /// # Errors
    /// When the equations cannot be formed, or there is no problem.
    pub fn new(
        problems: &[&Problem<'_>],
        values: &[f64],
        levels: NoiseLevels,
    ) -> Result<Self, IdentifyError> {
        let first = problems.first().ok_or(IdentifyError::NoRecordings)?;
        let equations = first.model.equations(values)?;
        let mut times: Vec<f64> = problems.iter().flat_map(|problem| sample_times(problem)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let exact = NoiseLevels { inputs: vec![0.0; levels.inputs.len()], ..levels.clone() };
        let prewhitenings = prewhitening::fixed(&equations, &levels, &times, &first.intersample);
        Ok(match prewhitenings {
            Some(mut prewhitenings) => {
                for prewhitening in &mut prewhitenings {
                    prewhitening.reduce();
                }
                Self {
                    levels,
                    prewhitenings: Arc::new(prewhitenings),
                    discrepancy: Arc::default(),
                    excess: 1.0,
                }
            }
            None => Self {
                levels: exact,
                prewhitenings: Arc::default(),
                discrepancy: Arc::default(),
                excess: 1.0,
            },
        })
    }

    /// This noise model with a model discrepancy (M. C. Kennedy and A. O'Hagan, J. R. Stat. Soc. B 63, 2001): one level per output, in
    /// units of sensor noise, estimated from the residuals of the evaluation `at` of `problem`'s model. `None` if the prediction overflows.
    ///
    /// # Errors
    /// When a recording cannot be read.
    pub fn with_discrepancy(
        &self,
        problem: &Problem<'_>,
        at: &Evaluation,
    ) -> Result<Option<Self>, IdentifyError> {
        let sensor = Self { discrepancy: Arc::default(), ..self.clone() };
        let Some(white) = innovations(problem, &sensor, at)? else { return Ok(None) };
        let segments: Vec<_> = white.iter().map(|one| (one.sample_time_s, &*one.outputs)).collect();
        let present =
            || segments.iter().flat_map(|(_, outputs)| outputs.iter().flatten()).filter(|v| **v != 0.0);
        let excess = present().map(|v| v * v).sum::<f64>() / present().count().max(1) as f64;
        Ok(Some(Self { discrepancy: Arc::new(Discrepancy::estimate(&segments)), excess, ..sensor }))
    }

    /// This noise model without the filter for input noise.
    #[must_use]
    pub fn with_exact_inputs(&self) -> Self {
        Self { prewhitenings: Arc::default(), ..self.clone() }
    }

    /// Mean square of the residuals from which the discrepancy was estimated, in units of sensor noise: 1 where the model is complete.
    pub fn excess(&self) -> f64 {
        self.excess
    }

    /// The noise levels.
    pub fn levels(&self) -> &NoiseLevels {
        &self.levels
    }

    pub(crate) fn weights(&self, problem: &Problem<'_>, values: &[f64]) -> Weights {
        Weights {
            frozen: Some(Arc::clone(&self.prewhitenings)),
            discrepancy: Arc::clone(&self.discrepancy),
            ..Weights::white(self.levels.outputs.clone(), factors::scales(problem, values))
        }
    }
}

/// Whitened residuals of one segment of a recording.
#[derive(Debug, Clone)]
pub struct Innovations {
    /// Sample time, s.
    pub sample_time_s: f64,
    /// Innovations by output, in units of noise; zero where missing.
    pub outputs: Vec<Vec<f64>>,
}

/// Whitened residuals of a model at a fit, by segment; `None` where the prediction overflows.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{NoiseModel, innovations, measure}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let at = measure(&problem, &noise_model, &values)?.expect("no overflow");
/// let white = innovations(&problem, &noise_model, &at)?.expect("no overflow");
/// assert_eq!((white.len(), white[0].outputs.len(), white[0].outputs[0].len()), (1, 2, 1000));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read.
pub fn innovations(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    at: &Evaluation,
) -> Result<Option<Vec<Innovations>>, IdentifyError> {
    let problem = levels::without_parameters(problem);
    let weights = Weights { innovations: true, ..noise_model.weights(&problem, &at.values) };
    let point = Point { values: at.values.clone(), nuisance: at.nuisance.clone() };
    let Some(evaluated) = evaluation::run(&problem, &point, &weights)? else { return Ok(None) };
    let each = problem.segments.iter().zip(evaluated).map(|(segment, result)| Innovations {
        sample_time_s: segment.sample_time_s,
        outputs: result.innovations,
    });
    Ok(Some(each.collect()))
}

/// Noise levels estimated from a model's residuals, each bounded by the highest frequencies of its channel, see
/// [`crate::Noise::Estimated`]. Levels given in the model file stay.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{NoiseModel, measure, noise}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// # let problem = Problem::new(&model, &recordings, Options::default())?;
/// # let values = model.values();
/// # let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// # let noise_model = NoiseModel::new(&[&problem], &values, levels.clone())?;
/// let at = measure(&problem, &noise_model, &values)?.expect("no overflow");
/// let estimated = noise(&problem, &at, &levels)?;
/// assert!(estimated.outputs.iter().all(|std| (std / 0.07 - 1.0).abs() < 0.2), "{estimated:?}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read.
pub fn noise(
    problem: &Problem<'_>,
    at: &Evaluation,
    before: &NoiseLevels,
) -> Result<NoiseLevels, IdentifyError> {
    let most = input_noise::most(problem)?;
    let known = problem.model.outputs().map(|channel| channel.noise_std);
    // The level of a channel without values weights nothing.
    let level = |rms: f64, read: f64, most: f64| if read > 0.0 { rms.min(most) } else { 1.0 };
    let read = at.rms.iter().zip(&at.read).zip(&most.outputs);
    let outputs =
        known.zip(read).map(|(known, ((rms, read), most))| known.unwrap_or(level(*rms, *read, *most)));
    let point = Point { values: at.values.clone(), nuisance: at.nuisance.clone() };
    let inputs: Vec<f64> = most
        .inputs
        .iter()
        .enumerate()
        .map(|(k, most)| before.inputs.get(k).map_or(*most, |b| b.min(*most)))
        .collect();
    let start = NoiseLevels { outputs: outputs.collect(), inputs };
    if !start.in_the_input() || !prewhitening::exists(problem, &point.values, &start) {
        return Ok(start);
    }
    levels::maximum_likelihood(problem, &point, start, &most)
}
