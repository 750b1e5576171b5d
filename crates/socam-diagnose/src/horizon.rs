//! Multiple shooting: the start of the selection where the base model's residuals are far above the noise.
//!
//! A free run from one start state integrates the model's errors over the whole recording. Its deviance then has minima in which base
//! parameters imitate the missing physics. A prediction in short parts, each with its own start state, stays near the measured motion
//! (multiple shooting, H. G. Bock 1983, without continuity of the parts). The first effect found in this way, with all parameter values, is
//! the start of the selection on whole recordings. Values from elsewhere that are nearly right are fitted to longer and longer parts.

use socam_identify::{
    IdentifyError, Options as FitOptions, Problem, StartState,
    comparison::{self, Evaluation, NoiseModel},
};
use socam_model::Model;
use socam_recording::{Dataset, RecordingError};

use crate::{
    choice,
    context::{Context, FAR_BEYOND_NOISE},
    extension::carried_over,
    forward,
    selection::Path,
};

/// Samples per part. The longer parts are tried if the shorter ones show no effect.
const SAMPLES: [usize; 2] = [40, 160];
/// Fewest parts of a recording.
const LEAST_PARTS: usize = 4;
/// Samples of the first parts of a fit by parts, by how much longer the next ones are, and iterations with each.
const FIRST_SAMPLES: u64 = 160;
const LONGER: u64 = 4;
const ITERATIONS: usize = 10;

/// A model's fit to whole recordings from values (SI) that are nearly right, where a free run from them ends turns away from what was measured. They
/// are fitted to parts of the recordings first that become longer and have start states of their own. `None` where a prediction overflows, or the search
/// was ended.
pub(crate) fn fitted_by_parts(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    noise: &NoiseModel,
) -> Result<Option<Evaluation>, IdentifyError> {
    let fit = FitOptions { start_state: StartState::Free, ..context.tentative_fit() };
    let longest = context.training.iter().map(Dataset::rows).max().unwrap_or(0);
    let mut values = values.to_vec();
    let mut samples = FIRST_SAMPLES;
    while 2 * samples <= longest && !context.stops() {
        let parts = in_parts(context.training, samples)?;
        let problem = Problem::new(model, &parts, fit.clone())?;
        let sensors = NoiseModel::new(&[&problem], &values, noise.levels().clone())?.with_exact_inputs();
        let Some(at) = settled(&problem, &sensors, &values)? else { return Ok(None) };
        values = at.values;
        samples *= LONGER;
    }
    if context.stops() {
        return Ok(None);
    }
    settled(&context.tentative(model)?, noise, &values)
}

/// A fit that begins at fitted start states: from those of the first samples a descent may run away from values that are nearly right.
fn settled(
    problem: &Problem<'_>,
    noise: &NoiseModel,
    values: &[f64],
) -> Result<Option<Evaluation>, IdentifyError> {
    let Some(begun) = comparison::measure(problem, noise, values)? else { return Ok(None) };
    let from = Some((problem.model(), &begun));
    comparison::descend(problem, noise, values, from, (comparison::COARSE, ITERATIONS))
}

/// Recordings in parts of this many samples.
fn in_parts(recordings: &[Dataset], samples: u64) -> Result<Vec<Dataset>, RecordingError> {
    recordings.iter().map(|dataset| dataset.in_parts(samples)).collect()
}

impl Path {
    /// The first effect that short parts of the recordings show, fitted to whole recordings. `None` if the base model is already near the
    /// data, or if the model with that effect is not.
    pub(crate) fn by_short_horizons(&self, context: &Context<'_>) -> Result<Option<Self>, IdentifyError> {
        if self.noise.excess() < FAR_BEYOND_NOISE || context.stops() {
            return Ok(None);
        }
        let longest = context.training.iter().map(|dataset| dataset.rows() as usize / LEAST_PARTS).max();
        for samples in SAMPLES.into_iter().filter(|samples| Some(*samples) <= longest) {
            let Some(found) = self.on_parts(context, samples)? else { continue };
            if let Some(path) = self.carried_over(context, found)? {
                return Ok(Some(path));
            }
        }
        Ok(None)
    }

    /// The selection on parts of this many samples; `None` where no effect was added.
    fn on_parts(&self, context: &Context<'_>, samples: usize) -> Result<Option<Self>, IdentifyError> {
        let parts = in_parts(context.training, samples as u64)?;
        let fit = FitOptions { start_state: StartState::Free, ..context.fit.clone() };
        let model = &self.base.model;
        let journal = context.journal.on("on short parts of the recordings");
        let short = Context::new(model, &parts, fit, context.options)?.noting_in(journal);
        let begun = forward::begin(&short, model, &model.values(), self.noise.levels())?;
        let Some(mut path) = begun else { return Ok(None) };
        path.test(&short)?;
        if context.stops() {
            return Ok(None);
        }
        let mut tried = path.worth_trying(context.options.false_alarm_rate);
        tried.retain(|(candidate, _)| !candidate.begins_large);
        short.journal.note_left_out(&path.tests, &tried, context.options.false_alarm_rate);
        let Some(choice) = choice::best(&short, &path, &tried, None)? else { return Ok(None) };
        path.add(&short, choice)?;
        Ok(Some(path).filter(|path| !path.terms.is_empty()))
    }

    /// The effects of another path, fitted to whole recordings from its values; `None` where their residuals stay far above the noise.
    fn carried_over(&self, context: &Context<'_>, found: Self) -> Result<Option<Self>, IdentifyError> {
        let candidates = found.terms.iter().map(|term| &term.candidate);
        let Some(model) = self.base.extended_by(candidates) else { return Ok(None) };
        let values = carried_over((&found.last.model, &found.last.at.values), &model);
        let last = context.fitted(&model, &values, None, &self.noise)?;
        let Some(last) = last.filter(|last| last.deviance() < self.last.deviance()) else { return Ok(None) };
        let mut path = Self { last, terms: found.terms, tests: Vec::new(), ..self.clone() };
        path.priors.rig = self.scales(context)?.rig;
        // Nested laws are tried again on whole recordings.
        path.terms.iter_mut().for_each(|term| term.excess_at_upgrade = f64::INFINITY);
        path.renew_noise(context)?;
        path.eliminate(context, path.terms.len())?;
        Ok(Some(path).filter(|path| path.noise.excess() < FAR_BEYOND_NOISE))
    }
}
