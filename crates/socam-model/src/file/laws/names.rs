//! The names of a law's formula: what each means, and which a place has.

use super::super::{
    curves::ReadCurve,
    raw::{Name, RawLaw},
    reader::Reader,
    wording::meant,
};
use crate::{
    Model, ModelError,
    effects::{ActsAt, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS, QuantityKind},
    formula::{CURVE, FUNCTIONS, FormulaProblem, Step, What},
};

/// Names with a meaning of their own in every formula, beside those of functions.
const RESERVED: [&str; 5] = ["pi", "through", "change", "state", CURVE];

/// A name of a formula.
pub(super) enum Meaning {
    Place(LawInput),
    /// Index of a channel.
    Channel(usize),
    /// Index of a parameter of the model.
    Parameter(usize),
    /// The law's curve.
    Curve,
}

/// A formula while it is read: its names and what they mean, in the order in which they occur.
pub(super) struct Names<'t> {
    pub(super) found: Vec<(&'t str, Meaning)>,
}

impl Reader<'_> {
    /// What each name of the formula means.
    pub(super) fn names<'r>(
        &mut self,
        raw: &'r RawLaw,
        acts_at: ActsAt,
        steps: &'r [Step],
        model: &Model,
    ) -> Result<Names<'r>, ModelError> {
        let law = raw.name.get_ref();
        let own =
            |table: &'static str, names: Vec<&'r Name>| names.into_iter().map(move |name| (table, name));
        let keys: Vec<(&str, &Name)> =
            own("parameters", raw.parameters.0.iter().map(|(name, _)| name).collect())
                .chain(own("inputs", raw.inputs.0.iter().map(|(name, _)| name).collect()))
                .collect();
        for (index, (table, key)) in keys.iter().enumerate() {
            let label = key.get_ref().as_str();
            let is_taken = RESERVED.contains(&label)
                || FUNCTIONS.iter().any(|(name, _)| *name == label)
                || symbols(acts_at).iter().any(|(name, ..)| *name == label)
                || keys[..index].iter().any(|(_, other)| other.get_ref() == label);
            if is_taken {
                return self.fail(
                    key,
                    format!(
                        "{label} has a meaning in this formula already; give the key of {table} another name"
                    ),
                );
            }
        }
        let mut names = Names { found: Vec::new() };
        for step in steps {
            let What::Name(name) = &step.what else {
                if matches!(step.what, What::Call(function) if FUNCTIONS[function].0 == "sign") {
                    let problem = "sign jumps where its argument is 0, and no motion does; write tanh(x/width) with a width as a parameter";
                    return Err(
                        self.in_formula(raw, &FormulaProblem::at(raw.formula.get_ref(), step.at, problem))
                    );
                }
                continue;
            };
            if name != "pi" && !names.found.iter().any(|(known, _)| known == name) {
                let meaning = self.meaning(raw, acts_at, (name, step.at), model)?;
                names.found.push((name, meaning));
            }
        }
        if let Some(curve) = &raw.curve {
            let over = curve.get_ref().over.get_ref();
            if !names.found.iter().any(|(_, meaning)| matches!(meaning, Meaning::Curve)) {
                return self.fail(&raw.formula, format!("the formula of the law {law} does not name its curve; write curve in it, or leave formula out"));
            }
            if !names.found.iter().any(|(known, _)| known == over) {
                let meaning = self.input_over(raw, acts_at, &curve.get_ref().over, model)?;
                names.found.push((over, meaning));
            }
        }
        self.name_units(&names);
        Ok(names)
    }

    fn meaning(
        &mut self,
        raw: &RawLaw,
        acts_at: ActsAt,
        (name, at): (&str, usize),
        model: &Model,
    ) -> Result<Meaning, ModelError> {
        let channel = |name: &str| model.channels.iter().position(|channel| channel.name == name);
        if name == CURVE && raw.curve.is_some() {
            return Ok(Meaning::Curve);
        }
        if let Some((_, reference)) = raw.parameters.0.iter().find(|(key, _)| key.get_ref() == name) {
            return self.parameter(name, reference, QuantityKind::Gain).map(Meaning::Parameter);
        }
        if let Some((_, given)) = raw.inputs.0.iter().find(|(key, _)| key.get_ref() == name) {
            let Some(index) = channel(given.get_ref()) else {
                let known: Vec<&str> = model.channels.iter().map(|channel| channel.name.as_str()).collect();
                let meant = meant(given.get_ref(), known.iter().copied());
                let message = format!(
                    "there is no channel \"{}\"{meant}; channels are {}",
                    given.get_ref(),
                    known.join(", ")
                );
                return self.fail(given, message);
            };
            return Ok(Meaning::Channel(index));
        }
        let of_place = symbols(acts_at);
        if let Some((_, input, _)) = of_place.iter().find(|(symbol, ..)| *symbol == name) {
            return Ok(Meaning::Place(*input));
        }
        if !RESERVED.contains(&name) {
            if let Some(index) = self.parameters.iter().position(|parameter| parameter.name == name) {
                return Ok(Meaning::Parameter(index));
            }
            if let Some(index) = channel(name) {
                return Ok(Meaning::Channel(index));
            }
        }
        let known: Vec<&str> = of_place.iter().map(|(symbol, ..)| *symbol).collect();
        let keys = raw.parameters.0.iter().map(|(key, _)| key).chain(raw.inputs.0.iter().map(|(key, _)| key));
        let all = known.iter().copied().chain(keys.map(|key| key.get_ref().as_str()));
        let all = all.chain(self.parameters.iter().map(|own| own.name.as_str()));
        let meant = meant(name, all.chain(model.channels.iter().map(|own| own.name.as_str())));
        let problem = format!(
            "there is no {name} at {}{meant}; the formula may name {}, keys of parameters and inputs, [parameters] and channels",
            acts_at.noun(),
            known.join(", ")
        );
        Err(self.in_formula(raw, &FormulaProblem::at(raw.formula.get_ref(), at, problem)))
    }

    /// What a curve is drawn over.
    fn input_over(
        &mut self,
        raw: &RawLaw,
        acts_at: ActsAt,
        over: &Name,
        model: &Model,
    ) -> Result<Meaning, ModelError> {
        let label = over.get_ref().as_str();
        match self.meaning(raw, acts_at, (label, 0), model) {
            Ok(meaning @ (Meaning::Place(_) | Meaning::Channel(_))) => Ok(meaning),
            _ => {
                let known: Vec<&str> = symbols(acts_at).iter().map(|(symbol, ..)| *symbol).collect();
                let all = known.iter().copied().chain(model.channels.iter().map(|own| own.name.as_str()));
                let message = format!(
                    "laws.{}.curve is over \"{label}\", which is no input at {}{}; write over = one of {}, or the name of a channel",
                    raw.name.get_ref(),
                    acts_at.noun(),
                    meant(label, all.collect::<Vec<_>>().into_iter()),
                    known.join(", ")
                );
                self.fail(over, message)
            }
        }
    }

    /// Refuses keys of `parameters` and `inputs` that the formula does not name.
    pub(super) fn check_keys_are_used(&self, raw: &RawLaw, names: &Names<'_>) -> Result<(), ModelError> {
        let parameters = raw.parameters.0.iter().map(|(key, _)| ("parameters", key));
        let mut keys = parameters.chain(raw.inputs.0.iter().map(|(key, _)| ("inputs", key)));
        let unused = keys.find(|(_, key)| !names.found.iter().any(|(name, _)| name == key.get_ref()));
        let Some((table, key)) = unused else { return Ok(()) };
        let message = format!(
            "the formula of the law {} does not name {}; remove it from {table}, or use it",
            raw.name.get_ref(),
            key.get_ref()
        );
        self.fail(key, message)
    }

    pub(super) fn check_counts(
        &self,
        raw: &RawLaw,
        names: &Names<'_>,
        curve: Option<&ReadCurve>,
    ) -> Result<(), ModelError> {
        let of_formula = names.parameters().count();
        let parameters = of_formula + curve.map_or(0, |curve| curve.parameters().count());
        let is_input = |meaning: &Meaning| matches!(meaning, Meaning::Place(_) | Meaning::Channel(_));
        let inputs = names.found.iter().filter(|(_, own)| is_input(own)).count();
        let over = |what: &str, found: usize, most: usize| {
            let message = format!(
                "laws.{}.formula has {found} {what}, and a law has at most {most}; write it as several laws",
                raw.name.get_ref()
            );
            self.fail(&raw.formula, message)
        };
        if parameters > MAX_PARAMETERS {
            return over("parameters", parameters, MAX_PARAMETERS);
        }
        if inputs > MAX_LAW_INPUTS {
            return over("inputs", inputs, MAX_LAW_INPUTS);
        }
        Ok(())
    }
}

