//! Step by step: which effect to add, and whether it is worth it.

use socam_identify::{
    IdentifyError, NoiseLevels,
    compare::{self, Measured, Yardstick},
};
use socam_model::Model;
use socam_recording::Dataset;

use crate::{
    alike::alike,
    bench::{Bench, Fitted},
    candidates::{self, Candidate},
    scales::Scales,
    screen::{self, Promising, carried},
    shapes::{self, Shape, Unexplained},
};

mod blind;
mod choice;
mod refine;

use choice::{Named, Tried, against_noise, best, proof};

/// Candidates that are fitted in earnest, and places of any one effect among them: in a long chain neighbours promise the same.
const TRIED: usize = 8;
const PLACES: usize = 4;
/// Least fall of the sum of squares in training that counts.
const LEAST_GAIN: f64 = 25.0;
/// Mean square of what is left on held-out recordings, in units of noise, from which on it is looked at by shape.
pub(crate) const MISFIT: f64 = 1.05;
/// From where on parameters may have been bent so far that they do not find back by themselves.
const BENT: f64 = 2.0;
/// So many iterations from the file's values must come within so many times the sum of squares of the fit there is; likewise without an
/// effect that was added: far from where it fits, a law takes long to follow.
const AFRESH: usize = 10;
const HOPEFUL: f64 = 2.0;
const WITHOUT: [(usize, f64); 2] = [(2, 100.0), (4, HOPEFUL)];
/// A named effect that explains less than this share of what a curve at one place would is not believed.
const NEARLY: f64 = 0.6;
/// A name that only a curve pointed to has to gain more than that, and this share of what is missed on held-out recordings, per cent.
const NEARLY_ALL: f64 = 90.0;
/// Least share of the misfit on held-out recordings, per cent, that an effect or a curve must carry: where much is left, almost
/// anything takes some of it.
const LEAST_SHARE: f64 = 5.0;
/// Least share of the misfit in training that an effect must promise; effects that are far from linear promise little.
const LEAST_PROMISE: f64 = 1e-3;

/// Share of what an effect gained below which another one at the same place, or a curve anywhere, is taken for what its law leaves.
const SHADOW: f64 = 2e-3;

/// A name at a curve's own place that gains more than so many times what the curve adds to it is no part of that: it has a remainder.
const MUCH: f64 = 10.0;

/// One effect that was added.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub(crate) candidate: Candidate,
    pub(crate) p_value: f64,
    pub(crate) gain: f64,
    pub(crate) held_gain_percent: f64,
    pub(crate) proof: Proof,
    /// What else was tried, by how much worse it predicted held-out recordings.
    pub(crate) rivals: Vec<(Candidate, f64)>,
}

/// On what an effect holds that was not fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Proof {
    /// The held-out recordings.
    HeldOut,
    /// Those do not show it; but training recordings that are left out in turn do: how much of what is missed there it takes, per cent.
    InTurn(f64),
}

/// The whole way.
#[derive(Clone)]
pub(crate) struct Course {
    pub(crate) base: Fitted,
    pub(crate) last: Fitted,
    pub(crate) steps: Vec<Step>,
    /// Fits before each of these.
    before: Vec<Fitted>,
    pub(crate) yardstick: Yardstick,
    /// What a screening of the last model saw, strongest first; nothing once that is another one.
    pub(crate) screened: Vec<Promising>,
    /// What remains without a name.
    pub(crate) unexplained: Option<Unexplained>,
}

/// From a base model at its fit (`values`, SI) and noise levels to what is missing.
pub(crate) fn run(
    bench: &Bench<'_>,
    model: &Model,
    values: &[f64],
    levels: NoiseLevels,
) -> Result<Option<Course>, IdentifyError> {
    let yardstick = bench.yardstick(model, values, levels)?;
    let Some(base) = bench.fitted(model, values, None, &yardstick)? else { return Ok(None) };
    let mut course = Course {
        last: base.clone(),
        base,
        steps: Vec::new(),
        before: Vec::new(),
        yardstick,
        screened: Vec::new(),
        unexplained: None,
    };
    for _ in 0..bench.options.most_effects {
        let (scales, threshold) = course.look(bench)?;
        let Some(named) = course.choose(bench, &scales, threshold)? else { return Ok(Some(course)) };
        course.add(bench, named)?;
    }
    Ok(Some(course))
}

