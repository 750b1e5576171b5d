//! Fast simulation of a model: the predictions of a fit, without sensitivities.

use socam_model::{Equations, Model};

use crate::{
    IdentifyError, Intersample,
    prediction::{
        event::Event,
        exponential::SampleSteps,
        hybrid_modes::HybridModes,
        integrator::{DEFAULT_TOLERANCE, Integrator},
        intersample::{self, InputPolynomial},
        start_state,
    },
};

/// Start of a prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start<'a> {
    /// The drivetrain is at rest relative to the first input sample. Only for drivetrains that have such a state (no free-running
    /// position).
    Equilibrium,
    /// The states of the model are given, in the order of [`Equations::state_names`], SI.
    State(&'a [f64]),
}

/// The result of [`Predictor::run`].
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Per output, in the order of [`Model::outputs`], one value per sample, SI.
    pub outputs: Vec<Vec<f64>>,
    /// States at the last sample, SI. A run that continues from them starts with that sample.
    pub end: Vec<f64>,
    /// Number of steps; at least one per sample after the first.
    pub steps: usize,
    /// Number of steps of the shortest length that missed the tolerance. More than a few mean that a law is too steep for the sample
    /// time; the prediction is then right on average only.
    pub unresolved: usize,
}

/// Simulates a model at given parameter values and sample time.
///
/// ```
/// use socam_identify::{Intersample, Predictor, Start};
///
/// let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
/// let predictor = Predictor::new(&model, &model.values(), 1e-3)?.with_tolerance(1e-4);
/// let (torque, still) = ([1.0; 100], vec![0.0; predictor.states()]);
/// let found = predictor.run(&[&torque], &[Intersample::Hold], Start::State(&still))?;
/// // Both speeds rise from zero.
/// assert!(found.outputs.iter().all(|speed| speed[0] == 0.0 && speed[99] > 0.0));
/// assert_eq!((found.end.len(), found.unresolved), (3, 0));
/// # Ok::<(), socam_identify::IdentifyError>(())
/// ```
///
/// # Method
/// Exponential time differencing (Cox and Matthews 2002, doi:10.1006/jcph.2002.6995): the step of the linear part is exact, however
/// stiff it is. Forces are interpolated over a step by a parabola through their values at its start, middle and end, which are solved
/// together with the motion (exponential collocation of order four: Hochbruck and Ostermann 2005,
/// doi:10.1016/j.apnum.2004.08.005). A sample in which a force departs from the parabola is divided into up to 1024 steps. A model
/// without nonlinear laws is exact to rounding. A gear with play is linear on either flank and between them: a step ends within a
/// thousandth of a sample of the time at which teeth meet or part, and the state is corrected for the rest.
///
/// # Assumes
/// Inputs follow [`Intersample`] between their samples, as in a fit, and the samples have no gap.
///
/// # Breaks when
/// A force law is curved only within an eighth of a sample (a speed that touches zero between samples may go unnoticed), or jumps
/// within a thousandth of a sample ([`Prediction::unresolved`] counts such steps). The reference for such cases is the
/// error-controlled plant of the simulator, which shares only the equations with this predictor.
pub struct Predictor {
    values: Vec<f64>,
    name: String,
    hybrid_modes: HybridModes,
    tolerance: f64,
}

impl Predictor {
    /// `values` are all parameters of the model, SI; `sample_time_s` is in s.
    ///
    /// # Errors
    /// When the equations cannot be formed at these values, the sample time is not positive, or the motion overflows within a sample.
    pub fn new(model: &Model, values: &[f64], sample_time_s: f64) -> Result<Self, IdentifyError> {
        if !(sample_time_s.is_finite() && sample_time_s > 0.0) {
            return Err(IdentifyError::Option(format!("a sample time of {sample_time_s} s cannot be meant")));
        }
        Self::along(model, values, SampleSteps::Even(sample_time_s))
    }

    /// For steps of these lengths.
    pub(crate) fn along(model: &Model, values: &[f64], steps: SampleSteps) -> Result<Self, IdentifyError> {
        let equations = model.equations(values)?;
        let hybrid_modes = HybridModes::new(&equations, &[], values, &[], steps)
            .ok_or_else(|| IdentifyError::Diverged { model: model.name.clone() })?;
        let (values, name) = (values.to_vec(), model.name.clone());
        Ok(Self { values, name, hybrid_modes, tolerance: DEFAULT_TOLERANCE })
    }