impl<'t> Names<'t> {
    /// Names of parameters and their indices in the model.
    pub(super) fn parameters(&self) -> impl Iterator<Item = (&'t str, usize)> + '_ {
        self.found.iter().filter_map(|(name, meaning)| match meaning {
            Meaning::Parameter(index) => Some((*name, *index)),
            Meaning::Place(_) | Meaning::Channel(_) | Meaning::Curve => None,
        })
    }
}

/// Inputs that a kind of place has: name in a formula, input, quantity.
pub(super) fn symbols(acts_at: ActsAt) -> Vec<(&'static str, LawInput, QuantityKind)> {
    use QuantityKind as Kind;
    let speed = ("speed", LawInput::Speed, Kind::Speed);
    let angle = ("angle", LawInput::Angle, Kind::Angle);
    let twist = ("twist", LawInput::Twist, Kind::Angle);
    let rate = ("twist_rate", LawInput::TwistRate, Kind::Speed);
    let torque = ("torque", LawInput::Torque, Kind::Torque);
    let time = ("time", LawInput::Time, Kind::Time);
    match acts_at {
        ActsAt::Bearing | ActsAt::Node => vec![speed, angle, time],
        ActsAt::Spring => vec![twist, rate, torque, time],
        ActsAt::Gear => vec![speed, angle, torque, time],
        ActsAt::Channel => vec![("reading", LawInput::Reading, Kind::Gain), angle, time],
        ActsAt::Shaft => Vec::new(),
    }
}
