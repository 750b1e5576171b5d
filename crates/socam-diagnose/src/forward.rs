//! Forward stepwise selection: score test, choice of one effect, its addition, until no candidate predicts better.

use socam_identify::{
    IdentifyError, NoiseLevels,
    comparison::{self, NoiseModel},
};
use socam_model::{Model, effects::Rig};

use crate::{
    candidate::Candidate,
    candidates,
    choice::{self, Choice},
    context::{Context, FittedModel},
    criterion, halving,
    journal::Fate,
    nonparametric::{self, term::Unexplained},
    plausibility::PriorKnowledge,
    scales::Scales,
    score_test,
    selection::{DISPLACED, Path, Unexamined},
};

/// Number of steps beyond the largest number of effects, for further orders of periodic effects: all orders at one place are one effect.
const MORE_ORDERS: usize = 8;

/// Typical shares of a diagnosis' time before and after the selection, 1; used to estimate the remaining time.
const PART_BEFORE: f64 = 0.15;
const PART_AFTER: f64 = 0.15;

/// Runs the selection from a base model, its fitted `values` (SI) and noise levels. `None` where the base model's prediction overflows.
pub(crate) fn run(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    levels: &NoiseLevels,
) -> Result<Option<Path>, IdentifyError> {
    let Some(begun) = begin(context, model, values, levels)? else { return Ok(None) };
    let nearer = match begun.by_prescribed_motion(context)? {
        Some(nearer) => Some(nearer),
        None => begun.by_short_horizons(context)?,
    };
    nearer.unwrap_or(begun).extended(context).map(Some)
}

