//! `[[laws]]`: formulas of the file's author as laws of the model, with their units checked.

use toml::Spanned;

use super::{
    curves::ReadCurve,
    raw::{Name, RawLaw},
    reader::Reader,
    wording::{line_of, meant},
};
use crate::{
    CandidateLaw, Model, ModelError,
    effects::{
        self, ActsAt, Effect, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS, OwnInput, OwnLaw, OwnParameter,
        QuantityKind,
    },
    formula::{self, CURVE, FUNCTIONS, FormulaProblem, Step, What},
};

/// Longest formula, bytes.
const LONGEST: usize = 1000;
/// Names with a meaning of their own in every formula, beside those of functions.
const RESERVED: [&str; 5] = ["pi", "through", "change", "state", CURVE];

/// A name of a formula.
enum Meaning {
    Place(LawInput),
    /// Index of a channel.
    Channel(usize),
    /// Index of a parameter of the model.
    Parameter(usize),
    /// The law's curve.
    Curve,
}

/// A formula while it is read: its names and what they mean, in the order in which they occur.
struct Names<'t> {
    found: Vec<(&'t str, Meaning)>,
}

impl Reader<'_> {
    /// Reads a law; adds it to the model's effects, or to its candidates.
    pub(super) fn law(&mut self, mut raw: RawLaw, model: &mut Model) -> Result<(), ModelError> {
        self.check_law_name(&raw.name, model)?;
        if raw.formula.span().is_empty() {
            let Some(curve) = &raw.curve else {
                return self.fail(
                    &raw.name,
                    "formula is missing; write formula = \"-a*speed\", or curve = { over = \"speed\", ... }",
                );
            };
            raw.formula = Spanned::new(curve.span(), raw.formula.into_inner());
        }
        let acts_at = self.law_place(&raw, model)?;
        let text = raw.formula.get_ref();
        if text.len() > LONGEST {
            let message = format!(
                "laws.{}.formula has more than {LONGEST} characters; write it as several laws",
                raw.name.get_ref()
            );
            return self.fail(&raw.formula, message);
        }
        let steps = formula::parse(text).map_err(|problem| self.in_formula(&raw, &problem))?;
        let names = self.names(&raw, acts_at, &steps, model)?;
        let over = self.unit_over(&raw, acts_at, &names, model);
        let curve = raw.curve.as_ref().map(|curve| self.curve(&raw, curve, &over)).transpose()?;
        self.check_counts(&raw, &names, curve.as_ref())?;
        self.check_units(&raw, acts_at, &steps, (&names, curve.as_ref()), model)?;
        self.check_keys_are_used(&raw, &names)?;
        let mut parameters: Vec<(String, usize)> =
            names.parameters().map(|(name, index)| (name.to_owned(), index)).collect();
        parameters.extend(curve.iter().flat_map(ReadCurve::parameters));
        let effect =
            self.own_effect(&raw, acts_at, &steps, (&names, curve.as_ref()), (&parameters, model))?;
        self.check_values(&raw, effect, &parameters)?;
        let indices: Vec<usize> = parameters.iter().map(|(_, index)| *index).collect();
        if raw.candidate {
            if effect.amplitude.parameters.is_empty() {
                let message = format!(
                    "laws.{}: a candidate needs parameters in which its formula is linear and that make it zero where they are zero, as a in a*tanh(speed/b); leave candidate out, or write such a factor",
                    raw.name.get_ref()
                );
                return self.fail(&raw.formula, message);
            }
            let fixed = indices.iter().map(|index| self.parameters[*index].fixed).collect();
            model.candidates.push(CandidateLaw { effect, parameters: indices, fixed });
            return Ok(());
        }
        if !self.put(effect, raw.at.get_ref().clone(), indices, model) {
            return self.fail(&raw.at, format!("a law cannot act at \"{}\"", raw.at.get_ref()));
        }
        Ok(())
    }

    fn in_formula(&self, raw: &RawLaw, problem: &FormulaProblem) -> ModelError {
        let message = format!("laws.{}.formula, {problem}", raw.name.get_ref());
        ModelError::File { line: line_of(self.text, raw.formula.span().start), message }
    }

    fn check_law_name(&self, name: &Name, model: &Model) -> Result<(), ModelError> {
        let label = name.get_ref();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
        if label.is_empty() || label.len() > 60 || !label.chars().all(is_plain) {
            return self.fail(
                name,
                format!(
                    "\"{}\" is no name of a law; write one of letters, digits, _ and -",
                    label.escape_debug()
                ),
            );
        }
        if effects::find(label).is_some() {
            return self
                .fail(name, format!("{label} is an effect of the catalogue; give the law another name"));
        }
        let of_laws =
            model.effects.iter().map(|used| used.effect).chain(model.candidates.iter().map(|own| own.effect));
        if of_laws.filter(|effect| effect.is_own()).any(|effect| effect.id == label) {
            return self.fail(name, format!("the law \"{label}\" is there already; names must differ"));
        }
        Ok(())
    }

    /// Kind of place at which a law acts.
    fn law_place(&self, raw: &RawLaw, model: &Model) -> Result<ActsAt, ModelError> {
        let place = raw.at.get_ref();
        let bearings = model.bearings.iter().map(|own| (&own.name, ActsAt::Bearing));
        let springs = model.springs.iter().map(|own| (&own.name, ActsAt::Spring));
        let gears = model.gears.iter().map(|own| (&own.name, ActsAt::Gear));
        let nodes = model.nodes.iter().map(|own| (&own.name, ActsAt::Node));
        let channels = model.channels.iter().map(|own| (&own.name, ActsAt::Channel));
        let all: Vec<_> = bearings.chain(springs).chain(gears).chain(nodes).chain(channels).collect();
        if let Some((_, acts_at)) = all.iter().find(|(name, _)| *name == place) {
            return Ok(*acts_at);
        }
        let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
        let meant = meant(place, names.iter().copied());
        self.fail(
            &raw.at,
            format!(
                "a law acts at a bearing, spring, gear, node or channel, and \"{place}\" is none{meant}; write at = one of {}",
                names.join(", ")
            ),
        )
    }

    /// What each name of the formula means.
    fn names<'r>(
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

    /// Calls the SI units of parameters that the file gives in others by their usual names: a width in rpm is in rad/s, and not in 1/s.
    fn name_units(&mut self, names: &Names<'_>) {
        let usual = self.usual_units();
        for (_, index) in names.parameters() {
            let own = &mut self.parameters[index];
            if let Some(powers) = formula::powers_of(&own.file_unit).filter(|_| own.unit != own.file_unit) {
                own.unit = formula::unit_of(powers, &usual);
            }
        }
    }

    /// Refuses keys of `parameters` and `inputs` that the formula does not name.
    fn check_keys_are_used(&self, raw: &RawLaw, names: &Names<'_>) -> Result<(), ModelError> {
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

    /// SI unit of what a law's curve is drawn over.
    fn unit_over(&self, raw: &RawLaw, acts_at: ActsAt, names: &Names<'_>, model: &Model) -> String {
        let over = raw.curve.as_ref().map_or("", |curve| curve.get_ref().over.get_ref().as_str());
        let meaning = names.found.iter().find(|(name, _)| *name == over).map(|(_, meaning)| meaning);
        match meaning {
            Some(Meaning::Channel(index)) => model.channels[*index].unit.to_owned(),
            Some(Meaning::Place(LawInput::Reading)) => channel_unit(raw, model).to_owned(),
            Some(Meaning::Place(input)) => {
                let kind = symbols(acts_at).into_iter().find(|(_, own, _)| own == input);
                kind.map_or("1", |(.., kind)| kind.unit(self.rotational)).to_owned()
            }
            _ => "1".to_owned(),
        }
    }

    fn check_counts(
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

    fn check_units(
        &self,
        raw: &RawLaw,
        acts_at: ActsAt,
        steps: &[Step],
        (names, curve): (&Names<'_>, Option<&ReadCurve>),
        model: &Model,
    ) -> Result<(), ModelError> {
        let unit = |kind: QuantityKind| kind.unit(self.rotational);
        let powers = |unit: &str| formula::powers_of(unit).unwrap_or_default();
        let named = |name: &str| {
            let (_, meaning) = names.found.iter().find(|(known, _)| *known == name)?;
            Some(match meaning {
                Meaning::Place(LawInput::Reading) => powers(channel_unit(raw, model)),
                Meaning::Place(input) => {
                    let (.., kind) = symbols(acts_at).into_iter().find(|(_, own, _)| own == input)?;
                    powers(unit(kind))
                }
                Meaning::Channel(index) => powers(model.channels[*index].unit),
                Meaning::Parameter(index) => powers(&self.parameters[*index].file_unit),
                Meaning::Curve => powers(curve.map_or("1", |curve| curve.unit.as_str())),
            })
        };
        let usual = self.usual_units();
        let found = formula::check(raw.formula.get_ref(), steps, &usual, &named)
            .map_err(|problem| self.in_formula(raw, &problem))?;
        let (what, wanted) = match acts_at {
            ActsAt::Channel => ("a reading", channel_unit(raw, model)),
            _ if self.rotational => ("a torque", "N m"),
            _ => ("a force", "N"),
        };
        if found.is(powers(wanted)) {
            return Ok(());
        }
        let (own, wanted_powers) = (found.powers(), powers(wanted));
        let missing = std::array::from_fn(|index| wanted_powers[index] - own[index]);
        let message = format!(
            "laws.{}.formula is in \"{}\", but at {} it gives {what} in \"{wanted}\"; a factor in \"{}\" is missing",
            raw.name.get_ref(),
            formula::unit_of(own, &usual),
            raw.at.get_ref(),
            formula::unit_of(missing, &usual)
        );
        self.fail(&raw.formula, message)
    }

    /// Units by which a formula's units are called.
    fn usual_units(&self) -> Vec<&'static str> {
        use QuantityKind::{Angle, Damping, Drag, Inertia, Ratio, Speed, Stiffness, Time, Torque};
        let kinds = [Ratio, Torque, Speed, Angle, Inertia, Stiffness, Damping, Drag, Time];
        kinds
            .iter()
            .map(|kind| kind.unit(self.rotational))
            .chain(["m", "N", "N m/s", "A", "V", "K"])
            .collect()
    }

    fn own_effect(
        &self,
        raw: &RawLaw,
        acts_at: ActsAt,
        steps: &[Step],
        (names, curve): (&Names<'_>, Option<&ReadCurve>),
        (parameters, model): (&[(String, usize)], &Model),
    ) -> Result<&'static Effect, ModelError> {
        let mut inputs = Vec::new();
        let over = raw.curve.as_ref().map(|curve| curve.get_ref().over.get_ref().as_str());
        let mut position = None;
        for (symbol, input, _) in symbols(acts_at) {
            if names
                .found
                .iter()
                .any(|(name, meaning)| *name == symbol && matches!(meaning, Meaning::Place(_)))
            {
                position = position.or((over == Some(symbol)).then_some(inputs.len()));
                inputs.push(OwnInput::Place(input));
            }
        }
        for (name, meaning) in &names.found {
            if let Meaning::Channel(index) = meaning {
                position = position.or((over == Some(*name)).then_some(inputs.len()));
                let channel = model.channels[*index].name.clone();
                inputs.push(OwnInput::Channel { channel, symbol: (*name).to_owned() });
            }
        }
        let parameters = parameters.iter().map(|(name, index)| {
            let own = &self.parameters[*index];
            let (least, most) = if raw.candidate { own.bounds } else { (f64::NEG_INFINITY, f64::INFINITY) };
            OwnParameter {
                name: name.clone(),
                unit: own.unit.clone(),
                bounds: [least.to_bits(), most.to_bits()],
            }
        });
        let renamed = renamed(raw.formula.get_ref(), steps, names);
        let law = OwnLaw {
            name: raw.name.get_ref().clone(),
            place: raw.at.get_ref().clone(),
            acts_at,
            parameters: parameters.collect(),
            curve: curve.zip(position).map(|(curve, input)| curve.own(input)),
            inputs,
            formula: renamed,
            is_candidate: raw.candidate,
        };
        let steps = formula::parse(&law.formula).map_err(|problem| self.in_formula(raw, &problem))?;
        if steps.len() > formula::MOST_OPERATIONS {
            let message = format!(
                "laws.{}.formula has {} numbers, names and operators, and at most {} are read; write it as several laws",
                raw.name.get_ref(),
                steps.len(),
                formula::MOST_OPERATIONS
            );
            return self.fail(&raw.formula, message);
        }
        match law.effect(&steps) {
            Some(effect) => Ok(effect),
            None => self.fail(
                &raw.formula,
                "this program has read as many different laws as it holds; start it again",
            ),
        }
    }

    /// Refuses parameters at which the formula has no value; parameters by which it divides keep their sign.
    fn check_values(
        &mut self,
        raw: &RawLaw,
        effect: &Effect,
        names: &[(String, usize)],
    ) -> Result<(), ModelError> {
        for own in effect.divisors() {
            let (name, index) = (&names[own].0, names[own].1);
            let parameter = &mut self.parameters[index];
            if parameter.value > 0.0 {
                parameter.bounds.0 = parameter.bounds.0.max(0.0);
            } else if parameter.value < 0.0 {
                parameter.bounds.1 = parameter.bounds.1.min(0.0);
            } else {
                let message = format!(
                    "laws.{}.formula divides by {name}, which is 0; give it another value",
                    raw.name.get_ref()
                );
                return self.fail(&raw.formula, message);
            }
        }
        let values: Vec<f64> = names.iter().map(|(_, index)| self.parameters[*index].value).collect();
        if !effect.laws().iter().all(|law| law.is_finite_at(&values)) {
            let message = format!(
                "laws.{}.formula has no finite value at the file's parameters, its inputs being 1; change the values, or the formula",
                raw.name.get_ref()
            );
            return self.fail(&raw.formula, message);
        }
        Ok(())
    }
}

impl<'t> Names<'t> {
    /// Names of parameters and their indices in the model.
    fn parameters(&self) -> impl Iterator<Item = (&'t str, usize)> + '_ {
        self.found.iter().filter_map(|(name, meaning)| match meaning {
            Meaning::Parameter(index) => Some((*name, *index)),
            Meaning::Place(_) | Meaning::Channel(_) | Meaning::Curve => None,
        })
    }
}

/// Inputs that a kind of place has: name in a formula, input, quantity.
fn symbols(acts_at: ActsAt) -> Vec<(&'static str, LawInput, QuantityKind)> {
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

/// Unit of the channel at which a law acts.
fn channel_unit(raw: &RawLaw, model: &Model) -> &'static str {
    model
        .channels
        .iter()
        .find(|channel| channel.name == *raw.at.get_ref())
        .map_or("1", |channel| channel.unit)
}

/// The formula with the places' inputs by their names in laws: a user's `torque` is `through` there.
fn renamed(text: &str, steps: &[Step], names: &Names<'_>) -> String {
    let mut out = text.to_owned();
    for step in steps.iter().rev() {
        let What::Name(name) = &step.what else { continue };
        let meaning = names.found.iter().find(|(known, _)| known == name);
        if let Some((_, Meaning::Place(input))) = meaning {
            out.replace_range(step.at..step.at + name.len(), input.symbol());
        }
    }
    out
}

#[cfg(test)]
mod tests;
