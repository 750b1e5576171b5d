//! The score (Lagrange multiplier) test: whether any candidate is missing from the model, and how much each would gain, without a fit.
//!
//! One evaluation with sensitivities gives each candidate's efficient scores by block. A candidate's statistic is the quadratic form of the
//! sum of its scores in the inverse of their own scatter, so that it is valid for residuals of any size, spectrum and local variance. A
//! wild bootstrap gives its family-wise p-value: signs of whole blocks are drawn at random, for all candidates together, and the p-value is
//! the share of draws whose largest statistic exceeds the candidate's (V. Chernozhukov, D. Chetverikov, K. Kato, Ann. Stat. 41, 2013; P.
//! Westfall and S. Young, Resampling-Based Multiple Testing, 1993). Unknown orders, frequencies and time constants are candidates on a
//! grid, so the p-value holds for these too. A candidate that acts in only a few blocks cannot be significant in this test. For it there is
//! a second test by the noise model's own scale: its gain must exceed [`INFLATION`] times what that noise would make.

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

use crate::{
    candidate::{Candidate, INITIAL_SHARE},
    extension::{carried_over, free_parameters},
    scales::Scales,
};

/// Number of candidates that share one evaluation: each adds to the cost of a step, and one that acts on a sensor's reading adds less.
const BATCH: usize = 10;
const SENSOR_BATCH: usize = 18;
/// Draws of the bootstrap. Its smallest p-value is one over this number plus one.
const DRAWS: usize = 1999;
/// Draws for a p-value that is compared with those of many recordings, if none of the first draws has a larger statistic.
const MORE_DRAWS: usize = 39_999;
/// Largest ratio of the noise power in the direction in which a candidate acts to that of the noise model, 1.
const INFLATION: f64 = 8.0;