/// The path at the base model. `None` where the base model's prediction overflows.
pub(crate) fn begin(
    context: &Context<'_>,
    model: &Model,
    values: &[f64],
    levels: &NoiseLevels,
) -> Result<Option<Path>, IdentifyError> {
    let Some((base, noise)) = base(context, model, values, levels)? else { return Ok(None) };
    let priors = PriorKnowledge { base: model.clone(), rig: Rig::of_model(model, &base.at.values) };
    let (last, terms, tests) = (base.clone(), Vec::new(), Vec::new());
    Ok(Some(Path { last, base, terms, priors, noise, tests, unexplained: None, unexamined: None }))
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
    /// Adds effects until none predicts better.
    fn extended(mut self, context: &Context<'_>) -> Result<Self, IdentifyError> {
        for _ in 0..context.options.most_effects + MORE_ORDERS {
            if context.stops() {
                self.unexamined = Some(Unexamined::Candidates);
            }
            if self.unexamined.is_some() || !self.extend(context)? {
                break;
            }
        }
        Ok(self)
    }

    /// One step: adds the effect that predicts best, if one predicts better than the last model. Returns whether an effect was added. A
    /// choice during which the search was ended is not made.
    fn extend(&mut self, context: &Context<'_>) -> Result<bool, IdentifyError> {
        context.journal.begin_step(self.effects() + 1);
        self.begin_part(context, "score test of the candidates", 0.0);
        self.settle_inputs(context)?;
        let scales = self.test(context)?;
        if context.stops() {
            self.unexamined = Some(Unexamined::Candidates);
        }
        if self.tests.is_empty() {
            return Ok(false);
        }
        self.begin_part(context, "fits of the candidates", 0.3);
        let tried = self.worth_trying(context.options.false_alarm_rate);
        context.journal.note_left_out(&self.tests, &tried, context.options.false_alarm_rate);
        let mut named = choice::best(context, self, &tried, Some(&scales))?;
        if context.stops() {
            self.unexamined = Some(Unexamined::fits(&tried));
            return Ok(false);
        }
        let is_any_significant = !tried.is_empty();
        self.begin_part(context, "curves without a law", 0.7);
        self.unexplained =
            nonparametric::competing(context, self, &scales, named.as_ref(), is_any_significant)?;
        if context.stops() {
            // The effect was chosen among all candidates; only the curves did not compete with it.
            (self.unexplained, self.unexamined) = (None, Some(Unexamined::Curves));
        }
        if let Some(curve) = &self.unexplained.clone() {
            self.begin_part(context, "laws in the place of a curve", 0.8);
            let mut overlooked = self.overlooked(curve, &tried);
            // The effect chosen before the curve was fitted competes again.
            let is_chosen = |candidate: &Candidate| {
                named.as_ref().is_some_and(|one| one.term.candidate.is_same(candidate))
            };
            overlooked.extend(tried.iter().filter(|(candidate, _)| is_chosen(candidate)).cloned());
            let late = choice::best(context, self, &overlooked, None)?;
            named = match late {
                Some(late) if !curve.beats(context, self, &late)? => Some(late),
                late => {
                    late.iter().for_each(|late| context.journal.note(&late.term.candidate, Fate::Curve));
                    self.first_of_two(context, curve)?
                }
            };
            if context.stops() {
                self.unexamined = Some(Unexamined::Laws);
                return Ok(false);
            }
            if named.is_none() {
                if self.exchange_laws_at(context, &curve.place)? {
                    self.unexplained = None;
                    return Ok(true);
                }
                named = self.best_given_up(context, curve)?;
                if context.stops() {
                    self.unexamined = Some(Unexamined::Laws);
                    return Ok(false);
                }
            }
            if named.is_none() {
                self.replace_by_curve(context)?;
                return Ok(false);
            }
            self.unexplained = None;
        }
        let Some(choice) = named else { return Ok(false) };
        if self.is_remainder(context, &choice)? {
            context.journal.note(&choice.term.candidate, Fate::Remainder);
            return Ok(false);
        }
        self.begin_part(context, "other laws at the place, and terms before it", 0.85);
        self.add(context, choice)?;
        Ok(true)
    }

    /// Reports the beginning of a part of this step; `share` of the step is done by then.
    fn begin_part(&self, context: &Context<'_>, name: &str, share: f64) {
        let (added, most) = (self.effects(), context.options.most_effects);
        let step = (added.min(most) as f64 + share) / (most + 1) as f64;
        let name = format!("{name}, effect {}", added + 1);
        context.fit.progress.part(&name, PART_BEFORE + (1.0 - PART_BEFORE - PART_AFTER) * step);
    }

    /// The better of two effects at a curve's place that together predict as well as the curve: a curve also follows the sum of two laws,
    /// which a single law cannot. `None` if no two effects do.
    fn first_of_two(
        &self,
        context: &Context<'_>,
        curve: &Unexplained,
    ) -> Result<Option<Choice>, IdentifyError> {
        let at_the_place = |path: &Self| -> Vec<(Candidate, f64)> {
            let own = path.tests.iter().filter(|one| one.possible && one.start.place == curve.place);
            own.map(|one| (one.start.clone(), one.p_value)).collect()
        };
        let Some(first) = choice::best(context, self, &at_the_place(self), None)? else { return Ok(None) };
        let mut with_first = self.clone();
        with_first.terms.push(first.term.clone());
        (with_first.last, with_first.noise) = (first.fitted.clone(), first.noise.clone());
        with_first.test(context)?;
        let Some(second) = choice::best(context, &with_first, &at_the_place(&with_first), None)? else {
            return Ok(None);
        };
        let both = Choice { before: first.before.clone(), ..second };
        Ok(if curve.beats(context, self, &both)? { None } else { Some(first) })
    }

    /// Sizes of motions and torques at the last fit.
    pub(crate) fn scales(&self, context: &Context<'_>) -> Result<Scales, IdentifyError> {
        let FittedModel { model, at, .. } = &self.last;
        Scales::new(&context.problem(model)?, model, &self.noise, at)
    }

    /// Score test of all candidates that were not added yet. Returns the sizes of motions and torques.
    pub(crate) fn test(&mut self, context: &Context<'_>) -> Result<Scales, IdentifyError> {
        let scales = self.scales(context)?;
        if self.terms.is_empty() {
            self.priors.rig = scales.rig.clone();
        }
        let FittedModel { model, at, .. } = &self.last;
        let mut all = candidates::all(model, &scales);
        // Effects that are observationally equivalent to an added one are not tested either.
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
        if context.stops() {
            // The p-values hold for all candidates together, and some may not have been tested.
            self.tests.clear();
        }
        Ok(scales)
    }

    /// Score test of the last model, unless it was made or the search was ended.
    pub(crate) fn test_last(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        if self.tests.is_empty() && !context.stops() {
            self.test(context)?;
        }
        Ok(())
    }

    /// Whether a choice gains no more than the discrepancy of an earlier term's law can make: a real effect differs from its law by a share
    /// of its contribution, and most of that difference appears at its own place.
    fn is_remainder(&self, context: &Context<'_>, choice: &Choice) -> Result<bool, IdentifyError> {
        for index in 0..self.terms.len() {
            let is_there = self.terms[index].candidate.place == choice.term.candidate.place;
            let discrepancy = if is_there { criterion::by_law } else { criterion::by_law_elsewhere };
            let without = self.evaluated_without(context, index, &choice.noise)?;
            let Some((_, without)) = without else { continue };
            let earlier = 0.5 * (without.total() - choice.before.deviance());
            if choice.term.gain.log_score < discrepancy(earlier) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Adds the chosen term, estimates the noise again, and tries nested laws and elimination.
    pub(crate) fn add(&mut self, context: &Context<'_>, choice: Choice) -> Result<(), IdentifyError> {
        let was = self.noise.excess();
        self.terms.push(choice.term);
        self.noise = choice.noise;
        self.last = choice.fitted;
        if context.stops() {
            self.tests.clear();
            return Ok(());
        }
        if was >= DISPLACED {
            self.last = restarted(context, self, self.last.clone())?;
        }
        self.renew_noise(context)?;
        // A law that was raced from one start may have ended short of what it can explain: it begins again from a simpler one.
        let last = self.terms.len() - 1;
        self.simplify(context, last)?;
        self.tests.clear();
        self.upgrade(context)?;
        self.eliminate(context, last)
    }

    /// Estimates sensor noise and discrepancy from the last model's residuals, and fits the last model under them, unless the search was
    /// ended.
    pub(crate) fn renew_noise(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        if context.stops() {
            return Ok(());
        }
        let noise = context.noise_at(&self.last.model, &self.last.at, self.noise.levels())?;
        let Some(noise) = noise else { return Ok(()) };
        if let Some(again) = context.refitted(&self.last, &noise)? {
            (self.last, self.noise) = (again, noise);
        }
        Ok(())
    }
}

/// A fit whose base parameters start again at the file's values, if it is better than `fitted`. Missing physics displaces the base
/// parameters, and a fit that starts at the displaced values may not return. Parameters of effects in the base model start at the file's
/// values here, but at their fitted values in `halving`.
fn restarted(context: &Context<'_>, path: &Path, fitted: FittedModel) -> Result<FittedModel, IdentifyError> {
    let mut values = fitted.at.values.clone();
    for parameter in &path.base.model.parameters {
        if let Some(index) = fitted.model.parameter(&parameter.name) {
            values[index] = parameter.value;
        }
    }
    let trial = halving::descend_from_afar(
        context,
        &fitted.model,
        &values,
        &path.noise,
        (&fitted.at.chi2, |_| f64::INFINITY),
    )?;
    let Some(trial) = trial else { return Ok(fitted) };
    let other = context.fitted(&fitted.model, &trial.values, Some((&fitted.model, &trial)), &path.noise)?;
    Ok(other.filter(|other| other.deviance() < fitted.deviance()).unwrap_or(fitted))
}
