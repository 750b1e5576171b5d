//! The score test: whether anything is missing, over all candidates at once, and what each would gain, without fitting one.
//!
//! One evaluation with sensitivities gives each candidate's efficient scores by block. A candidate's statistic is the quadratic form of their
//! sum by their own scatter, so that it holds whatever the size, colour and local variance of the residuals. The largest of all is judged by
//! a wild bootstrap: signs of whole blocks are drawn anew, for all candidates together, and the share of draws whose largest statistic
//! exceeds a candidate's is its family-wise p-value (V. Chernozhukov, D. Chetverikov, K. Kato, Ann. Stat. 41, 2013; P. Westfall and S. Young,
//! Resampling-Based Multiple Testing, 1993). Unknown orders, frequencies and time constants are candidates of a grid, and are covered too.
//! A candidate that acts in a few blocks only cannot stand out that way; it may by the noise model's own scale, if its
//! gain is [`INFLATION`] times what that noise would make.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};
use rayon::prelude::*;
use socam_identify::{
    IdentifyError, Options, Problem,
    comparison::{self, CandidateScore, Evaluation, NoiseModel},
};
use socam_model::{Model, ModelError};
use socam_recording::Dataset;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::{candidates::Candidate, scales::Scales};

/// Candidates that share a pass: each adds to what a step costs; those less that only a sensor shows.
const TOGETHER: usize = 10;
const TOGETHER_ON_SENSORS: usize = 18;
/// Draws of the bootstrap: the least p-value is one over these.
const DRAWS: usize = 1999;
/// How much stronger than the noise model has it noise may be in the direction in which a candidate acts, in power.
const INFLATION: f64 = 8.0;

/// A candidate and what it scores_of_candidates, as a start for a fit.
#[derive(Debug, Clone)]
pub(crate) struct RankedCandidate {
    /// With the strength that the slopes foretell.
    pub(crate) start: Candidate,
    pub(crate) promise: CandidateScore,
    /// Chance that anything among all candidates stands out as much where nothing is missing.
    pub(crate) p_value: f64,
    /// Whether the foretold strength is one that can be.
    pub(crate) possible: bool,
}

/// What all candidates promise to a model at a fit (`at`). What is of full strength is tried on the recording with the largest torques
/// first, for it costs much: what makes that one no better does nothing for the others.
pub(crate) fn run(
    model: &Model,
    datasets: &[Dataset],
    options: &Options,
    noise_model: &NoiseModel,
    at: &Evaluation,
    (scales, all): (&Scales, &[Candidate]),
) -> Result<Vec<RankedCandidate>, IdentifyError> {
    // What is of some strength already would change what the others see.
    let (full, linear): (Vec<&Candidate>, Vec<&Candidate>) =
        all.iter().partition(|candidate| candidate.starts_at_amplitude());
    let (structural, laws): (Vec<&Candidate>, Vec<&Candidate>) =
        linear.into_iter().partition(|candidate| candidate.effect.is_structural());
    // What has a memory answers the motion even at no strength, and several of them each other.
    let (remembering, laws): (Vec<&Candidate>, Vec<&Candidate>) =
        laws.into_iter().partition(|candidate| candidate.effect.has_memory());
    let is_on_a_sensor = |one: &&Candidate| model.outputs().any(|output| output.name == one.place);
    let (on_sensors, laws): (Vec<&Candidate>, Vec<&Candidate>) = laws.into_iter().partition(is_on_a_sensor);
    let mut batches: Vec<Vec<&Candidate>> = laws.chunks(TOGETHER).map(<[_]>::to_vec).collect();
    batches.extend(on_sensors.chunks(TOGETHER_ON_SENSORS).map(<[_]>::to_vec));
    batches.extend(full.into_iter().chain(remembering).map(|candidate| vec![candidate]));
    batches.extend(by_kind(structural));
    let whole = Problem::new(model, datasets, options.clone())?;
    let each = batches.par_iter().map(|batch| {
        let on_all = || together(model, datasets, options, noise_model, at, batch);
        let spring = model.springs.iter().position(|spring| spring.name == batch[0].place);
        let (true, Some(spring)) = (batch[0].starts_at_amplitude(), spring) else { return on_all() };
        let largest_amplitude = scales.largest_amplitude(spring);
        let one = std::slice::from_ref(&datasets[largest_amplitude]);
        let first = together(model, one, options, noise_model, &at.on_one(&whole, largest_amplitude), batch)?;
        if first.iter().any(|ranked| ranked.promise.gain > 0.0) {
            return on_all();
        }
        // Nor is it a start for anything.
        Ok(first.into_iter().map(|ranked| RankedCandidate { possible: false, ..ranked }).collect())
    });
    let found: Result<Vec<Vec<RankedCandidate>>, IdentifyError> = each.collect();
    let mut found: Vec<RankedCandidate> = found?.into_iter().flatten().collect();
    judge(&mut found);
    found.sort_by(|a, b| b.promise.gain.total_cmp(&a.promise.gain));
    Ok(found)
}

