//! An oracle that knows the hidden effects: their detectability on the held-out recordings, and whether another effect is observationally
//! equivalent.

use socam_diagnose::document::Finding;
use socam_identify::comparison::{self, Evaluation, NoiseModel};
use socam_identify::{Intersample, NoiseLevels, Options, Problem};
use socam_model::{Model, effects};
use socam_recording::Dataset;
use socam_sim::challenge::{Case, CaseKind, Drive, Hidden, Recordings};

/// Greatest number of iterations of a fit; few suffice, since fits start at the truth.
const MAX_ITERATIONS: usize = 30;
/// Least decrease of the whitened chi-square of the held-out recordings by a detectable effect, in units of the chi-square per value of the
/// true model.
pub(super) const DETECTABLE_GAIN: f64 = 25.0;
/// Greatest increase of chi-square by an observationally equivalent effect, in these units: the 99.8 % quantile for one degree of freedom.
const EQUIVALENT_LOSS: f64 = 10.0;

/// Result of the oracle.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Oracle {
    /// Decrease of the whitened chi-square by each hidden effect, all others known; `None` if a fit fails.
    pub(super) gain: Vec<Option<f64>>,
    /// Whitened chi-square per value of the true model; 1 if the catalogue describes the bench completely.
    pub(super) misfit: Option<f64>,
}

impl Oracle {
    /// Whether each hidden effect is detectable in the presence of the unexplained background.
    pub(super) fn detects_all(&self) -> bool {
        let unit = self.misfit.unwrap_or(1.0).max(1.0);
        self.gain.iter().all(|gain| gain.is_some_and(|gain| gain >= DETECTABLE_GAIN * unit))
    }
}

/// Runs the oracle.
pub(super) fn ask(case: &Case, recordings: &Recordings) -> Oracle {
    let nothing = || Oracle { gain: vec![None; case.hidden.len()], misfit: None };
    let answer =
        if case.kind == CaseKind::Outside { outside(case, recordings) } else { told_all(case, recordings) };
    answer.unwrap_or_else(|_| nothing())
}

fn told_all(case: &Case, recordings: &Recordings) -> anyhow::Result<Oracle> {
    let full = told(case, &case.hidden)?;
    let noise_model = noise_model(case, &full, recordings)?;
    let with_all = left(case, &full, &noise_model, recordings)?;
    let each = (0..case.hidden.len()).map(|index| {
        let mut others = case.hidden.clone();
        others.remove(index);
        let without = left(case, &told(case, &others)?, &noise_model, recordings)?;
        Ok(with_all.as_ref().zip(without).map(|(with, without)| without.total() - with.total()))
    });
    let gain = each.collect::<anyhow::Result<_>>()?;
    Ok(Oracle { gain, misfit: with_all.as_ref().map(misfit) })
}

/// For an effect without a law in the catalogue, the same machine is also recorded with nothing hidden: the difference of chi-square of the
/// base model is the detectable part.
fn outside(case: &Case, recordings: &Recordings) -> anyhow::Result<Oracle> {
    let base = told(case, &[])?;
    let plain = case.without_hidden().record()?;
    let noise_model = noise_model(case, &base, recordings)?;
    let (with, without) =
        (left(case, &base, &noise_model, recordings)?, left(case, &base, &noise_model, &plain)?);
    let gain = with.as_ref().zip(without.as_ref()).map(|(with, without)| with.total() - without.total());
    Ok(Oracle { gain: vec![gain], misfit: without.as_ref().map(misfit) })
}

fn misfit(measured: &Evaluation) -> f64 {
    measured.total() / measured.count.iter().sum::<f64>()
}

/// Whether another effect, in place of a hidden one, predicts the held-out recordings equally well: then these recordings cannot
/// distinguish them. It is computed by fits to the recordings of the case.
pub(super) fn is_equivalent(
    case: &Case,
    recordings: &Recordings,
    index: usize,
    (effect, place, parameters): (&str, &str, &[(&str, f64)]),
) -> bool {
    let answer = || -> anyhow::Result<bool> {
        let full = told(case, &case.hidden)?;
        let noise_model = noise_model(case, &full, recordings)?;
        let mut others = case.hidden.clone();
        others.remove(index);
        let rival = told(case, &others)?.with_effect(effect, place, parameters)?;
        let (known, other) =
            (left(case, &full, &noise_model, recordings)?, left(case, &rival, &noise_model, recordings)?);
        Ok(known.zip(other).is_some_and(|(known, other)| {
            other.total() - known.total() <= EQUIVALENT_LOSS * misfit(&known).max(1.0)
        }))
    };
    answer().unwrap_or(false)
}