/// A ranked candidate: its score, its p-value and the start of its fit.
#[derive(Debug, Clone)]
pub(crate) struct RankedCandidate {
    /// The candidate at [`INITIAL_SHARE`] of the linearly predicted amplitude.
    pub(crate) start: Candidate,
    /// Names and linearly predicted values of the amplitude parameters, SI; of a wave, its amplitude.
    pub(crate) predicted: Vec<(&'static str, f64)>,
    pub(crate) score: CandidateScore,
    /// Family-wise p-value: chance that any candidate has as large a statistic where nothing is missing.
    pub(crate) p_value: f64,
    /// Whether the linearly predicted amplitude lies within its bounds.
    pub(crate) possible: bool,
}

/// Score test of all candidates at a model's fit `at`, the largest gain first. A candidate with a non-null linearisation point costs a
/// nonlinear evaluation. It is therefore tested first on the one recording with the largest torque at its place, and on all only if it
/// gains there. Once the search is ended no further candidate is tested, and the result is of no use.
pub(crate) fn run(
    model: &Model,
    datasets: &[Dataset],
    options: &Options,
    noise_model: &NoiseModel,
    at: &Evaluation,
    (scales, all): (&Scales, &[Candidate]),
) -> Result<Vec<RankedCandidate>, IdentifyError> {
    // A candidate at a non-null amplitude changes the motion, so it cannot share an evaluation.
    let (nonnull, linear): (Vec<&Candidate>, Vec<&Candidate>) =
        all.iter().partition(|candidate| candidate.has_nonnull_linearisation());
    let (structural, laws): (Vec<&Candidate>, Vec<&Candidate>) =
        linear.into_iter().partition(|candidate| candidate.effect.is_structural());
    // A law with memory has states that depend on the motion even at a null amplitude, and on the states of other such laws.
    let (with_memory, laws): (Vec<&Candidate>, Vec<&Candidate>) =
        laws.into_iter().partition(|candidate| candidate.effect.has_memory());
    let is_on_a_sensor = |one: &&Candidate| model.outputs().any(|output| output.name == one.place);
    let (on_sensors, laws): (Vec<&Candidate>, Vec<&Candidate>) = laws.into_iter().partition(is_on_a_sensor);
    let mut batches: Vec<Vec<&Candidate>> = laws.chunks(BATCH).map(<[_]>::to_vec).collect();
    batches.extend(on_sensors.chunks(SENSOR_BATCH).map(<[_]>::to_vec));
    batches.extend(nonnull.into_iter().chain(with_memory).map(|candidate| vec![candidate]));
    batches.extend(by_kind(structural));
    let whole = Problem::of_known(model, datasets, options.clone())?;
    let each = batches.par_iter().map(|batch| {
        if options.progress.stops() {
            return Ok(Vec::new());
        }
        let on_all = || scored_batch(model, datasets, options, noise_model, at, batch);
        let spring = model.springs.iter().position(|spring| spring.name == batch[0].place);
        let (true, Some(spring)) = (batch[0].has_nonnull_linearisation(), spring) else { return on_all() };
        let largest_amplitude = scales.largest_amplitude(spring);
        let one = std::slice::from_ref(&datasets[largest_amplitude]);
        let first =
            scored_batch(model, one, options, noise_model, &at.on_one(&whole, largest_amplitude), batch)?;
        if first.iter().any(|ranked| ranked.score.gain > 0.0) {
            return on_all();
        }
        // Such a candidate is not a start for a fit either.
        Ok(first.into_iter().map(|ranked| RankedCandidate { possible: false, ..ranked }).collect())
    });
    let found: Result<Vec<Vec<RankedCandidate>>, IdentifyError> = each.collect();
    let mut found: Vec<RankedCandidate> = found?.into_iter().flatten().collect();
    set_p_values(&mut found);
    found.sort_by(|a, b| b.score.gain.total_cmp(&a.score.gain));
    Ok(found)
}

/// Gives each candidate its family-wise p-value.
fn set_p_values(all: &mut [RankedCandidate]) {
    let p_values = family_wise(&all.iter().map(|one| &one.score).collect::<Vec<_>>());
    all.iter_mut().zip(p_values).for_each(|(one, p_value)| one.p_value = p_value);
}

/// Smallest p-value of all candidates with a possible amplitude, by [`MORE_DRAWS`] if [`DRAWS`] do not resolve it.
pub(crate) fn least_p_value(all: &[RankedCandidate]) -> f64 {
    let least = |p_values: &mut dyn Iterator<Item = f64>| p_values.fold(1.0, f64::min);
    let first = least(&mut all.iter().filter(|one| one.possible).map(|one| one.p_value));
    if first > 2.0 / (1 + DRAWS) as f64 {
        return first;
    }
    let finer = family_wise_by(MORE_DRAWS, &all.iter().map(|one| &one.score).collect::<Vec<_>>());
    least(&mut all.iter().zip(finer).filter(|(one, _)| one.possible).map(|(_, p_value)| p_value))
}

/// Family-wise p-value of each of several tests on the same blocks: the chance that any of them has as large a statistic where nothing is
/// missing.
pub(crate) fn family_wise(all: &[&CandidateScore]) -> Vec<f64> {
    family_wise_by(DRAWS, all)
}

fn family_wise_by(draws: usize, all: &[&CandidateScore]) -> Vec<f64> {
    let statistics: Vec<Option<Statistic>> = all.iter().map(|one| Statistic::new(&one.scores)).collect();
    let largest = largest_by_chance(draws, &statistics);
    let count = all.len().max(1) as f64;
    let each = all.iter().zip(&statistics).map(|(one, statistic)| {
        let robust = statistic.as_ref().map_or(1.0, |statistic| {
            let own = statistic.surprise(&statistic.sum);
            let exceed = largest.iter().filter(|chance| **chance >= own).count();
            (1 + exceed) as f64 / (1 + largest.len()) as f64
        });
        let by_scale = chi_squared_tail(one.gain / INFLATION, one.step.len()) * count;
        // Two tests, so the smaller p-value counts double.
        (2.0 * robust.min(by_scale)).min(1.0)
    });
    each.collect()
}

/// A candidate's scores by block, whitened: their squares sum to one in each direction. `sum` is their sum over blocks.
struct Statistic {
    scores: Vec<Vec<f64>>,
    sum: Vec<f64>,
}

impl Statistic {
    /// `None` where the scatter of the scores is singular.
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

