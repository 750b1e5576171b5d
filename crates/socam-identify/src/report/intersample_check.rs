//! Check of the intersample assumption: whether another one moves an estimate out of its interval, and whether the recordings contradict it.

use socam_model::{Channel, Intersample};

use crate::{
    IdentifyError, Problem,
    optimiser::{
        descent::Descent,
        intersamples::{Alternative, CLEARLY, TOLD_APART, is_open, others},
    },
    report::ParameterEstimate,
};

/// Smallest move of an estimate that is reported, in half widths of its interval.
const LEAST_MOVE: f64 = 1.0;

/// One sentence per input whose assumption moves a determined parameter out of its interval, unless the recordings contradict the other
/// assumption.
pub(crate) fn warnings(
    problem: &Problem<'_>,
    descent: &Descent,
    parameters: &[ParameterEstimate],
) -> Result<Vec<String>, IdentifyError> {
    let mut found = Vec::new();
    for (input, channel) in problem.model.inputs().enumerate() {
        let kind = problem.intersample[input];
        let rival_deviance = problem.between.get(input).and_then(|between| between.rival_deviance);
        if rival_deviance.is_some_and(|worse| worse > CLEARLY * TOLD_APART) {
            continue;
        }
        let mut best: Option<Moved> = None;
        for other in others(channel, kind) {
            let alternative = Alternative::new(problem, descent, (input, other), TOLD_APART)?;
            let moved = alternative.and_then(|one| Moved::new(problem, descent, parameters, one));
            best = [best, moved].into_iter().flatten().min_by(|a, b| a.deviance.total_cmp(&b.deviance));
        }
        found.extend(best.map(|best| best.sentence(channel, kind, is_open(&problem.options, channel))));
    }
    Ok(found)
}

/// An assumption that was not made, that the recordings do not contradict, and that moves an estimate.
struct Moved {
    kind: Intersample,
    deviance: f64,
    /// The parameter that it moves most, and the move in half widths of its interval.
    parameter: String,
    half_widths: f64,
}

impl Moved {
    /// `None` where it moves no estimate, or the recordings contradict it.
    fn new(
        problem: &Problem<'_>,
        descent: &Descent,
        parameters: &[ParameterEstimate],
        Alternative { kind, deviance, point }: Alternative,
    ) -> Option<Self> {
        let point = point.filter(|_| deviance <= TOLD_APART)?;
        let moved = |index: usize| point.values[index] - descent.point.values[index];
        let each = problem.free.iter().filter_map(|index| {
            let estimate = &parameters[*index];
            let [from, to] = [estimate.ci95[0]?, estimate.ci95[1]?];
            estimate.identifiable.then(|| (estimate.name.clone(), 2.0 * moved(*index).abs() / (to - from)))
        });
        let (parameter, half_widths) = each.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (half_widths >= LEAST_MOVE).then_some(Self { kind, deviance, parameter, half_widths })
    }

    fn sentence(&self, channel: &Channel, kind: Intersample, is_open: bool) -> String {
        let Self { kind: other, deviance, parameter, half_widths } = self;
        let (input, kind, other) = (&channel.name, kind.name(), other.name());
        if *deviance < -TOLD_APART {
            let stated = if is_open { "was taken as" } else { "is stated to be" };
            return format!(
                "{input} {stated} {kind} between its samples, but {other} fits the recordings better (chi-square lower by {:.0}) and moves {parameter} by {half_widths:.1} half-widths of its interval",
                -deviance
            );
        }
        format!(
            "the recordings do not tell whether {input} is {kind} or {other} between its samples; {kind} was taken, and {other} would move {parameter} by {half_widths:.1} half-widths of its interval: find out what drives it, and state it by `between` of {input} in the model file"
        )
    }
}
