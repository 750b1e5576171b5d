//! Forward stepwise selection: which effect to add, and whether it is worth it.

use socam_identify::{
    IdentifyError, NoiseLevels,
    comparison::{self, NoiseModel},
};
use socam_model::{Model, effects::Rig};
use socam_recording::Dataset;

use crate::{
    alike::alike,
    candidates::{self, Candidate},
    choice::{self, Choice},
    context::{Context, FAR_BEYOND_NOISE, FittedModel},
    criterion::{self, Difference},
    halving,
    nonparametric::{self, Unexplained},
    plausibility::Known,
    scales::Scales,
    score_test::{self, RankedCandidate, carried},
};

/// Candidates that are fitted, and places of any one effect among them: in a long chain neighbours promise the same.
const TRIED: usize = 8;
const PLACES: usize = 4;
/// Effects that also begin large where the base model is far from the data.
const LARGE: usize = 12;
/// Mean square of the residuals in units of sensor noise from which on something is left.
pub(crate) const EXCESS: f64 = 1.05;
/// From where on base parameters may have been displaced so far that a fit does not find back from there.
pub(crate) const DISPLACED: f64 = 2.0;
/// Further orders of effects that come back with every turn: all orders at one place are one effect.
const MORE_ORDERS: usize = 8;

/// One effect that was added.
#[derive(Debug, Clone)]
pub(crate) struct Term {
    pub(crate) candidate: Candidate,
    /// Of the score test, over all candidates.
    pub(crate) p_value: f64,
    /// Competing models and their weights, of which the term's own is what is missing to one.
    pub(crate) rivals: Vec<(Candidate, f64)>,
    /// What it gains now, beside all others.
    pub(crate) gain: Difference,
    /// The last model without it, at its fit.
    pub(crate) without: Option<FittedModel>,
    /// Excess over sensor noise when nested laws were last tried in its place.
    pub(crate) excess_at_upgrade: f64,
}

/// From the base model to the corrected one.
#[derive(Clone)]
pub(crate) struct Path {
    pub(crate) base: FittedModel,
    pub(crate) last: FittedModel,
    pub(crate) terms: Vec<Term>,
    /// What is known before any recording.
    pub(crate) known: Known,
    /// Sensor noise and model discrepancy as the last model shows them.
    pub(crate) noise: NoiseModel,
    /// The last score test, the largest gain first; empty where the model changed since.
    pub(crate) tests: Vec<RankedCandidate>,
    /// What remains without a name.
    pub(crate) unexplained: Option<Unexplained>,
}

/// From a base model at its fit (`values`, SI) and noise levels to what is missing; `None` where its prediction overflows.
pub(crate) fn run(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    levels: &NoiseLevels,
) -> Result<Option<Path>, IdentifyError> {
    let Some((base, noise)) = base(context, model, values, levels)? else { return Ok(None) };
    let known = Known { base: model.clone(), rig: Rig::of_model(model, &base.at.values) };
    let mut path = Path {
        last: base.clone(),
        base,
        terms: Vec::new(),
        known,
        noise,
        tests: Vec::new(),
        unexplained: None,
    };
    for _ in 0..context.options.most_effects + MORE_ORDERS {
        if !path.extend(context)? {
            break;
        }
    }
    Ok(Some(path))
}

/// The base model at its fit under its own noise model.
fn base(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    levels: &NoiseLevels,
) -> Result<Option<(FittedModel, NoiseModel)>, IdentifyError> {
    let sensor = context.sensor_noise(model, values, levels.clone())?;
    let problem = context.problem(model)?;
    let Some(first) = comparison::measure(&problem, &sensor, values)? else { return Ok(None) };
    let Some(noise) = context.noise_at(model, &first, levels)? else { return Ok(None) };
    let Some(base) = context.fitted(model, values, Some((model, &first)), &noise)? else { return Ok(None) };
    let noise = context.noise_at(model, &base.at, noise.levels())?.unwrap_or(noise);
    Ok(context.refitted(&base, &noise)?.map(|base| (base, noise)))
}

impl Path {
    /// What a model gains over another one in cross-validation, and how much more plausible its parameters are.
    pub(crate) fn gain(&self, after: &FittedModel, before: &FittedModel) -> Difference {
        let own = criterion::difference(&after.validation, &before.validation);
        let prior = self.known.log_prior(after) - self.known.log_prior(before);
        Difference { log_score: own.log_score + prior, ..own }
    }

