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

    /// The behaviour of an input under which the last model fits the recordings better than under its present one, with that fit.
    fn better_kind(
        &self,
        context: &Context<'_>,
        input: &str,
    ) -> Result<Option<(Intersample, FittedModel)>, IdentifyError> {
        let Some(channel) = self.last.model.inputs().find(|channel| channel.name == input) else {
            return Ok(None);
        };
        let is_far = self.noise.excess() > DISPLACED;
        let least = least_intersample_gain(channel, self.last.deviance(), is_far);
        let mut best: Option<(Intersample, Model, comparison::Evaluation)> = None;
        for kind in other_intersamples(channel, channel.intersample()) {
            let Some(model) = with_kind(&self.last.model, input, kind) else { continue };
            let problem = context.tentative(&model)?;
            let mut at = Some(self.last.at.clone());
            for iterations in ITERATIONS {
                let Some(from) = at.take_if(|at| at.total() < self.last.deviance() + WORTH_CONTINUING) else {
                    break;
                };
                let round = (comparison::COARSE, iterations);
                at = comparison::descend(&problem, &self.noise, &from.values, Some((&model, &from)), round)?;
            }
            let below = best.as_ref().map_or(self.last.deviance() - least, |(.., best)| best.total());
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
