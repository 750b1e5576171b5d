//! A model that advances from communication point to communication point.

use socam_identify::{Intersample, Predictor, Start};
use socam_model::{Equations, Model, Quantity};

use crate::FmuError;
use crate::variables::{self, Variable, VariableRole, variables};

/// Longest sample of the predictor, s. Laws are followed within a sample down to a thousandth of it; without laws a step is exact at any
/// length.
const LONGEST_SAMPLE_S: f64 = 1e-3;

/// Most samples of a step: a step of 100 s.
const MOST_SAMPLES: f64 = 1e5;

/// All state that changes during a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Time, s.
    pub time_s: f64,
    /// Time of the start, s.
    pub start_s: f64,
    /// Inputs in the order of the equations, SI.
    pub inputs: Vec<f64>,
    /// Parameters, SI.
    pub values: Vec<f64>,
    /// States, SI.
    pub state: Vec<f64>,
}

/// A running simulation of a model.
///
/// ```
/// use socam_fmu::Simulation;
///
/// let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
/// let mut simulation = Simulation::new(model)?;
/// let reference = |name: &str| simulation.variables().iter().position(|variable| variable.name == name).unwrap();
/// let (torque, speed) = (reference("motor_torque"), reference("load_speed"));
/// simulation.set(torque, 1.0)?;
/// simulation.step(0.5)?;
/// assert!(simulation.get(&[speed])?[0] > 0.0);
/// # Ok::<(), socam_fmu::FmuError>(())
/// ```
pub struct Simulation {
    model: Model,
    variables: Vec<Variable>,
    /// Source of the values of each input of the equations.
    sources: Vec<Source>,
    now: Snapshot,
    first: Snapshot,
    /// Predictor for the last sample time; a change of a parameter clears it.
    predictor: Option<(f64, Predictor)>,
    /// Equations for derivatives; a change of a parameter clears them.
    equations: Option<Equations>,
}

/// Source of the values of an input of the equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    /// The importer sets the value, which is held over a step.
    Held,
    /// Time since the start.
    Time,
    /// The integral of the input of this index.
    Turned(usize),
}

impl Simulation {
    /// A model at rest at the values of its file, at time 0.
    ///
    /// # Errors
    /// The errors of [`variables()`].
    pub fn new(model: Model) -> Result<Self, FmuError> {
        let values = model.values();
        let equations = model.equations(&values)?;
        let variables = variables(&model, &equations)?;
        let sources: Vec<Source> = model
            .inputs()
            .map(|channel| match channel.quantity {
                Quantity::Time => Source::Time,
                Quantity::Turned => {
                    variables::tachometer(&model, channel).map_or(Source::Held, Source::Turned)
                }
                _ => Source::Held,
            })
            .collect();
        let (inputs, state) = (vec![0.0; sources.len()], vec![0.0; equations.state.nrows()]);
        let now = Snapshot { time_s: 0.0, start_s: 0.0, inputs, values, state };
        Ok(Self { model, variables, sources, first: now.clone(), now, predictor: None, equations: None })
    }

    /// All variables, by their value references.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The present state, to return to it.
    pub fn snapshot(&self) -> &Snapshot {
        &self.now
    }