    /// Adds what predicts best, if anything does; says whether it did.
    fn extend(&mut self, context: &Context<'_>) -> Result<bool, IdentifyError> {
        let scales = self.test(context)?;
        if self.tests.is_empty() {
            return Ok(false);
        }
        let tried = self.worth_trying(context.options.false_alarm_rate);
        let mut named = choice::best(context, self, &tried, Some(&scales))?;
        let is_suspicious = !tried.is_empty();
        self.unexplained = nonparametric::competing(context, self, &scales, named.as_ref(), is_suspicious)?;
        if let Some(curve) = &self.unexplained {
            let mut overlooked = self.overlooked(curve, &tried);
            // They are compared with what was chosen before.
            let is_chosen = |candidate: &Candidate| {
                named.as_ref().is_some_and(|one| one.term.candidate.is_same(candidate))
            };
            overlooked.extend(tried.iter().filter(|(candidate, _)| is_chosen(candidate)).cloned());
            let late = choice::best(context, self, &overlooked, None)?;
            named = match late {
                Some(late) if !curve.beats(context, self, &late)? => Some(late),
                _ => None,
            };
            if named.is_none() {
                self.replace_by_curve(context)?;
                return Ok(false);
            }
            self.unexplained = None;
        }
        let Some(choice) = named else { return Ok(false) };
        if self.is_remainder(context, &choice)? {
            return Ok(false);
        }
        self.add(context, choice)?;
        Ok(true)
    }

    /// The score test of all that was not added yet; returns how large motions and torques are.
    fn test(&mut self, context: &Context<'_>) -> Result<Scales, IdentifyError> {
        let FittedModel { model, at, .. } = &self.last;
        let scales = Scales::new(&context.problem(model)?, model, &self.noise, at)?;
        if self.terms.is_empty() {
            self.known.rig = scales.rig.clone();
        }
        let mut all = candidates::all(model, &scales);
        // Nor what is observationally equivalent to something that was added.
        let known: Vec<Candidate> =
            (0..self.terms.len()).flat_map(|index| self.equivalent(context, index)).collect();
        let is_known = |candidate: &Candidate| {
            known.iter().any(|known| known.is_same(candidate))
                || self.terms.iter().any(|term| term.candidate.repeats(candidate))
        };
        all.retain(|candidate| !is_known(candidate));
        if self.effects() >= context.options.most_effects {
            all.retain(|candidate| self.has(candidate));
        }
        self.tests =
            score_test::run(model, context.training, &context.fit, &self.noise, at, (&scales, &all))?;
        Ok(scales)
    }

    /// Effects that were added, several orders at one place being one.
    pub(crate) fn effects(&self) -> usize {
        let is_first = |index: &usize| {
            !self.terms[..*index].iter().any(|term| term.candidate.is_same(&self.terms[*index].candidate))
        };
        (0..self.terms.len()).filter(is_first).count()
    }

    /// The same of the last model, unless that was done.
    pub(crate) fn test_last(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        if self.tests.is_empty() {
            self.test(context)?;
        }
        Ok(())
    }

    /// The candidates that would gain most of those that stand out, each effect and place once, with their starts.
    fn worth_trying(&self, false_alarm_rate: f64) -> Vec<(Candidate, f64)> {
        let mut tried: Vec<(Candidate, f64)> = Vec::new();
        let able = self.tests.iter().filter(|one| one.possible && one.p_value < false_alarm_rate);
        for one in able {
            let starts = tried.iter().filter(|(candidate, _)| candidate.is_same(&one.start)).count();
            let elsewhere = tried.iter().filter(|(candidate, _)| candidate.effect.id == one.start.effect.id);
            let elsewhere = elsewhere.filter(|(candidate, _)| !candidate.is_same(&one.start)).count();
            let has_room = tried.len() < TRIED && elsewhere < PLACES && !one.start.is_always_tried();
            if starts < one.start.most_starts() && has_room {
                tried.push((one.start.clone(), one.p_value));
            }
        }
        let (model, values) = (&self.last.model, &self.last.at.values);
        let begun = tried.into_iter().flat_map(|(candidate, p_value)| {
            let starts = candidates::starts(candidate, model, values);
            starts.into_iter().map(move |start| (start, p_value))
        });
        begun.chain(self.large(false_alarm_rate)).collect()
    }

