//! A candidate: one effect of the catalogue at one place of a model, with the values from which a fit may start.

use socam_model::{
    Model, ModelError, Motion,
    effects::{Coordinate, Effect, FittedValues, Form, Linearisation, Rig, Values},
};

/// Share of the linearly predicted amplitude at which a fit starts. The full amplitude would fit only once all other parameters had
/// moved too.
pub(crate) const INITIAL_SHARE: f64 = 0.02;
/// Largest number of starts of one effect at one place that are fitted.
const MOST_STARTS: usize = 3;

/// An effect at a place, its other parameters at one point of their grid and its amplitude at the null value.
#[derive(Debug, Clone)]
pub(crate) struct Candidate {
    pub(crate) effect: &'static Effect,
    pub(crate) place: String,
    /// Values of all parameters that a model file must give, SI.
    pub(crate) values: Values,
    /// Names of the amplitude parameters. The model is linear in these at their null value.
    pub(crate) amplitudes: &'static [&'static str],
    /// Value of the first amplitude parameter at which sensitivities are taken.
    pub(crate) linearised_at: f64,
    /// Whether a fit starts at a usual amplitude, with all other parameters at the file's values.
    pub(crate) begins_large: bool,
    /// Largest speed at its place, SI; zero where it is not known.
    pub(crate) speed: f64,
}

impl Candidate {
    pub(crate) fn new(effect: &'static Effect, place: &str, values: Values) -> Self {
        let amplitudes = effect.amplitude.parameters;
        let first = values.iter().find(|(name, _)| amplitudes.first() == Some(name));
        let linearised_at = first.map_or(0.0, |(_, value)| *value);
        Self {
            effect,
            place: place.to_owned(),
            values,
            amplitudes,
            linearised_at,
            begins_large: false,
            speed: 0.0,
        }
    }

    /// The model with this effect.
    ///
    /// # Errors
    /// Where it cannot act at that place.
    pub(crate) fn added_to(&self, model: &Model) -> Result<Model, ModelError> {
        let mut values = self.values.clone();
        values.extend(self.effect.narrowed(self.speed, model.motion == Motion::Rotation));
        model.with_effect(self.effect.id, &self.place, &values)
    }

    /// Whether the effect is a wave of unknown phase. The score test then has two amplitudes, a quarter of a period apart.
    pub(crate) fn is_wave(&self) -> bool {
        self.effect.is_wave()
    }

    /// Whether sensitivities are taken at an amplitude other than the null value.
    pub(crate) fn has_nonnull_linearisation(&self) -> bool {
        self.effect.linearisation == Linearisation::NonNull
    }

    /// Whether sensitivities cannot predict the amplitude. Such a candidate is fitted from several starts, with all parameters free.
    pub(crate) fn needs_restarts(&self) -> bool {
        self.effect.linearisation == Linearisation::Restarts
    }

    /// Whether sensitivities at the null value say little about large amplitudes. Such a candidate is fitted whatever its score.
    pub(crate) fn is_always_tried(&self) -> bool {
        self.effect.linearisation == Linearisation::NearNull
    }

    /// Number of starts that are worth a fit: several where the result depends on the start values of nonlinear parameters.
    pub(crate) fn most_starts(&self) -> usize {
        let others = self.values.iter().any(|(name, _)| !self.amplitudes.contains(name));
        if others
            && !self.is_wave()
            && self.effect.linearisation == Linearisation::Null
            && !self.effect.has_memory()
        {
            MOST_STARTS
        } else {
            1
        }
    }

    /// Amplitude at which the effect does nothing.
    pub(crate) fn null_value(&self) -> f64 {
        self.effect.amplitude.null
    }