/// Gives each candidate its family-wise p-value.
fn judge(all: &mut [RankedCandidate]) {
    let p_values = family_wise(&all.iter().map(|one| &one.promise).collect::<Vec<_>>());
    all.iter_mut().zip(p_values).for_each(|(one, p_value)| one.p_value = p_value);
}

/// For each of several tests on the same blocks: the chance that any of them stands out as much where nothing is missing.
pub(crate) fn family_wise(all: &[&CandidateScore]) -> Vec<f64> {
    let statistics: Vec<Option<Statistic>> = all.iter().map(|one| Statistic::new(&one.scores)).collect();
    let largest = largest_by_chance(&statistics);
    let count = all.len().max(1) as f64;
    let each = all.iter().zip(&statistics).map(|(one, statistic)| {
        let robust = statistic.as_ref().map_or(1.0, |statistic| {
            let own = statistic.surprise(&statistic.sum);
            let exceed = largest.iter().filter(|chance| **chance >= own).count();
            (1 + exceed) as f64 / (1 + largest.len()) as f64
        });
        let by_scale = chi_squared_tail(one.gain / INFLATION, one.step.len()) * count;
        // Either may speak for it.
        (2.0 * robust.min(by_scale)).min(1.0)
    });
    each.collect()
}

/// A candidate's scores by block, made orthonormal: their squares sum to one in each direction.
struct Statistic {
    scores: Vec<Vec<f64>>,
    sum: Vec<f64>,
}

impl Statistic {
    /// `None` where the scores have no scatter.
    fn new(scores: &[Vec<f64>]) -> Option<Self> {
        let n = scores.first()?.len();
        let scatter =
            nalgebra::DMatrix::from_fn(n, n, |i, j| scores.iter().map(|s| s[i] * s[j]).sum::<f64>());
        let root = nalgebra::Cholesky::new(scatter)?;
        let each = scores.iter().map(|score| {
            let whitened = root.l().solve_lower_triangular(&nalgebra::DVector::from_column_slice(score))?;
            Some(whitened.as_slice().to_vec())
        });
        let scores: Vec<Vec<f64>> = each.collect::<Option<_>>()?;
        let sum = (0..n).map(|k| scores.iter().map(|s| s[k]).sum()).collect();
        Some(Self { scores, sum })
    }

    /// How unlikely a sum of scores is, comparable between candidates of different numbers of parameters.
    fn surprise(&self, sum: &[f64]) -> f64 {
        -chi_squared_tail(sum.iter().map(|s| s * s).sum(), sum.len()).max(f64::MIN_POSITIVE).ln()
    }
}

/// The largest surprise of all candidates in each draw of the blocks' signs.
fn largest_by_chance(statistics: &[Option<Statistic>]) -> Vec<f64> {
    let blocks = statistics.iter().flatten().map(|s| s.scores.len()).max().unwrap_or(0);
    let draw = |number: usize| {
        let mut random = ChaCha8Rng::seed_from_u64(number as u64);
        let signs: Vec<f64> =
            (0..blocks).map(|_| if random.next_u32() & 1 == 0 { 1.0 } else { -1.0 }).collect();
        let each = statistics.iter().flatten().filter(|s| s.scores.len() == blocks).map(|statistic| {
            let width = statistic.sum.len();
            let mut sum = vec![0.0; width];
            for (score, sign) in statistic.scores.iter().zip(&signs) {
                sum.iter_mut().zip(score).for_each(|(sum, score)| *sum += sign * score);
            }
            statistic.surprise(&sum)
        });
        each.fold(0.0, f64::max)
    };
    (0..DRAWS).into_par_iter().map(draw).collect()
}

fn chi_squared_tail(value: f64, parameters: usize) -> f64 {
    ChiSquared::new(parameters.max(1) as f64).map_or(1.0, |noise| noise.sf(value.max(0.0)))
}

/// Effects that change the network, each kind for itself, no two at one place.
fn by_kind(all: Vec<&Candidate>) -> Vec<Vec<&Candidate>> {
    let mut batches: Vec<Vec<&Candidate>> = Vec::new();
    for candidate in all {
        let fits = |batch: &&mut Vec<&Candidate>| {
            let same_kind = batch[0].effect.acts_at == candidate.effect.acts_at;
            let other_place = batch.iter().all(|known| {
                known.place != candidate.place
                    || (candidate.effect.acts_at == socam_model::effects::ActsAt::Gear)
            });
            same_kind && other_place && batch.len() < TOGETHER
        };
        match batches.iter_mut().find(fits) {
            Some(batch) => batch.push(candidate),
            None => batches.push(vec![candidate]),
        }
    }
    batches
}

