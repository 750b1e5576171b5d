//! `curve = { over = "speed", at = [..], values = [..], unit = ".." }` of a law: its points, with their units checked.

use toml::Spanned;

use super::{
    raw::{RawCurve, RawLaw, Written},
    reader::Reader,
};
use crate::{
    ModelError,
    effects::{OwnCurve, QuantityKind},
    formula,
};

/// Most points of a curve.
const MOST_POINTS: usize = 50;

/// A curve that was read, SI.
pub(super) struct ReadCurve {
    at: Vec<f64>,
    values: ReadValues,
    /// Unit of its values.
    pub(super) unit: String,
}

enum ReadValues {
    Numbers(Vec<f64>),
    /// Indices of parameters of the model.
    Parameters(Vec<usize>),
}

impl ReadCurve {
    /// Its parameters: names in the law, and indices in the model.
    pub(super) fn parameters(&self) -> impl Iterator<Item = (String, usize)> + '_ {
        let indices: &[usize] = match &self.values {
            ReadValues::Numbers(_) => &[],
            ReadValues::Parameters(indices) => indices,
        };
        indices.iter().enumerate().map(|(point, index)| (format!("value_{}", point + 1), *index))
    }

    /// The curve over the law's input of this index.
    pub(super) fn own(&self, input: usize) -> OwnCurve {
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect();
        let values = match &self.values {
            ReadValues::Numbers(numbers) => bits(numbers),
            ReadValues::Parameters(_) => Vec::new(),
        };
        OwnCurve { input, at: bits(&self.at), values }
    }
}

impl Reader<'_> {
    /// Reads a curve that is drawn over a quantity in the unit `over`.
    pub(super) fn curve(
        &mut self,
        law: &RawLaw,
        raw: &Spanned<RawCurve>,
        over: &str,
    ) -> Result<ReadCurve, ModelError> {
        let name = law.name.get_ref();
        let curve = raw.get_ref();
        let (at, values) = (curve.at.get_ref(), curve.values.get_ref());
        if at.len() != values.len() || !(2..=MOST_POINTS).contains(&at.len()) {
            let message = format!(
                "laws.{name}.curve has {} positions in `at` and {} values; write as many of both, 2 to {MOST_POINTS}",
                at.len(),
                values.len()
            );
            return self.fail(&curve.at, message);
        }
        let rises = |pair: &[f64]| pair[0] < pair[1];
        if !(at.iter().all(|at| at.is_finite()) && at.windows(2).all(rises)) {
            return self.fail(&curve.at, format!("laws.{name}.curve.at must increase from number to number"));
        }
        let factor = match &curve.at_unit {
            None => 1.0,
            Some(unit) => match socam_units::parse(unit.get_ref()) {
                Some(own) if formula::powers_of(unit.get_ref()) == formula::powers_of(over) => own.factor,
                _ => {
                    let message = format!(
                        "laws.{name}.curve.at_unit is \"{}\", but {} is in \"{over}\"; write a unit that can be converted to that",
                        unit.get_ref(),
                        curve.over.get_ref()
                    );
                    return self.fail(unit, message);
                }
            },
        };
        let at = at.iter().map(|at| at * factor).collect();
        if values.iter().any(|value| matches!(value.get_ref(), Written::Name(_))) {
            let (values, unit) = self.named_values(name, curve)?;
            return Ok(ReadCurve { at, values: ReadValues::Parameters(values), unit });
        }
        let Some(unit) = &curve.unit else {
            return self.fail(raw, format!("laws.{name}.curve needs the unit of its values; write unit = \"N m\", or names of parameters as values"));
        };
        let Some(own) = socam_units::parse(unit.get_ref()) else {
            return self.fail(
                unit,
                format!(
                    "laws.{name}.curve.unit: \"{}\" is no unit; expected something like \"N m\"",
                    unit.get_ref()
                ),
            );
        };
        let number = |value: &Spanned<Written>| match value.get_ref() {
            Written::Number(number) if number.is_finite() => Some(number * own.factor),
            _ => None,
        };
        match values.iter().map(number).collect() {
            Some(values) => {
                Ok(ReadCurve { at, values: ReadValues::Numbers(values), unit: unit.get_ref().clone() })
            }
            None => self.fail(
                &curve.values,
                format!("laws.{name}.curve.values must be finite numbers, or names of parameters"),
            ),
        }
    }

    /// Indices of the parameters that are the values of a curve, and their unit.
    fn named_values(&mut self, name: &str, curve: &RawCurve) -> Result<(Vec<usize>, String), ModelError> {
        if let Some(unit) = &curve.unit {
            return self.fail(unit, format!("laws.{name}.curve.unit is for numbers; these values are parameters, which have units of their own"));
        }
        let mut indices = Vec::new();
        for value in curve.values.get_ref() {
            indices.push(self.parameter("values", value, QuantityKind::Gain)?);
        }
        let unit_of = |index: usize| self.parameters[index].file_unit.clone();
        let first = unit_of(indices[0]);
        for (value, index) in curve.values.get_ref().iter().zip(&indices) {
            let own = unit_of(*index);
            if formula::powers_of(&own) != formula::powers_of(&first) {
                let message = format!(
                    "laws.{name}.curve.values are in \"{first}\" and \"{own}\"; all must have one unit"
                );
                return self.fail(value, message);
            }
        }
        Ok((indices, first))
    }
}
