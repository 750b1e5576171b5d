//! Effects and parameter values that a simulated bench has but its written model lacks, in the notation of the command line.

use std::str::FromStr;

use socam_model::effects::Effect;

use crate::SimError;

/// A parameter value that replaces the model's: `k1=71` (SI).
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// Parameter's name.
    pub name: String,
    /// Value, SI.
    pub value: f64,
}

/// An effect of the catalogue that the truth has but the written model lacks: `EFFECT@PLACE:name=value,..` (SI).
#[derive(Debug, Clone, PartialEq)]
pub struct Concealed {
    /// Effect's id.
    pub effect: String,
    /// Place's name.
    pub place: String,
    /// Parameters of the effect.
    pub parameters: Vec<Override>,
}

impl Concealed {
    /// Checks that the parameters are those of the effect, and that none is missing. `offered` are the names that a message lists.
    pub(crate) fn check_parameters(&self, effect: &Effect, offered: &[&str]) -> Result<(), SimError> {
        let fail = |problem: String| Err(SimError::argument(self.to_string(), problem));
        let is_unknown = |given: &&Override| effect.parameters.iter().all(|own| own.name != given.name);
        if let Some(unknown) = self.parameters.iter().find(is_unknown) {
            let names = offered.join(", ");
            return fail(format!("{} has no parameter `{}`; it has {names}", effect.id, unknown.name));
        }
        let is_given = |name: &str| self.parameters.iter().any(|given| given.name == name);
        match effect.given().find(|needed| !is_given(needed.name)) {
            Some(needed) => fail(format!("{} needs its parameter `{}`", effect.id, needed.name)),
            None => Ok(()),
        }
    }
}

impl FromStr for Override {
    type Err = SimError;

    fn from_str(text: &str) -> Result<Self, SimError> {
        let (name, value) = text
            .split_once('=')
            .ok_or_else(|| SimError::argument(text, "expected name=value, as in k1=71"))?;
        let (name, number) = (name.trim(), value.trim());
        match number.parse::<f64>() {
            _ if name.is_empty() => Err(SimError::argument(text, "there is no name before the `=`")),
            Ok(value) if value.is_finite() => Ok(Self { name: name.into(), value }),
            _ => Err(SimError::argument(text, format!("`{number}` is not a finite number"))),
        }
    }
}

impl FromStr for Concealed {
    type Err = SimError;

    fn from_str(text: &str) -> Result<Self, SimError> {
        let expected = "expected EFFECT@PLACE:name=value,.., as in coulomb_friction@load_bearing:torque=0.4";
        let (what, parameters) = text.split_once(':').unwrap_or((text, ""));
        let (effect, place) = what.split_once('@').ok_or_else(|| SimError::argument(text, expected))?;
        if effect.is_empty() || place.is_empty() {
            return Err(SimError::argument(text, expected));
        }
        let parameters = parameters.split(',').filter(|part| !part.trim().is_empty()).map(str::parse);
        Ok(Self {
            effect: effect.into(),
            place: place.into(),
            parameters: parameters.collect::<Result<_, _>>()?,
        })
    }
}

impl std::fmt::Display for Concealed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}@{}", self.effect, self.place)?;
        for (index, Override { name, value }) in self.parameters.iter().enumerate() {
            write!(f, "{}{name}={value}", if index == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}