    /// Far from the data a little of an effect leads nowhere, and scores say little: what would gain most begins at usual sizes, whether it stands
    /// out or not.
    pub(crate) fn far(&self) -> Vec<(Candidate, f64)> {
        // What was added has brought them nearer.
        let displaced = if self.terms.is_empty() { DISPLACED } else { FAR_BEYOND_NOISE };
        if self.noise.excess() <= displaced {
            return Vec::new();
        }
        let mut known: Vec<&Candidate> = Vec::new();
        let mut far = Vec::new();
        for one in &self.tests {
            let starts = candidates::usual(&one.start, &self.known.rig);
            let is_new = !known.iter().any(|known| known.is_same(&one.start));
            if is_new && known.len() < LARGE && !starts.is_empty() && !one.start.is_always_tried() {
                known.push(&one.start);
                far.extend(starts.into_iter().map(|start| (start, one.p_value)));
            }
        }
        far
    }

    /// Large amplitudes of effects of which a little says nothing, where anything at all is missing.
    fn large(&self, false_alarm_rate: f64) -> Vec<(Candidate, f64)> {
        let others = self.tests.iter().filter(|one| !one.start.is_always_tried() && one.possible);
        let p_value = others.map(|one| one.p_value).fold(1.0, f64::min);
        if p_value >= false_alarm_rate {
            return Vec::new();
        }
        let all = self.tests.iter().filter(|one| one.start.is_always_tried());
        let starts = all.flat_map(|one| {
            let little = Some(one.start.clone()).filter(|_| one.possible);
            little.into_iter().chain(candidates::large(&one.start, &self.known.rig))
        });
        starts.map(|start| (start, p_value)).collect()
    }

    /// What acts where a curve was found and was not tried: scores at a null amplitude may say little of what a large one does.
    fn overlooked(&self, curve: &Unexplained, tried: &[(Candidate, f64)]) -> Vec<(Candidate, f64)> {
        let mut all: Vec<(Candidate, f64)> = Vec::new();
        for one in self.tests.iter().filter(|one| one.possible && one.start.place == curve.place) {
            if !tried.iter().chain(&all).any(|(known, _)| known.is_same(&one.start)) {
                all.push((one.start.clone(), curve.p_value));
            }
        }
        all
    }

