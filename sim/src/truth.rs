//! The simulated drivetrain: a model with changed parameters and with effects that the written model lacks.

use socam_model::{Equations, Model, ModelError, effects};

use crate::SimError;
use crate::concealed::{Concealed, Override};
use crate::fault::Fault;

/// A drivetrain to simulate.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The model with all concealed effects.
    pub model: Model,
    /// Parameter values, SI.
    pub values: Vec<f64>,
    /// Faults of its sensors: channel's name and fault, in the order given.
    pub(crate) faults: Vec<(String, Fault)>,
}

impl Truth {
    /// The model's drivetrain with replaced parameter values and concealed effects.
    ///
    /// # Errors
    /// [`SimError::Argument`] for a parameter, effect or place that does not exist; [`SimError::Model`] where the result
    /// cannot move.
    pub fn new(model: &Model, overrides: &[Override], concealed: &[Concealed]) -> Result<Self, SimError> {
        let mut model = model.clone();
        let mut faults = Vec::new();
        for hidden in concealed {
            match effects::find(&hidden.effect).filter(|effect| Fault::is_one(effect)) {
                Some(effect) => {
                    faults.push((faulty_channel(&model, hidden)?, Fault::new(effect, hidden)?));
                }
                None => model = conceal(&model, hidden)?,
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
        let truth = Self { values: model.values(), model, faults };
        truth.equations()?;
        Ok(truth)
    }

    /// Equations of motion.
    ///
    /// # Errors
    /// [`ModelError`] where it cannot move.
    pub fn equations(&self) -> Result<Equations, ModelError> {
        self.model.equations(&self.values)
    }
}

/// Name of the channel whose sensor has the fault.
fn faulty_channel(model: &Model, hidden: &Concealed) -> Result<String, SimError> {
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
    let Some(effect) = model.effect_with(&hidden.effect, given) else {
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
    let own: Vec<&str> = effect.parameters.iter().map(|own| own.name).collect();
    let names = if effect.is_own() { own } else { effects::parameters_of(effect.id) };
    hidden.check_parameters(effect, &names)?;
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