impl Course {
    /// Screens all that was not added yet. Returns how large things are, and below which chance one stands out.
    fn look(&mut self, bench: &Bench<'_>) -> Result<(Scales, f64), IdentifyError> {
        let Fitted { model, at, .. } = &self.last;
        let scales = Scales::new(&bench.problem(model)?, model, &self.yardstick, at)?;
        let mut all = candidates::all(model, &scales);
        // Nor what no recording tells from something that was added.
        let known: Vec<Candidate> =
            (0..self.steps.len()).flat_map(|index| self.alike(bench, index)).collect();
        let is_known = |candidate: &Candidate| {
            known.iter().any(|known| known.is_same(candidate))
                || self.steps.iter().any(|step| step.candidate.repeats(candidate))
        };
        all.retain(|candidate| !is_known(candidate));
        let mut seen =
            screen::screen(model, bench.training, &bench.fit, &self.yardstick, at, (&scales, &all))?;
        seen.sort_by(|a, b| b.promise.gain.total_cmp(&a.promise.gain));
        self.screened = seen;
        Ok((scales, bench.options.false_alarm_rate / all.len().max(1) as f64))
    }

    /// What could not be seen is said of the last model: screens it unless that was done.
    pub(crate) fn look_last(&mut self, bench: &Bench<'_>) -> Result<(), IdentifyError> {
        if self.screened.is_empty() {
            self.look(bench)?;
        }
        Ok(())
    }

    /// What to add next; nothing where nothing is missing, or what is has no name.
    fn choose(
        &mut self,
        bench: &Bench<'_>,
        scales: &Scales,
        threshold: f64,
    ) -> Result<Option<Named>, IdentifyError> {
        let mut tried = worth_trying(self, threshold);
        let suspicious = tried.iter().any(|(_, p_value)| *p_value < threshold);
        let mut named = best(bench, self, &mut tried, Some(scales))?;
        if let Some(weak) = named.take_if(|named| named.chosen.0.p_value >= threshold) {
            named = against_noise(bench, &self.yardstick, weak, threshold)?;
            if named.is_none() && suspicious {
                tried.retain(|(_, p_value)| *p_value < threshold);
                named = best(bench, self, &mut tried, Some(scales))?;
            }
        }
        let chosen = named.as_ref().map(|named| &named.chosen);
        let gains = self.gains(bench)?;
        self.unexplained = unnamed(bench, self, scales, chosen, &gains, suspicious)?;
        let Some(curve) = &self.unexplained else {
            return Ok(named.filter(|named| !self.is_shadow(&gains, &named.chosen.0)));
        };
        let late = best(bench, self, &mut overlooked(self, curve, &tried), None)?;
        let is_it = |late: &Named| {
            let step = &late.chosen.0;
            step.gain > curve.gain && step.held_gain_percent > NEARLY_ALL && !self.is_shadow(&gains, step)
        };
        let late = late.filter(is_it);
        match late {
            Some(_) => self.unexplained = None,
            None => self.leave_to_curve(bench)?,
        }
        Ok(late)
    }