    /// Whether a choice is what the law of an earlier term leaves: a real effect differs from its law by a share of itself, most of which shows at
    /// its own place.
    fn is_remainder(&self, context: &Context<'_>, choice: &Choice) -> Result<bool, IdentifyError> {
        for index in 0..self.terms.len() {
            let is_there = self.terms[index].candidate.place == choice.term.candidate.place;
            let discrepancy = if is_there { criterion::by_law } else { criterion::by_law_elsewhere };
            let Some((model, values)) = self.begun_without(index) else { continue };
            let without = comparison::measure(&context.problem(&model)?, &choice.noise, &values)?;
            let Some(without) = without else { continue };
            let earlier = 0.5 * (without.total() - choice.before.deviance());
            if choice.term.gain.log_score < discrepancy(earlier) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Adds what was chosen, and makes of it what the recordings now say.
    fn add(&mut self, context: &Context<'_>, choice: Choice) -> Result<(), IdentifyError> {
        let was = self.noise.excess();
        self.terms.push(choice.term);
        self.noise = choice.noise;
        self.last = if was < DISPLACED { choice.fitted } else { restarted(context, self, choice.fitted)? };
        self.renew_noise(context)?;
        self.upgrade(context)?;
        self.simplify(context, self.terms.len() - 1)?;
        self.tests.clear();
        self.eliminate(context, self.terms.len() - 1)
    }

    /// Estimates sensor noise and discrepancy by the last model, and fits it under these.
    pub(crate) fn renew_noise(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        let noise = context.noise_at(&self.last.model, &self.last.at, self.noise.levels())?;
        let Some(noise) = noise else { return Ok(()) };
        if let Some(again) = context.refitted(&self.last, &noise)? {
            (self.last, self.noise) = (again, noise);
        }
        Ok(())
    }

    /// The last model but for one of its terms, and its values as they are.
    pub(crate) fn begun_without(&self, index: usize) -> Option<(Model, Vec<f64>)> {
        let others = self.terms.iter().enumerate().filter(|(other, _)| *other != index);
        let model = self.base.with(others.map(|(_, term)| &term.candidate))?;
        let values = carried((&self.last.model, &self.last.at.values), &model);
        Some((model, values))
    }

    /// The last model with another candidate in the place of one of its terms, and its values as they are.
    pub(crate) fn begun_with(&self, index: usize, candidate: &Candidate) -> Option<(Model, Vec<f64>)> {
        let each = self.terms.iter().enumerate();
        let each = each.map(|(other, term)| if other == index { candidate } else { &term.candidate });
        let model = self.base.with(each)?;
        let values = carried((&self.last.model, &self.last.at.values), &model);
        Some((model, values))
    }

    /// With all that was found, the curve of what has no name among it; `None` where nothing was.
    pub(crate) fn corrected(&self) -> Option<&FittedModel> {
        let named = (!self.terms.is_empty()).then_some(&self.last);
        self.unexplained.as_ref().map(|found| &found.fitted).or(named)
    }

    /// The same, or the last fit where nothing was found.
    pub(crate) fn whole(&self) -> &FittedModel {
        self.corrected().unwrap_or(&self.last)
    }

    /// Sensor noise beside all that was found; what a curve carries is none.
    pub(crate) fn levels(&self, context: &Context<'_>) -> Result<NoiseLevels, IdentifyError> {
        match &self.unexplained {
            Some(Unexplained { fitted, .. }) => {
                comparison::noise(&context.problem(&fitted.model)?, &fitted.at, self.noise.levels())
            }
            None => Ok(self.noise.levels().clone()),
        }
    }

    /// Parameters of a term: their names, and where the last model has them.
    pub(crate) fn parameters(&self, term: usize) -> impl Iterator<Item = (&'static str, usize)> + '_ {
        let model = &self.last.model;
        let used = &model.effects[model.effects.len() - self.terms.len() + term];
        used.effect.parameters.iter().zip(&used.parameters).map(|(own, index)| (own.name, *index))
    }

    /// The same with their values at the last fit.
    pub(crate) fn fitted_parameters(&self, term: usize) -> Vec<(&'static str, f64)> {
        self.parameters(term).map(|(name, index)| (name, self.last.at.values[index])).collect()
    }

    /// What is observationally equivalent to a term.
    pub(crate) fn equivalent(&self, context: &Context<'_>, term: usize) -> Vec<Candidate> {
        let candidate = &self.terms[term].candidate;
        let amplitude = candidate.strength.first().and_then(|name| self.value(term, name));
        let step_s = context.training.first().map_or(0.0, Dataset::sample_time_s);
        alike(&self.last.model, candidate, amplitude, step_s)
    }

    /// Value of one of a term's parameters at the last fit.
    pub(crate) fn value(&self, term: usize, name: &str) -> Option<f64> {
        let index = self.parameters(term).find(|(own, _)| *own == name)?.1;
        Some(self.last.at.values[index])
    }

    /// Whether an effect at a place was added.
    pub(crate) fn has(&self, candidate: &Candidate) -> bool {
        self.terms.iter().any(|term| term.candidate.is_same(candidate))
    }
}

/// What is missing displaces all other parameters, and a fit may not find back from there: base parameters begin again at the file's values.
fn restarted(context: &Context<'_>, path: &Path, fitted: FittedModel) -> Result<FittedModel, IdentifyError> {
    let mut values = fitted.at.values.clone();
    for parameter in &path.base.model.parameters {
        if let Some(index) = fitted.model.parameter(&parameter.name) {
            values[index] = parameter.value;
        }
    }
    let trial = halving::from_afar(context, &fitted.model, &values, &path.noise, &fitted.at.chi2)?;
    let Some(trial) = trial else { return Ok(fitted) };
    let other = context.fitted(&fitted.model, &trial.values, Some((&fitted.model, &trial)), &path.noise)?;
    Ok(other.filter(|other| other.deviance() < fitted.deviance()).unwrap_or(fitted))
}
