//! Every way in which an effect of the catalogue may be added to a model: where, and from which values a fit may start.

use socam_model::{
    Model, Motion, Prior,
    effects::{self, Amplitude, Coordinate, Effect, FittedValues, Form, Linearisation, REFINED, Rig, Values},
};

use crate::{scales::Scales, score_test::A_LITTLE, selection::Path};

pub(crate) use socam_model::effects::is_part;

/// An effect at a place with its other parameters at one point of their grid, its amplitude at the null value.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) effect: &'static Effect,
    pub(crate) place: String,
    /// All parameters that a file must give, SI.
    pub(crate) values: Values,
    /// Those that measure how strong it is: the model is linear in them where they are null.
    pub(crate) strength: &'static [&'static str],
    /// Value of the first of these where sensitivities are taken.
    pub(crate) linearised_at: f64,
    /// Whether a fit begins with an amplitude as large as it usually is, and all other parameters at the file's values.
    pub(crate) begins_large: bool,
}

impl Candidate {
    fn new(effect: &'static Effect, place: &str, values: Values) -> Self {
        let strength = effect.amplitude.parameters;
        let first = values.iter().find(|(name, _)| strength.first() == Some(name));
        let linearised_at = first.map_or(0.0, |(_, value)| *value);
        Self { effect, place: place.to_owned(), values, strength, linearised_at, begins_large: false }
    }

    /// Whether it is a wave whose phase is not known: then its strength is that of two, a quarter of a period apart.
    pub(crate) fn is_wave(&self) -> bool {
        self.effect.is_wave()
    }

    /// Whether the grid's points are of some strength already.
    pub(crate) fn starts_at_amplitude(&self) -> bool {
        self.effect.linearisation == Linearisation::NonNull
    }

    /// Whether sensitivities cannot predict its strength: a fit is begun from several, with all parameters free.
    pub(crate) fn is_far(&self) -> bool {
        self.effect.linearisation == Linearisation::Restarts
    }

    /// Whether sensitivities predict little of what much of it does, so that it is fitted whatever they say.
    pub(crate) fn is_always_tried(&self) -> bool {
        self.effect.linearisation == Linearisation::NearNull
    }

    /// Starts that are worth a fit: several where what it is not linear in decides where a fit ends.
    pub(crate) fn most_starts(&self) -> usize {
        let others = self.values.iter().any(|(name, _)| !self.strength.contains(name));
        if others
            && !self.is_wave()
            && self.effect.linearisation == Linearisation::Null
            && !self.effect.has_memory()
        {
            STARTS
        } else {
            1
        }
    }

    /// What its strength is where it does nothing.
    pub(crate) fn nothing(&self) -> f64 {
        self.effect.amplitude.null
    }

    /// Change of an amplitude whose coordinate changes by `step` from where sensitivities are taken.
    pub(crate) fn moved(&self, name: &str, before: f64, step: f64) -> f64 {
        match self.effect.amplitude.coordinate {
            Coordinate::Value => before + step,
            Coordinate::Inverse if self.strength.contains(&name) => {
                // A stiffness is moved by what it gives: from one that is as good as rigid.
                let compliance = (1.0 - step / before) / before;
                if compliance > 0.0 { (1.0 / compliance).min(10.0 * before) } else { -1.0 }
            }
            Coordinate::Inverse => before,
        }
    }

    /// An amplitude that does as much as a change of its coordinate by `change`.
    pub(crate) fn size_of(&self, change: f64) -> f64 {
        match self.effect.amplitude.coordinate {
            Coordinate::Value if self.starts_at_amplitude() => self.linearised_at,
            Coordinate::Value => change,
            Coordinate::Inverse => self.linearised_at * self.linearised_at / change,
        }
    }