    /// Takes out what was added before a curve was found, where beside that it would not be: of what has no name a good part may look like
    /// something that has one, elsewhere or, on the average over time, in the same place.
    fn leave_to_curve(&mut self, bench: &Bench<'_>) -> Result<(), IdentifyError> {
        for index in (0..self.steps.len()).rev() {
            let Some(curve) = &self.unexplained else { return Ok(()) };
            let is_there = self.steps[index].candidate.place == curve.place;
            if is_there && self.gains(bench)?[index].0 > MUCH * curve.gain {
                continue;
            }
            let Some((model, values)) = self.begun_without(index) else { continue };
            let beside = curve.beside(bench, (&model, &values), &self.yardstick)?;
            let Some(beside) = beside else { continue };
            if proof(bench, &self.yardstick, &beside, &curve.fitted)?.is_some() {
                continue;
            }
            let Some(fitted) = bench.fitted(&model, &values, None, &self.yardstick)? else { continue };
            let named = self.clone();
            self.remove(bench, index, fitted)?;
            if self.unexplained.is_none() {
                *self = named;
            }
        }
        Ok(())
    }

    /// The last model but for one of the effects that were added, and its values as they are.
    fn begun_without(&self, index: usize) -> Option<(Model, Vec<f64>)> {
        let others = self.steps.iter().enumerate().filter(|(other, _)| *other != index);
        let model = self.base.with(others.map(|(_, step)| &step.candidate))?;
        let values = carried((&self.last.model, &self.last.at.values), &model);
        Some((model, values))
    }

    /// Adds what was chosen, and makes of it what the recordings now say.
    fn add(&mut self, bench: &Bench<'_>, named: Named) -> Result<(), IdentifyError> {
        let Named { chosen: (step, fitted), nearest } = named;
        self.steps.push(step);
        self.before.push(self.last.clone());
        self.last = afresh(bench, self, fitted)?;
        self.judge_noise(bench)?;
        if let Some(nearest) = nearest {
            self.enrich(bench, nearest)?;
        }
        self.refine(bench)?;
        self.drop_superfluous(bench)?;
        self.screened.clear();
        Ok(())
    }

    /// With all that was found, the curve of what has no name among it; `None` where nothing was.
    pub(crate) fn corrected(&self) -> Option<&Fitted> {
        let named = (!self.steps.is_empty()).then_some(&self.last);
        self.unexplained.as_ref().map(|found| &found.fitted).or(named)
    }

    /// The same, or the last fit where nothing was found.
    pub(crate) fn whole(&self) -> &Fitted {
        self.corrected().unwrap_or(&self.last)
    }

    /// Noise as it shows beside all that was found; what a curve carries is none.
    pub(crate) fn levels(&self, bench: &Bench<'_>) -> Result<NoiseLevels, IdentifyError> {
        match &self.unexplained {
            Some(Unexplained { fitted, .. }) => {
                compare::noise(&bench.problem(&fitted.model)?, &fitted.at, self.yardstick.levels())
            }
            None => Ok(self.yardstick.levels().clone()),
        }
    }

