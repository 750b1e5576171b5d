//! Behaviour of the inputs between their samples, decided anew as effects are added: what is missing may have hidden it from the fit of
//! the base model, and a wrong one looks like a delay or a lag.

use socam_identify::{IdentifyError, comparison, is_motion, least_intersample_gain, other_intersamples};
use socam_model::{Channel, Intersample, Model, effects::Form};

use crate::{
    context::{Context, FittedModel},
    selection::{DISPLACED, Path},
};

/// Iterations of the fit under another behaviour, and the deviance above the last fit's up to which it is continued.
const ITERATIONS: [usize; 2] = [3, 12];
const WORTH_CONTINUING: f64 = 100.0;
/// Share of the deviance by which a fit with another behaviour in place of a delay may be worse.
const AS_WELL: f64 = 0.02;

impl Path {
    /// Takes the behaviour of each open input that fits best, and removes effects that gain nothing under it. Nothing is changed by fits
    /// during which the search was ended.
    pub(crate) fn settle_inputs(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        let mut has_changed = false;
        for input in &context.open_inputs {
            if context.stops() {
                break;
            }
            let Some((kind, fitted)) = self.better_kind(context, input)? else { continue };
            let Some(base) = with_kind(&self.base.model, input, kind) else { continue };
            let from = Some((&self.base.model, &self.base.at));
            let Some(base) = context.fitted(&base, &self.base.at.values, from, &self.noise)? else {
                continue;
            };
            if context.stops() {
                break;
            }
            (self.base, self.last) = (base, fitted);
            self.priors.base = self.base.model.clone();
            has_changed = true;
        }
        if has_changed {
            self.tests.clear();
            self.renew_noise(context)?;
            self.eliminate(context, self.terms.len())?;
        }
        Ok(())
    }

    /// A sentence about each input whose stated behaviour fits worse than another one: findings may then stand for it.
    pub(crate) fn stated_otherwise(&self, context: &Context<'_>) -> Result<Vec<String>, IdentifyError> {
        let mut sentences = Vec::new();
        for channel in self.last.model.inputs() {
            let (name, stated) = (&channel.name, channel.intersample().name());
            if context.stops() || context.open_inputs.contains(name) {
                continue;
            }
            let found = match self.better_kind(context, name)? {
                Some((kind, fitted)) => {
                    let lower = self.last.deviance() - fitted.deviance();
                    Some(format!(
                        "{} fits these recordings better (chi-square lower by {lower:.0})",
                        kind.name()
                    ))
                }
                None => self.kind_in_place_of_delay(context, channel)?,
            };
            sentences.extend(found.map(|found| {
                format!(
                    "`{name}` is stated to be {stated} between its samples, but {found}: leave open how it moves between its samples"
                )
            }));
        }
        Ok(sentences)
    }

    /// Part of a sentence about another behaviour of an input that explains the recordings as well as a delay or a lag that was found.
    fn kind_in_place_of_delay(
        &self,
        context: &Context<'_>,
        channel: &Channel,
    ) -> Result<Option<String>, IdentifyError> {
        for (index, term) in self.terms.iter().enumerate() {
            let own = &term.candidate;
            if !matches!(own.effect.form, Form::Delay | Form::Lag) {
                continue;
            }
            let Some((model, values)) = self.start_without(index) else { continue };
            for kind in other_intersamples(channel, channel.intersample()) {
                let Some(model) = with_kind(&model, &channel.name, kind) else { continue };
                let fitted = context.fitted(&model, &values, None, &self.noise)?;
                let most = self.last.deviance() * (1.0 + AS_WELL);
                if fitted.is_some_and(|fitted| fitted.deviance() < most) {
                    let (kind, effect) = (kind.name(), own.effect.name);
                    return Ok(Some(format!(
                        "{kind} explains these recordings as well as the {effect} at {}, which then is none",
                        own.place
                    )));
                }
            }
        }
        Ok(None)
    }

    /// The behaviour of an input under which the last model fits the recordings better than under its present one, with that fit.
    fn better_kind(
        &self,
        context: &Context<'_>,
        input: &str,
    ) -> Result<Option<(Intersample, FittedModel)>, IdentifyError> {
        let last = &self.last;
        let Some(channel) = last.model.inputs().find(|channel| channel.name == input) else {
            return Ok(None);
        };
        let is_far = self.noise.excess() > DISPLACED;
        let least = least_intersample_gain(channel, last.deviance(), is_far);
        let mut best: Option<(Intersample, Model, comparison::Evaluation)> = None;
        // A motion that jumps at its samples is believed only where nothing else is missing.
        let possible = |kind: &Intersample| !(is_far && *kind == Intersample::Hold && is_motion(channel));
        for kind in other_intersamples(channel, channel.intersample()).filter(possible) {
            let Some(model) = with_kind(&last.model, input, kind) else { continue };
            let problem = context.tentative(&model)?;
            let mut at = Some(last.at.clone());
            for iterations in ITERATIONS {
                let Some(from) = at.take_if(|at| at.total() < last.deviance() + WORTH_CONTINUING) else {
                    break;
                };
                let round = (comparison::COARSE, iterations);
                at = comparison::descend(&problem, &self.noise, &from.values, Some((&model, &from)), round)?;
            }
            let below = best.as_ref().map_or(last.deviance() - least, |(.., best)| best.total());
            if let Some(at) = at.filter(|at| at.total() < below) {
                best = Some((kind, model, at));
            }
        }
        let Some((kind, model, at)) = best else { return Ok(None) };
        Ok(context.fitted(&model, &at.values, Some((&model, &at)), &self.noise)?.map(|fitted| (kind, fitted)))
    }
}

/// A model with another behaviour of an input; `None` where its text does not hold the input.
fn with_kind(model: &Model, input: &str, kind: Intersample) -> Option<Model> {
    let mut model = model.clone();
    model.set_intersample(input, Some(kind)).ok()?;
    Some(model)
}