    /// Least and greatest value of one of its parameters at its place.
    pub(crate) fn bounds(&self, model: &Model, name: &str) -> (f64, f64) {
        let own = self.effect.parameters.iter().find(|parameter| parameter.name == name);
        let (least, most) = own.map_or((f64::NEG_INFINITY, f64::INFINITY), |own| own.bounds);
        match self.effect.form {
            // Nothing has less inertia than none.
            Form::Inertia => {
                let before =
                    self.values.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, value)| *value);
                (before - inertia(model, &self.place).unwrap_or(0.0), most)
            }
            _ => (least, most),
        }
    }

    /// Whether the other one is this effect at this place too, whatever its values.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.effect.id == other.effect.id && self.place == other.place
    }

    /// Whether it is the same and, if it comes back with every turn, as often: what does not run true has several orders.
    pub(crate) fn repeats(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|candidate| candidate.value("order"));
        self.is_same(other) && (own == others || own.is_nan())
    }

    /// Of a parameter that a file must give, SI; NaN for any other.
    pub(crate) fn value(&self, name: &str) -> f64 {
        FittedValues(&self.values).get(name)
    }

    pub(crate) fn with(&self, name: &str, value: f64) -> Self {
        let mut changed = self.clone();
        changed.values.iter_mut().filter(|(known, _)| *known == name).for_each(|(_, old)| *old = value);
        changed
    }

    /// With all of these values.
    fn with_all(&self, values: &Values) -> Self {
        values.iter().fold(self.clone(), |changed, (name, value)| changed.with(name, *value))
    }
}

/// Quantiles of their priors at which amplitudes are begun that have to be large to show.
pub(crate) const USUAL_SHARES: [f64; 2] = [0.5, 0.9];
/// Most starts of one effect at one place that are fitted.
const STARTS: usize = 3;

/// All of them.
pub(crate) fn all(model: &Model, scales: &Scales) -> Vec<Candidate> {
    let mut found = Vec::new();
    // What comes back with every turn needs something that turns.
    let turns = model.motion == Motion::Rotation;
    for effect in effects::screened().filter(|effect| turns || !effect.is_by_turn()) {
        for place in effect.places_in(model) {
            let starts = (effect.starts)(&scales.rig, &place);
            found.extend(starts.into_iter().map(|start| Candidate::new(effect, &place, start)));
        }
    }
    found
}

/// A model with a candidate added at its values; `None` where it cannot act there. An order that is a whole number is held to it by its
/// prior: the data move it only where they say so.
pub(crate) fn added(model: &Model, candidate: &Candidate) -> Option<Model> {
    let mut grown = model.with_effect(candidate.effect.id, &candidate.place, &candidate.values).ok()?;
    let rig = Rig::of_model(model, &model.values());
    let used = grown.effects.last()?;
    let mut held = Vec::new();
    for (name, prior) in (candidate.effect.priors)(&rig, &candidate.place) {
        let index = used.effect.parameters.iter().position(|own| own.name == name)?;
        let near = prior.whole_number_near(candidate.value(name));
        held.extend(near.map(|(value, std)| (used.parameters[index], Prior { value, std })));
    }
    held.into_iter().for_each(|(index, prior)| grown.parameters[index].prior = Some(prior));
    Some(grown)
}

/// Points from which a fit is begun.
pub(crate) fn starts(candidate: Candidate, model: &Model, values: &[f64]) -> Vec<Candidate> {
    let rig = Rig::of_model(model, values);
    let Amplitude { parameters, null, .. } = candidate.effect.amplitude;
    let whole = |(name, value): &(&'static str, f64)| {
        let is_little = parameters.contains(name) && null.is_finite();
        (*name, if is_little { null + (value - null) / A_LITTLE } else { *value })
    };
    let whole: Values = candidate.values.iter().map(whole).collect();
    let all = (candidate.effect.fit_starts)(&rig, &candidate.place, &candidate.values, &whole);
    all.iter().map(|values| candidate.with_all(values)).collect()
}

/// Of a node, where the model has some.
fn inertia(model: &Model, place: &str) -> Option<f64> {
    let node = model.nodes.iter().find(|node| node.name == place)?;
    Some(model.parameters[node.inertia?].value)
}

/// Refined laws that may stand for an effect, the simplest first, each from several points of what it has beside.
pub(crate) fn refined_laws(candidate: &Candidate, model: &Model) -> Vec<Vec<Candidate>> {
    let laws = REFINED.iter().map(|effect| {
        let values = effect.given().map(|own| (own.name, candidate.value(own.name))).collect();
        Candidate::new(effect, &candidate.place, values).in_place_of(candidate, &candidate.values, model)
    });
    laws.filter(|starts| !starts.is_empty()).collect()
}