    /// Value of the parameter `name` after a step of its linear coordinate, from its value `before`.
    pub(crate) fn stepped(&self, name: &str, before: f64, step: f64) -> f64 {
        match self.effect.amplitude.coordinate {
            Coordinate::Value => before + step,
            Coordinate::Inverse if self.amplitudes.contains(&name) => {
                // The model is linear in the compliance; `before` is a nearly rigid stiffness.
                let compliance = (1.0 - step / before) / before;
                if compliance > 0.0 { (1.0 / compliance).min(10.0 * before) } else { -1.0 }
            }
            Coordinate::Inverse => before,
        }
    }

    /// Amplitude after a change of its linear coordinate from the null value by `change`.
    pub(crate) fn amplitude_of(&self, change: f64) -> f64 {
        match self.effect.amplitude.coordinate {
            Coordinate::Value if self.has_nonnull_linearisation() => self.linearised_at,
            Coordinate::Value => change,
            Coordinate::Inverse => self.linearised_at * self.linearised_at / change,
        }
    }

    /// Lower and upper bound of the parameter `name` at the candidate's place.
    pub(crate) fn bounds(&self, model: &Model, name: &str) -> (f64, f64) {
        let own = self.effect.parameters.iter().find(|parameter| parameter.name == name);
        let (least, most) = own.map_or((f64::NEG_INFINITY, f64::INFINITY), |own| own.bounds);
        match self.effect.form {
            // The total inertia at a place cannot be negative.
            Form::Inertia => {
                let before =
                    self.values.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, value)| *value);
                (before - inertia(model, &self.place).unwrap_or(0.0), most)
            }
            _ => (least, most),
        }
    }

    /// Whether the other candidate is the same effect at the same place, whatever its values.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.effect.id == other.effect.id && self.place == other.place
    }

    /// Whether the other candidate is the same effect at the same place and, for effects periodic in the angle, of the same order.
    pub(crate) fn repeats(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|candidate| candidate.value("order"));
        self.is_same(other) && (own == others || own.is_nan())
    }

    /// Value of a parameter that a model file must give, SI; NaN for any other name.
    pub(crate) fn value(&self, name: &str) -> f64 {
        FittedValues(&self.values).get(name)
    }

    /// The candidate with one value changed.
    pub(crate) fn with(&self, name: &str, value: f64) -> Self {
        let mut changed = self.clone();
        changed.values.iter_mut().filter(|(known, _)| *known == name).for_each(|(_, old)| *old = value);
        changed
    }

    /// The candidate with all of these values.
    pub(crate) fn with_all(&self, values: &Values) -> Self {
        values.iter().fold(self.clone(), |changed, (name, value)| changed.with(name, *value))
    }

    /// Whether this law contains another one at the same place as a special case.
    pub(crate) fn contains(&self, other: &Self) -> bool {
        self.place == other.place && self.extends(other)
    }

    /// Whether this law contains another one, at whatever places.
    fn extends(&self, other: &Self) -> bool {
        self.effect.replaces.iter().any(|own| own.law == other.effect.id)
    }

    /// Whether two laws, at whatever places, are the same or one contains the other.
    pub(crate) fn is_akin(&self, other: &Self) -> bool {
        self.effect.id == other.effect.id || self.extends(other) || other.extends(self)
    }

    /// Starts of this law in the place of the law `simpler`, whose fitted values are `fitted`. Empty where this law does not contain
    /// `simpler`.
    pub(crate) fn in_place_of(&self, simpler: &Self, fitted: &[(&str, f64)], model: &Model) -> Vec<Self> {
        let own = self.effect.replaces.iter().find(|own| own.law == simpler.effect.id);
        let Some(own) = own.filter(|_| self.place == simpler.place) else { return Vec::new() };
        let starts = (own.starts)(&Rig::of_model(model, &model.values()), &FittedValues(fitted));
        let all = starts.iter().map(|values| self.with_all(values));
        all.filter(|start| start.values.iter().all(|(_, value)| value.is_finite())).collect()
    }
}

/// Inertia of a node, SI; `None` where the node has none.
fn inertia(model: &Model, place: &str) -> Option<f64> {
    let node = model.nodes.iter().find(|node| node.name == place)?;
    Some(model.parameters[node.inertia?].value)
}
