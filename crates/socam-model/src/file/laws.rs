//! `[[laws]]`: formulas of the file's author as laws of the model, with their units checked.

mod names;
#[cfg(test)]
mod tests;
mod units;

use toml::Spanned;

use super::{
    curves::ReadCurve,
    raw::{Name, RawLaw},
    reader::Reader,
    wording::{line_of, meant},
};
use crate::{
    CandidateLaw, Model, ModelError,
    effects::{self, ActsAt, Effect, OwnInput, OwnLaw, OwnParameter},
    formula::{self, FormulaProblem, Step, What},
};

use names::{Meaning, Names, symbols};

/// Longest formula, bytes.
const LONGEST: usize = 1000;
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

    pub(super) fn in_formula(&self, raw: &RawLaw, problem: &FormulaProblem) -> ModelError {
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
