//! The candidates of a model: every effect of the catalogue at every place and grid point, and the values from which they are fitted.

use socam_model::{
    Model, Motion,
    effects::{Amplitude, Rig, Values},
};

use crate::{
    candidate::{Candidate, INITIAL_SHARE},
    scales::Scales,
};

pub(crate) use socam_model::effects::is_part;

/// Quantiles of an amplitude's prior at which candidates with large amplitudes start.
const USUAL_SHARES: [f64; 2] = [0.5, 0.9];

/// All candidates of a model.
pub(crate) fn all(model: &Model, scales: &Scales) -> Vec<Candidate> {
    let mut found = Vec::new();
    // Effects that are periodic in the angle need a rotating model.
    let turns = model.motion == Motion::Rotation;
    for effect in model.screened().filter(|effect| turns || !effect.is_by_turn()) {
        // A law of the file's own that a diagnosis has put there is in the model.
        let is_there = |place: &String| {
            effect.is_own()
                && model.effects.iter().any(|own| own.effect.id == effect.id && own.place == *place)
        };
        for place in effect.places_in(model).into_iter().filter(|place| !is_there(place)) {
            let starts = effect.starts_in(&scales.rig, &place);
            let speed = scales.rig.speed_at(effect.acts_at, &place);
            let with = |start| Candidate { speed, ..Candidate::new(effect, &place, start) };
            found.extend(starts.into_iter().map(with));
        }
    }
    found
}

/// Start points of a candidate's fit. `values` are the parameter values of `model`, SI.
pub(crate) fn starts(candidate: Candidate, model: &Model, values: &[f64]) -> Vec<Candidate> {
    let rig = Rig::of_model(model, values);
    let Amplitude { parameters, null, .. } = candidate.effect.amplitude;
    let predicted = |(name, value): &(&'static str, f64)| {
        let is_reduced = parameters.contains(name) && null.is_finite();
        (*name, if is_reduced { null + (value - null) / INITIAL_SHARE } else { *value })
    };
    let predicted: Values = candidate.values.iter().map(predicted).collect();
    let all = (candidate.effect.fit_starts)(&rig, &candidate.place, &candidate.values, &predicted);
    all.iter().map(|values| candidate.with_all(values)).collect()
}

/// Starts with usual amplitudes at every grid point of the candidate's effect.
pub(crate) fn large_starts(candidate: &Candidate, rig: &Rig) -> Vec<Candidate> {
    let all =
        USUAL_SHARES.iter().flat_map(|share| candidate.effect.large_starts(rig, &candidate.place, *share));
    all.map(|values| Candidate { begins_large: true, ..candidate.with_all(&values) }).collect()
}

/// Starts with usual amplitudes at the candidate's own grid point; of a wave, at several phases. Empty for a wave of one of many orders or
/// frequencies. (`Effect::large_starts` covers all grid points instead.)
pub(crate) fn usual_starts(candidate: &Candidate, rig: &Rig) -> Vec<Candidate> {
    let priors = candidate.effect.priors_in(rig, &candidate.place);
    let quantile =
        |name: &str, share: f64| priors.iter().find(|(known, _)| *known == name)?.1.quantile(share);
    let at_quantile = |share: &f64| -> Option<Candidate> {
        let begun = candidate
            .amplitudes
            .iter()
            .try_fold(candidate.clone(), |begun, name| Some(begun.with(name, quantile(name, *share)?)))?;
        Some(Candidate { begins_large: true, ..begun })
    };
    if candidate.is_wave() {
        let is_one_of_many = candidate.value("order").is_finite() || candidate.value("frequency").is_finite();
        return if is_one_of_many { Vec::new() } else { large_starts(candidate, rig) };
    }
    USUAL_SHARES.iter().filter_map(at_quantile).collect()
}
