//! Prior plausibility of a model's parameters, from the model file and the catalogue.

use socam_model::{
    Model,
    effects::{Prior, QuantityKind, Rig},
};

use crate::context::FittedModel;

/// Prior knowledge: the base model as its file has it, and the machine's sizes, from which effects take their priors.
#[derive(Clone)]
pub(crate) struct PriorKnowledge {
    pub(crate) base: Model,
    pub(crate) rig: Rig,
}

impl PriorKnowledge {
    /// Logarithm of the prior density of a fit's parameters relative to usual values: 0 for usual values, minus infinity outside a
    /// parameter's support. A base parameter has a log-normal prior about the file's value, with a standard deviation of 1 in the natural
    /// logarithm. Parameters of added effects have the priors of the catalogue.
    pub(crate) fn log_prior(&self, fitted: &FittedModel) -> f64 {
        self.of_displacement(fitted) + self.of_effects(fitted)
    }

    /// Log prior of the base parameters' displacement from the file's values. Directions that the recordings do not determine count as little
    /// as they can.
    fn of_displacement(&self, fitted: &FittedModel) -> f64 {
        let moved = self.base.parameters.iter().filter_map(|parameter| {
            let value = *fitted.validation.nearest.get(fitted.model.parameter(&parameter.name)?)?;
            let known = !parameter.fixed && parameter.bounds.0 >= 0.0 && parameter.value > 0.0 && value > 0.0;
            known.then(|| (value / parameter.value).ln())
        });
        -0.5 * moved.map(|moved| moved * moved).sum::<f64>()
    }

    /// Log prior of the parameters of added effects.
    fn of_effects(&self, fitted: &FittedModel) -> f64 {
        let added = fitted.model.effects.iter().skip(self.base.effects.len());
        let each = added.map(|used| {
            let value = |name: &str| {
                let index = used.effect.parameters.iter().position(|own| own.name == name)?;
                Some(fitted.at.values[used.parameters[index]])
            };
            let priors = used.effect.priors_in(&self.rig, &used.place);
            let each = priors.iter().filter_map(|(name, prior)| {
                let own = used.effect.parameters.iter().find(|own| own.name == *name)?;
                let chosen =
                    if own.kind == QuantityKind::Frequency { self.lines(prior).max(1.0).ln() } else { 0.0 };
                Some(prior.plausibility(value(name)?) - chosen)
            });
            each.sum::<f64>()
        });
        each.sum()
    }

    /// Number of frequencies that the recordings resolve within a prior's support. The log prior of a frequency is lowered by the logarithm
    /// of that number, because the best of so many was chosen.
    fn lines(&self, prior: &Prior) -> f64 {
        let (least, most) = prior.support;
        let most = most.min(0.5 / self.rig.sample_time_s);
        let lines = 2.0 * (most - least) * self.rig.longest_s;
        if lines.is_finite() { lines } else { 1.0 }
    }
}