    /// The fits before and after each step.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (&Fitted, &Fitted)> {
        self.before.iter().zip(self.before.iter().skip(1).chain([&self.last]))
    }

    /// What each step gains in training, and of what the fit before missed on held-out recordings, per cent: all by the last yardstick,
    /// for as noise is judged again what is missed weighs more.
    pub(crate) fn gains(&self, bench: &Bench<'_>) -> Result<Vec<(f64, f64)>, IdentifyError> {
        if self.steps.is_empty() {
            return Ok(Vec::new());
        }
        let again = |fitted: &Fitted| bench.measured(fitted, &self.yardstick);
        let all: Result<Vec<Option<Fitted>>, IdentifyError> =
            self.before.iter().chain([&self.last]).map(again).collect();
        let all = all?;
        let gains = all.windows(2).zip(&self.steps).map(|(pair, step)| match pair {
            [Some(before), Some(after)] => {
                (before.at.total() - after.at.total(), before.held_gain_percent(after))
            }
            _ => (step.gain, step.held_gain_percent),
        });
        Ok(gains.collect())
    }

    /// Parameters of an effect that was added: their names, and where the last model has them.
    pub(crate) fn parameters(&self, step: usize) -> impl Iterator<Item = (&'static str, usize)> + '_ {
        let model = &self.last.model;
        let used = &model.effects[model.effects.len() - self.steps.len() + step];
        used.effect.parameters.iter().zip(&used.parameters).map(|(own, index)| (own.name, *index))
    }

    /// What no recording tells from an effect that was added.
    pub(crate) fn alike(&self, bench: &Bench<'_>, step: usize) -> Vec<Candidate> {
        let candidate = &self.steps[step].candidate;
        let strength = candidate.strength.first().and_then(|name| self.fitted(step, name));
        let step_s = bench.training.first().map_or(0.0, Dataset::sample_time_s);
        alike(&self.last.model, candidate, strength, step_s)
    }

    /// Value of one of them at the last fit.
    pub(crate) fn fitted(&self, step: usize, name: &str) -> Option<f64> {
        let index = self.parameters(step).find(|(own, _)| *own == name)?.1;
        Some(self.last.at.values[index])
    }

    /// Takes out what was added earlier and would not be added now: what came last explains it too.
    fn drop_superfluous(&mut self, bench: &Bench<'_>) -> Result<(), IdentifyError> {
        for index in (0..self.steps.len().saturating_sub(1)).rev() {
            let Some(without) = self.without(bench, index)? else { continue };
            if proof(bench, &self.yardstick, &without, &self.last)?.is_none() {
                self.remove(bench, index, without)?;
            }
        }
        Ok(())
    }

    /// Fits the last model but for one of the effects that were added; `None` where that stays far from it.
    fn without(&self, bench: &Bench<'_>, index: usize) -> Result<Option<Fitted>, IdentifyError> {
        let Some((model, values)) = self.begun_without(index) else { return Ok(None) };
        let mut at: Option<Measured> = None;
        for (iterations, hopeful) in WITHOUT {
            let (begin, from) = at.as_ref().map_or((&values, None), |at| (&at.values, Some((&model, at))));
            let leg = (compare::COARSE, iterations);
            at = compare::descend(&bench.problem(&model)?, &self.yardstick, begin, from, leg)?;
            if at.as_ref().is_none_or(|at| at.total() > hopeful * self.last.at.total()) {
                return Ok(None);
            }
        }
        let Some(at) = at else { return Ok(None) };
        let begun = Fitted { at, model, held: Vec::new() };
        bench.fitted(&begun.model, &begun.at.values, Some(&begun), &self.yardstick)
    }

    /// Judges noise by the last model, and measures by that from now on.
    fn judge_noise(&mut self, bench: &Bench<'_>) -> Result<(), IdentifyError> {
        let problem = bench.problem(&self.last.model)?;
        let levels = compare::noise(&problem, &self.last.at, self.yardstick.levels())?;
        self.yardstick = bench.yardstick(&self.last.model, &self.last.at.values, levels)?;
        let again =
            bench.fitted(&self.last.model, &self.last.at.values, Some(&self.last), &self.yardstick)?;
        if let Some(again) = again {
            self.last = again;
        }
        Ok(())
    }

    /// Whether it was added.
    pub(crate) fn has(&self, candidate: &Candidate) -> bool {
        self.steps.iter().any(|step| step.candidate.is_same(candidate))
    }

    /// Whether something that was added is there.
    fn is_wrong_at(&self, place: &str) -> bool {
        self.steps.iter().any(|step| step.candidate.place == place)
    }

    /// Whether a step is what the law of an earlier one at the same place leaves: none is quite obeyed.
    fn is_shadow(&self, gains: &[(f64, f64)], step: &Step) -> bool {
        let mut earlier = self.steps.iter().zip(gains);
        earlier.any(|(earlier, (gain, _))| {
            earlier.candidate.place == step.candidate.place && step.gain < SHADOW * gain
        })
    }

    /// Takes a step back, unless that would leave a misfit, even from where the step has led: of two springs in a row, neither of which
    /// is known, one may harden although nobody can say by how much.
    pub(crate) fn undo(&mut self, bench: &Bench<'_>, index: usize) -> Result<bool, IdentifyError> {
        let total = |fitted: &Fitted| fitted.at.total() + fitted.held_chi2();
        let without = match &self.unexplained {
            None => {
                let without = self.without(bench, index)?;
                without.filter(|fitted| total(fitted) < MISFIT * total(&self.last))
            }
            Some(curve) => {
                let Some((model, values)) = self.begun_without(index) else { return Ok(false) };
                let beside = curve.beside(bench, (&model, &values), &self.yardstick)?;
                if beside.is_none_or(|beside| total(&beside) >= MISFIT * total(&curve.fitted)) {
                    return Ok(false);
                }
                bench.fitted(&model, &values, None, &self.yardstick)?
            }
        };
        match without {
            Some(fitted) => self.remove(bench, index, fitted).map(|()| true),
            None => Ok(false),
        }
    }

    /// Goes on without a step; what it gained is the next one's, and a curve is measured anew.
    fn remove(&mut self, bench: &Bench<'_>, index: usize, fitted: Fitted) -> Result<(), IdentifyError> {
        let gone = self.steps.remove(index);
        self.screened.clear();
        match self.steps.get_mut(index) {
            Some(next) => {
                self.before.remove(index + 1);
                next.gain += gone.gain;
                let left = (1.0 - 0.01 * gone.held_gain_percent) * (1.0 - 0.01 * next.held_gain_percent);
                next.held_gain_percent = 100.0 * (1.0 - left);
            }
            None => {
                self.before.pop();
            }
        }
        self.last = fitted;
        self.judge_noise(bench)?;
        if let Some(Unexplained { free, .. }) = self.unexplained.take()
            && let Some(shape) = shapes::together(bench, &self.last, &self.yardstick, &[free])?.first()
        {
            self.unexplained = shapes::confirmed(bench, &self.last, &self.yardstick, shape)?;
        }
        Ok(())
    }
}