    /// Negative log p-value of a sum of scores, comparable between candidates with different numbers of parameters.
    fn surprise(&self, sum: &[f64]) -> f64 {
        -chi_squared_tail(sum.iter().map(|s| s * s).sum(), sum.len()).max(f64::MIN_POSITIVE).ln()
    }
}

/// The largest surprise of all candidates, for each draw of the blocks' signs.
fn largest_by_chance(draws: usize, statistics: &[Option<Statistic>]) -> Vec<f64> {
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
    (0..draws).into_par_iter().map(draw).collect()
}

/// Chance that a chi-square variable with this many degrees of freedom exceeds `value`.
fn chi_squared_tail(value: f64, parameters: usize) -> f64 {
    ChiSquared::new(parameters.max(1) as f64).map_or(1.0, |noise| noise.sf(value.max(0.0)))
}

/// Batches of effects that change the network: one kind of place per batch, no two effects at one place.
fn by_kind(all: Vec<&Candidate>) -> Vec<Vec<&Candidate>> {
    let mut batches: Vec<Vec<&Candidate>> = Vec::new();
    for candidate in all {
        let fits = |batch: &&mut Vec<&Candidate>| {
            let same_kind = batch[0].effect.acts_at == candidate.effect.acts_at;
            let other_place = batch.iter().all(|known| {
                known.place != candidate.place
                    || (candidate.effect.acts_at == socam_model::effects::ActsAt::Gear)
            });
            same_kind && other_place && batch.len() < BATCH
        };
        match batches.iter_mut().find(fits) {
            Some(batch) => batch.push(candidate),
            None => batches.push(vec![candidate]),
        }
    }
    batches
}

/// Scores of a batch of candidates from one evaluation, without those that cannot act; empty where sensitivities overflow.
fn scored_batch(
    model: &Model,
    datasets: &[Dataset],
    options: &Options,
    noise_model: &NoiseModel,
    at: &Evaluation,
    batch: &[&Candidate],
) -> Result<Vec<RankedCandidate>, IdentifyError> {
    let Ok((grown, groups)) = with_batch(model, batch) else { return Ok(Vec::new()) };
    let values = carried_over((model, &at.values), &grown);
    let progress = options.progress.clone().tentative();
    let problem = match Problem::new(&grown, datasets, Options { progress, ..options.clone() }) {
        Ok(problem) => problem,
        // An effect may let go what held the machine in its state of rest: the others are tested without it.
        Err(IdentifyError::Unsuited { .. }) if batch.len() > 1 => {
            let alone =
                |one| scored_batch(model, datasets, options, noise_model, at, std::slice::from_ref(one));
            let each: Result<Vec<Vec<RankedCandidate>>, IdentifyError> = batch.iter().map(alone).collect();
            return Ok(each?.into_iter().flatten().collect());
        }
        Err(IdentifyError::Unsuited { .. }) => return Ok(Vec::new()),
        Err(error) => return Err(error),
    };
    let base = free_parameters(model, &grown);
    let scores = comparison::score_test(&problem, noise_model, &values, (model, at), &base, &groups)?;
    let Some(scores) = scores else { return Ok(Vec::new()) };
    let each = batch.iter().zip(scores).map(|(candidate, mut score)| {
        if candidate.has_nonnull_linearisation() {
            score.gain += at.total() - score.total;
        }
        linearly_predicted(model, candidate, score)
    });
    Ok(each.collect())
}

/// The model with all candidates of a batch at their linearisation points, and the indices of each one's amplitude parameters.
fn with_batch(model: &Model, batch: &[&Candidate]) -> Result<(Model, Vec<Vec<usize>>), ModelError> {
    let mut grown = model.clone();
    let mut names: Vec<Vec<String>> = Vec::new();
    for candidate in batch {
        let mut own = Vec::new();
        let phases: &[f64] = if candidate.is_wave() { &[0.0, std::f64::consts::FRAC_PI_2] } else { &[0.0] };
        for phase in phases {
            let shifted = candidate.with("phase", *phase);
            grown = shifted.added_to(&grown)?;
            own.extend(amplitude_names(&grown, candidate));
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

/// Names of the amplitude parameters of the model's last effect.
fn amplitude_names(model: &Model, candidate: &Candidate) -> Vec<String> {
    let Some(used) = model.effects.last() else { return Vec::new() };
    let own = used.effect.parameters.iter().zip(&used.parameters);
    own.filter(|(parameter, _)| candidate.amplitudes.contains(&parameter.name))
        .map(|(_, index)| model.parameters[*index].name.clone())
        .collect()
}

/// The candidate at the start of its fit, from the linearised prediction of its amplitude.
fn linearly_predicted(model: &Model, candidate: &Candidate, score: CandidateScore) -> RankedCandidate {
    let mut start = candidate.clone();
    let mut possible = true;
    let mut predicted = Vec::new();
    if candidate.is_wave() {
        let (sin, cos) = (score.step[0], score.step.get(1).copied().unwrap_or(0.0));
        let name = candidate.amplitudes[0];
        predicted.push((name, sin.hypot(cos)));
        start = start.with(name, INITIAL_SHARE * sin.hypot(cos)).with("phase", cos.atan2(sin));
    } else {
        for (name, step) in candidate.amplitudes.iter().zip(&score.step) {
            let before = candidate.values.iter().find(|(known, _)| known == name).map_or(0.0, |(_, v)| *v);
            let (least, most) = candidate.bounds(model, name);
            let stepped = |share: f64| candidate.stepped(name, before, share * step);
            let is_linear = !candidate.has_nonnull_linearisation();
            predicted.push((*name, if is_linear { stepped(1.0) } else { candidate.linearised_at }));
            possible &= (least..=most).contains(&stepped(1.0));
            let share = if candidate.has_nonnull_linearisation() { 0.0 } else { INITIAL_SHARE };
            start = start.with(name, stepped(share).clamp(least, most));
        }
    }
    RankedCandidate { start, predicted, score, p_value: 1.0, possible }
}