/// What an answer's effects leave on the held-out recordings, less what the hidden effects leave, in units of the latter per value: whitened
/// chi-square of models that are fitted to the training recordings from the true parameters. `None` where an answer's effect has no law.
pub(super) fn truth_gains(case: &Case, recordings: &Recordings, findings: &[Finding]) -> Option<f64> {
    let answer = || -> anyhow::Result<Option<f64>> {
        let full = told(case, &case.hidden)?;
        let noise_model = noise_model(case, &full, recordings)?;
        let mut answered = told(case, &[])?;
        for finding in findings {
            answered = answered.with_effect(&finding.effect, &finding.location, &values(finding))?;
        }
        let known = left(case, &full, &noise_model, recordings)?;
        let other = left(case, &answered, &noise_model, recordings)?;
        Ok(known.zip(other).map(|(known, other)| (other.total() - known.total()) / misfit(&known).max(1.0)))
    };
    answer().ok().flatten().filter(|gain| gain.is_finite())
}

/// Names and values of a finding's parameters that have one.
pub(super) fn values(finding: &Finding) -> Vec<(&str, f64)> {
    finding.parameters.iter().filter_map(|own| Some((own.name.as_str(), own.value?))).collect()
}

/// The base model at the true parameters, with some of the hidden effects. Their laws are those of the catalogue, and the
/// parameters of these laws are fitted.
fn told(case: &Case, hidden: &[Hidden]) -> anyhow::Result<Model> {
    let mut model = case.base()?;
    for hidden in hidden.iter().filter(|hidden| effects::find(&hidden.effect).is_some()) {
        let values: Vec<(&str, f64)> =
            hidden.parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        model = model.with_effect(&hidden.effect, &hidden.place, &values)?;
    }
    for parameter in &case.machine.parameters {
        if let Some(index) = model.parameter(&parameter.name) {
            model.parameters[index].value = parameter.value;
        }
    }
    Ok(model)
}

/// The true noise of the bench.
fn noise_model(case: &Case, model: &Model, recordings: &Recordings) -> anyhow::Result<NoiseModel> {
    let is_measured = case.machine.input.drive == Drive::Speed;
    let input = |name: &str, clock: bool| if clock || !is_measured { 0.0 } else { case.noise_floor(name) };
    let levels = NoiseLevels {
        outputs: model.outputs().map(|channel| case.noise_floor(&channel.name)).collect(),
        inputs: model.inputs().map(|channel| input(&channel.name, channel.quantity.is_clock())).collect(),
    };
    let training = problem(case, model, &recordings.training)?;
    let holdout = problem(case, model, &recordings.holdout)?;
    Ok(NoiseModel::new(&[&training, &holdout], &model.values(), levels)?)
}

/// Whitened chi-square on the held-out recordings of a model that is fitted to the training recordings.
fn left(
    case: &Case,
    model: &Model,
    noise_model: &NoiseModel,
    recordings: &Recordings,
) -> anyhow::Result<Option<Evaluation>> {
    let training = problem(case, model, &recordings.training)?;
    let Some(fitted) = comparison::descend(
        &training,
        noise_model,
        &model.values(),
        None,
        (comparison::FINE, MAX_ITERATIONS),
    )?
    else {
        return Ok(None);
    };
    let holdout = problem(case, model, &recordings.holdout)?;
    Ok(comparison::measure(&holdout, noise_model, &fitted.values)?)
}

fn problem<'a>(case: &Case, model: &'a Model, data: &'a [Dataset]) -> anyhow::Result<Problem<'a>> {
    Ok(Problem::new(model, data, options(case))?)
}

/// Intersample behaviour of a clean bench: a drive ramps between samples, a prescribed motion is smooth.
pub(super) fn options(case: &Case) -> Options {
    let ramps = case.machine.input.drive != Drive::Speed;
    Options { intersample: ramps.then_some(Intersample::Linear), ..Options::default() }
}