    /// Returns to a snapshot of the same model.
    ///
    /// # Errors
    /// [`FmuError::Argument`] where it is of another model.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), FmuError> {
        let lengths = |s: &Snapshot| [s.inputs.len(), s.values.len(), s.state.len()];
        if lengths(snapshot) != lengths(&self.now) {
            return Err(FmuError::Argument("the state to be restored is one of another model".into()));
        }
        if snapshot.values != self.now.values {
            self.forget();
        }
        self.now.clone_from(snapshot);
        Ok(())
    }

    /// Returns to the values before the first call.
    pub fn reset(&mut self) {
        self.now.clone_from(&self.first);
        self.forget();
    }

    /// Sets the time at which the simulation starts, s.
    ///
    /// # Errors
    /// [`FmuError::Argument`] where it is not finite.
    pub fn start_at(&mut self, start_s: f64) -> Result<(), FmuError> {
        if !start_s.is_finite() {
            return Err(FmuError::Argument(format!("a start at {start_s} s cannot be meant")));
        }
        (self.now.start_s, self.now.time_s) = (start_s, start_s);
        Ok(())
    }

    /// Sets an input, a parameter or a state by its value reference, SI.
    ///
    /// # Errors
    /// [`FmuError::Argument`] where there is no such variable, it cannot be set, or the value is out of its bounds.
    pub fn set(&mut self, reference: usize, value: f64) -> Result<(), FmuError> {
        let variable = self.variable(reference)?;
        let (name, (least, greatest)) = (&variable.name, variable.bounds);
        if !(value.is_finite() && (least..=greatest).contains(&value)) {
            let problem = format!("{name} cannot be {value}: its limits are {least} and {greatest}");
            return Err(FmuError::Argument(problem));
        }
        match variable.kind {
            VariableRole::Input(index) => self.now.inputs[index] = value,
            VariableRole::State(index) => self.now.state[index] = value,
            VariableRole::Parameter(index) => {
                self.now.values[index] = value;
                self.forget();
            }
            VariableRole::Time | VariableRole::Output(_) | VariableRole::Derivative(_) => {
                return Err(FmuError::Argument(format!("{name} is computed and cannot be set")));
            }
        }
        Ok(())
    }

    /// Values by their value references, SI.
    ///
    /// # Errors
    /// [`FmuError::Argument`] where there is no such variable, [`FmuError::Simulation`] where outputs cannot be computed.
    pub fn get(&mut self, references: &[usize]) -> Result<Vec<f64>, FmuError> {
        let kinds: Result<Vec<VariableRole>, _> =
            references.iter().map(|r| self.variable(*r).map(|variable| variable.kind)).collect();
        let kinds = kinds?;
        let needs_outputs = kinds.iter().any(|kind| matches!(kind, VariableRole::Output(_)));
        let outputs = if needs_outputs { self.outputs()? } else { Vec::new() };
        let needs_rates = kinds.iter().any(|kind| matches!(kind, VariableRole::Derivative(_)));
        let rates = if needs_rates { self.derivatives()? } else { Vec::new() };
        let now = &self.now;
        let value = |kind: &VariableRole| match *kind {
            VariableRole::Time => now.time_s,
            VariableRole::Input(index) => now.inputs[index],
            VariableRole::Output(index) => outputs[index],
            VariableRole::Parameter(index) => now.values[index],
            VariableRole::State(index) => now.state[index],
            VariableRole::Derivative(index) => rates[index],
        };
        Ok(kinds.iter().map(value).collect())
    }

    /// Outputs at the present state and inputs, SI.
    ///
    /// # Errors
    /// [`FmuError::Simulation`] where the parameters have no equations or an output overflows.
    pub fn outputs(&mut self) -> Result<Vec<f64>, FmuError> {
        let sample_s = self.predictor.as_ref().map_or(LONGEST_SAMPLE_S, |(sample_s, _)| *sample_s);
        let prediction = self.predict(sample_s, 0)?;
        Ok(prediction.outputs.iter().map(|output| output[0]).collect())
    }

    /// Advances by `step_s` with held inputs.
    ///
    /// # Errors
    /// [`FmuError::Argument`] for a step that is not positive or longer than 100 s, [`FmuError::Simulation`] where the motion overflows. The
    /// state is then that before the step.
    pub fn step(&mut self, step_s: f64) -> Result<(), FmuError> {
        let samples = (step_s / LONGEST_SAMPLE_S - 1e-6).ceil().max(1.0);
        if !(step_s > 0.0 && samples <= MOST_SAMPLES) {
            return Err(FmuError::Argument(format!("a step of {step_s} s is not between 0 and 100 s")));
        }
        let prediction = self.predict(step_s / samples, samples as usize)?;
        self.now.state = prediction.end;
        for (index, source) in self.sources.iter().enumerate() {
            if let Source::Turned(speed) = source {
                self.now.inputs[index] += step_s * self.now.inputs[*speed];
            }
        }
        self.now.time_s += step_s;
        Ok(())
    }

    /// Discards everything that was computed from parameters.
    fn forget(&mut self) {
        (self.predictor, self.equations) = (None, None);
    }

    fn variable(&self, reference: usize) -> Result<&Variable, FmuError> {
        let missing = || FmuError::Argument(format!("no variable has the value reference {reference}"));
        self.variables.get(reference).ok_or_else(missing)
    }

    /// `samples` steps of `sample_s` from the present state.
    fn predict(&mut self, sample_s: f64, samples: usize) -> Result<socam_identify::Prediction, FmuError> {
        let now = &self.now;
        // Communication points are rounded; one predictor serves steps of equal length.
        let fits = |own_s: f64| (own_s - sample_s).abs() <= 1e-9 * sample_s;
        let (own_s, predictor) = match self.predictor.take() {
            Some((own_s, predictor)) if fits(own_s) => (own_s, predictor),
            _ => (sample_s, Predictor::new(&self.model, &now.values, sample_s)?),
        };
        let along = |(index, source): (usize, &Source)| {
            let (first, slope) = match source {
                Source::Held => (now.inputs[index], 0.0),
                Source::Time => (now.time_s - now.start_s, 1.0),
                Source::Turned(speed) => (now.inputs[index], now.inputs[*speed]),
            };
            (0..=samples).map(|k| first + slope * sample_s * k as f64).collect::<Vec<f64>>()
        };
        let inputs: Vec<Vec<f64>> = self.sources.iter().enumerate().map(along).collect();
        let slices: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
        let kinds = vec![Intersample::Linear; slices.len()];
        let prediction = predictor.run(&slices, &kinds, Start::State(&now.state));
        self.predictor = Some((own_s, predictor));
        Ok(prediction?)
    }
}

mod exchange;
#[cfg(test)]
mod tests;