/// What is missing bends all other parameters, and a fit may not find its way back from there: where much was missing, the base
/// model's are also begun where its file has them.
fn afresh(bench: &Bench<'_>, course: &Course, fitted: Fitted) -> Result<Fitted, IdentifyError> {
    if course.last.scale().max(course.last.training_scale()) < BENT {
        return Ok(fitted);
    }
    let mut values = fitted.at.values.clone();
    for parameter in &course.base.model.parameters {
        if let Some(index) = fitted.model.parameter(&parameter.name) {
            values[index] = parameter.value;
        }
    }
    let problem = bench.problem(&fitted.model)?;
    let trial = compare::descend(&problem, &course.yardstick, &values, None, (compare::COARSE, AFRESH))?;
    let Some(trial) = trial.filter(|trial| trial.total() < HOPEFUL * fitted.at.total()) else {
        return Ok(fitted);
    };
    let trial = Fitted { at: trial, ..fitted.clone() };
    let other = bench.fitted(&trial.model, &trial.at.values, Some(&trial), &course.yardstick)?;
    Ok(other.filter(|other| other.at.total() < fitted.at.total()).unwrap_or(fitted))
}

/// What has structure but no name: looked for where nothing named was kept although something stands out, or where what was kept
/// leaves much and explains far less than a curve at some place would. `gains` are those of the steps before.
fn unnamed(
    bench: &Bench<'_>,
    course: &Course,
    scales: &Scales,
    named: Option<&(Step, Fitted)>,
    gains: &[(f64, f64)],
    suspicious: bool,
) -> Result<Option<Unexplained>, IdentifyError> {
    let is_elsewhere =
        named.is_some_and(|(step, _)| !course.steps.is_empty() && !course.is_wrong_at(&step.candidate.place));
    let left = named.map_or(course.last.scale(), |(_, fitted)| fitted.scale());
    let is_calm = left < MISFIT && !is_elsewhere;
    if is_calm && named.is_some() {
        return Ok(None);
    }
    let mut free = shapes::places(bench, &course.last.model, scales);
    free.retain(|free| !is_calm || suspicious || free.is_nameless());
    let shapes = shapes::all(bench, &course.last, &course.yardstick, &free)?;
    let Some(first) = shapes.first() else { return Ok(None) };
    let threshold = bench.options.false_alarm_rate / shapes.len() as f64;
    let strongest = gains.iter().map(|(gain, _)| *gain).fold(0.0, f64::max);
    let by_name = named.map_or(0.0, |(step, _)| step.gain);
    let nearly = match named {
        Some((step, _)) => share_of_a_name(course, &step.candidate, first),
        None => NEARLY,
    };
    if first.p_value > threshold
        || first.gain < (LEAST_GAIN * course.last.scale()).max(SHADOW * strongest)
        || by_name > nearly * first.gain
    {
        return Ok(None);
    }
    let found = shapes::confirmed(bench, &course.last, &course.yardstick, first)?;
    // Beside what has a name, it has to be worth as much as another name.
    let least_held = if course.steps.is_empty() { 0.0 } else { LEAST_SHARE };
    Ok(found.filter(|found| {
        by_name < nearly * found.gain
            && found.misfit_percent > LEAST_SHARE
            && found.held_gain_percent > least_held
    }))
}

