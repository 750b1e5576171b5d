//! What is known before any recording: how plausible a model's parameters are.

use socam_model::{
    Model,
    effects::{Kind, Prior, Rig},
};

use crate::context::FittedModel;

/// The base model as its file has it, and the machine in numbers.
#[derive(Clone)]
pub(crate) struct Known {
    pub(crate) base: Model,
    pub(crate) rig: Rig,
}

impl Known {
    /// Logarithm of how plausible a fit's parameters are, relative to what is usual: 0 for usual ones, minus infinity for what cannot be. A base
    /// parameter is known from the model file to within a factor of e (one standard deviation of its logarithm); those of
    /// effects that were added have the priors of the catalogue.
    pub(crate) fn log_prior(&self, fitted: &FittedModel) -> f64 {
        self.displacement(fitted) + self.effects(fitted)
    }

    fn displacement(&self, fitted: &FittedModel) -> f64 {
        let moved = self.base.parameters.iter().filter_map(|parameter| {
            let value = fitted.at.values[fitted.model.parameter(&parameter.name)?];
            let known = !parameter.fixed && parameter.bounds.0 >= 0.0 && parameter.value > 0.0 && value > 0.0;
            known.then(|| (value / parameter.value).ln())
        });
        -0.5 * moved.map(|moved| moved * moved).sum::<f64>()
    }

    fn effects(&self, fitted: &FittedModel) -> f64 {
        let added = fitted.model.effects.iter().skip(self.base.effects.len());
        let each = added.map(|used| {
            let value = |name: &str| {
                let index = used.effect.parameters.iter().position(|own| own.name == name)?;
                Some(fitted.at.values[used.parameters[index]])
            };
            let priors = (used.effect.priors)(&self.rig, &used.place);
            let each = priors.iter().filter_map(|(name, prior)| {
                let own = used.effect.parameters.iter().find(|own| own.name == *name)?;
                let chosen = if own.kind == Kind::Frequency { self.lines(prior).max(1.0).ln() } else { 0.0 };
                Some(prior.plausibility(value(name)?) - chosen)
            });
            each.sum::<f64>()
        });
        each.sum()
    }

    /// Frequencies that the recordings tell apart within a prior's support: a line at one of them is one of so many.
    fn lines(&self, prior: &Prior) -> f64 {
        let (least, most) = prior.support;
        let most = most.min(0.5 / self.rig.sample_time_s);
        let lines = 2.0 * (most - least) * self.rig.longest_s;
        if lines.is_finite() { lines } else { 1.0 }
    }
}
