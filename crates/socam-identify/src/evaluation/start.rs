//! Nuisance parameters before a fit: start states from the first samples, offsets of zero.

use socam_model::{Equations, effects::LawInput};

use crate::{
    IdentifyError,
    prediction::start_state,
    preprocessing::segments,
    problem::{Problem, StartState},
};

/// Indices of the internal states of force laws (the deflection of bristles). Their start values are not fitted: the first reversal
/// erases them, and before it they would fit other errors.
pub(crate) fn law_states(equations: &Equations) -> Vec<usize> {
    let own = equations.ports.iter().enumerate();
    let own = own.filter(|(_, port)| port.law.law_inputs.get(port.law_input) == Some(&LawInput::State));
    let seen = own.filter_map(|(p, _)| (0..equations.port.ncols()).find(|i| equations.port[(p, *i)] != 0.0));
    seen.collect()
}

/// First nuisance parameters by segment: start state from the first samples, offsets zero.
pub(crate) fn first_nuisance(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let equations = problem.model.equations(values)?;
    let offsets = problem.model.outputs().filter(|channel| channel.estimate_offset).count();
    problem
        .segments
        .iter()
        .map(|segment| {
            let mut nuisance = Vec::new();
            if problem.options.start_state == StartState::Free {
                let (inputs, outputs) = first_samples(problem, segment)?;
                nuisance = start_state::guess(&equations, values, &inputs, &outputs);
            }
            nuisance.extend(std::iter::repeat_n(0.0, offsets));
            Ok(nuisance)
        })
        .collect()
}

/// First sample of every input and output (NaN where missing) of a segment.
fn first_samples(
    problem: &Problem<'_>,
    segment: &segments::Segment,
) -> Result<(Vec<f64>, Vec<f64>), IdentifyError> {
    let mut first = (Vec::new(), Vec::new());
    let head = segments::Segment { rows: 2, ..segment.clone() };
    segments::read(
        problem.model,
        &problem.datasets[segment.recording],
        &head,
        &problem.intersample,
        |chunk| {
            if first.0.is_empty() {
                first.0 = chunk.inputs.iter().map(|input| input[0]).collect();
                first.1 = chunk.outputs.iter().map(|output| output[0]).collect();
            }
        },
    )?;
    Ok(first)
}
