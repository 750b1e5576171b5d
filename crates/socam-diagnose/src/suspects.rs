//! Which effects a fitted model may leave out, and what its parameters would be with each of them: one score test, without a search.

use socam_identify::{
    Identification, Move, Noise, Options, Problem, Suspect,
    comparison::{self, Evaluation, NoiseModel},
};
use socam_model::Model;
use socam_recording::Dataset;

use crate::{
    candidates,
    diagnose::levels,
    error::DiagnoseError,
    preprocessing::{connected, heads, preprocessed},
    scales::Scales,
    score_test::{self, RankedCandidate},
    whiteness::is_white,
};

/// Least gain of a suspected effect, as a share of the largest gain of any. Others may act as well, but explain the data less.
const PLAUSIBLE: f64 = 0.1;
/// Least share of an effect's change of the residuals that no change of the parameters makes. With less it is nearly another name for a
/// parameter, such as a difference of directions for an offset, and a size that is estimated from the small rest says little.
const LEAST_OWN: f64 = 0.1;
/// Largest family-wise p-value of a suspected effect.
const SIGNIFICANT: f64 = 0.05;
/// Most rows of all recordings together that are tested: more resolve the sizes of effects better than their linearisation holds.
const MOST_ROWS: u64 = 60_000;

/// Effects that `model` may leave out at the fit `found` to `datasets`, the one that would explain most first, with the change of every
/// free parameter that goes with it. Empty where no effect of the catalogue is significant. `options` are those of the fit.
///
/// # Method
/// The score test of every effect at every place under the noise levels of the fit. A suspected effect explains at least a tenth of what
/// the best one does. The changes are those of one linear step of effect and parameters together. Of long recordings the first parts are
/// tested. Where the fit explains its recordings, the test is made only if what is left is not white: small imperfections move parameters
/// further than their scatter long before they are seen in a residual.
///
/// # Errors
/// When a recording cannot be read.
///
/// # Breaks when
/// The effect is large: its size and the changes are linearised at the fit. It does not act in the first part of a long
/// recording. Two effects that only together explain the data are not found.
pub fn suspects(
    model: &Model,
    datasets: &[Dataset],
    found: &Identification,
    options: &Options,
) -> Result<Vec<Suspect>, DiagnoseError> {
    // The fit has estimated the levels, also those that were given to it.
    let options = &Options { noise: Noise::Estimated, ..options.clone() };
    let mut settled = model.clone();
    found.state_between(&mut settled)?;
    let model = &settled;
    let (datasets, _) = connected(model, &heads(datasets, MOST_ROWS)?)?;
    let levels = levels(model, found);
    let (datasets, _) = preprocessed(model, &datasets, &found.point, &levels, options)?;
    let problem = Problem::new(model, &datasets, options.clone())?;
    let noise = NoiseModel::new(&[&problem], &found.point, levels)?;
    let Some(at) = comparison::measure(&problem, &noise, &found.point)? else { return Ok(Vec::new()) };
    if found.explains() {
        let left = comparison::innovations(&problem, &noise, &at)?.unwrap_or_default();
        if is_white(&left.into_iter().map(|segment| segment.outputs).collect::<Vec<_>>()) {
            return Ok(Vec::new());
        }
    }
    let scales = Scales::new(&problem, model, &noise, &at)?;
    let all = candidates::all(model, &scales);
    let ranked = score_test::run(model, &datasets, options, &noise, &at, (&scales, &all))?;
    Ok(plausible(model, &ranked, &at))
}

/// The best grid point of each effect and place that explains much of what is left.
fn plausible(model: &Model, ranked: &[RankedCandidate], at: &Evaluation) -> Vec<Suspect> {
    let mut kept: Vec<&RankedCandidate> = Vec::new();
    for one in ranked.iter().filter(|one| one.possible && one.p_value < SIGNIFICANT) {
        let most = kept.first().map_or(0.0, |best| best.score.gain);
        let is_plausible = one.score.gain > PLAUSIBLE * most && one.score.own > LEAST_OWN;
        if is_plausible && !kept.iter().any(|known| known.start.is_same(&one.start)) {
            kept.push(one);
        }
    }
    kept.into_iter().map(|one| suspect(model, one, (&at.values, at.total()))).collect()
}

fn suspect(model: &Model, one: &RankedCandidate, (values, total): (&[f64], f64)) -> Suspect {
    let free = model.parameters.iter().zip(values).filter(|(parameter, _)| !parameter.fixed);
    let moves = free.zip(&one.score.base_step).zip(&one.score.base_std);
    Suspect {
        effect: one.start.effect.id.to_owned(),
        name: one.start.effect.name.to_owned(),
        location: one.start.place.clone(),
        explains: (one.score.gain / total).clamp(0.0, 1.0),
        moves: moves
            .map(|(((parameter, from), step), std)| {
                (parameter.name.clone(), Move { from: *from, to: from + step, std: *std })
            })
            .collect(),
    }
}