/// How much of what a curve would gain a name has to, to be believed.
fn share_of_a_name(course: &Course, named: &Candidate, curve: &Shape) -> f64 {
    // A curve over a turn is made of several waves, and the others follow.
    if named.value("order").is_finite() && curve.is_turn() {
        return 1.0 / shapes::ORDERS as f64;
    }
    // Where something is wrong already, more of it is likelier than something else elsewhere.
    let is_more = course.is_wrong_at(curve.place()) && !course.is_wrong_at(&named.place);
    if is_more { 1.0 } else { NEARLY }
}

/// The candidates that promise most of those that may stand out, each effect and place once.
fn worth_trying(course: &Course, threshold: f64) -> Vec<(Candidate, f64)> {
    let mut tried: Vec<(Candidate, f64)> = Vec::new();
    let least = LEAST_GAIN.max(LEAST_PROMISE * course.last.misfit());
    for one in &course.screened {
        let p_value = one.promise.p_value.min(one.promise.white_p_value());
        let significant = p_value < threshold && one.promise.gain > least;
        // Where a fit may end depends on where it starts in what the effect is not linear in.
        let starts = tried.iter().filter(|(candidate, _)| candidate.is_same(&one.start)).count();
        let most = one.start.most_starts();
        let elsewhere = tried.iter().filter(|(candidate, _)| candidate.effect.id == one.start.effect.id);
        let elsewhere = elsewhere.filter(|(candidate, _)| !candidate.is_same(&one.start)).count();
        // The first bit of play says little of what much of it does.
        let has_room = (tried.len() < TRIED && elsewhere < PLACES) || one.start.is_always_tried();
        if one.possible && significant && starts < most && has_room {
            tried.push((one.start.clone(), one.promise.p_value));
        }
    }
    let (model, values) = (&course.last.model, &course.last.at.values);
    let begun = tried.into_iter().flat_map(|(candidate, p_value)| {
        let starts = candidates::starts(candidate, model, values);
        starts.into_iter().map(move |start| (start, p_value))
    });
    begun.collect()
}

/// What acts where a curve was found and was not tried: slopes at no strength may say little of what much would do, as of a coupling
/// that hardens near a resonance.
fn overlooked(course: &Course, curve: &Unexplained, tried: &[(Candidate, f64)]) -> Vec<(Candidate, f64)> {
    let mut all: Vec<(Candidate, f64)> = Vec::new();
    let there = course.screened.iter().filter(|one| one.possible && one.start.place == curve.place);
    for one in there {
        if !tried.iter().chain(&all).any(|(known, _)| known.is_same(&one.start)) {
            all.push((one.start.clone(), curve.p_value));
        }
    }
    all
}
