//! What the simulated drivetrain really is: a model with changed parameters and with physics that the model leaves out.

use std::str::FromStr;

use socam_model::{Equations, Model, ModelError, effects};

use crate::SimError;
use crate::flaw::Flaw;

/// A parameter value in place of the model's: `k1=71` (SI).
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// Parameter's name.
    pub name: String,
    /// Value, SI.
    pub value: f64,
}

/// An effect of the catalogue that the truth has and the written model does not: `EFFECT@PLACE:name=value,..` (SI).
#[derive(Debug, Clone, PartialEq)]
pub struct Concealed {
    /// Effect's id.
    pub effect: String,
    /// Place's name.
    pub place: String,
    /// Its parameters.
    pub parameters: Vec<Override>,
}

/// A drivetrain to simulate.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The model with everything that was concealed.
    pub model: Model,
    /// Its parameter values, SI.
    pub values: Vec<f64>,
    /// What its sensors do to the truth: channel's name and flaw, in the order given.
    pub(crate) flaws: Vec<(String, Flaw)>,
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

impl Truth {
    /// The model's drivetrain with other parameter values and with concealed effects.
    ///
    /// # Errors
    /// [`SimError::Argument`] for a parameter, effect or place that does not exist; [`SimError::Model`] where the result
    /// cannot move.
    pub fn new(model: &Model, overrides: &[Override], concealed: &[Concealed]) -> Result<Self, SimError> {
        let mut model = model.clone();
        let mut flaws = Vec::new();
        for hidden in concealed {
            if Flaw::is_one(&hidden.effect) {
                flaws.push((flawed_channel(&model, hidden)?, Flaw::read(hidden)?));
            } else {
                model = conceal(&model, hidden)?;
            }
        }
        for change in overrides {
            let index = model.parameter(&change.name).ok_or_else(|| {
                let names: Vec<_> =
                    model.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
                SimError::argument(
                    &change.name,
                    format!("no parameter of {}; it has {}", model.name, names.join(", ")),
                )
            })?;
            model.parameters[index].value = change.value;
        }
        let truth = Self { values: model.values(), model, flaws };
        truth.equations()?;
        Ok(truth)
    }

    /// Its equations of motion.
    ///
    /// # Errors
    /// [`ModelError`] where it cannot move.
    pub fn equations(&self) -> Result<Equations, ModelError> {
        self.model.equations(&self.values)
    }
}

/// The channel whose sensor is flawed.
pub(crate) fn flawed_channel(model: &Model, hidden: &Concealed) -> Result<String, SimError> {
    if model.channels.iter().any(|channel| channel.name == hidden.place) {
        return Ok(hidden.place.clone());
    }
    let names: Vec<_> = model.channels.iter().map(|channel| channel.name.as_str()).collect();
    let problem = format!("there is no channel `{}`; {} has {}", hidden.place, model.name, names.join(", "));
    Err(SimError::argument(hidden.to_string(), problem))
}

fn conceal(model: &Model, hidden: &Concealed) -> Result<Model, SimError> {
    let fail = |problem: String| Err(SimError::argument(hidden.to_string(), problem));
    let given = hidden.parameters.iter().map(|given| given.name.as_str());
    let Some(effect) = effects::find_with(&hidden.effect, given) else {
        let known: Vec<_> = effects::CATALOGUE.iter().map(|effect| effect.id).collect();
        return fail(format!("there is no effect `{}`; effects are {}", hidden.effect, known.join(", ")));
    };
    let places = model.places(effect);
    if !places.contains(&hidden.place.as_str()) {
        return fail(format!(
            "{} cannot act at `{}`; places for it are {}",
            effect.id,
            hidden.place,
            places.join(", ")
        ));
    }
    if let Some(unknown) =
        hidden.parameters.iter().find(|given| effect.parameters.iter().all(|p| p.name != given.name))
    {
        let names = effects::parameters_of(effect.id).join(", ");
        return fail(format!("{} has no parameter `{}`; it has {names}", effect.id, unknown.name));
    }
    let given = |name: &str| hidden.parameters.iter().any(|given| given.name == name);
    if let Some(needed) = effect.parameters.iter().find(|p| p.default.is_none() && !given(p.name)) {
        return fail(format!("{} needs its parameter `{}`", effect.id, needed.name));
    }
    let values: Vec<(&str, f64)> =
        hidden.parameters.iter().map(|given| (given.name.as_str(), given.value)).collect();
    let changed = model.with_effect(effect.id, &hidden.place, &values);
    changed.or_else(|error| fail(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bench() -> Model {
        Model::builtin("speed-o-cam").unwrap()
    }

    #[test]
    fn concealed_physics_is_read_and_added() {
        let friction: Concealed = "coulomb_friction@load_bearing:torque=0.4".parse().unwrap();
        let load: Concealed = "constant_load@load:torque=-0.1".parse().unwrap();
        let truth = Truth::new(&bench(), &["k1=60".parse().unwrap()], &[friction.clone(), load]).unwrap();
        assert_eq!(truth.values[truth.model.parameter("k1").unwrap()], 60.0);
        assert_eq!(truth.equations().unwrap().ports.len(), 2);
        assert_eq!(friction.to_string(), "coulomb_friction@load_bearing:torque=0.4");
    }

    #[test]
    fn each_slip_is_named() {
        let problem = |text: &str| {
            let hidden = text.parse::<Concealed>();
            hidden.and_then(|hidden| Truth::new(&bench(), &[], &[hidden])).unwrap_err().to_string()
        };
        for (text, expected) in [
            ("coulomb_friction", "expected EFFECT@PLACE"),
            ("sensor_gain@load:gain=1", "there is no channel `load`; speed-o-cam has "),
            ("rust@load_bearing", "there is no effect `rust`; effects are coulomb_friction"),
            ("coulomb_friction@load:torque=1", "places for it are cam_bearing, load_bearing"),
            ("coulomb_friction@load_bearing:force=1", "has no parameter `force`"),
            ("coulomb_friction@load_bearing", "needs its parameter `torque`"),
            ("coulomb_friction@load_bearing:torque=much", "`much` is not a finite number"),
        ] {
            assert!(problem(text).contains(expected), "{}", problem(text));
        }
        let change = Truth::new(&bench(), &["k9=1".parse().unwrap()], &[]).unwrap_err().to_string();
        assert!(change.starts_with("`k9`: no parameter of speed-o-cam; it has "), "{change}");
    }
}
