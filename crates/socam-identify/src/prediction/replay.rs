//! The prediction of a segment beside its measurements.

use socam_model::Model;

use crate::{
    IdentifyError,
    prediction::{
        integrator::{DEFAULT_TOLERANCE, Integrator},
        intersample,
        predictor::{Predictor, Start},
    },
    preprocessing::segments::{self, Segment},
    problem::{Problem, StartState},
};

/// Signals of a segment, SI.
pub(crate) struct Replay {
    /// Inputs as the model reads them.
    pub(crate) inputs: Vec<Vec<f64>>,
    /// Measured outputs; NaN where missing.
    pub(crate) measured: Vec<Vec<f64>>,
    /// Predicted outputs, without estimated offsets.
    pub(crate) predicted: Vec<Vec<f64>>,
    /// States at the rows that were asked for.
    pub(crate) states: Vec<Vec<f64>>,
}

/// Predicts a segment by `model`, which has the inputs of the problem's, at parameters `values` and from the start state of `nuisance`. The
/// states at the rows `kept`, counted from the start of the segment in rising order, are part of the result.
///
/// # Errors
/// When the recording cannot be read, or the prediction overflows.
pub(crate) fn replay(
    problem: &Problem<'_>,
    model: &Model,
    values: &[f64],
    segment: &Segment,
    nuisance: &[f64],
    kept: &[u64],
) -> Result<Replay, IdentifyError> {
    let predictor = Predictor::along(model, values, segment.steps())?;
    let bases: Vec<_> = problem.intersample.iter().map(|kind| intersample::basis(*kind)).collect();
    let outputs = model.outputs().count();
    let mut all = Replay {
        inputs: vec![Vec::new(); problem.model.inputs().count()],
        measured: vec![Vec::new(); problem.outputs()],
        predicted: vec![Vec::new(); outputs],
        states: Vec::new(),
    };
    let (mut polynomials, mut raw, mut now) = (Vec::new(), Vec::new(), vec![0.0; outputs]);
    let mut row = 0;
    let mut integrator: Option<Result<Integrator<'_>, IdentifyError>> = None;
    let dataset = &problem.datasets[segment.recording];
    segments::read(problem.model, dataset, segment, &problem.intersample, |chunk| {
        all.inputs.iter_mut().zip(&chunk.inputs).for_each(|(all, more)| all.extend(more));
        all.measured.iter_mut().zip(&chunk.outputs).for_each(|(all, more)| all.extend(more));
        for k in 0..chunk.rows() {
            chunk.inputs_along(k, &bases, &mut polynomials);
            let running = integrator.get_or_insert_with(|| {
                let first: Vec<f64> = polynomials.iter().map(|polynomial| polynomial.at(1.0)).collect();
                let start = match problem.options.start_state {
                    StartState::Free => Start::State(&nuisance[..predictor.states()]),
                    StartState::Equilibrium => Start::Equilibrium,
                };
                let state = predictor.start(start, &first)?;
                Ok(Integrator::new(predictor.hybrid_modes(), DEFAULT_TOLERANCE, &state, &first))
            });
            let Ok(running) = running else { return };
            if row > 0 {
                running.sample(&polynomials, chunk.parts(k, predictor.hybrid_modes().finest_s), |_| {});
            }
            if kept.get(all.states.len()) == Some(&row) {
                all.states.push(running.state().to_vec());
            }
            row += 1;
            raw.clear();
            raw.extend(chunk.inputs.iter().map(|input| input[k]));
            running.outputs(&raw, &mut now);
            all.predicted.iter_mut().zip(&now).for_each(|(output, value)| output.push(*value));
        }
    })?;
    let end = integrator.transpose()?;
    if end.iter().flat_map(Integrator::state).chain(&now).any(|value| !value.is_finite()) {
        return Err(IdentifyError::Diverged { model: model.name.clone() });
    }
    Ok(all)
}
