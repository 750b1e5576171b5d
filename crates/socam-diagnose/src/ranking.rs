//! Ranks effects by the score test at fixed parameter values, to explain a change of a bench whose model is known.
//!
//! A diagnosis tests an effect against models whose base parameters are fitted anew. Here the base parameters keep their values, and a
//! change of each free one competes with the effects of the catalogue.

use socam_identify::{
    IdentifyError, Options, Problem,
    comparison::{self, CandidateScore, Evaluation, NoiseModel},
};
use socam_model::Model;
use socam_recording::Dataset;

use crate::{
    candidates,
    scales::Scales,
    score_test::{self, RankedCandidate},
};

/// The `effect` of a [`RankedEffect`] that is a change of a parameter.
pub const PARAMETER: &str = "parameter";

/// An effect at a place, or a change of a parameter, with its score.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedEffect {
    /// Id of the effect, or [`PARAMETER`].
    pub effect: &'static str,
    /// Place, or name of the parameter.
    pub place: String,
    /// Names and linearly predicted values of the amplitude parameters, SI; of a changed parameter, its value.
    pub amplitude: Vec<(String, f64)>,
    /// Linearly predicted decrease of the sum of squared whitened residuals.
    pub gain: f64,
    /// Family-wise p-value over all effects and parameters.
    pub p_value: f64,
}

/// Ranks all effects of the catalogue and all free parameters of `model` on `datasets`, the largest gain first. Each effect and place is
/// listed once, at its best grid point. `at` is the model evaluated on `datasets` under `noise_model`, by [`comparison::measure`].
///
/// # Method
/// The score test: a quadratic form of the efficient scores by block, with family-wise p-values from a wild bootstrap (V. Chernozhukov,
/// D. Chetverikov, K. Kato, Ann. Stat. 41, 2013) over all effects and parameters together.
///
/// # Errors
/// When a recording cannot be read.
///
/// # Breaks when
/// The change is large: gains and amplitudes are those of the model linearised at `at`.
pub fn rank(
    model: &Model,
    datasets: &[Dataset],
    options: &Options,
    noise_model: &NoiseModel,
    at: &Evaluation,
) -> Result<Vec<RankedEffect>, IdentifyError> {
    let mut known = model.clone();
    known.parameters.iter_mut().for_each(|parameter| parameter.fixed = true);
    let problem = Problem::of_known(&known, datasets, options.clone())?;
    let scales = Scales::new(&problem, &known, noise_model, at)?;
    let all = candidates::all(&known, &scales);
    let ranked = score_test::run(&known, datasets, options, noise_model, at, (&scales, &all))?;
    let ranked: Vec<RankedCandidate> = ranked.into_iter().filter(|one| one.possible).collect();
    let changes = parameter_scores(model, datasets, options, noise_model, at)?;
    let scores = ranked.iter().map(|one| &one.score).chain(changes.iter().map(|(_, score)| score));
    let p_values = score_test::family_wise(&scores.collect::<Vec<_>>());
    let effects = ranked.iter().map(|one| RankedEffect {
        effect: one.start.effect.id,
        place: one.start.place.clone(),
        amplitude: one.predicted.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
        gain: one.score.gain,
        p_value: 1.0,
    });
    let changed = changes.iter().map(|(index, score)| RankedEffect {
        effect: PARAMETER,
        place: model.parameters[*index].name.clone(),
        amplitude: vec![(model.parameters[*index].name.clone(), at.values[*index] + score.step[0])],
        gain: score.gain,
        p_value: 1.0,
    });
    let mut found: Vec<RankedEffect> = effects.chain(changed).collect();
    found.iter_mut().zip(p_values).for_each(|(one, p_value)| one.p_value = p_value);
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut best: Vec<RankedEffect> = Vec::new();
    for one in found {
        if !best.iter().any(|known| known.effect == one.effect && known.place == one.place) {
            best.push(one);
        }
    }
    Ok(best)
}

/// Scores of the model's free parameters, each alone, with their indices. Empty where nothing is free or sensitivities overflow.
fn parameter_scores(
    model: &Model,
    datasets: &[Dataset],
    options: &Options,
    noise_model: &NoiseModel,
    at: &Evaluation,
) -> Result<Vec<(usize, CandidateScore)>, IdentifyError> {
    let free: Vec<usize> = (0..model.parameters.len()).filter(|k| !model.parameters[*k].fixed).collect();
    if free.is_empty() {
        return Ok(Vec::new());
    }
    let problem = Problem::new(model, datasets, options.clone())?;
    let groups: Vec<Vec<usize>> = free.iter().map(|index| vec![*index]).collect();
    let scores = comparison::score_test(&problem, noise_model, &at.values, (model, at), &[], &groups)?;
    Ok(free.into_iter().zip(scores.unwrap_or_default()).collect())
}
