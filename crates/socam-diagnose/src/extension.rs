//! Extending a model by an effect: the larger model, its start values and its free parameters.

use socam_model::{Model, Prior, effects::Rig};

use crate::candidate::Candidate;

/// The model with a candidate added at its values; `None` where the effect cannot act at that place. An order that is a whole number gets
/// a prior there, so that a fit moves it only where the data require it.
pub(crate) fn extended(model: &Model, candidate: &Candidate) -> Option<Model> {
    let mut grown = candidate.added_to(model).ok()?;
    let rig = Rig::of_model(model, &model.values());
    let used = grown.effects.last()?;
    let mut held = Vec::new();
    for (name, prior) in candidate.effect.priors_in(&rig, &candidate.place) {
        let index = used.effect.parameters.iter().position(|own| own.name == name)?;
        let near = prior.whole_number_near(candidate.value(name));
        held.extend(near.map(|(value, std)| (used.parameters[index], Prior { value, std })));
    }
    held.into_iter().for_each(|(index, prior)| grown.parameters[index].prior = Some(prior));
    Some(grown)
}

/// Parameter values of an extended model: those of the old model where a parameter has the same name, else the file's.
pub(crate) fn carried_over(old: (&Model, &[f64]), new: &Model) -> Vec<f64> {
    let mut values = new.values();
    for (parameter, value) in old.0.parameters.iter().zip(old.1) {
        if let Some(index) = new.parameter(&parameter.name) {
            values[index] = *value;
        }
    }
    values
}

/// Indices in the extended model `grown` of the free parameters of `model`.
pub(crate) fn free_parameters(model: &Model, grown: &Model) -> Vec<usize> {
    let free = model.parameters.iter().filter(|parameter| !parameter.fixed);
    free.filter_map(|parameter| grown.parameter(&parameter.name)).collect()
}
