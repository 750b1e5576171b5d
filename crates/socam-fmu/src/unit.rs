//! One instance: variables, parameters, states, steps.

use socam_identify::{Intersample, Predictor, Start};
use socam_model::Model;

/// What a variable is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set by the importer, held over a step.
    Input,
    /// Computed.
    Output,
    /// Set before the start; a physical parameter.
    Parameter,
    /// Set before the start; the start value of a state.
    State,
}

/// A variable. Its value reference is its index plus one; reference 0 is time.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Unique name.
    pub name: String,
    /// What it is for.
    pub causality: Causality,
    /// SI unit; empty where it is not known.
    pub unit: String,
    /// Description.
    pub description: String,
    /// Start value, SI.
    pub start: f64,
}

/// A model that is stepped.
pub struct Unit {
    model: Model,
    variables: Vec<Variable>,
    /// Values of all variables; outputs are computed when they are read.
    values: Vec<f64>,
    states: Vec<f64>,
    /// Sample time and predictor of the present parameters.
    predictor: Option<(f64, Predictor)>,
    time_s: f64,
}

/// Step of the predictor that reads outputs before the first step, s.
const ANY_STEP_S: f64 = 1e-3;

impl Unit {
    /// Reads a model file.
    ///
    /// # Errors
    /// One sentence where it is not a model, or has inputs that laws compute from the recording.
    pub fn new(model_text: &str) -> Result<Self, String> {
        let model = Model::parse(model_text).map_err(|error| error.to_string())?;
        let equations = model.equations(&model.values()).map_err(|error| error.to_string())?;
        let inputs = model.inputs().count();
        if inputs != equations.input.ncols() || model.inputs().any(|input| input.quantity.is_clock()) {
            return Err(format!("{} has laws of time or angle, which a unit cannot hold", model.name));
        }
        let variables = variables(&model, &equations.state_names);
        let values = variables.iter().map(|variable| variable.start).collect();
        let states = vec![0.0; equations.state_names.len()];
        Ok(Self { model, variables, values, states, predictor: None, time_s: 0.0 })
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// All variables but time.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Time, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    fn of(&self, causality: Causality) -> Vec<f64> {
        let all = self.variables.iter().zip(&self.values);
        all.filter(|(variable, _)| variable.causality == causality).map(|(_, value)| *value).collect()
    }

    /// Starts at `time_s` from the start values.
    pub fn start(&mut self, time_s: f64) {
        (self.time_s, self.predictor, self.states) = (time_s, None, self.of(Causality::State));
    }

    /// Values by reference.
    ///
    /// # Errors
    /// One sentence where there is no such variable, or the equations cannot be formed.
    pub fn get(&mut self, references: &[u32]) -> Result<Vec<f64>, String> {
        let is_output = |reference: &u32| {
            self.variables.get(*reference as usize - 1).is_some_and(|v| v.causality == Causality::Output)
        };
        if references.iter().any(|reference| *reference > 0 && is_output(reference)) {
            self.compute_outputs()?;
        }
        let value = |reference: &u32| match reference.checked_sub(1) {
            None => Ok(self.time_s),
            Some(index) => self.values.get(index as usize).copied().ok_or_else(|| unknown(*reference)),
        };
        references.iter().map(value).collect()
    }

    /// Sets a value by reference. Parameters and start values take effect at [`Unit::start`].
    ///
    /// # Errors
    /// One sentence where there is no such variable, it is an output, or the value is not finite.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), String> {
        let index = reference.checked_sub(1).ok_or_else(|| unknown(reference))? as usize;
        let variable = self.variables.get(index).ok_or_else(|| unknown(reference))?;
        if variable.causality == Causality::Output || !value.is_finite() {
            return Err(format!("{} cannot be set to {value}", variable.name));
        }
        self.values[index] = value;
        Ok(())
    }

    /// Steps with the inputs held.
    ///
    /// # Errors
    /// One sentence where the step is not positive or the motion overflows; the state is then as before.
    pub fn step(&mut self, step_s: f64) -> Result<(), String> {
        let inputs: Vec<[f64; 2]> = self.of(Causality::Input).into_iter().map(|value| [value; 2]).collect();
        let slices: Vec<&[f64]> = inputs.iter().map(|input| input.as_slice()).collect();
        self.predict(step_s, &slices).map(|(_, end)| self.states = end)?;
        self.time_s += step_s;
        Ok(())
    }

    fn compute_outputs(&mut self) -> Result<(), String> {
        let inputs: Vec<[f64; 1]> = self.of(Causality::Input).into_iter().map(|value| [value]).collect();
        let slices: Vec<&[f64]> = inputs.iter().map(|input| input.as_slice()).collect();
        let step_s = self.predictor.as_ref().map_or(ANY_STEP_S, |(step_s, _)| *step_s);
        let (outputs, _) = self.predict(step_s, &slices)?;
        let places = self.variables.iter().zip(&mut self.values);
        let places = places.filter(|(variable, _)| variable.causality == Causality::Output);
        places.zip(outputs).for_each(|((_, value), output)| *value = output);
        Ok(())
    }

    /// Last outputs and states for these input samples.
    fn predict(&mut self, step_s: f64, inputs: &[&[f64]]) -> Result<(Vec<f64>, Vec<f64>), String> {
        // Importers compute a step as a difference of times, which varies by rounding.
        let is_same = |known: f64| (known - step_s).abs() < 1e-9 * known;
        if !self.predictor.as_ref().is_some_and(|(known, _)| is_same(*known)) {
            let parameters = self.of(Causality::Parameter);
            let made = Predictor::new(&self.model, &parameters, step_s).map_err(|error| error.to_string())?;
            self.predictor = Some((step_s, made));
        }
        let Some((_, predictor)) = &self.predictor else { return Err("there is no predictor".into()) };
        let kinds = vec![Intersample::Hold; inputs.len()];
        let found =
            predictor.run(inputs, &kinds, Start::State(&self.states)).map_err(|error| error.to_string())?;
        let last = found.outputs.iter().filter_map(|output| output.last().copied()).collect();
        Ok((last, found.end))
    }
}

fn unknown(reference: u32) -> String {
    format!("there is no variable of reference {reference}")
}

/// Inputs, outputs, parameters and start values, with unique names.
fn variables(model: &Model, state_names: &[String]) -> Vec<Variable> {
    let channel = |channel: &socam_model::Channel, causality| Variable {
        name: channel.name.clone(),
        causality,
        unit: channel.unit.into(),
        description: format!("{} at {}", format!("{:?}", channel.quantity).to_lowercase(), channel.at),
        start: 0.0,
    };
    let inputs = model.inputs().map(|input| channel(input, Causality::Input));
    let outputs = model.outputs().map(|output| channel(output, Causality::Output));
    let parameters = model.parameters.iter().map(|parameter| Variable {
        name: parameter.name.clone(),
        causality: Causality::Parameter,
        unit: parameter.unit.clone(),
        description: parameter.source.clone(),
        start: parameter.value,
    });
    let states = state_names.iter().map(|name| Variable {
        name: format!("start_{}", name.replace(|c: char| !c.is_ascii_alphanumeric(), "_")),
        causality: Causality::State,
        unit: String::new(),
        description: format!("start value: {name}"),
        start: 0.0,
    });
    let mut all: Vec<Variable> = inputs.chain(outputs).chain(parameters).chain(states).collect();
    for k in 0..all.len() {
        while all[k].name == "time" || all[..k].iter().any(|other| other.name == all[k].name) {
            all[k].name.push_str("_parameter");
        }
    }
    all
}
