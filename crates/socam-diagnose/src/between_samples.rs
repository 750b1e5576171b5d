//! Behaviour of the inputs between their samples, decided anew as effects are added: what is missing may have hidden it from the fit of
//! the base model, and a wrong one looks like a delay or a lag.

use socam_identify::{IdentifyError, comparison, least_intersample_gain, other_intersamples};
use socam_model::{Intersample, Model};

use crate::{
    context::{Context, FittedModel},
    selection::{DISPLACED, Path},
};

/// Iterations of the fit under another behaviour, and the deviance above the last fit's up to which it is continued.
const ITERATIONS: [usize; 2] = [3, 12];
const WORTH_CONTINUING: f64 = 100.0;

impl Path {
    /// Takes the behaviour of each open input that fits best, and removes effects that gain nothing under it. Nothing is changed by fits
    /// during which the search was ended.
    pub(crate) fn settle_inputs(&mut self, context: &Context<'_>) -> Result<(), IdentifyError> {
        let mut has_changed = false;
        for input in &context.open_inputs {
            if context.stops() {
                break;
            }
            let Some((kind, fitted)) = self.better_kind(context, &self.last, input)? else { continue };
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

    /// A sentence about each input whose stated behaviour fits the model as given worse than another one: findings may then stand for it.
    pub(crate) fn stated_otherwise(&self, context: &Context<'_>) -> Result<Vec<String>, IdentifyError> {
        let mut sentences = Vec::new();
        for channel in self.base.model.inputs() {
            let (name, stated) = (&channel.name, channel.intersample().name());
            if context.stops() || context.open_inputs.contains(name) {
                continue;
            }
            let Some((kind, fitted)) = self.better_kind(context, &self.base, name)? else { continue };
            let (kind, lower) = (kind.name(), self.base.deviance() - fitted.deviance());
            sentences.push(format!(
                "`{name}` is stated to be {stated} between its samples, but the model as given fits better with {kind} (chi-square lower by {lower:.0}); effects that were found may stand for that: leave it open (--between {name}=auto)"
            ));
        }
        Ok(sentences)
    }

    /// The behaviour of an input under which a fitted model fits the recordings better than under its present one, with that fit.
    fn better_kind(
        &self,
        context: &Context<'_>,
        last: &FittedModel,
        input: &str,
    ) -> Result<Option<(Intersample, FittedModel)>, IdentifyError> {
        let Some(channel) = last.model.inputs().find(|channel| channel.name == input) else {
            return Ok(None);
        };
        let is_far = self.noise.excess() > DISPLACED;
        let least = least_intersample_gain(channel, last.deviance(), is_far);
        let mut best: Option<(Intersample, Model, comparison::Evaluation)> = None;
        for kind in other_intersamples(channel, channel.intersample()) {
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
