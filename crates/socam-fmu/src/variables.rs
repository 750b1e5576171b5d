//! The variables of an FMU: the model's inputs, outputs, parameters and states, with their names and value references.

use std::collections::HashSet;

use socam_model::{Channel, Equations, Model, Quantity};

use crate::FmuError;

/// Meaning of a variable in the model, with its index there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VariableRole {
    /// Time, s.
    Time,
    /// An input of the model, by its index in the equations.
    Input(usize),
    /// An output of the model.
    Output(usize),
    /// A parameter of the model.
    Parameter(usize),
    /// A state of the equations.
    State(usize),
    /// The time derivative of a state.
    Derivative(usize),
}

/// A variable. Its value reference is its index in [`variables()`].
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name by the structured naming convention of FMI, unique.
    pub name: String,
    /// Meaning of the variable in the model.
    pub kind: VariableRole,
    /// SI unit; empty where the file gives none.
    pub unit: String,
    /// One line.
    pub description: String,
    /// Start value, SI; time, outputs and derivatives have none.
    pub start: Option<f64>,
    /// Least and greatest value, SI; infinite where there is no limit.
    pub bounds: (f64, f64),
}

const UNBOUNDED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// All variables of a model; `equations` are those at its file's values.
///
/// ```
/// let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
/// let variables = socam_fmu::variables(&model, &model.equations(&model.values())?)?;
/// let names: Vec<_> = variables.iter().map(|variable| variable.name.as_str()).collect();
/// assert_eq!(names[..4], ["time", "motor_torque", "motor_speed", "load_speed"]);
/// assert!(names.contains(&"parameter.stiffness") && names.contains(&"state.speed_of_load"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FmuError::Unsuited`] where a law depends on the rate of change of an input, or on the turned angle of a node whose speed is an output.
pub fn variables(model: &Model, equations: &Equations) -> Result<Vec<Variable>, FmuError> {
    let time = Variable {
        name: "time".into(),
        kind: VariableRole::Time,
        unit: "s".into(),
        description: "simulated time".into(),
        start: None,
        bounds: UNBOUNDED,
    };
    let mut all = vec![time];
    for (index, channel) in model.inputs().enumerate() {
        match channel.quantity {
            Quantity::Change => return Err(changes(channel)),
            Quantity::Turned if tachometer(model, channel).is_none() => return Err(turns(channel)),
            Quantity::Turned | Quantity::Time => {}
            _ => all.push(of_channel(channel, VariableRole::Input(index), Some(0.0))),
        }
    }
    all.extend(
        model.outputs().enumerate().map(|(index, c)| of_channel(c, VariableRole::Output(index), None)),
    );
    all.extend(model.parameters.iter().enumerate().map(|(index, parameter)| Variable {
        name: format!("parameter.{}", identifier(&parameter.name)),
        kind: VariableRole::Parameter(index),
        unit: parameter.unit.clone(),
        description: parameter.source.clone(),
        start: Some(parameter.value),
        bounds: parameter.bounds,
    }));
    all.extend(equations.state_names.iter().enumerate().map(|(index, name)| Variable {
        name: format!("state.{}", identifier(name)),
        kind: VariableRole::State(index),
        unit: String::new(),
        description: format!("{name}, SI"),
        start: Some(0.0),
        bounds: UNBOUNDED,
    }));
    make_unique(&mut all);
    if can_exchange(model) {
        let states: Vec<Variable> =
            all.iter().filter(|variable| matches!(variable.kind, VariableRole::State(_))).cloned().collect();
        all.extend(states.into_iter().enumerate().map(|(index, state)| Variable {
            name: format!("der({})", state.name),
            kind: VariableRole::Derivative(index),
            description: format!("time derivative of {}", state.description),
            start: None,
            ..state
        }));
    }
    Ok(all)
}

/// Whether the states of the equations are all that a step changes. A turned angle would be one more.
pub(crate) fn can_exchange(model: &Model) -> bool {
    model.inputs().all(|channel| channel.quantity != Quantity::Turned)
}

/// The index among the inputs of the speed whose integral is the turned angle `turned`.
pub(crate) fn tachometer(model: &Model, turned: &Channel) -> Option<usize> {
    model.inputs().position(|c| c.quantity == Quantity::Speed && c.column == turned.column)
}

fn of_channel(channel: &Channel, kind: VariableRole, start: Option<f64>) -> Variable {
    let quantity = format!("{:?}", channel.quantity).to_lowercase();
    let description = format!("{quantity} at {}; column {} of recordings", channel.at, channel.column);
    let (name, unit) = (identifier(&channel.name), channel.unit.into());
    Variable { name, kind, unit, description, start, bounds: UNBOUNDED }
}

fn changes(channel: &Channel) -> FmuError {
    FmuError::Unsuited(format!(
        "an effect depends on how fast a channel changes (`{}`), but inputs of an FMU are held between communication points; \
         remove that effect from the model file",
        channel.name
    ))
}

fn turns(channel: &Channel) -> FmuError {
    FmuError::Unsuited(format!(
        "an effect depends on the angle through which {} has turned, and the model file has no input that is its speed; remove that effect, \
         or make the speed of {} an input",
        channel.at, channel.at
    ))
}

/// A name of FMI's structured convention: letters, digits and underscores, not beginning with a digit.
fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let begins_badly = plain.chars().next().is_none_or(|first| first.is_ascii_digit());
    if begins_badly { format!("_{plain}") } else { plain }
}

/// Appends a number to names that occur before.
fn make_unique(variables: &mut [Variable]) {
    let mut taken = HashSet::new();
    for variable in variables {
        let name = variable.name.clone();
        let mut number = 2;
        while !taken.insert(variable.name.clone()) {
            variable.name = format!("{name}_{number}");
            number += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_identifiers_and_unique() {
        assert_eq!(["2 \u{b5}m", "", "speed of load"].map(identifier), ["_2__m", "_", "speed_of_load"]);
        let model = socam_model::Model::builtin("two-mass").unwrap();
        let text =
            model.text.replace("motor_speed", "\"load speed\"").replace("load_speed", "\"load-speed\"");
        let model = socam_model::Model::parse(&text).unwrap();
        let all = variables(&model, &model.equations(&model.values()).unwrap()).unwrap();
        assert_eq!([&all[2].name, &all[3].name], ["load_speed", "load_speed_2"]);
    }
}
