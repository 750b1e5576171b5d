//! Functions for an importer that integrates the model itself (model exchange).

use super::{Simulation, Source};
use crate::{FmuError, rates, variables};

impl Simulation {
    /// Whether an importer can integrate the model itself.
    ///
    /// # Errors
    /// [`FmuError::Unsuited`] where an effect depends on the turned angle, which is no state of the equations.
    pub fn check_exchange(&self) -> Result<(), FmuError> {
        let problem =
            "an effect depends on the angle that a node has turned, which only co-simulation follows";
        variables::can_exchange(&self.model).then_some(()).ok_or_else(|| FmuError::Unsuited(problem.into()))
    }

    /// Sets the time without a step, s.
    ///
    /// # Errors
    /// [`FmuError::Argument`] where it is not finite.
    pub fn set_time(&mut self, time_s: f64) -> Result<(), FmuError> {
        if !time_s.is_finite() {
            return Err(FmuError::Argument(format!("a time of {time_s} s cannot be meant")));
        }
        self.now.time_s = time_s;
        Ok(())
    }

    /// Sets all states, SI. Values that are not finite are an importer's trial step and give derivatives that are not.
    ///
    /// # Errors
    /// [`FmuError::Argument`] for another number of states.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), FmuError> {
        if states.len() != self.now.state.len() {
            let problem = format!("{} values for {} states", states.len(), self.now.state.len());
            return Err(FmuError::Argument(problem));
        }
        self.now.state.copy_from_slice(states);
        Ok(())
    }

    /// Time derivatives of the states, SI per second.
    ///
    /// # Errors
    /// [`FmuError::Model`] where the parameters have no equations.
    pub fn derivatives(&mut self) -> Result<Vec<f64>, FmuError> {
        let equations = match self.equations.take() {
            Some(equations) => equations,
            None => self.model.equations(&self.now.values)?,
        };
        let now = &self.now;
        let input = |(source, input): (&Source, &f64)| match source {
            Source::Time => now.time_s - now.start_s,
            Source::Held | Source::Turned(_) => *input,
        };
        let inputs: Vec<f64> = self.sources.iter().zip(&now.inputs).map(input).collect();
        let rates = rates::rates(&equations, &now.values, &now.state, &inputs);
        self.equations = Some(equations);
        Ok(rates)
    }
}