/// Starts of a law that holds more than a term's, from the term's fitted values; refined ones as far as their further parameters are known.
pub(crate) fn richer_laws(path: &Path, term: usize) -> Vec<Candidate> {
    let own = &path.terms[term].candidate;
    let fitted = path.fitted_parameters(term);
    let seen = path.tests.iter().map(|one| &one.start);
    let mut starts: Vec<Candidate> =
        seen.flat_map(|start| start.in_place_of(own, &fitted, &path.last.model)).collect();
    let richer = starts.clone();
    let refined = richer.iter().flat_map(|start| refined_laws(start, &path.base.model)).flatten();
    for start in refined.filter(|start| richer.iter().any(|before| before.is_same(start))) {
        let known = fitted.iter().filter(|(name, _)| !richer[0].values.iter().any(|(own, _)| own == name));
        let start = known.fold(start, |start, (name, value)| start.with(name, *value));
        if starts.iter().all(|other| other.values != start.values) {
            starts.push(start);
        }
    }
    starts
}

/// Laws with fewer parameters that a term's law holds as special cases, at its fitted values, the simplest first.
pub(crate) fn simpler_laws(path: &Path, term: usize) -> Vec<Candidate> {
    let own = &path.terms[term].candidate;
    let fitted = path.fitted_parameters(term);
    let is_held =
        |id: &str| id == own.effect.id || own.effect.replaces.iter().any(|simpler| simpler.law == id);
    let laws = effects::CATALOGUE.iter().chain(REFINED).filter(|effect| is_held(effect.id));
    let each = laws.filter(|effect| effect.given().count() < own.values.len()).filter_map(|effect| {
        let value = |name: &str| fitted.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
        let values: Option<Values> =
            effect.given().map(|given| Some((given.name, value(given.name)?))).collect();
        Some(Candidate::new(effect, &own.place, values?))
    });
    let mut simpler: Vec<Candidate> = each.collect();
    simpler.sort_by_key(|law| law.values.len());
    simpler
}

/// Starts with amplitudes as large as they usually are.
pub(crate) fn large(candidate: &Candidate, rig: &Rig) -> Vec<Candidate> {
    let all =
        USUAL_SHARES.iter().flat_map(|share| candidate.effect.large_starts(rig, &candidate.place, *share));
    all.map(|values| Candidate { begins_large: true, ..candidate.with_all(&values) }).collect()
}

/// The same start with its amplitudes as large as they usually are, of a wave at several phases; none for one of many orders or frequencies.
pub(crate) fn usual(candidate: &Candidate, rig: &Rig) -> Vec<Candidate> {
    let priors = (candidate.effect.priors)(rig, &candidate.place);
    let quantile =
        |name: &str, share: f64| priors.iter().find(|(known, _)| *known == name)?.1.quantile(share);
    let of = |share: &f64| -> Option<Candidate> {
        let begun = candidate
            .strength
            .iter()
            .try_fold(candidate.clone(), |begun, name| Some(begun.with(name, quantile(name, *share)?)))?;
        Some(Candidate { begins_large: true, ..begun })
    };
    if candidate.is_wave() {
        let is_one_of_many = candidate.value("order").is_finite() || candidate.value("frequency").is_finite();
        return if is_one_of_many { Vec::new() } else { large(candidate, rig) };
    }
    USUAL_SHARES.iter().filter_map(of).collect()
}

impl Candidate {
    /// Whether this law holds another one of the same place as its special case.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        self.place == other.place && self.effect.replaces.iter().any(|own| own.law == other.effect.id)
    }

    /// Starts of this law in the place of a simpler one of which these are the fitted values; none where it is not one for that.
    pub(crate) fn in_place_of(&self, simpler: &Self, fitted: &[(&str, f64)], model: &Model) -> Vec<Self> {
        let own = self.effect.replaces.iter().find(|own| own.law == simpler.effect.id);
        let Some(own) = own.filter(|_| self.place == simpler.place) else { return Vec::new() };
        let starts = (own.starts)(&Rig::of_model(model, &model.values()), &FittedValues(fitted));
        let all = starts.iter().map(|values| self.with_all(values));
        all.filter(|start| start.values.iter().all(|(_, value)| value.is_finite())).collect()
    }
}