    /// Sets the tolerance of a step's error in the input of a law, relative to the largest such input so far. Errors of steps add up
    /// until they are damped: outputs have about ten times this error relative to their range. A tolerance 32 times smaller doubles the
    /// number of steps where a law is curved.
    #[must_use]
    pub fn with_tolerance(mut self, relative: f64) -> Self {
        self.tolerance = relative.max(0.0);
        self
    }

    fn equations(&self) -> &Equations {
        &self.hybrid_modes.network().equations
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.equations().state.nrows()
    }

    /// Predicts the outputs. `inputs` holds one slice per input in the order of [`Model::inputs`], SI, all of the same length;
    /// `intersample` has one entry per input.
    ///
    /// # Errors
    /// When the numbers or lengths of inputs or start state do not fit, when [`Start::Equilibrium`] is asked of a model without
    /// equilibrium, or when the prediction overflows.
    pub fn run(
        &self,
        inputs: &[&[f64]],
        intersample: &[Intersample],
        start: Start<'_>,
    ) -> Result<Prediction, IdentifyError> {
        let rows = inputs.first().map_or(0, |input| input.len());
        self.check(inputs, intersample.len(), rows)?;
        let held: Vec<_> = inputs
            .iter()
            .zip(intersample)
            .map(|(input, kind)| {
                (intersample::basis(*kind), intersample::coefficients(input, 0..rows, *kind))
            })
            .collect();
        let along = |k: usize, polynomials: &mut Vec<InputPolynomial>| {
            polynomials.clear();
            polynomials.extend(held.iter().map(|(bases, held)| InputPolynomial::new(bases, &held[k..])));
        };
        let (mut polynomials, mut raw) = (Vec::new(), Vec::new());
        along(0, &mut polynomials);
        let first: Vec<f64> = polynomials.iter().map(|polynomial| polynomial.at(1.0)).collect();
        let state = self.start(start, &first)?;
        let mut integrator = Integrator::new(&self.hybrid_modes, self.tolerance, &state, &first);
        let mut steps = 0;
        let mut values = vec![0.0; self.equations().output.nrows()];
        let mut outputs: Vec<Vec<f64>> = values.iter().map(|_| Vec::with_capacity(rows)).collect();
        for k in 0..rows {
            if k > 0 {
                along(k, &mut polynomials);
                integrator.sample(&polynomials, None, |event| {
                    steps += usize::from(matches!(event, Event::Step(_)));
                });
            }
            raw.clear();
            raw.extend(inputs.iter().map(|input| input[k]));
            integrator.outputs(&raw, &mut values);
            outputs.iter_mut().zip(&values).for_each(|(output, value)| output.push(*value));
        }
        let end = integrator.state().to_vec();
        if !(end.iter().chain(&values).all(|value| value.is_finite())) {
            return Err(IdentifyError::Diverged { model: self.name.clone() });
        }
        Ok(Prediction { outputs, end, steps, unresolved: integrator.unresolved })
    }

    fn check(&self, inputs: &[&[f64]], kinds: usize, rows: usize) -> Result<(), IdentifyError> {
        let refuse = |text: String| Err(IdentifyError::Option(text));
        let (given, expected) = (inputs.len(), self.equations().input.ncols());
        if given != expected {
            return refuse(format!("{given} inputs for the {expected} of {}", self.name));
        }
        if kinds != expected {
            return refuse(format!("{kinds} kinds of motion between samples for the {expected} inputs"));
        }
        if rows == 0 || inputs.iter().any(|input| input.len() != rows) {
            return refuse("inputs need equal numbers of samples, at least one".into());
        }
        Ok(())
    }

    pub(crate) fn hybrid_modes(&self) -> &HybridModes {
        &self.hybrid_modes
    }

    pub(crate) fn start(&self, start: Start<'_>, inputs: &[f64]) -> Result<Vec<f64>, IdentifyError> {
        match start {
            Start::State(state) if state.len() == self.states() => Ok(state.to_vec()),
            Start::State(state) => Err(IdentifyError::Option(format!(
                "a start state of {} numbers for the {} states of {}",
                state.len(),
                self.states(),
                self.name
            ))),
            Start::Equilibrium => start_state::equilibrium(self.equations(), &self.values, inputs)
                .map(|state| state.iter().copied().collect())
                .ok_or_else(|| IdentifyError::Unsuited {
                    method: "a start from rest",
                    model: self.name.clone(),
                    why: "nothing holds its position, so that it has no state of rest; give a start state"
                        .into(),
                }),
        }
    }
}

#[cfg(test)]
mod tests;
