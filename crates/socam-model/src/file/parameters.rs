//! `[parameters.NAME]` and references to parameters, with checks of units and signs.

use toml::Spanned;

use super::{
    raw::{Name, RawParameter, Reference, Written},
    reader::Reader,
    wording::{line_of, meant},
};
use crate::{LARGEST_VALUE, ModelError, Parameter, Prior, effects::QuantityKind};

/// Smallest magnitude of a parameter beside zero, SI: quotients by much smaller ones overflow.
const SMALLEST_VALUE: f64 = 1e-60;

impl Reader<'_> {
    pub(super) fn read_parameter(&mut self, name: &Name, raw: RawParameter) -> Result<Parameter, ModelError> {
        let label = name.get_ref();
        let Some(unit) = socam_units::parse(raw.unit.get_ref()) else {
            return self.fail(&raw.unit, format!(
                "parameters.{label}.unit: \"{}\" is no unit; expected something like \"N m/rad\", \"kg m2\" or \"1\"",
                raw.unit.get_ref(),
            ));
        };
        if !raw.value.get_ref().is_finite() {
            return self.fail(&raw.value, format!("parameters.{label}.value must be a finite number"));
        }
        if (raw.value.get_ref() * unit.factor).abs() > LARGEST_VALUE {
            return self.fail(
                &raw.value,
                format!(
                    "parameters.{label}.value is beyond {LARGEST_VALUE:e} in SI, which nothing mechanical is"
                ),
            );
        }
        if *raw.value.get_ref() != 0.0 && (raw.value.get_ref() * unit.factor).abs() < SMALLEST_VALUE {
            return self.fail(
                &raw.value,
                format!("parameters.{label}.value is nearer to 0 than {SMALLEST_VALUE:e} in SI; write 0 if that is meant"),
            );
        }
        let ends = raw.bounds.as_ref().map(|bounds| bounds.get_ref().as_slice());
        let [low, high] = match ends {
            None => [f64::NEG_INFINITY, f64::INFINITY],
            Some([low, high]) => [*low, *high],
            Some(_) => {
                let at = raw.bounds.as_ref().map_or(raw.unit.span(), Spanned::span);
                let message =
                    format!("parameters.{label}.bounds must be two numbers; write bounds = [low, high]");
                return self.fail_in(line_of(self.text, at.start), message);
            }
        };
        let bounds = (low * unit.factor, high * unit.factor);
        self.bounded.extend(raw.bounds.map(|bounds| (label.clone(), *raw.value.get_ref(), bounds)));
        let prior = raw.prior.map(|prior| match *prior.std.get_ref() {
            std if std > 0.0 && std.is_finite() && prior.value.is_finite() => {
                Ok(Prior { value: prior.value * unit.factor, std: std * unit.factor })
            }
            _ => self.fail(
                &prior.std,
                format!("parameters.{label}.prior needs a finite value and a positive std"),
            ),
        });
        Ok(Parameter {
            value: raw.value.get_ref() * unit.factor,
            name: label.clone(),
            unit: si_name(unit.dimension, raw.unit.get_ref()),
            file_unit: raw.unit.into_inner(),
            file_factor: unit.factor,
            bounds,
            fixed: raw.fixed,
            source: raw.source,
            prior: prior.transpose()?,
        })
    }

    /// Checks values against bounds. It runs after all references are read, because "an inertia is zero" is the more specific message.
    pub(super) fn check_bounds(&self) -> Result<(), ModelError> {
        for (name, value, bounds) in &self.bounded {
            let [low, high] = bounds.get_ref()[..] else { continue };
            if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
                return self.fail(
                    bounds,
                    format!("parameters.{name}.bounds must be [low, high] with low < high, as in bounds = [{}, {}]", low.min(high), low.max(high)),
                );
            }
            if !(low..=high).contains(value) {
                return self.fail(
                    bounds,
                    format!(
                        "parameters.{name}.value is {value}, outside its bounds {low} to {high}; change either"
                    ),
                );
            }
        }
        Ok(())
    }

    /// The name of the parameter that `key` refers to.
    fn name_of<'r>(
        &self,
        key: &str,
        reference: &'r Reference,
        kind: QuantityKind,
    ) -> Result<&'r str, ModelError> {
        let value = match reference.get_ref() {
            Written::Name(name) => return Ok(name),
            Written::Number(number) => number.to_string(),
            Written::Other => "...".into(),
        };
        let letter = match kind {
            QuantityKind::Inertia if self.rotational => "J",
            QuantityKind::Inertia => "m",
            QuantityKind::Stiffness => "k",
            QuantityKind::Damping => "c",
            QuantityKind::Ratio => "N",
            QuantityKind::Resistance => "R",
            QuantityKind::Inductance => "L",
            QuantityKind::TorqueConstant => "kt",
            QuantityKind::BackEmf => "ke",
            _ => "p",
        };
        let is_free = |name: &String| !self.parameters.iter().any(|parameter| parameter.name == *name);
        let name = (1..).map(|number| format!("{letter}{number}")).find(is_free).unwrap_or_default();
        let unit = kind.unit(self.rotational);
        let unit = if unit.is_empty() { "1" } else { unit };
        self.fail(
            reference,
            format!(
                "{key} must be the name of a parameter; write {key} = \"{name}\", and under [parameters] {name} = {{ value = {value}, unit = \"{unit}\" }}"
            ),
        )
    }

    /// Index of the parameter that `key` names, where a quantity of `kind` is expected; sets its SI unit.
    pub(super) fn parameter(
        &mut self,
        key: &str,
        reference: &Reference,
        kind: QuantityKind,
    ) -> Result<usize, ModelError> {
        let label = self.name_of(key, reference, kind)?;
        let Some(index) = self.parameters.iter().position(|parameter| parameter.name == *label) else {
            let unit = kind.unit(self.rotational);
            let unit = if unit.is_empty() { "1" } else { unit };
            let meant = meant(label, self.parameters.iter().map(|parameter| parameter.name.as_str()));
            return self.fail(
                reference,
                format!(
                    "there is no parameter \"{label}\"{meant}; declare it under [parameters], as in {label} = {{ value = 1, unit = \"{unit}\" }}"
                ),
            );
        };
        let Some(expected) = kind.dimension(self.rotational) else { return Ok(index) };
        let found = socam_units::parse(&self.parameters[index].file_unit).map(|unit| unit.dimension);
        if found != Some(expected) {
            let unit = kind.unit(self.rotational);
            let message = format!(
                "{key} is parameter \"{label}\" in \"{}\", but here a unit like \"{unit}\" is expected",
                self.parameters[index].file_unit,
            );
            return self.fail(reference, message);
        }
        self.parameters[index].unit = kind.unit(self.rotational).into();
        Ok(index)
    }

    /// Index of a parameter that cannot be negative, see [`Self::parameter`]; its lower bound becomes 0 where the file gives none.
    pub(super) fn positive(
        &mut self,
        reference: &Reference,
        kind: QuantityKind,
    ) -> Result<usize, ModelError> {
        let key = kind_name(kind);
        let index = self.parameter(key, reference, kind)?;
        let parameter = &mut self.parameters[index];
        parameter.bounds.0 = parameter.bounds.0.max(0.0);
        let (allowed, instead) = match kind {
            QuantityKind::Inertia => ("positive", "; a node without inertia has no key inertia"),
            QuantityKind::Stiffness => {
                ("positive", "; where nothing joins the two nodes, leave the spring out")
            }
            QuantityKind::Inductance => {
                ("positive", "; where the current follows the voltage at once, leave it out")
            }
            QuantityKind::Damping | QuantityKind::BackEmf => ("zero or more", ""),
            _ => ("positive", ""),
        };
        if parameter.value < 0.0
            || (parameter.value == 0.0 && !matches!(kind, QuantityKind::Damping | QuantityKind::BackEmf))
        {
            let value = parameter.value / parameter.file_factor;
            let message = format!(
                "{key} \"{}\" is {value} {}, but it must be {allowed}{instead}",
                parameter.name, parameter.file_unit
            );
            return self.fail(reference, message);
        }
        Ok(index)
    }
}

fn kind_name(kind: QuantityKind) -> &'static str {
    match kind {
        QuantityKind::Inertia => "inertia",
        QuantityKind::Stiffness => "stiffness",
        QuantityKind::Resistance => "resistance",
        QuantityKind::Inductance => "inductance",
        QuantityKind::TorqueConstant => "torque_constant",
        QuantityKind::BackEmf => "back_emf",
        QuantityKind::Torque => "limit",
        _ => "damping",
    }
}

/// SI unit of a parameter to which no element refers: its unit in the file where that is SI already.
fn si_name(dimension: socam_units::Dimension, file_unit: &str) -> String {
    match socam_units::parse(file_unit) {
        Some(unit) if unit.factor == 1.0 => file_unit.into(),
        _ => {
            let names = ["kg", "m", "s", "A", "K"];
            let factors = names.iter().zip(dimension).filter(|(_, power)| *power != 0);
            let text: Vec<_> = factors.map(|(name, power)| format!("{name}^{power}")).collect();
            if text.is_empty() { "1".into() } else { text.join(" ") }
        }
    }
}