fn together(
    model: &Model,
    datasets: &[Dataset],
    options: &Options,
    noise_model: &NoiseModel,
    at: &Evaluation,
    batch: &[&Candidate],
) -> Result<Vec<RankedCandidate>, IdentifyError> {
    let Ok((grown, groups)) = grown(model, batch) else { return Ok(Vec::new()) };
    let values = carried((model, &at.values), &grown);
    let problem = Problem::new(&grown, datasets, options.clone())?;
    let base = estimated(model, &grown);
    let scores_of_candidates =
        comparison::score_test(&problem, noise_model, &values, (model, at), &base, &groups)?;
    let Some(scores_of_candidates) = scores_of_candidates else { return Ok(Vec::new()) };
    let each = batch.iter().zip(scores_of_candidates).map(|(candidate, mut promise)| {
        if candidate.starts_at_amplitude() {
            promise.gain += at.total() - promise.total;
        }
        foretold(model, candidate, promise)
    });
    Ok(each.collect())
}

/// The model with all of a batch in it at no strength, and the parameters that measure each one's.
fn grown(model: &Model, batch: &[&Candidate]) -> Result<(Model, Vec<Vec<usize>>), ModelError> {
    let mut grown = model.clone();
    let mut names: Vec<Vec<String>> = Vec::new();
    for candidate in batch {
        let mut own = Vec::new();
        let phases: &[f64] = if candidate.is_wave() { &[0.0, std::f64::consts::FRAC_PI_2] } else { &[0.0] };
        for phase in phases {
            let turned = candidate.with("phase", *phase);
            grown = grown.with_effect(turned.effect.id, &turned.place, &turned.values)?;
            own.extend(strengths(&grown, candidate));
        }
        names.push(own);
    }
    for parameter in &mut grown.parameters {
        let is_new = model.parameter(&parameter.name).is_none();
        if is_new {
            parameter.fixed = !names.iter().flatten().any(|name| *name == parameter.name);
        }
    }
    let groups = names.iter().map(|own| own.iter().filter_map(|name| grown.parameter(name)).collect());
    let groups = groups.collect();
    Ok((grown, groups))
}

/// Names of the parameters that measure the strength of the model's last effect.
fn strengths(model: &Model, candidate: &Candidate) -> Vec<String> {
    let Some(used) = model.effects.last() else { return Vec::new() };
    let own = used.effect.parameters.iter().zip(&used.parameters);
    own.filter(|(parameter, _)| candidate.strength.contains(&parameter.name))
        .map(|(_, index)| model.parameters[*index].name.clone())
        .collect()
}

/// Values of a model that grew out of another one: those of the old go over by name.
pub(crate) fn carried(old: (&Model, &[f64]), new: &Model) -> Vec<f64> {
    let mut values = new.values();
    for (parameter, value) in old.0.parameters.iter().zip(old.1) {
        if let Some(index) = new.parameter(&parameter.name) {
            values[index] = *value;
        }
    }
    values
}

/// What a model estimates, in one that grew out of it.
pub(crate) fn estimated(model: &Model, grown: &Model) -> Vec<usize> {
    let free = model.parameters.iter().filter(|parameter| !parameter.fixed);
    free.filter_map(|parameter| grown.parameter(&parameter.name)).collect()
}

/// A fit begins with a little of the strength that is foretold: the whole of it fits only once all other parameters have moved.
pub(crate) const A_LITTLE: f64 = 0.02;

fn foretold(model: &Model, candidate: &Candidate, promise: CandidateScore) -> RankedCandidate {
    let mut start = candidate.clone();
    let mut possible = true;
    if candidate.is_wave() {
        let (sin, cos) = (promise.step[0], promise.step.get(1).copied().unwrap_or(0.0));
        let name = candidate.strength[0];
        start = start.with(name, A_LITTLE * sin.hypot(cos)).with("phase", cos.atan2(sin));
    } else {
        for (name, step) in candidate.strength.iter().zip(&promise.step) {
            let before = candidate.values.iter().find(|(known, _)| known == name).map_or(0.0, |(_, v)| *v);
            let (least, most) = candidate.bounds(model, name);
            let moved = |share: f64| candidate.moved(name, before, share * step);
            possible &= (least..=most).contains(&moved(1.0));
            let share = if candidate.starts_at_amplitude() { 0.0 } else { A_LITTLE };
            let moved = moved(share).clamp(least, most);
            start = start.with(name, moved);
        }
    }
    RankedCandidate { start, promise, p_value: 1.0, possible }
}
